/* SPDX-License-Identifier: BSD-3-Clause */
/* Holds every set of batch kernels that this processor runs against the one-direction functions, bit for bit: single lobes and
 * the whole hair, any n, any alignment, outputs in place of inputs, outputs and inputs left out, hard inputs, tables of awkward
 * sizes, mixtures of every shape, and strands of models over parameters. Prints the sets, what differs, and a checksum of all results; exits with 1 if anything
 * differs. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "batch.h"
#include "viewer.h"
#include "internal.h"

enum { MOST = 700, SLACK = 32, INPUTS = 6 + HAIRLUT_MAX_LOBES, ARRAYS = INPUTS + 5, AXES = 3 /* of parameters, at most */ };

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

/* ---- inputs: theta_r, phi_r, u_theta, u_phi, offset, u_lobe, then the shares of each lobe; parameters apart ---- */

static const float hard_angles[] = {0.0f,        -0.0f,        1.57079637f, -1.57079637f, 1.5707964f, -1.6f,
                                    3.14159274f, -3.14159274f, 100.0f,      -1e8f,        3e38f,      1e-30f,
                                    7.5f,        INFINITY,     -INFINITY,   NAN};
static const float hard_units[] = {0.0f,     -0.0f,  1.0f,  0.5f, 0.50000006f, 0.49999997f, 0.99999994f,
                                   5.96e-8f, 1e-12f, -1.0f, 2.0f, INFINITY,    -INFINITY,   NAN};
static const float hard_shares[] = {0.0f, 0.0f, -0.0f, -1.0f, 1e-45f, 1e-38f, 3e38f, 2e38f, 1e30f, INFINITY, -INFINITY, NAN};

#define PICK(array) array[random_bits() % (sizeof array / sizeof *array)]

static float inputs[INPUTS][MOST], parameters[AXES][MOST], directions[2][MOST];

/* Every fifth sample takes hard values. */
static void fill_inputs(size_t n)
{
    for (size_t i = 0; i < n; ++i) {
        const int hard = i % 5 == 4;
        inputs[0][i] = hard ? PICK(hard_angles) : (2.0f * random_unit() - 1.0f) * half_pi;
        inputs[1][i] = hard ? PICK(hard_angles) : (random_unit() - 0.5f) * 20.0f;
        inputs[2][i] = hard ? PICK(hard_units) : random_unit();
        inputs[3][i] = hard ? PICK(hard_units) : random_unit();
        inputs[4][i] = i % 7 == 3 ? PICK(hard_units) : 2.0f * random_unit() - 1.0f;
        inputs[5][i] = i % 11 == 10 ? PICK(hard_units) : random_unit();
        for (int k = 0; k < HAIRLUT_MAX_LOBES; ++k)
            inputs[6 + k][i] = (i + (size_t)k) % 13 == 6 ? PICK(hard_shares) : random_unit();
        for (int p = 0; p < AXES; ++p) /* beyond their range too */
            parameters[p][i] = (i + (size_t)p) % 9 == 4 ? PICK(hard_units) : 1.2f * random_unit() - 0.1f;
    }
}

/* Densities of directions that were sampled, and of hard ones. */
static void make_directions(size_t n, const float *theta_i, const float *phi_i)
{
    for (size_t i = 0; i < n; ++i) {
        directions[0][i] = i % 7 == 6 ? PICK(hard_angles) : theta_i[i];
        directions[1][i] = i % 7 == 5 ? PICK(hard_angles) : phi_i[i];
    }
}

/* ---- models ---- */

/* The width of tables whose middle columns are a float's step apart, high in one row and low in the next: what the change between
 * them rounds puts blended texels out of order. */
enum { CROWDED = 34 };

static void crowd(float *row, int j, float low, float high)
{
    const int first = CROWDED / 5, last = CROWDED - CROWDED / 4;
    const float middle = low + (high - low) * (j % 2 ? 0.25f : 0.9f);
    for (int i = 1; i + 1 < CROWDED; ++i)
        row[2 * i] = i <= first ? low + (middle - low) * ((float)i / (float)first)
                     : i < last ? nextafterf(row[2 * i - 2], high)
                                : high - (high - middle) * (float)(CROWDED - 1 - i) / (float)(CROWDED - last);
}

static float *make_texels(int width, int height, float low, float high)
{
    float *texels = malloc(2 * (size_t)(width * height) * sizeof *texels);
    double *at = malloc((size_t)width * sizeof *at);
    if (!texels || !at)
        exit(2);
    for (int j = 0; j < height; ++j) {
        at[0] = 0.0;
        for (int i = 1; i < width; ++i) { /* widths over three decades */
            const double r = random_unit();
            at[i] = at[i - 1] + 0.001 + r * r * r;
        }
        for (int i = 0; i < width; ++i) {
            const float x = (float)(low + (high - low) * (at[i] / at[width - 1]));
            texels[2 * (j * width + i)] = i == 0 ? low : i == width - 1 ? high : x;
            texels[2 * (j * width + i) + 1] = powf(10.0f, 6.0f * random_unit() - 2.0f); /* some are bounded */
        }
        if (width == CROWDED)
            crowd(texels + 2 * j * width, j, low, high);
    }
    free(at);
    return texels;
}

/* All rows of each node as its first */
static void make_rows_alike(float *texels, int width, int height, int nodes)
{
    const size_t row = 2 * (size_t)width;
    for (int j = 0; j < nodes * height; ++j)
        memcpy(texels + (size_t)j * row, texels + (size_t)(j - j % height) * row, row * sizeof *texels);
}

static float *make_floats(size_t n, float low, float high, float zero)
{
    float *values = malloc(n * sizeof *values);
    if (!values)
        exit(2);
    for (size_t k = 0; k < n; ++k)
        values[k] = random_unit() < zero ? 0.0f : low + (high - low) * random_unit();
    return values;
}

static float *make_nodes(int count, float low, float high)
{
    float *nodes = make_floats((size_t)count, 0.1f, 1.0f, 0.0f);
    for (int k = 1; k < count; ++k)
        nodes[k] += nodes[k - 1];
    const float first = nodes[0], last = nodes[count - 1];
    for (int k = 0; k < count; ++k)
        nodes[k] = count == 1       ? 0.5f * (low + high)
                   : k == count - 1 ? high
                                    : low + (high - low) * ((nodes[k] - first) / (last - first));
    return nodes;
}

/* What a model is made with. `zero` is the fraction of shares that are 0; every third lobe has a uniform azimuth. */
typedef struct shape {
    int width, height, lobes, rows, columns, mirrored, turned;
    float zero;
} shape;

enum { NODES = 3 /* of an axis */ };

/* Tables and mixture depend on `axes` of the parameters: a lobe's azimuth on one less, every fifth table on none. Every other
 * lobe's azimuth does not depend on theta_r. */
static hairlut_model *make_model(const shape *s, hairlut_warp warp, int axes)
{
    static const float values[NODES] = {0.0f, 0.4f, 1.0f};
    static const hairlut_parameter described[AXES] = {{sizeof *described, "rough", 0.0f, 1.0f, 0.7f},
                                                      {sizeof *described, "dark", 0.0f, 1.0f, 0.4f},
                                                      {sizeof *described, "cuticle", 0.0f, 1.0f, 0.0f}};
    static const hairlut_parameter_nodes nodes_of[AXES] = {
        {sizeof *nodes_of, 1, NODES, values}, {sizeof *nodes_of, 0, NODES, values}, {sizeof *nodes_of, 2, NODES, values}};
    static const int powers[AXES + 1] = {1, NODES, NODES * NODES, NODES * NODES * NODES};
    const int all = powers[axes];
    hairlut_table tables[2 * HAIRLUT_MAX_LOBES];
    hairlut_lobe_desc lobes[HAIRLUT_MAX_LOBES];
    char names[HAIRLUT_MAX_LOBES][16];
    const size_t nodes = (size_t)(s->rows * s->columns * s->lobes * all), first = (size_t)(s->rows * s->columns * all);
    for (int k = 0; k < 2 * s->lobes; ++k) {
        const float low = k % 2 ? 0.0f : -half_pi, high = k % 2 ? two_pi : half_pi;
        const int own = k % 5 == 4 || axes == 0 ? 0 : axes - k % 2;
        float *texels = make_texels(s->width, s->height * powers[own], low, high);
        if (k % 4 == 3)
            make_rows_alike(texels, s->width, s->height, powers[own]);
        const hairlut_table table = {sizeof table, texels, s->width, s->height,        -half_pi, half_pi,
                                     low,          high,   warp,     1.0f / 262144.0f, own,      nodes_of};
        tables[k] = table;
    }
    for (int k = 0; k < s->lobes; ++k) {
        const hairlut_lobe_desc lobe = {sizeof lobe, names[k], &tables[2 * k], k % 3 == 1 ? NULL : &tables[2 * k + 1],
                                        k % 2 ? HAIRLUT_AZIMUTH_SUM : HAIRLUT_AZIMUTH_DIFFERENCE};
        snprintf(names[k], sizeof names[k], "lobe%u", (unsigned)k);
        lobes[k] = lobe;
    }
    float *theta_r = make_nodes(s->rows, -1.5f, 1.5f), *offset = make_nodes(s->columns, s->mirrored ? 0.0f : -1.0f, 1.0f);
    float *share = make_floats(nodes, 0.1f, 2.0f, s->zero), *turn = make_floats(nodes, -20.0f, 20.0f, 0.0f);
    for (size_t k = 0; k < first; ++k)
        share[k] += 0.01f; /* one lobe has a share everywhere */
    const hairlut_mixture_desc mixture = {sizeof mixture,          s->rows,     s->columns, theta_r, offset, share,
                                          s->turned ? turn : NULL, s->mirrored, axes,       nodes_of};
    const hairlut_model_desc desc = {sizeof desc, s->lobes, lobes, &mixture, axes > 0 ? AXES : 0, described};
    hairlut_model *model = NULL;
    char message[HAIRLUT_MESSAGE_SIZE];
    if (hairlut_model_create(&desc, NULL, &model, message) != HAIRLUT_OK) {
        printf("%s\n", message);
        exit(2);
    }
    for (int k = 0; k < 2 * s->lobes; ++k)
        free((void *)tables[k].texels);
    free(theta_r), free(offset), free(share), free(turn);
    return model;
}

/* ---- checks ---- */

static float memory[ARRAYS][MOST * HAIRLUT_MAX_LOBES + SLACK];
static float expected[4][MOST], expected_pdf[MOST];

/* A call of one of the four functions of a set, on arrays placed somewhere. */
typedef struct call {
    const hairlut_batch *batch;
    const hairlut_model *model;
    int lobe; /* -1: the whole hair */
    int has_shares, has_offset, has_parameters;
    size_t n;
} call;

static float *place_array(int k, const float *from, size_t n)
{
    float *array = memory[k] + random_bits() % 16;
    memcpy(array, from, n * sizeof *array);
    array[n] = 12345.0f;
    return array;
}

static void check_canary(const call *c, const float *array, size_t n)
{
    if (array[n] != 12345.0f)
        fail("written beyond the end", c->batch->name, n, n, 12345.0f, array[n]);
}

/* The shares of all lobes side by side, as the caller passes them; NULL if there are none. */
static float *place_shares(const call *c)
{
    static float together[MOST * HAIRLUT_MAX_LOBES];
    const size_t n = c->n, lobes = (size_t)hairlut_lobe_count(c->model);
    for (size_t k = 0; k < lobes; ++k)
        memcpy(together + k * n, inputs[6 + k], n * sizeof *together);
    return c->has_shares ? place_array(6, together, n * lobes) : NULL;
}

/* The same of parameters, which are beside the shares. */
static float *place_parameters(const call *c)
{
    static float together[AXES * MOST];
    for (size_t p = 0; p < AXES; ++p)
        memcpy(together + p * c->n, parameters[p], c->n * sizeof *together);
    return c->has_parameters ? place_array(INPUTS + 4, together, c->n * AXES) : NULL;
}

static void one_sample(const call *c, size_t i, const float *strand, float *shares)
{
    float (*in)[MOST] = inputs;
    const float offset = c->has_offset ? in[4][i] : 0.0f;
    const hairlut_sample s = c->lobe >= 0 ? hairlut_sample_lobe(c->model, c->lobe, in[0][i], in[1][i], in[2][i], in[3][i])
                                          : hairlut_sample_strand(c->model, strand, shares, in[0][i], in[1][i], offset,
                                                                  in[5][i], in[2][i], in[3][i]);
    const float fields[4] = {s.theta_i, s.phi_i, s.pdf_angle, s.pdf_solid_angle};
    for (int k = 0; k < 4; ++k)
        expected[k][i] = fields[k];
}

static void one_pdf(const call *c, size_t i, const float *strand, float *shares)
{
    float (*in)[MOST] = inputs;
    const float offset = c->has_offset ? in[4][i] : 0.0f;
    expected_pdf[i] =
        c->lobe >= 0
            ? hairlut_pdf_lobe(c->model, c->lobe, in[0][i], in[1][i], directions[0][i], directions[1][i])
            : hairlut_pdf_strand(c->model, strand, shares, in[0][i], in[1][i], offset, directions[0][i], directions[1][i]);
}

static void one_by_one(const call *c, void (*one)(const call *, size_t, const float *, float *))
{
    float shares[HAIRLUT_MAX_LOBES], strand[AXES];
    for (size_t i = 0; i < c->n; ++i) {
        for (int k = 0; k < HAIRLUT_MAX_LOBES; ++k)
            shares[k] = inputs[6 + k][i];
        for (int p = 0; p < AXES; ++p)
            strand[p] = parameters[p][i];
        one(c, i, c->has_parameters ? strand : NULL, c->has_shares ? shares : NULL);
    }
}

static void sample(const call *c, float *const a[6], const float *strands, const float *shares, hairlut_samples out)
{
    const float *offset = c->has_offset ? a[4] : NULL;
    if (c->lobe >= 0)
        c->batch->sample_lobe(c->model, c->lobe, c->n, a[0], a[1], a[2], a[3], out);
    else if (strands)
        c->batch->sample_strand(c->model, c->n, strands, shares, a[0], a[1], offset, a[5], a[2], a[3], out);
    else
        c->batch->sample_hair(c->model, c->n, shares, a[0], a[1], offset, a[5], a[2], a[3], out);
}

static void pdf(const call *c, float *const a[6], const float *strands, const float *shares, float *out)
{
    const float *offset = c->has_offset ? a[4] : NULL;
    if (c->lobe >= 0)
        c->batch->pdf_lobe(c->model, c->lobe, c->n, a[0], a[1], a[2], a[3], out);
    else if (strands)
        c->batch->pdf_strand(c->model, c->n, strands, shares, a[0], a[1], offset, a[2], a[3], out);
    else
        c->batch->pdf_hair(c->model, c->n, shares, a[0], a[1], offset, a[2], a[3], out);
}

static void check_sample(const call *c)
{
    static const char *const names[4] = {"theta_i", "phi_i", "pdf_angle", "pdf_solid_angle"};
    const size_t n = c->n;
    float *a[6], *out[4], *shares = place_shares(c), *strands = place_parameters(c);
    for (int k = 0; k < 6; ++k)
        a[k] = place_array(k, inputs[k], n);
    for (int k = 0; k < 4; ++k)
        out[k] = place_array(INPUTS + k, inputs[0], n);
    const hairlut_samples apart = {out[0], out[1], out[2], out[3]}, angles_only = {out[0], out[1], NULL, NULL};
    sample(c, a, strands, shares, apart);
    for (int k = 0; k < 4; ++k)
        compare(names[k], c->batch->name, n, expected[k], out[k]);
    for (int k = 0; k < 6; ++k)
        if (memcmp(a[k], inputs[k], n * sizeof *a[k]) != 0)
            fail("an input changed", c->batch->name, n, 0, inputs[k][0], a[k][0]);
    sample(c, a, strands, shares, angles_only);
    compare("theta_i alone", c->batch->name, n, expected[0], out[0]);
    compare("phi_i alone", c->batch->name, n, expected[1], out[1]);
    const unsigned shift = random_bits() % 6; /* each output in place of some input */
    float *const to[4] = {a[shift], strands ? strands + (AXES - 1) * n : a[(shift + 1) % 6], a[(shift + 2) % 6],
                          shares ? shares : a[(shift + 3) % 6]};
    const hairlut_samples in_place = {to[0], to[1], to[2], to[3]};
    sample(c, a, strands, shares, in_place);
    for (int k = 0; k < 4; ++k)
        compare(names[k], c->batch->name, n, expected[k], to[k]);
    for (int k = 0; k < 4; ++k)
        check_canary(c, out[k], n);
    for (int k = 0; k < 6; ++k)
        check_canary(c, a[k], n);
}

static void check_pdf(const call *c)
{
    const size_t n = c->n;
    float *a[6], *out = place_array(INPUTS, inputs[0], n), *shares = place_shares(c), *strands = place_parameters(c);
    for (int k = 0; k < 6; ++k)
        a[k] = place_array(k, k == 2 ? directions[0] : k == 3 ? directions[1] : inputs[k], n);
    pdf(c, a, strands, shares, out);
    compare("pdf", c->batch->name, n, expected_pdf, out);
    const unsigned which = random_bits() % 8;
    float *const to = shares && which == 5 ? shares : strands && which >= 6 ? strands + which % 2 * n : a[which % 5];
    pdf(c, a, strands, shares, to);
    compare("pdf in place", c->batch->name, n, expected_pdf, to);
    check_canary(c, out, n);
}

/* Viewers, one for each element, give what is expected of the arrays. */
static void check_viewers(const call *c)
{
    static float got[5][MOST];
    float (*in)[MOST] = inputs, shares[HAIRLUT_MAX_LOBES], strand[AXES];
    const hairlut_one *one = &c->batch->one;
    for (size_t i = 0; i < c->n; ++i) {
        hairlut_view view;
        for (int k = 0; k < HAIRLUT_MAX_LOBES; ++k)
            shares[k] = in[6 + k][i];
        for (int p = 0; p < AXES; ++p)
            strand[p] = parameters[p][i];
        one->view(&view, c->model, c->has_parameters ? strand : NULL, c->has_shares ? shares : NULL, in[0][i], in[1][i],
                  c->has_offset ? in[4][i] : 0.0f);
        const hairlut_sample s = one->sample_view(&view, in[5][i], in[2][i], in[3][i]);
        const float fields[5] = {s.theta_i, s.phi_i, s.pdf_angle, s.pdf_solid_angle,
                                 one->pdf_view(&view, directions[0][i], directions[1][i])};
        for (int k = 0; k < 5; ++k)
            got[k][i] = fields[k];
    }
    for (int k = 0; k < 5; ++k)
        compare("a viewer's", c->batch->name, c->n, k < 4 ? expected[k] : expected_pdf, got[k]);
}

static void check_call(const call *c)
{
    fill_inputs(c->n);
    one_by_one(c, one_sample);
    check_sample(c);
    make_directions(c->n, expected[0], expected[1]);
    one_by_one(c, one_pdf);
    check_pdf(c);
    if (c->lobe < 0 && c->batch->one.view)
        check_viewers(c);
    for (int k = 0; k < 4; ++k)
        add_to_checksum(expected[k], c->n);
    add_to_checksum(expected_pdf, c->n);
}

static void check_model(const hairlut_batch *batch, const hairlut_model *model, size_t most)
{
    for (int lobe = -1; lobe < hairlut_lobe_count(model) && lobe < 2; ++lobe)
        for (size_t n = 0; n <= most + 1; ++n) {
            const int has_shares = (int)(n % 3 == 1), has_offset = (int)(n % 4 != 2);
            const call c = {batch, model, lobe, has_shares, has_offset, 0, n <= most ? n : MOST};
            check_call(&c);
        }
}

/* ---- strands ---- */

/* The whole hair at random strands */
static void check_strands(const hairlut_batch *batch, const hairlut_model *model)
{
    static const size_t counts[] = {0, 1, 2, 3, 5, 7, 8, 9, 15, 16, 17, 31, 255, 256, 264, 300, MOST};
    for (size_t k = 0; k < sizeof counts / sizeof *counts; ++k) {
        const call c = {batch, model, -1, k % 3 == 1, k % 4 != 2, 1, counts[k]};
        check_call(&c);
    }
}

static void check_all_strands(const hairlut_batch *batch)
{
    static const shape shapes[] = {{9, 5, 4, 7, 3, 1, 1, 0.3f},   {60, 3, 6, 1, 1, 0, 1, 0.0f},
                                   {100, 4, 2, 3, 4, 0, 0, 0.2f}, {600, 2, 5, 2, 1, 1, 1, 0.0f},
                                   {73, 3, 1, 1, 1, 0, 0, 0.0f},  {24, 9, 3, 2, 5, 1, 0, 0.0f},
                                   {8, 3, 16, 3, 4, 1, 1, 0.6f},  {9, 3, 2, 70, 2, 0, 1, 0.1f}};
    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; ++k)
        for (int axes = 1; axes <= AXES; ++axes) {
            hairlut_model *model = make_model(&shapes[k], k % 2 ? HAIRLUT_WARP_UNIFORM : HAIRLUT_WARP_OCTAVES, axes);
            check_strands(batch, model);
            hairlut_free(model);
        }
}

static void check_shapes(const hairlut_batch *batch)
{
    static const shape shapes[] = {
        {4, 2, 1, 1, 1, 0, 0, 0.0f},    {5, 3, 2, 1, 1, 0, 1, 0.0f},       {6, 2, 3, 1, 1, 1, 0, 0.0f},
        {17, 5, 4, 5, 1, 0, 1, 0.3f},   {18, 4, 2, 1, 7, 1, 1, 0.0f},      {19, 3, 16, 3, 4, 1, 1, 0.6f},
        {33, 7, 5, 9, 9, 0, 1, 0.2f},   {CROWDED, 9, 3, 1, 1, 0, 0, 0.0f}, {64, 9, 3, 70, 3, 1, 1, 0.0f},
        {65, 3, 2, 2, 66, 0, 1, 0.0f},  {66, 3, 2, 64, 65, 1, 0, 0.5f},    {67, 4, 1, 2, 2, 1, 1, 0.0f},
        {68, 5, 2, 1, 1, 0, 0, 0.0f},   {69, 3, 3, 2, 1, 0, 0, 0.5f},      {70, 4, 2, 1, 2, 1, 0, 0.0f},
        {73, 3, 2, 1, 1, 0, 0, 0.0f},   {74, 3, 2, 1, 1, 0, 0, 0.0f},      {127, 5, 2, 4, 4, 0, 1, 0.1f},
        {256, 4, 2, 1, 1, 1, 1, 0.0f},  {257, 3, 2, 1, 1, 0, 0, 0.0f},     {258, 3, 3, 3, 3, 1, 1, 0.3f},
        {300, 4, 2, 1, 1, 0, 0, 0.0f},  {514, 3, 2, 1, 1, 0, 0, 0.0f},     {1025, 2, 2, 1, 1, 0, 0, 0.0f},
        {4096, 2, 2, 1, 1, 0, 0, 0.0f},
    };
    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; ++k) {
        hairlut_model *model = make_model(&shapes[k], k % 4 == 3 ? HAIRLUT_WARP_UNIFORM : HAIRLUT_WARP_OCTAVES, 0);
        check_model(batch, model, 20);
        hairlut_free(model);
    }
}

int main(void)
{
    const hairlut_batch public_set = {"public",
                                      {hairlut_sample_lobe, hairlut_pdf_lobe, hairlut_sample_hair, hairlut_pdf_hair,
                                       hairlut_sample_strand, hairlut_pdf_strand, NULL, NULL, NULL},
                                      hairlut_sample_lobe_n,
                                      hairlut_pdf_lobe_n,
                                      hairlut_sample_hair_n,
                                      hairlut_pdf_hair_n,
                                      hairlut_sample_strand_n,
                                      hairlut_pdf_strand_n};
    const hairlut_batch *sets[8] = {&public_set};
    int count = 1;
    for (int level = 0; hairlut_batch_level(level); ++level)
        sets[count++] = hairlut_batch_level(level);
    for (int s = 0; s < count; ++s) {
        printf("set %s\n", sets[s]->name);
        state = 1; /* each set sees the same inputs */
        checksum = 14695981039346656037u;
        check_model(sets[s], hairlut_builtin("printed"), 200);
        check_model(sets[s], hairlut_builtin("fitted"), 200);
        check_shapes(sets[s]);
        check_all_strands(sets[s]);
        printf("checksum %016llx\n", (unsigned long long)checksum);
    }
    return failures != 0;
}
