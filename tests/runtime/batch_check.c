/* Holds every set of batch kernels that this processor runs against the one-direction functions, bit for bit: any n, any
 * alignment, outputs in place of inputs, outputs left out, hard inputs, tables of awkward sizes. Prints the sets, what
 * differs, and a checksum of all results; exits with 1 if anything differs. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "batch.h"
#include "internal.h"

enum { MOST = 700, LONG = 4500, SLACK = 32, ARRAYS = 8 }; /* from 4096 on, samples go on from an aligned vector */

static const float half_pi = 1.57079637f, two_pi = 6.28318548f;
static int failures;
static uint64_t checksum = 14695981039346656037u;
static uint32_t state = 1;

static uint32_t random_bits(void)
{
    state = state * 1664525u + 1013904223u;
    return state >> 8;
}

static float random_unit(void)
{
    return (float)random_bits() / 16777216.0f;
}

static void fail(const char *what, const char *set, size_t n, size_t i, float expected, float got)
{
    if (++failures <= 20)
        printf("%s, %s, n = %zu, element %zu: expected %.9g, got %.9g\n", set, what, n, i, (double)expected, (double)got);
}

/* The same bits; a result is never NaN. */
static void compare(const char *what, const char *set, size_t n, const float *expected, const float *got)
{
    for (size_t i = 0; i < n; ++i)
        if (memcmp(expected + i, got + i, sizeof(float)) != 0 || got[i] != got[i])
            fail(what, set, n, i, expected[i], got[i]);
}

static void add_to_checksum(const float *x, size_t n)
{
    const unsigned char *bytes = (const unsigned char *)x;
    for (size_t k = 0; k < n * sizeof(float); ++k)
        checksum = (checksum ^ bytes[k]) * 1099511628211u;
}

/* ---- inputs ---- */

static const float hard_angles[] = {0.0f,   -0.0f,        1.57079637f, -1.57079637f, 1.5707964f, -1.6f,    3.14159274f, -3.14159274f,
                                    100.0f, -1e8f,        3e38f,       1e-30f,       7.5f,       INFINITY, -INFINITY,   NAN};
static const float hard_units[] = {0.0f, -0.0f, 1.0f, 0.5f, 0.50000006f, 0.49999997f, 0.99999994f, 5.96e-8f, 1e-12f, -1.0f, 2.0f, INFINITY, -INFINITY, NAN};

/* theta_r, phi_r, u_theta, u_phi; every fifth sample takes hard values */
static void fill_inputs(float *const in[4], size_t n)
{
    for (size_t i = 0; i < n; ++i) {
        const int hard = i % 5 == 4;
        in[0][i] = hard ? hard_angles[random_bits() % 16] : (2.0f * random_unit() - 1.0f) * half_pi;
        in[1][i] = hard ? hard_angles[random_bits() % 16] : (random_unit() - 0.5f) * 20.0f;
        in[2][i] = hard ? hard_units[random_bits() % 14] : random_unit();
        in[3][i] = hard ? hard_units[random_bits() % 14] : random_unit();
    }
}

/* ---- tables ---- */

static float *make_texels(int width, int height, float low, float high)
{
    float *texels = malloc((size_t)(width * height) * sizeof *texels);
    double *at = malloc((size_t)width * sizeof *at);
    if (!texels || !at)
        exit(2);
    for (int j = 0; j < height; ++j) {
        at[0] = 0.0;
        for (int i = 1; i < width; ++i) { /* widths over three decades, so that curvature is bounded somewhere */
            const double r = random_unit();
            at[i] = at[i - 1] + 0.001 + r * r * r;
        }
        for (int i = 0; i < width; ++i)
            texels[j * width + i] = (float)(low + (high - low) * (at[i] / at[width - 1]));
        texels[j * width] = low;
        texels[j * width + width - 1] = high;
    }
    free(at);
    return texels;
}

static hairlut_model *make_model(int width, int height, hairlut_warp warp, hairlut_azimuth azimuth)
{
    const float low[3] = {-half_pi, 0.0f, -half_pi}, high[3] = {half_pi, two_pi, half_pi};
    hairlut_table table[3];
    for (int k = 0; k < 3; ++k) {
        const hairlut_table filled = {make_texels(width, height, low[k], high[k]), width, height, -half_pi, half_pi,
                                      low[k], high[k], warp, 1.0f / 262144.0f, 0.9f};
        table[k] = filled;
    }
    const hairlut_model_desc desc = {table[0], table[1], table[2], azimuth};
    hairlut_model *model = NULL;
    char message[HAIRLUT_MESSAGE_SIZE];
    if (hairlut_model_create(&desc, NULL, &model, message) != HAIRLUT_OK) {
        printf("%s\n", message);
        exit(2);
    }
    for (int k = 0; k < 3; ++k)
        free((void *)table[k].texels);
    return model;
}

/* ---- checks ---- */

typedef hairlut_sample (*sample_one)(const hairlut_model *, float, float, float, float);
typedef float (*pdf_one)(const hairlut_model *, float, float, float, float);
typedef void (*sample_many)(const hairlut_model *, size_t, const float *, const float *, const float *, const float *,
                            hairlut_samples);
typedef void (*pdf_many)(const hairlut_model *, size_t, const float *, const float *, const float *, const float *, float *);

typedef struct lobe {
    const char *name;
    sample_one sample;
    pdf_one pdf;
    sample_many sample_n;
    pdf_many pdf_n;
} lobe;

static float memory[ARRAYS][LONG + SLACK];
static float expected[4][LONG], expected_pdf[LONG], inputs[4][LONG];

/* Eight arrays, each with an alignment of its own, and a canary after its n floats. */
static void place_arrays(float *arrays[ARRAYS], size_t n)
{
    for (int k = 0; k < ARRAYS; ++k) {
        arrays[k] = memory[k] + random_bits() % 16;
        arrays[k][n] = 12345.0f;
    }
}

static void check_canaries(float *const arrays[ARRAYS], const char *set, size_t n)
{
    for (int k = 0; k < ARRAYS; ++k)
        if (arrays[k][n] != 12345.0f)
            fail("written beyond the end", set, n, n, 12345.0f, arrays[k][n]);
}

static void restore_inputs(float *const arrays[ARRAYS], size_t n)
{
    for (int k = 0; k < 4; ++k)
        memcpy(arrays[k], inputs[k], n * sizeof(float));
}

static void check_sample(const lobe *l, const char *set, const hairlut_model *model, size_t n)
{
    static const char *const names[4] = {"theta_i", "phi_i", "pdf_angle", "pdf_solid_angle"};
    float *a[ARRAYS];
    place_arrays(a, n);
    restore_inputs(a, n);
    const hairlut_samples apart = {a[4], a[5], a[6], a[7]};
    l->sample_n(model, n, a[0], a[1], a[2], a[3], apart);
    for (int k = 0; k < 4; ++k) {
        compare(names[k], set, n, expected[k], a[4 + k]);
        compare("an input changed", set, 0, inputs[k], a[k]);
    }
    const int shift = (int)(random_bits() % 4); /* each output in place of some input */
    float *const to[4] = {a[shift], a[(shift + 1) % 4], a[(shift + 2) % 4], a[(shift + 3) % 4]};
    const hairlut_samples in_place = {to[0], to[1], to[2], to[3]};
    l->sample_n(model, n, a[0], a[1], a[2], a[3], in_place);
    for (int k = 0; k < 4; ++k)
        compare(names[k], set, n, expected[k], to[k]);
    restore_inputs(a, n);
    const hairlut_samples angles_only = {a[4], a[5], NULL, NULL};
    l->sample_n(model, n, a[0], a[1], a[2], a[3], angles_only);
    compare("theta_i alone", set, n, expected[0], a[4]);
    compare("phi_i alone", set, n, expected[1], a[5]);
    check_canaries(a, set, n);
}

static void check_pdf(const lobe *l, const char *set, const hairlut_model *model, size_t n)
{
    float *a[ARRAYS];
    place_arrays(a, n);
    restore_inputs(a, n);
    l->pdf_n(model, n, a[0], a[1], a[2], a[3], a[4]);
    compare("pdf", set, n, expected_pdf, a[4]);
    float *const to = a[random_bits() % 4];
    l->pdf_n(model, n, a[0], a[1], a[2], a[3], to);
    compare("pdf in place", set, n, expected_pdf, to);
    check_canaries(a, set, n);
}

/* Densities are asked for directions that were drawn, and for hard ones. */
static void make_directions(size_t n)
{
    for (size_t i = 0; i < n; ++i) {
        inputs[2][i] = i % 7 == 6 ? hard_angles[random_bits() % 16] : expected[0][i];
        inputs[3][i] = i % 7 == 5 ? hard_angles[random_bits() % 16] : expected[1][i];
    }
}

static void check_model(const lobe *l, const char *set, const hairlut_model *model, size_t n)
{
    float *const in[4] = {inputs[0], inputs[1], inputs[2], inputs[3]};
    fill_inputs(in, n);
    for (size_t i = 0; i < n; ++i) {
        const hairlut_sample s = l->sample(model, in[0][i], in[1][i], in[2][i], in[3][i]);
        const float fields[4] = {s.theta_i, s.phi_i, s.pdf_angle, s.pdf_solid_angle};
        for (int k = 0; k < 4; ++k)
            expected[k][i] = fields[k];
    }
    check_sample(l, set, model, n);
    make_directions(n);
    for (size_t i = 0; i < n; ++i)
        expected_pdf[i] = l->pdf(model, in[0][i], in[1][i], in[2][i], in[3][i]);
    check_pdf(l, set, model, n);
    for (int k = 0; k < 4; ++k)
        add_to_checksum(expected[k], n);
    add_to_checksum(expected_pdf, n);
}

static void check_set(const hairlut_batch *batch, const hairlut_model *model, size_t most)
{
    const lobe lobes[2] = {
        {"direct", hairlut_sample_direct, hairlut_pdf_direct, batch->sample_direct, batch->pdf_direct},
        {"multiple", hairlut_sample_multiple, hairlut_pdf_multiple, batch->sample_multiple, batch->pdf_multiple}};
    for (int k = 0; k < 2; ++k) {
        for (size_t n = 0; n <= most; ++n)
            check_model(&lobes[k], batch->name, model, n);
        check_model(&lobes[k], batch->name, model, MOST);
    }
}

/* Arrays so long that their alignment is seen to, at eight of them */
static void check_long(const hairlut_batch *batch, const hairlut_model *model)
{
    const lobe direct = {"direct", hairlut_sample_direct, hairlut_pdf_direct, batch->sample_direct, batch->pdf_direct};
    for (size_t k = 0; k < 8; ++k)
        check_model(&direct, batch->name, model, LONG - k);
}

/* The mixture's _n functions are put together from the public kernels: checked once. */
static void check_mixture(const hairlut_model *model, size_t n)
{
    float *const in[4] = {inputs[0], inputs[1], inputs[2], inputs[3]};
    float weight[MOST], u_lobe[MOST], got[4][MOST], pdf[MOST];
    const hairlut_samples out = {got[0], got[1], got[2], got[3]};
    fill_inputs(in, n);
    for (size_t i = 0; i < n; ++i) {
        weight[i] = i % 9 == 8 ? hard_units[random_bits() % 14] : random_unit();
        u_lobe[i] = i % 11 == 10 ? hard_units[random_bits() % 14] : random_unit();
        const hairlut_sample s = hairlut_sample_mixture(model, weight[i], in[0][i], in[1][i], u_lobe[i], in[2][i], in[3][i]);
        const float fields[4] = {s.theta_i, s.phi_i, s.pdf_angle, s.pdf_solid_angle};
        for (int k = 0; k < 4; ++k)
            expected[k][i] = fields[k];
    }
    hairlut_sample_mixture_n(model, n, weight, in[0], in[1], u_lobe, in[2], in[3], out);
    for (int k = 0; k < 4; ++k)
        compare("mixture sample", "public", n, expected[k], got[k]);
    const hairlut_samples in_place = {weight, u_lobe, NULL, NULL};
    make_directions(n);
    for (size_t i = 0; i < n; ++i)
        expected_pdf[i] = hairlut_pdf_mixture(model, weight[i], in[0][i], in[1][i], in[2][i], in[3][i]);
    hairlut_pdf_mixture_n(model, n, weight, in[0], in[1], in[2], in[3], pdf);
    compare("mixture pdf", "public", n, expected_pdf, pdf);
    fill_inputs(in, n);
    hairlut_sample_mixture_n(model, n, weight, in[0], in[1], u_lobe, in[2], in[3], out);
    hairlut_sample_mixture_n(model, n, weight, in[0], in[1], u_lobe, in[2], in[3], in_place);
    compare("mixture in place", "public", n, got[0], weight);
    compare("mixture in place", "public", n, got[1], u_lobe);
}

int main(void)
{
    static const int sizes[][2] = {{4, 2},  {5, 3},   {6, 2},   {17, 5},  {18, 4},  {19, 3},  {33, 7},  {64, 9},   {65, 3},
                                   {66, 3}, {67, 4},  {68, 5},  {69, 3},  {70, 4},  {81, 3},  {127, 5}, {256, 4},  {257, 3},
                                   {258, 3}, {259, 5}, {300, 4}, {514, 3}, {1025, 2}, {1100, 3}, {4096, 2}};
    const hairlut_batch public_set = {"public", hairlut_sample_direct_n, hairlut_sample_multiple_n, hairlut_pdf_direct_n,
                                      hairlut_pdf_multiple_n};
    const hairlut_batch *sets[8] = {&public_set};
    int count = 1;
    for (int level = 0; hairlut_batch_level(level); ++level)
        sets[count++] = hairlut_batch_level(level);
    for (size_t n = 0; n <= 300; ++n)
        check_mixture(hairlut_builtin(n % 2 ? "printed" : "fitted"), n);
    for (int s = 0; s < count; ++s) {
        printf("set %s\n", sets[s]->name);
        state = 1; /* each set sees the same inputs */
        checksum = 14695981039346656037u;
        check_set(sets[s], hairlut_builtin("printed"), 200);
        check_set(sets[s], hairlut_builtin("fitted"), 200);
        check_long(sets[s], hairlut_builtin("fitted"));
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; ++k) {
            hairlut_model *model = make_model(sizes[k][0], sizes[k][1], k % 4 == 3 ? HAIRLUT_WARP_UNIFORM : HAIRLUT_WARP_OCTAVES,
                                              k % 2 ? HAIRLUT_AZIMUTH_SUM : HAIRLUT_AZIMUTH_DIFFERENCE);
            check_set(sets[s], model, 20);
            hairlut_free(model);
        }
        printf("checksum %016llx\n", (unsigned long long)checksum);
    }
    return failures != 0;
}
