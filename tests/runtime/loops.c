/* SPDX-License-Identifier: BSD-3-Clause */
/* Loops over the one-direction functions, and the single axes behind them, so that tests can call them a million times at once.
 * Arrays are n floats; `angle` is 0 for theta, 1 for phi. */
#include "axis.h"

#if defined(_WIN32)
#define LOOP __declspec(dllexport)
#else
#define LOOP __attribute__((visibility("default")))
#endif

LOOP void loop_sample(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                      const float *u_theta, const float *u_phi, hairlut_sample *out)
{
    for (size_t i = 0; i < n; ++i)
        out[i] = hairlut_sample_lobe(model, lobe, theta_r[i], phi_r[i], u_theta[i], u_phi[i]);
}

LOOP void loop_pdf(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                   const float *theta_i, const float *phi_i, float *pdf)
{
    for (size_t i = 0; i < n; ++i)
        pdf[i] = hairlut_pdf_lobe(model, lobe, theta_r[i], phi_r[i], theta_i[i], phi_i[i]);
}

LOOP void loop_invert(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                      const float *theta_i, const float *phi_i, float *u)
{
    for (size_t i = 0; i < n; ++i)
        hairlut_invert_lobe(model, lobe, theta_r[i], phi_r[i], theta_i[i], phi_i[i], u + 2 * i);
}

/* shares: NULL, or lobe_count numbers for each i, side by side */
static const float *shares_of(const hairlut_model *model, const float *shares, size_t i)
{
    return shares ? shares + i * (size_t)hairlut_lobe_count(model) : NULL;
}

LOOP void loop_sample_hair(const hairlut_model *model, const float *shares, size_t n, const float *theta_r,
                           const float *phi_r, const float *offset, const float *u_lobe, const float *u_theta,
                           const float *u_phi, hairlut_sample *out)
{
    for (size_t i = 0; i < n; ++i)
        out[i] = hairlut_sample_hair(model, shares_of(model, shares, i), theta_r[i], phi_r[i], offset[i], u_lobe[i],
                                     u_theta[i], u_phi[i]);
}

LOOP void loop_pdf_hair(const hairlut_model *model, const float *shares, size_t n, const float *theta_r, const float *phi_r,
                        const float *offset, const float *theta_i, const float *phi_i, float *pdf)
{
    for (size_t i = 0; i < n; ++i)
        pdf[i] = hairlut_pdf_hair(model, shares_of(model, shares, i), theta_r[i], phi_r[i], offset[i], theta_i[i], phi_i[i]);
}

/* parameters: NULL, or parameter_count numbers for each i, side by side */
static const float *parameters_of(const hairlut_model *model, const float *parameters, size_t i)
{
    return parameters ? parameters + i * (size_t)hairlut_parameter_count(model) : NULL;
}

LOOP void loop_sample_strand(const hairlut_model *model, const float *parameters, const float *shares, size_t n,
                             const float *theta_r, const float *phi_r, const float *offset, const float *u_lobe,
                             const float *u_theta, const float *u_phi, hairlut_sample *out)
{
    for (size_t i = 0; i < n; ++i)
        out[i] = hairlut_sample_strand(model, parameters_of(model, parameters, i), shares_of(model, shares, i), theta_r[i],
                                       phi_r[i], offset[i], u_lobe[i], u_theta[i], u_phi[i]);
}

LOOP void loop_pdf_strand(const hairlut_model *model, const float *parameters, const float *shares, size_t n,
                          const float *theta_r, const float *phi_r, const float *offset, const float *theta_i,
                          const float *phi_i, float *pdf)
{
    for (size_t i = 0; i < n; ++i)
        pdf[i] = hairlut_pdf_strand(model, parameters_of(model, parameters, i), shares_of(model, shares, i), theta_r[i],
                                    phi_r[i], offset[i], theta_i[i], phi_i[i]);
}

/* Both of each viewer, in the order density, sample, density of a copy; memory that was not zero before. Returns whether both
 * densities are the same. */
LOOP int loop_viewer(const hairlut_model *model, const float *parameters, const float *shares, size_t n,
                     const float *theta_r, const float *phi_r, const float *offset, const float *u_lobe,
                     const float *u_theta, const float *u_phi, const float *theta_i, const float *phi_i, hairlut_sample *out,
                     float *pdf)
{
    int same = 1;
    for (size_t i = 0; i < n; ++i) {
        hairlut_viewer viewer, copy;
        memset(&viewer, 0xA5, sizeof viewer);
        hairlut_viewer_at(&viewer, model, parameters_of(model, parameters, i), shares_of(model, shares, i), theta_r[i],
                          phi_r[i], offset[i]);
        pdf[i] = hairlut_viewer_pdf(&viewer, theta_i[i], phi_i[i]);
        copy = viewer;
        memset(&viewer, 0x5A, sizeof viewer);
        out[i] = hairlut_viewer_sample(&copy, u_lobe[i], u_theta[i], u_phi[i]);
        const float again = hairlut_viewer_pdf(&copy, theta_i[i], phi_i[i]);
        same &= memcmp(&again, &pdf[i], sizeof again) == 0;
    }
    return same;
}

static const hairlut_axis *axis_of(const hairlut_model *model, int lobe, int angle)
{
    return angle ? &model->lobes[lobe].phi : &model->lobes[lobe].theta;
}

/* As the functions of hairlut.h return an angle: in the domain. */
LOOP void axis_sample(const hairlut_model *model, int lobe, int angle, size_t n, const float *theta_r, const float *u,
                      float *x, float *pdf)
{
    const hairlut_axis *a = axis_of(model, lobe, angle);
    for (size_t i = 0; i < n; ++i) {
        const hairlut_row row = hairlut_axis_row(a, theta_r[i]);
        const hairlut_placed placed = hairlut_axis_find_place(a, &row, u[i]);
        const hairlut_draws draws = hairlut_draw_two(&placed, &placed);
        x[i] = hairlut_axis_inside(a, hairlut_quad_first(draws.x));
        pdf[i] = 1.0f / hairlut_quad_first(draws.slope);
    }
}

LOOP void axis_pdf(const hairlut_model *model, int lobe, int angle, size_t n, const float *theta_r, const float *x,
                   float *pdf)
{
    const hairlut_axis *a = axis_of(model, lobe, angle);
    for (size_t i = 0; i < n; ++i) {
        const hairlut_row row = hairlut_axis_row(a, theta_r[i]);
        const hairlut_found one = hairlut_axis_find(a, &row, x[i]), two[2] = {one, one};
        const hairlut_axes axes = hairlut_two_axes(two);
        const hairlut_inverses inverse = hairlut_invert(&axes);
        pdf[i] = (one.x == x[i] ? hairlut_quad_first(inverse.bend) : 0.0f) / hairlut_quad_first(inverse.root);
    }
}

LOOP void axis_invert(const hairlut_model *model, int lobe, int angle, size_t n, const float *theta_r, const float *x,
                      float *u)
{
    for (size_t i = 0; i < n; ++i)
        u[i] = hairlut_axis_invert(axis_of(model, lobe, angle), theta_r[i], x[i]);
}

/* The width, in x, of the cell that contains x. */
LOOP void axis_cell_width(const hairlut_model *model, int lobe, int angle, size_t n, const float *theta_r, const float *x,
                          float *width)
{
    const hairlut_axis *a = axis_of(model, lobe, angle);
    for (size_t i = 0; i < n; ++i) {
        const hairlut_row row = hairlut_axis_row(a, theta_r[i]);
        width[i] = fabsf(hairlut_quad_third(hairlut_axis_find(a, &row, x[i]).cell)) / HAIRLUT_SCALE;
    }
}

static int same_axis(const hairlut_axis *a, const hairlut_axis *b)
{
    const size_t rows = (size_t)HAIRLUT_STORED(a->columns, a->height), cells = (size_t)HAIRLUT_CELLS(a->columns, a->height);
    const size_t knots = (size_t)(HAIRLUT_KNOT * HAIRLUT_HALF(a->columns));
    return a->columns == b->columns && a->height == b->height && a->grid == b->grid && a->row_origin == b->row_origin &&
           a->row_scale == b->row_scale && a->warp == b->warp && a->e == b->e && a->scale == b->scale &&
           a->origin == b->origin && a->low == b->low && a->high == b->high &&
           memcmp(a->rows, b->rows, rows * sizeof(float)) == 0 &&
           memcmp(a->ends[0], b->ends[0], cells * sizeof(float)) == 0 &&
           memcmp(a->knots, b->knots, knots * sizeof(float)) == 0 &&
           memcmp(a->links, b->links, (size_t)(a->columns - 1) * sizeof *a->links) == 0;
}

static int same_lobe(const hairlut_lobe *a, const hairlut_lobe *b)
{
    return strcmp(a->name, b->name) == 0 && same_axis(&a->theta, &b->theta) && a->uniform == b->uniform &&
           (a->uniform || (same_axis(&a->phi, &b->phi) && a->sign == b->sign));
}

static int same_nodes(const hairlut_nodes *a, const hairlut_nodes *b)
{
    const size_t floats = (size_t)(8 * a->eights + 2 * a->count);
    return a->count == b->count && a->eights == b->eights && a->last == b->last &&
           a->pairs - a->inner == b->pairs - b->inner && memcmp(a->inner, b->inner, floats * sizeof(float)) == 0;
}

static int same_mixture(const hairlut_mixture *a, const hairlut_mixture *b)
{
    return same_nodes(&a->theta_r, &b->theta_r) && same_nodes(&a->arc, &b->arc) && a->four_count == b->four_count &&
           a->above == b->above && a->beside == b->beside && a->mirrored == b->mirrored && a->turned == b->turned &&
           a->constant == b->constant && memcmp(&a->mix, &b->mix, sizeof a->mix) == 0 &&
           memcmp(a->fours, b->fours, (size_t)(a->four_count * a->theta_r.count * a->arc.count) * sizeof *a->fours) == 0;
}

/* Whether two models are the same, bit for bit. */
LOOP int same_models(const hairlut_model *a, const hairlut_model *b)
{
    int same = a->lobe_count == b->lobe_count && a->direct == b->direct && a->multiple == b->multiple &&
               same_mixture(&a->mixture, &b->mixture);
    for (int k = 0; same && k < a->lobe_count; ++k)
        same = same_lobe(&a->lobes[k], &b->lobes[k]);
    return same;
}
