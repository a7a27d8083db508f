/* SPDX-License-Identifier: BSD-3-Clause */
/* A walk through the whole API: good models and refused ones, from memory and from directories, whose names stand on
 * lines of the standard input. For sanitizers, valgrind and coverage. exercise N: first uses the compiled-in models in N
 * threads at once. */
#include <pthread.h>
#include <string.h>

#include "batch.h"
#include "check.h"

enum { COUNT = 77, WIDTH = 9, WIDEST = 4096, HEIGHT = 3, ROWS = 2, COLUMNS = 2, LOBES = 3, MANY = 4096 };
enum { PARAMETERS = 4, NODES = 6 /* of an axis */, ALL_NODES = NODES * 2 * 2 * 2 };

/* ---- use ------------------------------------------------------------------------------------------------------ */

/* n numbers from a fixed generator, with hard ones among them. */
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

static void check_arrays(const hairlut_model *model, size_t n)
{
    float in[7][COUNT], shares[HAIRLUT_MAX_LOBES * COUNT], out[5][COUNT];
    const hairlut_samples all = {out[0], out[1], out[2], out[3]}, angles = {out[0], out[1], NULL, NULL};
    for (uint32_t k = 0; k < 7; ++k)
        fill(in[k], n, k < 3 ? -2.0f : 0.0f, k < 3 ? 2.0f : 1.0f, k + 1);
    fill(shares, n * (size_t)hairlut_lobe_count(model), -0.1f, 1.0f, 9);
    hairlut_sample_direct_n(model, n, in[0], in[1], in[3], in[4], all);
    hairlut_pdf_direct_n(model, n, in[0], in[1], out[0], out[1], out[4]);
    hairlut_sample_multiple_n(model, n, in[0], in[1], in[3], in[4], angles);
    hairlut_pdf_multiple_n(model, n, in[0], in[1], out[0], out[1], out[4]);
    for (int lobe = -1; lobe <= hairlut_lobe_count(model); ++lobe) {
        hairlut_sample_lobe_n(model, lobe, n, in[0], in[1], in[3], in[4], all);
        hairlut_pdf_lobe_n(model, lobe, n, in[0], in[1], out[0], out[1], out[4]);
    }
    hairlut_sample_hair_n(model, n, NULL, in[0], in[1], NULL, in[5], in[3], in[4], angles);
    hairlut_sample_hair_n(model, n, shares, in[0], in[1], in[2], in[5], in[3], in[4], all);
    hairlut_pdf_hair_n(model, n, shares, in[0], in[1], in[2], out[0], out[1], out[4]);
    hairlut_pdf_hair_n(model, n, NULL, in[0], in[1], NULL, out[0], out[1], out[4]);
    for (size_t i = 0; i < n; ++i)
        REQUIRE(isfinite(out[2][i]) && isfinite(out[3][i]) && isfinite(out[4][i]));
}

static void check_account(const hairlut_model *model)
{
    int width, height;
    for (int lobe = -1; lobe <= hairlut_lobe_count(model); ++lobe) {
        const int exists = lobe >= 0 && lobe < hairlut_lobe_count(model);
        REQUIRE(exists == (hairlut_lobe_name(model, lobe) != NULL));
        REQUIRE(!exists || hairlut_lobe_index(model, hairlut_lobe_name(model, lobe)) == lobe);
        hairlut_table_size(model, lobe, HAIRLUT_THETA, &width, &height);
        REQUIRE(exists == (width >= 4 && height >= 2));
        hairlut_table_size(model, lobe, HAIRLUT_PHI, &width, &height);
        REQUIRE(width >= 0 && height >= 0);
    }
    REQUIRE(hairlut_lobe_index(model, "no lobe") == -1 && hairlut_lobe_index(model, NULL) == -1);
}

/* One strand: directions that no lobe contains, what is no number, and shares of nothing. */
static void check_strand_directions(const hairlut_model *model)
{
    static const float none[HAIRLUT_MAX_LOBES], strand[HAIRLUT_MAX_PARAMETERS], half[] = {0.5f, 0.5f, 0.5f, 0.5f, NAN};
    check_sample(hairlut_sample_strand(model, NULL, NULL, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f));
    check_sample(hairlut_sample_strand(model, half, none, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f));
    REQUIRE(hairlut_pdf_strand(model, NULL, NULL, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f) > 0.0f);
    REQUIRE(hairlut_pdf_strand(model, strand, NULL, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f) > 0.0f);
    REQUIRE(hairlut_pdf_strand(model, strand, none, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f) == 0.0f);
    REQUIRE(hairlut_pdf_strand(model, strand, NULL, 0.1f, 0.2f, 0.3f, 4.0f, 0.5f) == 0.0f);
    REQUIRE(hairlut_pdf_strand(model, strand, NULL, NAN, 0.2f, 0.3f, 0.4f, 0.5f) == 0.0f);
    REQUIRE(hairlut_pdf_strand(model, strand, NULL, 0.1f, 0.2f, NAN, 0.4f, 0.5f) == 0.0f);
    REQUIRE(hairlut_pdf_strand(model, strand, NULL, 0.1f, 0.2f, 0.3f, 0.4f, INFINITY) == 0.0f);
}

/* Viewers: as the functions above. */
static void check_viewers(const hairlut_model *model)
{
    static const float none[HAIRLUT_MAX_LOBES], strand[HAIRLUT_MAX_PARAMETERS], half[] = {0.5f, 0.5f, 0.5f, 0.5f, NAN};
    const float *parameters[] = {NULL, strand, half}, *shares[] = {NULL, none, half};
    for (size_t k = 0; k < 9; ++k) {
        hairlut_viewer viewer;
        hairlut_viewer_at(&viewer, model, parameters[k / 3], hairlut_lobe_count(model) <= 4 ? shares[k % 3] : NULL, 0.1f,
                          0.2f, 0.3f);
        const hairlut_sample s = hairlut_viewer_sample(&viewer, 0.4f, 0.5f, 0.6f);
        const float pdf = hairlut_viewer_pdf(&viewer, s.theta_i, s.phi_i);
        check_sample(s);
        REQUIRE((pdf > 0.0f) == (s.pdf_angle > 0.0f));
        REQUIRE(hairlut_viewer_pdf(&viewer, 4.0f, 0.5f) == 0.0f && hairlut_viewer_pdf(&viewer, 0.4f, INFINITY) == 0.0f);
    }
}

/* Values of the parameters in their ranges, beyond them, and no numbers. */
static void check_strands(const hairlut_model *model)
{
    const int count = hairlut_parameter_count(model);
    float parameters[HAIRLUT_MAX_PARAMETERS * COUNT], shares[HAIRLUT_MAX_LOBES * COUNT], in[6][COUNT], out[5][COUNT];
    const hairlut_samples all = {out[0], out[1], out[2], out[3]}, angles = {out[0], out[1], NULL, NULL};
    fill(parameters, (size_t)count * COUNT, -0.5f, 1.5f, 11);
    fill(shares, (size_t)hairlut_lobe_count(model) * COUNT, -0.1f, 1.0f, 12);
    for (uint32_t k = 0; k < 6; ++k)
        fill(in[k], COUNT, k < 3 ? -2.0f : 0.0f, k < 3 ? 2.0f : 1.0f, k + 1);
    hairlut_sample_strand_n(model, COUNT, NULL, NULL, in[0], in[1], NULL, in[3], in[4], in[5], all);
    hairlut_pdf_strand_n(model, COUNT, NULL, NULL, in[0], in[1], NULL, out[0], out[1], out[4]);
    hairlut_sample_strand_n(model, COUNT, parameters, NULL, in[0], in[1], in[2], in[3], in[4], in[5], angles);
    hairlut_pdf_strand_n(model, COUNT, parameters, NULL, in[0], in[1], in[2], out[0], out[1], out[4]);
    hairlut_sample_strand_n(model, COUNT, parameters, shares, in[0], in[1], NULL, in[3], in[4], in[5], all);
    hairlut_pdf_strand_n(model, COUNT, parameters, shares, in[0], in[1], NULL, out[0], out[1], out[4]);
    for (size_t i = 0; i < COUNT; ++i) {
        const hairlut_sample s = {out[0][i], out[1][i], out[2][i], out[3][i]};
        check_sample(s);
        REQUIRE(isfinite(out[4][i]));
    }
    check_strand_directions(model);
    check_viewers(model);
}

/* What a model says of its parameters. */
static void check_names(const hairlut_model *model)
{
    float least, most, standard;
    for (int p = -1; p <= hairlut_parameter_count(model); ++p) {
        const char *name = hairlut_parameter_name(model, p);
        const int exists = p >= 0 && p < hairlut_parameter_count(model);
        REQUIRE(exists == (name != NULL) && hairlut_parameter_range(model, p, NULL, NULL, NULL) == exists);
        REQUIRE(!exists || hairlut_parameter_index(model, name) == p);
        REQUIRE(hairlut_parameter_range(model, p, &least, &most, &standard) == exists);
        REQUIRE(!exists || (least <= standard && standard <= most && least < most));
    }
    REQUIRE(hairlut_parameter_index(model, "none") == -1 && hairlut_parameter_index(model, NULL) == -1);
}

static void use(const hairlut_model *model)
{
    check_names(model);
    check_strands(model);
    static const float shares[][LOBES] = {{1.0f, 0.0f, 0.0f}, {0.0f, -1.0f, NAN}, {3e38f, 3e38f, 3e38f}, {0.0f, 0.0f, 0.0f}};
    check_model(model);
    check_account(model);
    for (size_t n = 0; n <= COUNT; n += n < 20 ? 1 : 19)
        check_arrays(model, n);
    for (size_t k = 0; k < sizeof shares / sizeof *shares && hairlut_lobe_count(model) <= LOBES; ++k) {
        check_sample(hairlut_sample_hair(model, shares[k], 0.3f, 0.5f, 0.1f, 0.9f, 0.2f, 0.7f));
        REQUIRE(isfinite(hairlut_pdf_hair(model, shares[k], 0.3f, 0.5f, 0.1f, 0.2f, 0.7f)));
    }
    const hairlut_sample s = hairlut_sample_direct(model, 0.3f, 0.5f, 0.25f, 0.75f);
    REQUIRE(hairlut_pdf_to_solid_angle(s.pdf_angle, s.theta_i) == s.pdf_solid_angle);
    REQUIRE(hairlut_pdf_direct(model, 0.3f, 0.5f, 4.0f, s.phi_i) == 0.0f);
    float u[2];
    hairlut_invert_lobe(model, 0, 0.3f, 0.5f, NAN, NAN, u);
    REQUIRE(u[0] == 0.0f && u[1] == 0.0f);
    check_sample(hairlut_sample_multiple(model, 0.3f, 0.5f, 0.25f, 0.75f));
    REQUIRE(hairlut_pdf_multiple(model, NAN, 0.5f, s.theta_i, s.phi_i) == 0.0f);
}

/* ---- models from memory --------------------------------------------------------------------------------------- */

/* Descriptors of a good model, to be spoilt: two tables, three lobes, the last of a uniform azimuth, and a mixture. */
typedef struct scene {
    float texels[2][ALL_NODES * HEIGHT * 1000 * 2]; /* of all nodes, or of one node and the widest table */
    float theta_r[ROWS], offset[COLUMNS], share[LOBES * ROWS * COLUMNS * ALL_NODES],
        turn[LOBES * ROWS * COLUMNS * ALL_NODES];
    float nodes[NODES], others[NODES], ends[2];
    hairlut_parameter parameters[PARAMETERS];
    hairlut_parameter_nodes axes[PARAMETERS], few[2];
    hairlut_table theta, phi;
    hairlut_lobe_desc lobes[LOBES];
    hairlut_mixture_desc mixture;
    hairlut_model_desc desc;
} scene;

static hairlut_table straight(float *texels, int width, float low, float high, hairlut_warp warp)
{
    const int nodes = width > 1000 ? 1 : ALL_NODES;
    for (int k = 0; k < HEIGHT * width * nodes; ++k) {
        texels[2 * k] = k % width == width - 1 ? high : low + (high - low) * (float)(k % width) / (float)(width - 1);
        texels[2 * k + 1] = (high - low) * (k % 5 ? 1.0f : 100.0f);
    }
    const hairlut_table table = {sizeof table, texels, width, HEIGHT, -1.5f, 1.5f, low, high, warp, 1e-6f, 0, NULL};
    return table;
}

static void set_scene(scene *s, int width, hairlut_warp warp, hairlut_azimuth azimuth)
{
    static const char *const names[LOBES] = {"direct", "multiple", "third_1"};
    s->theta = straight(s->texels[0], width, -1.57079637f, 1.57079637f, warp);
    s->phi = straight(s->texels[1], width, 0.0f, 6.28318548f, warp);
    for (int k = 0; k < LOBES; ++k) {
        const hairlut_lobe_desc lobe = {sizeof lobe, names[k], &s->theta, k < LOBES - 1 ? &s->phi : NULL, azimuth};
        s->lobes[k] = lobe;
    }
    for (int k = 0; k < LOBES * ROWS * COLUMNS * ALL_NODES; ++k)
        s->share[k] = (float)(k % 4), s->turn[k] = (float)(k % 12) - 6.0f;
    s->theta_r[0] = -1.0f, s->theta_r[1] = 1.0f, s->offset[0] = 0.0f, s->offset[1] = 1.0f;
    s->share[0] = 1.0f;
    const hairlut_mixture_desc mixture = {sizeof mixture, ROWS,    COLUMNS, s->theta_r, s->offset,
                                          s->share,       s->turn, 1,       0,          NULL};
    s->mixture = mixture;
    const hairlut_model_desc desc = {sizeof desc, LOBES, s->lobes, &s->mixture, 0, NULL};
    s->desc = desc;
}

/* hairlut_mixture_desc as 2.0 had it */
typedef struct mixture_2_0 {
    size_t size;
    int counts[2];
    const float *arrays[4];
    int mirrored;
} mixture_2_0;

/* The scene's tables and mixture over parameters: theta over the first `theta`, phi over the second, the mixture over the first
 * `mixture`. */
static void vary(scene *s, int theta, int phi, int mixture)
{
    static const char *const names[PARAMETERS] = {"rough", "dark_2", "flat", "d"};
    for (int k = 0; k < NODES; ++k)
        s->nodes[k] = s->others[k] = (float)k / (NODES - 1);
    s->others[1] = 0.1f;
    s->ends[0] = 0.0f, s->ends[1] = 1.0f;
    for (int p = 0; p < PARAMETERS; ++p) {
        const hairlut_parameter parameter = {sizeof parameter, names[p], 0.0f, 1.0f, 0.3f * (float)p};
        const hairlut_parameter_nodes axis = {sizeof axis, p, p == 0 ? NODES : 2, p == 0 ? s->nodes : s->ends};
        s->parameters[p] = parameter;
        s->axes[p] = axis;
    }
    s->few[0] = s->few[1] = s->axes[1];
    s->few[0].parameter = 0; /* the first parameter at two nodes: another scale than that of theta */
    s->theta.axis_count = theta;
    s->theta.axes = s->axes;
    s->phi.axis_count = phi;
    s->phi.axes = s->few;
    s->mixture.axis_count = mixture;
    s->mixture.axes = s->axes;
    for (int k = 0; k < LOBES * ROWS * COLUMNS * ALL_NODES; ++k)
        s->share[k] += k < ROWS * COLUMNS * ALL_NODES ? 0.5f : 0.0f; /* of the first lobe */
    s->desc.parameter_count = PARAMETERS;
    s->desc.parameters = s->parameters;
}

static void use_scene(const scene *s)
{
    hairlut_model *model;
    char message[HAIRLUT_MESSAGE_SIZE] = "";
    REQUIRE(hairlut_model_create(&s->desc, NULL, &model, message) == HAIRLUT_OK);
    use(model);
    hairlut_free(model);
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
static void check_good_models(scene *s)
{
    static const int widths[] = {4, WIDTH, 100, 300, 1000, 2000, WIDEST};
    for (size_t k = 0; k < sizeof widths / sizeof *widths; ++k) {
        set_scene(s, widths[k], k % 2 ? HAIRLUT_WARP_UNIFORM : HAIRLUT_WARP_OCTAVES, (hairlut_azimuth)(k % 2));
        use_scene(s);
    }
    set_scene(s, WIDTH, HAIRLUT_WARP_OCTAVES, HAIRLUT_AZIMUTH_SUM);
    s->desc.mixture = NULL;
    use_scene(s);
    s->phi.theta_r_max = 0.0f; /* rows as far apart as those of theta, and fewer */
    s->phi.height = 2;
    use_scene(s);
    set_scene(s, WIDTH, HAIRLUT_WARP_OCTAVES, HAIRLUT_AZIMUTH_SUM);
    s->mixture.share = s->mixture.turn = NULL;
    use_scene(s);
    s->mixture.theta_r_count = s->mixture.offset_count = 1;
    s->mixture.theta_r = s->mixture.offset = NULL;
    s->mixture.mirrored = 0;
    use_scene(s);
}

/* Every number of axes, of tables that are searched in every way; turns that depend on parameters, or do not. */
static void check_models_over_parameters(scene *s)
{
    static const int widths[] = {WIDTH, 60, 100, 1000};
    for (size_t k = 0; k < sizeof widths / sizeof *widths; ++k)
        for (int axes = 0; axes <= PARAMETERS; ++axes) {
            set_scene(s, widths[k], HAIRLUT_WARP_OCTAVES, HAIRLUT_AZIMUTH_SUM);
            vary(s, axes, axes % 3, PARAMETERS - axes);
            s->mixture.turn = axes == 1 ? NULL : s->turn;
            use_scene(s);
        }
    set_scene(s, WIDTH, HAIRLUT_WARP_OCTAVES, HAIRLUT_AZIMUTH_SUM);
    vary(s, 1, 2, 3);
    s->few[0].count = NODES;
    s->few[0].values = s->others;
    s->desc.mixture = NULL;
    use_scene(s);
    s->desc.mixture = &s->mixture;
    s->mixture.theta_r_count = s->mixture.offset_count = 1;
    s->mixture.mirrored = 0;
    use_scene(s);
    /* 2.0's sizes: no axes, no parameters */
    set_scene(s, WIDTH, HAIRLUT_WARP_OCTAVES, HAIRLUT_AZIMUTH_SUM);
    vary(s, 1, 1, 1);
    s->theta.size = s->phi.size = offsetof(hairlut_table, axis_count);
    s->mixture.size = sizeof(mixture_2_0);
    s->desc.size = offsetof(hairlut_model_desc, parameter_count);
    use_scene(s);
}

static void refuse(const scene *s, hairlut_result expected)
{
    hairlut_model *model = (hairlut_model *)(uintptr_t)1;
    char message[HAIRLUT_MESSAGE_SIZE] = "";
    REQUIRE(hairlut_model_create(&s->desc, NULL, &model, message) == expected && !model);
    REQUIRE(strstr(message, "expected") || strstr(message, "NULL"));
    REQUIRE(hairlut_model_create(&s->desc, NULL, &model, NULL) == expected && !model);
}

static const float *many_nodes(void)
{
    static float nodes[MANY];
    for (int k = 0; k < MANY; ++k)
        nodes[k] = (float)k / MANY;
    return nodes;
}

/* Every way in which a descriptor can be wrong. */
static void check_refusals(scene *s)
{
#define REFUSE(change, expected) \
    (set_scene(s, WIDTH, HAIRLUT_WARP_OCTAVES, HAIRLUT_AZIMUTH_SUM), change, refuse(s, expected))
    REFUSE(s->desc.size = 0, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->desc.size += 8, HAIRLUT_ERROR_VERSION);
    REFUSE(s->desc.lobe_count = 0, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->desc.lobe_count = HAIRLUT_MAX_LOBES + 1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->desc.lobes = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[0].size = 1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[1].size = 1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[1].name = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[1].name = "", HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[1].name = "Multiple", HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[1].name = "2nd", HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[1].name = "a-b", HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[1].name = "a{", HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[1].name = "abcdefghijklmnopqrstuvwxyz0123456789_and_more", HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[1].name = "direct", HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[1].theta = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[1].theta = &s->phi, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[1].phi = &s->theta, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->lobes[1].azimuth = (hairlut_azimuth)7, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->theta.size = 3, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->theta.texels = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->theta.width = 3, HAIRLUT_ERROR_TABLE);
    REFUSE(s->theta.width = 4097, HAIRLUT_ERROR_TABLE);
    REFUSE(s->theta.height = 1, HAIRLUT_ERROR_TABLE);
    REFUSE(s->theta.height = 4097, HAIRLUT_ERROR_TABLE);
    REFUSE(s->theta.theta_r_max = s->theta.theta_r_min, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->theta.theta_r_max = s->theta.theta_r_min + 5e-7f, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->theta.theta_r_max = 7.0f, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->theta.theta_r_min = -7.0f, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->theta.domain_max = NAN, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->theta.warp = (hairlut_warp)9, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->theta.warp_e = 0.0f, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->theta.warp_e = 2.0f, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->texels[0][2 * (WIDTH + 2)] = NAN, HAIRLUT_ERROR_TABLE);
    REFUSE(s->texels[0][2 * WIDTH] = -1.5f, HAIRLUT_ERROR_TABLE);
    REFUSE(s->texels[0][2 * (2 * WIDTH - 1)] = 1.5f, HAIRLUT_ERROR_TABLE);
    REFUSE(s->texels[0][2 * WIDTH + 1] = 0.0f, HAIRLUT_ERROR_TABLE);
    REFUSE(s->texels[0][2 * WIDTH + 1] = 1e13f, HAIRLUT_ERROR_TABLE);
    REFUSE(s->texels[1][3] = NAN, HAIRLUT_ERROR_TABLE);
    REFUSE(s->mixture.size = 1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->mixture.mirrored = 2, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->mixture.theta_r_count = 0, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->mixture.theta_r_count = 4097, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->mixture.theta_r = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(
        (s->mixture.theta_r_count = s->mixture.offset_count = MANY, s->mixture.theta_r = s->mixture.offset = many_nodes()),
        HAIRLUT_ERROR_TABLE);
    REFUSE(s->theta_r[1] = -1.0f, HAIRLUT_ERROR_TABLE);
    REFUSE(s->theta_r[0] = -7.0f, HAIRLUT_ERROR_TABLE);
    REFUSE(s->theta_r[1] = NAN, HAIRLUT_ERROR_TABLE);
    REFUSE(s->offset[0] = -0.5f, HAIRLUT_ERROR_TABLE);
    REFUSE(s->offset[1] = 1.5f, HAIRLUT_ERROR_TABLE);
    REFUSE(s->share[3] = -1.0f, HAIRLUT_ERROR_TABLE);
    REFUSE(s->share[3] = INFINITY, HAIRLUT_ERROR_TABLE);
    REFUSE(s->turn[3] = 26.0f, HAIRLUT_ERROR_TABLE);
    REFUSE(memset(s->share, 0, sizeof s->share), HAIRLUT_ERROR_TABLE);
#undef REFUSE
}

/* The same of parameters and axes. */
static void check_refused_parameters(scene *s)
{
    const float *const nodes = many_nodes();
#define REFUSE(change, expected)                                                                                       \
    (set_scene(s, WIDTH, HAIRLUT_WARP_OCTAVES, HAIRLUT_AZIMUTH_SUM), vary(s, 1, 2, 3), s->theta.axes = s->few, change, \
     refuse(s, expected))
    REFUSE(s->desc.parameter_count = -1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->desc.parameter_count = HAIRLUT_MAX_PARAMETERS + 1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->desc.parameter_count = 1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->desc.parameters = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->parameters[0].size = 1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->parameters[1].size = 1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->parameters[1].name = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->parameters[1].name = "Rough", HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->parameters[1].name = "lobe", HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->parameters[1].name = "rough", HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->parameters[1].least = NAN, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->parameters[1].least = 2.0f, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->parameters[1].least = -2e30f, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->parameters[1].most = 2e30f, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->parameters[1].most = 1e-31f, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->parameters[1].standard = -0.1f, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->parameters[1].standard = 1.1f, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->theta.axis_count = -1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->theta.axis_count = HAIRLUT_MAX_AXES + 1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->phi.axes = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->few[0].size = 1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->few[1].size = 1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->few[0].parameter = -1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->few[0].parameter = HAIRLUT_MAX_PARAMETERS, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->few[1].parameter = 0, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->few[0].count = 1, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->few[0].count = 65, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->few[0].values = NULL, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->ends[1] = NAN, HAIRLUT_ERROR_TABLE);
    REFUSE(s->ends[1] = 0.0f, HAIRLUT_ERROR_TABLE);
    REFUSE(s->ends[1] = 0.9f, HAIRLUT_ERROR_TABLE);
    REFUSE(s->ends[0] = 0.1f, HAIRLUT_ERROR_TABLE);
    REFUSE(s->nodes[2] = 0.0f, HAIRLUT_ERROR_TABLE);
    REFUSE(s->mixture.axis_count = 5, HAIRLUT_ERROR_ARGUMENT);
    REFUSE(s->texels[0][2 * (WIDTH * HEIGHT + 2)] = NAN, HAIRLUT_ERROR_TABLE);
    REFUSE(s->share[1] = -1.0f, HAIRLUT_ERROR_TABLE);
    REFUSE((s->theta.axis_count = 3, s->theta.axes = s->axes, s->theta.height = 4096), HAIRLUT_ERROR_TABLE);
    REFUSE((s->mixture.theta_r_count = 4096, s->mixture.theta_r = nodes, s->mixture.offset_count = 16,
            s->mixture.offset = nodes),
           HAIRLUT_ERROR_TABLE);
#undef REFUSE
}

static void check_arguments(scene *s)
{
    const hairlut_allocator poor = {never, forget, NULL}, half = {never, NULL, NULL}, other_half = {NULL, forget, NULL},
                            none = {NULL, NULL, NULL};
    char message[HAIRLUT_MESSAGE_SIZE];
    hairlut_model *model;
    set_scene(s, WIDTH, HAIRLUT_WARP_OCTAVES, HAIRLUT_AZIMUTH_DIFFERENCE);
    REQUIRE(hairlut_model_create(&s->desc, &poor, &model, message) == HAIRLUT_ERROR_MEMORY && !model);
    REQUIRE(hairlut_model_create(&s->desc, &half, &model, message) == HAIRLUT_ERROR_ARGUMENT);
    REQUIRE(hairlut_model_create(&s->desc, &other_half, &model, message) == HAIRLUT_ERROR_ARGUMENT);
    REQUIRE(hairlut_model_create(&s->desc, &none, &model, NULL) == HAIRLUT_OK);
    hairlut_free(model);
    REQUIRE(hairlut_model_create(NULL, NULL, &model, message) == HAIRLUT_ERROR_ARGUMENT);
    REQUIRE(hairlut_model_create(&s->desc, NULL, NULL, message) == HAIRLUT_ERROR_ARGUMENT);
    REQUIRE(hairlut_validate(NULL, message) == HAIRLUT_ERROR_ARGUMENT);
    REQUIRE(hairlut_validate(&s->theta, message) == HAIRLUT_OK);
    hairlut_free(NULL);
    hairlut_free((hairlut_model *)hairlut_builtin("fitted"));
    REQUIRE(hairlut_version() == HAIRLUT_VERSION && !hairlut_builtin("none") && !hairlut_builtin(NULL));
    for (int k = -1; k < 12; ++k)
        REQUIRE(hairlut_result_string((hairlut_result)k)[0]);
}

static void check_frame(void)
{
    const hairlut_frame frame = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};
    static const float directions[][3] = {{0.6f, 0.0f, 0.8f},     {1.0f, 0.0f, 0.0f},  {-2.0f, 0.0f, 0.0f},
                                          {0.0f, 0.0f, 0.0f},     {NAN, 0.0f, 1.0f},   {3e38f, 3e38f, 3e38f},
                                          {1e-30f, 0.0f, 1e-30f}, {0.0f, -1.0f, 0.0f}, {0.0f, 3e38f, 3e38f}};
    static const float angles[] = {0.0f, 4.0f, -4.0f, NAN, INFINITY, 1e9f};
    float theta, phi, back[3];
    for (size_t k = 0; k < sizeof directions / sizeof *directions; ++k) {
        hairlut_angles(&frame, directions[k], &theta, &phi);
        REQUIRE(fabsf(theta) <= 1.57079637f && fabsf(phi) <= 3.14159274f);
        hairlut_direction(&frame, theta, phi, back);
        REQUIRE(fabsf(back[0]) <= 1.0f + 1e-6f);
    }
    const hairlut_frame broken = {{1.0f, 0.0f, 0.0f}, {INFINITY, INFINITY, INFINITY}, {0.0f, 0.0f, 1.0f}};
    hairlut_angles(&broken, directions[0], &theta, &phi);
    REQUIRE(theta == 0.0f && phi == 0.0f);
    for (size_t k = 0; k < sizeof angles / sizeof *angles; ++k) {
        hairlut_direction(&frame, angles[k], angles[(k + 1) % 6], back);
        REQUIRE(isfinite(back[0]) && isfinite(back[1]) && isfinite(back[2]));
    }
}

/* ---- models from files ---------------------------------------------------------------------------------------- */

static void load(const char *directory)
{
#ifdef EXERCISE_EXR
    char message[HAIRLUT_MESSAGE_SIZE];
    hairlut_model *model;
    const hairlut_result result = hairlut_load_with(directory, NULL, &model, message);
    REQUIRE((result == HAIRLUT_OK) == (model != NULL));
    if (model)
        check_model(model);
    else
        REQUIRE(strstr(message, ".exr: "));
    hairlut_free(model);
    REQUIRE(hairlut_load(directory, &model) == result);
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

/* ---- threads -------------------------------------------------------------------------------------------------- */

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

/* The names of the kernels that this processor runs, in a line, for the coverage count. */
static void print_kernels(void)
{
    printf("kernels");
    for (int level = 0; hairlut_batch_level(level); ++level)
        printf(" %s", hairlut_batch_level(level)->name);
    putchar('\n');
}

int main(int argc, char **argv)
{
    static scene s;
    char directory[4096];
    if (argc > 1)
        check_threads(atoi(argv[1]));
    use(hairlut_builtin("printed"));
    use(hairlut_builtin("fitted"));
    check_frame();
    check_good_models(&s);
    check_models_over_parameters(&s);
    check_refusals(&s);
    check_refused_parameters(&s);
    check_arguments(&s);
    check_loader_arguments();
    while (fgets(directory, sizeof directory, stdin)) {
        directory[strcspn(directory, "\n")] = '\0';
        load(directory);
    }
    print_kernels();
    puts("done");
    return 0;
}
