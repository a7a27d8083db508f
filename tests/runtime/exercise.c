/* Walks through the whole API for the sanitizers, valgrind and the coverage count: exercise [-t THREADS] [DIRECTORY...].
 * Directories hold table files; the loader must accept or refuse each with a message. Built with -DEXERCISE_EXR where
 * there is a loader. Correct numbers are the other tests' business: this one looks for memory, threads and undefined
 * behaviour. */
#include <pthread.h>
#include <string.h>

#include "batch.h"
#include "check.h"

enum { COUNT = 77, WIDTH = 9, WIDEST = 300, HEIGHT = 3 };

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

/* Every kernel that this processor runs, not only the widest. */
static void check_kernels(const hairlut_model *model, size_t n)
{
    float in[6][COUNT], out[5][COUNT];
    const hairlut_samples all = {out[0], out[1], out[2], out[3]}, angles = {out[0], out[1], NULL, NULL};
    for (uint32_t k = 0; k < 6; ++k)
        fill(in[k], n, k < 2 ? -2.0f : 0.0f, k < 2 ? 2.0f : 1.0f, k + 1);
    const hairlut_batch *batch;
    for (int level = 0; (batch = hairlut_batch_level(level)); ++level) {
        batch->sample_direct(model, n, in[0], in[1], in[2], in[3], all);
        batch->pdf_direct(model, n, in[0], in[1], out[0], out[1], out[4]);
        batch->sample_multiple(model, n, in[0], in[1], in[2], in[3], angles);
        batch->pdf_multiple(model, n, in[0], in[1], out[0], out[1], out[4]);
        for (size_t i = 0; i < n; ++i)
            REQUIRE(isfinite(out[2][i]) && isfinite(out[3][i]) && isfinite(out[4][i]));
    }
}

/* Their names in a line, for the coverage count. */
static void print_kernels(void)
{
    printf("kernels");
    for (int level = 0; hairlut_batch_level(level); ++level)
        printf(" %s", hairlut_batch_level(level)->name);
    putchar('\n');
}

static void check_batches(const hairlut_model *model, size_t n)
{
    float in[6][COUNT], out[5][COUNT];
    const hairlut_samples all = {out[0], out[1], out[2], out[3]}, angles = {out[0], out[1], NULL, NULL};
    for (uint32_t k = 0; k < 6; ++k)
        fill(in[k], n, k < 2 ? -2.0f : 0.0f, k < 2 ? 2.0f : 1.0f, k + 1);
    hairlut_sample_direct_n(model, n, in[0], in[1], in[2], in[3], all);
    hairlut_sample_direct_n(model, n, in[0], in[1], in[2], in[3], angles);
    hairlut_pdf_direct_n(model, n, in[0], in[1], out[0], out[1], out[4]);
    hairlut_sample_multiple_n(model, n, in[0], in[1], in[2], in[3], all);
    hairlut_sample_multiple_n(model, n, in[0], in[1], in[2], in[3], angles);
    hairlut_pdf_multiple_n(model, n, in[0], in[1], out[0], out[1], out[4]);
    hairlut_sample_mixture_n(model, n, in[5], in[0], in[1], in[4], in[2], in[3], all);
    hairlut_pdf_mixture_n(model, n, in[5], in[0], in[1], out[0], out[1], out[4]);
    for (size_t i = 0; i < n; ++i)
        REQUIRE(isfinite(out[2][i]) && isfinite(out[3][i]) && isfinite(out[4][i]));
}

/* Lobes of several models, with weights of every kind, the first turned by any angle. */
static void check_components(float turn)
{
    const hairlut_model *a = hairlut_builtin("fitted"), *b = hairlut_builtin("printed");
    static const float weights[] = {0.0f, 1.0f, -1.0f, 1e-45f, 3e38f, INFINITY, NAN};
    enum { WEIGHTS = sizeof weights / sizeof *weights };
    for (int i = 0; i < WEIGHTS; ++i)
        for (int j = 0; j < WEIGHTS; ++j) {
            const hairlut_component mixed[] = {{weights[i] > 0.0f ? a : NULL, HAIRLUT_LOBE_DIRECT, weights[i], turn},
                                               {weights[j] > 0.0f ? b : NULL, HAIRLUT_LOBE_MULTIPLE, weights[j], 0.5f}};
            const int valid = isfinite(weights[i]) && isfinite(weights[j]) && (weights[i] > 0.0f || weights[j] > 0.0f)
                              && (isfinite(turn) || !(weights[i] > 0.0f));
            for (int n = -1; n <= 2; ++n) {
                static const float u[] = {-1.0f, 0.0f, 0.5f, 1.0f, NAN};
                for (int k = 0; k < 5; ++k) {
                    const hairlut_sample s = hairlut_sample_components(mixed, n, 0.3f, 0.5f, u[k], 0.4f, 0.7f);
                    REQUIRE(isfinite(s.theta_i) && isfinite(s.phi_i) && isfinite(s.pdf_solid_angle));
                    REQUIRE(n < 2 || (s.pdf_angle > 0.0f) == (valid && u[k] == u[k]));
                }
                const float pdf = hairlut_pdf_components(mixed, n, 0.3f, 0.5f, 0.1f, 2.0f);
                REQUIRE(isfinite(pdf) && (n < 2 || (pdf > 0.0f) == valid));
            }
        }
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

static void use(const hairlut_model *model)
{
    int width, height;
    float u[2];
    check_model(model);
    for (size_t n = 0; n <= COUNT; n += n < 20 ? 1 : 19)
        check_batches(model, n), check_kernels(model, n);
    for (int part = 0; part < 3; ++part) {
        hairlut_table_size(model, (hairlut_part)part, &width, &height);
        REQUIRE(width >= 4 && height >= 2);
    }
    const hairlut_sample s = hairlut_sample_multiple(model, 0.3f, 0.5f, 0.25f, 0.75f);
    hairlut_invert_multiple(model, 0.3f, 0.5f, s.theta_i, s.phi_i, u);
    REQUIRE(fabsf(u[0] - 0.25f) < 1e-5f && fabsf(u[1] - 0.75f) < 1e-5f);
    REQUIRE(hairlut_pdf_to_solid_angle(s.pdf_angle, s.theta_i) == s.pdf_solid_angle);
    REQUIRE(hairlut_pdf_multiple(model, NAN, 0.5f, s.theta_i, s.phi_i) == 0.0f);
    REQUIRE(hairlut_pdf_direct(model, 0.3f, 0.5f, 4.0f, s.phi_i) == 0.0f);
    check_direction(model, 0.3f, 0.5f, 0.9f, 0.1f);
}

static float texels[2][HEIGHT * WIDEST];

static hairlut_table straight_of(int azimuth, int width)
{
    const float low = azimuth ? 0.0f : -1.57079637f, high = azimuth ? 6.28318548f : 1.57079637f;
    const float last = (float)(width - 1);
    for (int k = 0; k < HEIGHT * width; ++k)
        texels[azimuth][k] = k % width == width - 1 ? high : low + (high - low) * (float)(k % width) / last;
    const hairlut_table table = {texels[azimuth], width, HEIGHT, -1.5f, 1.5f, low, high, HAIRLUT_WARP_OCTAVES, 1e-6f, 0.9f};
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

/* The least width, and two that are not searched as small ones are: by two counts of 16, and with a halving between them. */
static void check_widths(void)
{
    static const int widths[] = {4, 100, WIDEST};
    for (size_t k = 0; k < sizeof widths / sizeof *widths; ++k) {
        const hairlut_model_desc desc = {straight_of(0, widths[k]), straight_of(1, widths[k]), straight_of(0, widths[k]),
                                         HAIRLUT_AZIMUTH_DIFFERENCE};
        hairlut_model *model;
        REQUIRE(hairlut_model_create(&desc, NULL, &model, NULL) == HAIRLUT_OK);
        use(model);
        hairlut_free(model);
    }
}

static void check_creation(void)
{
    hairlut_model_desc desc = {straight(0), straight(1), straight(0), HAIRLUT_AZIMUTH_SUM};
    const hairlut_allocator poor = {never, forget, NULL}, half = {never, NULL, NULL};
    char message[HAIRLUT_MESSAGE_SIZE];
    hairlut_model *model;
    REQUIRE(hairlut_model_create(&desc, NULL, &model, message) == HAIRLUT_OK);
    use(model);
    hairlut_free(model);
    desc.multiple_theta.warp = HAIRLUT_WARP_UNIFORM;
    desc.direct_phi.warp = HAIRLUT_WARP_UNIFORM;
    REQUIRE(hairlut_model_create(&desc, NULL, &model, NULL) == HAIRLUT_OK);
    use(model);
    hairlut_free(model);
    hairlut_free(NULL);
    REQUIRE(hairlut_model_create(&desc, &poor, &model, message) == HAIRLUT_ERROR_MEMORY && !model);
    REQUIRE(hairlut_model_create(&desc, &half, &model, message) == HAIRLUT_ERROR_ARGUMENT);
    REQUIRE(hairlut_model_create(NULL, NULL, &model, message) == HAIRLUT_ERROR_ARGUMENT);
    REQUIRE(hairlut_model_create(&desc, NULL, NULL, message) == HAIRLUT_ERROR_ARGUMENT);
    REQUIRE(hairlut_validate(NULL, message) == HAIRLUT_ERROR_ARGUMENT);
    desc.azimuth = (hairlut_azimuth)7;
    REQUIRE(hairlut_model_create(&desc, NULL, &model, message) == HAIRLUT_ERROR_ARGUMENT);
    desc.azimuth = HAIRLUT_AZIMUTH_SUM;
    desc.direct_phi = straight(0);
    REQUIRE(hairlut_model_create(&desc, NULL, &model, message) == HAIRLUT_ERROR_ARGUMENT);
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
    REFUSE(t.warp_e = 0.0f, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(t.cell_limit = 1.0f, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(texels[0][WIDTH + 2] = NAN, HAIRLUT_ERROR_TABLE);
    REFUSE(texels[0][WIDTH] = -1.5f, HAIRLUT_ERROR_TABLE);
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
    hairlut_free((hairlut_model *)hairlut_builtin("fitted"));
    check_frame();
    static const float turns[] = {0.0f, -2.0f, 1e6f, -3e38f, INFINITY, NAN};
    for (size_t k = 0; k < sizeof turns / sizeof *turns; ++k)
        check_components(turns[k]);
    check_widths();
    check_creation();
    check_validation();
    check_loader_arguments();
    for (int k = first; k < argc; ++k)
        load(argv[k]);
    print_kernels();
    puts("done");
    return 0;
}
