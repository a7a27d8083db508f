/* Walks through the whole API for the sanitizers, valgrind and the coverage count: exercise [-t THREADS] [DIRECTORY...].
 * Directories hold table files; the loader must accept or refuse each with a message. Built with -DEXERCISE_EXR where
 * there is a loader. Correct numbers are the other tests' business: this one looks for memory, threads and undefined
 * behaviour. */
#include <pthread.h>
#include <string.h>

#include "batch.h"
#include "check.h"

enum { COUNT = 300, WIDTH = 9, WIDEST = 300, HEIGHT = 3 };

/* n directions from a fixed generator, with hard ones among them. */
static void fill(float *values, size_t n, float low, float high, uint32_t seed)
{
    static const float hard[] = {-INFINITY, INFINITY, NAN, 0.0f, 1e8f, -1e8f, 1.57079637f, -1.57079637f};
    for (size_t i = 0; i < n; ++i) {
        seed = seed * 1664525u + 1013904223u;
        values[i] = low + (high - low) * (float)(seed >> 8) / 16777216.0f;
        if (i % 13 == 5)
            values[i] = hard[(i / 13) % (sizeof hard / sizeof *hard)];
    }
}

/* Inputs of arrays: theta_r, phi_r, u_theta, u_phi, offset, u_lobe, then shares. */
typedef struct arrays {
    float in[6][COUNT], shares[HAIRLUT_MAX_LOBES * COUNT], out[5][COUNT];
} arrays;

static void fill_arrays(arrays *a, const hairlut_model *model, size_t n)
{
    for (uint32_t k = 0; k < 6; ++k)
        fill(a->in[k], n, k < 2 ? -2.0f : k == 4 ? -1.0f : 0.0f, k < 2 ? 2.0f : 1.0f, k + 1);
    fill(a->shares, n * (size_t)hairlut_lobe_count(model), -0.2f, 1.0f, 9);
}

static void require_finite(const arrays *a, size_t n)
{
    for (size_t i = 0; i < n; ++i)
        REQUIRE(isfinite(a->out[2][i]) && isfinite(a->out[3][i]) && isfinite(a->out[4][i]));
}

/* Every function of a set of kernels. */
static void check_kernels(const hairlut_batch *batch, const hairlut_model *model, size_t n)
{
    static _Thread_local arrays a;
    float(*in)[COUNT] = a.in, (*out)[COUNT] = a.out;
    const hairlut_samples all = {out[0], out[1], out[2], out[3]}, angles = {out[0], out[1], NULL, NULL};
    fill_arrays(&a, model, n);
    for (int lobe = 0; lobe < hairlut_lobe_count(model); ++lobe) {
        batch->sample_lobe(model, lobe, n, in[0], in[1], in[2], in[3], lobe % 2 ? angles : all);
        batch->pdf_lobe(model, lobe, n, in[0], in[1], out[0], out[1], out[4]);
        require_finite(&a, n);
    }
    for (int k = 0; k < 4; ++k) {
        const float *shares = k & 1 ? a.shares : NULL, *offset = k & 2 ? in[4] : NULL;
        batch->sample_hair(model, n, shares, in[0], in[1], offset, in[5], in[2], in[3], k ? all : angles);
        batch->pdf_hair(model, n, shares, in[0], in[1], offset, out[0], out[1], out[4]);
        require_finite(&a, n);
    }
}

/* Every kernel that this processor runs, not only the widest, and the public functions. */
static void check_batches(const hairlut_model *model, size_t n)
{
    static const hairlut_batch public_set = {"public", hairlut_sample_lobe_n, hairlut_pdf_lobe_n, hairlut_sample_hair_n, hairlut_pdf_hair_n};
    static _Thread_local arrays a;
    const hairlut_samples all = {a.out[0], a.out[1], a.out[2], a.out[3]};
    const hairlut_batch *batch;
    check_kernels(&public_set, model, n);
    for (int level = 0; (batch = hairlut_batch_level(level)); ++level)
        check_kernels(batch, model, n);
    fill_arrays(&a, model, n);
    hairlut_sample_direct_n(model, n, a.in[0], a.in[1], a.in[2], a.in[3], all);
    hairlut_pdf_direct_n(model, n, a.in[0], a.in[1], a.out[0], a.out[1], a.out[4]);
    require_finite(&a, n);
    hairlut_sample_multiple_n(model, n, a.in[0], a.in[1], a.in[2], a.in[3], all);
    hairlut_pdf_multiple_n(model, n, a.in[0], a.in[1], a.out[0], a.out[1], a.out[4]);
    require_finite(&a, n);
    hairlut_sample_lobe_n(model, -1, n, a.in[0], a.in[1], a.in[2], a.in[3], all);
    hairlut_pdf_lobe_n(model, HAIRLUT_MAX_LOBES, n, a.in[0], a.in[1], a.in[2], a.in[3], a.out[4]);
    for (size_t i = 0; i < n; ++i)
        REQUIRE(a.out[2][i] == 0.0f && a.out[4][i] == 0.0f);
}

/* Their names in a line, for the coverage count. */
static void print_kernels(void)
{
    printf("kernels");
    for (int level = 0; hairlut_batch_level(level); ++level)
        printf(" %s", hairlut_batch_level(level)->name);
    putchar('\n');
}

static void check_frame(void)
{
    const hairlut_frame frame = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};
    static const float directions[][3] = {{0.6f, 0.0f, 0.8f}, {1.0f, 0.0f, 0.0f}, {-2.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f},
                                          {NAN, 0.0f, 1.0f}, {3e38f, 3e38f, 3e38f}};
    for (size_t k = 0; k < sizeof directions / sizeof *directions; ++k) {
        float theta, phi, back[3];
        hairlut_angles(&frame, directions[k], &theta, &phi);
        REQUIRE(fabsf(theta) <= 1.57079637f && fabsf(phi) <= 3.14159274f);
        hairlut_direction(&frame, theta, phi, back);
        REQUIRE(fabsf(back[0]) <= 1.0f + 1e-6f);
    }
}

static void check_names(const hairlut_model *model)
{
    const int count = hairlut_lobe_count(model);
    REQUIRE(count >= 1 && count <= HAIRLUT_MAX_LOBES);
    REQUIRE(!hairlut_lobe_name(model, -1) && !hairlut_lobe_name(model, count));
    REQUIRE(hairlut_lobe_index(model, NULL) == -1 && hairlut_lobe_index(model, "no such lobe") == -1);
    for (int lobe = -1; lobe <= count; ++lobe) {
        int width, height;
        const int exists = lobe >= 0 && lobe < count;
        REQUIRE(!exists || hairlut_lobe_index(model, hairlut_lobe_name(model, lobe)) == lobe);
        hairlut_table_size(model, lobe, HAIRLUT_THETA, &width, &height);
        REQUIRE(exists ? width >= 4 && height >= 2 : width == 0 && height == 0);
        hairlut_table_size(model, lobe, HAIRLUT_PHI, &width, &height);
        REQUIRE(exists || width == 0);
    }
}

static void use(const hairlut_model *model)
{
    float u[2];
    check_model(model);
    check_names(model);
    for (size_t n = 0; n <= 20; ++n)
        check_batches(model, n);
    check_batches(model, COUNT);
    const hairlut_sample s = hairlut_sample_lobe(model, 0, 0.3f, 0.5f, 0.25f, 0.75f);
    hairlut_invert_lobe(model, 0, 0.3f, 0.5f, s.theta_i, s.phi_i, u);
    REQUIRE(fabsf(u[0] - 0.25f) < 1e-5f && fabsf(u[1] - 0.75f) < 1e-5f);
    REQUIRE(hairlut_pdf_to_solid_angle(s.pdf_angle, s.theta_i) == s.pdf_solid_angle);
    REQUIRE(hairlut_pdf_multiple(model, NAN, 0.5f, s.theta_i, s.phi_i) == 0.0f);
    REQUIRE(hairlut_pdf_direct(model, 0.3f, 0.5f, 4.0f, s.phi_i) == 0.0f);
    REQUIRE(isfinite(hairlut_sample_direct(model, 0.3f, 0.5f, 0.1f, 0.2f).theta_i));
    REQUIRE(isfinite(hairlut_sample_multiple(model, 0.3f, 0.5f, 0.1f, 0.2f).theta_i));
}

static float texels[2][2 * HEIGHT * WIDEST];

static hairlut_table straight_of(int azimuth, int width)
{
    const float low = azimuth ? 0.0f : -1.57079637f, high = azimuth ? 6.28318548f : 1.57079637f;
    const float last = (float)(width - 1);
    for (int k = 0; k < HEIGHT * width; ++k) {
        texels[azimuth][2 * k] = k % width == width - 1 ? high : low + (high - low) * (float)(k % width) / last;
        texels[azimuth][2 * k + 1] = high - low;
    }
    const hairlut_table table = {sizeof table, texels[azimuth], width, HEIGHT, -1.5f, 1.5f, low, high, HAIRLUT_WARP_UNIFORM, 1e-6f};
    return table;
}

static hairlut_table straight(int azimuth)
{
    return straight_of(azimuth, WIDTH);
}

static void *never(void *user, size_t size)
{
    (void)user;
    (void)size;
    return NULL;
}

static void forget(void *user, void *memory)
{
    (void)user;
    free(memory);
}

/* Two lobes that share a theta table, the second of uniform azimuth. */
typedef struct two_lobes {
    hairlut_table theta, phi;
    hairlut_lobe_desc lobes[2];
    hairlut_model_desc desc;
} two_lobes;

static void describe(two_lobes *two, int width)
{
    const hairlut_lobe_desc direct = {sizeof direct, "direct", &two->theta, &two->phi, HAIRLUT_AZIMUTH_SUM};
    const hairlut_lobe_desc multiple = {sizeof multiple, "multiple", &two->theta, NULL, HAIRLUT_AZIMUTH_SUM};
    const hairlut_model_desc desc = {sizeof desc, 2, two->lobes, NULL};
    two->theta = straight_of(0, width);
    two->phi = straight_of(1, width);
    two->lobes[0] = direct;
    two->lobes[1] = multiple;
    two->desc = desc;
}

static void create_and_use(const hairlut_model_desc *desc)
{
    hairlut_model *model;
    REQUIRE(hairlut_model_create(desc, NULL, &model, NULL) == HAIRLUT_OK);
    use(model);
    hairlut_free(model);
}

/* The least width, and two that are not searched as small ones are: by two counts of 16, and with a halving between them. */
static void check_widths(void)
{
    static const int widths[] = {4, 100, WIDEST};
    for (size_t k = 0; k < sizeof widths / sizeof *widths; ++k) {
        two_lobes two;
        describe(&two, widths[k]);
        create_and_use(&two.desc);
    }
}

/* Mixtures of one node, a few, and so many that single samples look for theirs. */
static void check_mixtures(void)
{
    enum { MOST = 80 };
    static float nodes[MOST], grid[2 * MOST * MOST];
    for (int k = 0; k < MOST; ++k)
        nodes[k] = (float)k / MOST;
    for (int k = 0; k < 2 * MOST * MOST; ++k)
        grid[k] = k < MOST * MOST ? (float)(k % 7) + 0.5f : (float)(k % 3);
    static const int sides[][2] = {{1, 1}, {3, 1}, {1, 5}, {4, 3}, {MOST, MOST}};
    for (size_t k = 0; k < sizeof sides / sizeof *sides; ++k)
        for (int form = 0; form < 4; ++form) {
            two_lobes two;
            describe(&two, WIDTH);
            const hairlut_mixture_desc mixture = {sizeof mixture, sides[k][0], sides[k][1], nodes, nodes, form ? grid : NULL,
                                                  form & 1 ? grid : NULL, form >> 1};
            two.desc.mixture = &mixture;
            create_and_use(&two.desc);
        }
}

static void check_refusals(void)
{
    two_lobes two;
    hairlut_model *model;
    char message[HAIRLUT_MESSAGE_SIZE];
    const float pair[2] = {0.0f, 1.0f}, none[4] = {0.0f, 0.0f, 0.0f, 0.0f}, bad[4] = {NAN, NAN, NAN, NAN};
    const hairlut_mixture_desc sound = {sizeof sound, 2, 1, pair, NULL, NULL, NULL, 0};
    hairlut_mixture_desc mixture;
#define REFUSE_MODEL(change, expected)                                                                                \
    (describe(&two, WIDTH), mixture = sound, two.desc.mixture = &mixture, change,                                     \
     REQUIRE_RESULT(hairlut_model_create(&two.desc, NULL, &model, message) == (expected) && !model))
#define REQUIRE_RESULT(condition) ((condition) ? (void)0 : (fprintf(stderr, "%s\n", message), abort()))
    REFUSE_MODEL(two.desc.size = 1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(two.desc.size += 8, HAIRLUT_ERROR_VERSION);
    REFUSE_MODEL(two.desc.lobe_count = 0, HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(two.desc.lobes = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(two.lobes[1].size = 3, HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(two.lobes[1].name = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(two.lobes[1].name = "No", HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(two.lobes[1].name = "direct", HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(two.lobes[0].theta = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(two.lobes[0].phi = &two.theta, HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(two.lobes[0].azimuth = (hairlut_azimuth)7, HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(mixture.size = 0, HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(mixture.mirrored = 2, HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(mixture.theta_r_count = 0, HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(mixture.theta_r = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE_MODEL(mixture.theta_r = none, HAIRLUT_ERROR_TABLE);
    REFUSE_MODEL(mixture.share = none, HAIRLUT_ERROR_TABLE);
    REFUSE_MODEL(mixture.share = bad, HAIRLUT_ERROR_TABLE);
    REFUSE_MODEL(mixture.turn = bad, HAIRLUT_ERROR_TABLE);
}

static void check_creation(void)
{
    two_lobes two;
    const hairlut_allocator poor = {never, forget, NULL}, half = {never, NULL, NULL};
    char message[HAIRLUT_MESSAGE_SIZE];
    hairlut_model *model;
    describe(&two, WIDTH);
    create_and_use(&two.desc);
    two.theta.warp = HAIRLUT_WARP_OCTAVES;
    two.phi.warp = HAIRLUT_WARP_OCTAVES;
    create_and_use(&two.desc);
    hairlut_free(NULL);
    REQUIRE(hairlut_model_create(&two.desc, &poor, &model, message) == HAIRLUT_ERROR_MEMORY && !model);
    REQUIRE(hairlut_model_create(&two.desc, &half, &model, message) == HAIRLUT_ERROR_ARGUMENT);
    REQUIRE(hairlut_model_create(NULL, NULL, &model, message) == HAIRLUT_ERROR_ARGUMENT);
    REQUIRE(hairlut_model_create(&two.desc, NULL, NULL, message) == HAIRLUT_ERROR_ARGUMENT);
    REQUIRE(hairlut_validate(NULL, message) == HAIRLUT_ERROR_ARGUMENT);
}

static void refuse(hairlut_table table, hairlut_result expected)
{
    char message[HAIRLUT_MESSAGE_SIZE];
    REQUIRE(hairlut_validate(&table, message) == expected);
    REQUIRE(strstr(message, "expected"));
}

static void check_validation(void)
{
    hairlut_table t;
#define REFUSE(change, expected) (t = straight(0), change, refuse(t, expected))
    REFUSE(t.texels = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(t.width = 3, HAIRLUT_ERROR_TABLE);
    REFUSE(t.theta_r_max = t.theta_r_min, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(t.domain_max = NAN, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(t.warp = (hairlut_warp)9, HAIRLUT_ERROR_ARGUMENT);
    REFUSE((t.warp = HAIRLUT_WARP_OCTAVES, t.warp_e = 0.0f), HAIRLUT_ERROR_ARGUMENT);
    REFUSE(t.size = 0, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(texels[0][2 * (WIDTH + 2)] = NAN, HAIRLUT_ERROR_TABLE);
    REFUSE(texels[0][2 * WIDTH] = -1.5f, HAIRLUT_ERROR_TABLE);
    REFUSE(texels[0][2 * WIDTH + 1] = 0.0f, HAIRLUT_ERROR_TABLE);
}

static void load(const char *directory)
{
#ifdef EXERCISE_EXR
    char message[HAIRLUT_MESSAGE_SIZE];
    hairlut_model *model;
    const hairlut_result result = hairlut_load_with(directory, NULL, &model, message);
    REQUIRE((result == HAIRLUT_OK) == (model != NULL));
    if (model)
        use(model);
    else
        REQUIRE(strstr(message, ".exr: "));
    hairlut_free(model);
    if (hairlut_load(directory, &model) == HAIRLUT_OK)
        hairlut_free(model);
    printf("%s: %s\n", directory, result == HAIRLUT_OK ? "loaded" : message);
#else
    printf("%s: no loader\n", directory);
#endif
}

static void check_loader_arguments(void)
{
#ifdef EXERCISE_EXR
    const hairlut_allocator poor = {never, forget, NULL}, half = {NULL, forget, NULL};
    hairlut_model *model;
    REQUIRE(hairlut_load_with(NULL, NULL, &model, NULL) == HAIRLUT_ERROR_ARGUMENT);
    REQUIRE(hairlut_load_with(".", NULL, NULL, NULL) == HAIRLUT_ERROR_ARGUMENT);
    REQUIRE(hairlut_load_with(".", &poor, &model, NULL) == HAIRLUT_ERROR_MEMORY);
    REQUIRE(hairlut_load_with(".", &half, &model, NULL) == HAIRLUT_ERROR_ARGUMENT);
#endif
}

static void *use_builtin(void *name)
{
    use(hairlut_builtin(name));
    return NULL;
}

/* All threads read the same two models from the first call on. */
static void check_threads(int count)
{
    pthread_t threads[16];
    for (int k = 0; k < count; ++k)
        REQUIRE(pthread_create(&threads[k], NULL, use_builtin, k % 2 ? (void *)"fitted" : (void *)"printed") == 0);
    for (int k = 0; k < count; ++k)
        REQUIRE(pthread_join(threads[k], NULL) == 0);
}

int main(int argc, char **argv)
{
    int first = 1;
    if (argc > 2 && strcmp(argv[1], "-t") == 0) {
        check_threads(atoi(argv[2]));
        first = 3;
    }
    REQUIRE(hairlut_version() == HAIRLUT_VERSION && !hairlut_builtin("none") && !hairlut_builtin(NULL));
    for (int k = -1; k < 12; ++k)
        REQUIRE(hairlut_result_string((hairlut_result)k)[0]);
    use(hairlut_builtin("printed"));
    use(hairlut_builtin("fitted"));
    use(hairlut_builtin("brown"));
    hairlut_free((hairlut_model *)hairlut_builtin("fitted"));
    check_frame();
    check_widths();
    check_mixtures();
    check_creation();
    check_refusals();
    check_validation();
    check_loader_arguments();
    for (int k = first; k < argc; ++k)
        load(argv[k]);
    print_kernels();
    puts("done");
    return 0;
}
