/* Loops over the one-direction functions, and the single axes behind them, so that tests can ask for a million at once.
 * Arrays are n floats; `lobe` is 0 for direct, 1 for multiple; `axis` is 0 direct_theta, 1 direct_phi, 2 multiple_theta. */
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
        out[i] = lobe ? hairlut_sample_multiple(model, theta_r[i], phi_r[i], u_theta[i], u_phi[i])
                      : hairlut_sample_direct(model, theta_r[i], phi_r[i], u_theta[i], u_phi[i]);
}

LOOP void loop_pdf(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                   const float *theta_i, const float *phi_i, float *pdf)
{
    for (size_t i = 0; i < n; ++i)
        pdf[i] = lobe ? hairlut_pdf_multiple(model, theta_r[i], phi_r[i], theta_i[i], phi_i[i])
                      : hairlut_pdf_direct(model, theta_r[i], phi_r[i], theta_i[i], phi_i[i]);
}

LOOP void loop_invert(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                      const float *theta_i, const float *phi_i, float *u)
{
    for (size_t i = 0; i < n; ++i) {
        if (lobe)
            hairlut_invert_multiple(model, theta_r[i], phi_r[i], theta_i[i], phi_i[i], u + 2 * i);
        else
            hairlut_invert_direct(model, theta_r[i], phi_r[i], theta_i[i], phi_i[i], u + 2 * i);
    }
}

LOOP void loop_sample_components(const hairlut_component *components, int count, size_t n, const float *theta_r,
                                 const float *phi_r, const float *u_lobe, const float *u_theta, const float *u_phi,
                                 hairlut_sample *out)
{
    for (size_t i = 0; i < n; ++i)
        out[i] = hairlut_sample_components(components, count, theta_r[i], phi_r[i], u_lobe[i], u_theta[i], u_phi[i]);
}

LOOP void loop_pdf_components(const hairlut_component *components, int count, size_t n, const float *theta_r,
                              const float *phi_r, const float *theta_i, const float *phi_i, float *pdf)
{
    for (size_t i = 0; i < n; ++i)
        pdf[i] = hairlut_pdf_components(components, count, theta_r[i], phi_r[i], theta_i[i], phi_i[i]);
}

static const hairlut_axis *axis_of(const hairlut_model *model, int axis)
{
    return axis == 0 ? &model->direct_theta : axis == 1 ? &model->direct_phi : &model->multiple_theta;
}

/* As the functions of hairlut.h return an angle: in the domain. */
LOOP void axis_sample(const hairlut_model *model, int axis, size_t n, const float *theta_r, const float *u, float *x, float *pdf)
{
    for (size_t i = 0; i < n; ++i) {
        const hairlut_draw draw = hairlut_axis_sample(axis_of(model, axis), theta_r[i], u[i]);
        x[i] = hairlut_axis_inside(axis_of(model, axis), draw.x);
        pdf[i] = 1.0f / draw.slope;
    }
}

LOOP void axis_pdf(const hairlut_model *model, int axis, size_t n, const float *theta_r, const float *x, float *pdf)
{
    const hairlut_axis *a = axis_of(model, axis);
    for (size_t i = 0; i < n; ++i)
        pdf[i] = hairlut_axis_holds(a, x[i]) / hairlut_axis_slope(a, hairlut_axis_look_up(a, theta_r[i], x[i]), x[i]);
}

LOOP void axis_invert(const hairlut_model *model, int axis, size_t n, const float *theta_r, const float *x, float *u)
{
    for (size_t i = 0; i < n; ++i)
        u[i] = hairlut_axis_invert(axis_of(model, axis), theta_r[i], x[i]);
}

/* The width, in x, of the cell that holds x: from its nearer knot to that of the next cell. */
LOOP void axis_cell_width(const hairlut_model *model, int axis, size_t n, const float *theta_r, const float *x, float *width)
{
    for (size_t i = 0; i < n; ++i) {
        const hairlut_axis *a = axis_of(model, axis);
        const hairlut_found found = hairlut_axis_look_up(a, theta_r[i], x[i]);
        const hairlut_quad t = hairlut_quad_all(found.row.t);
        int high;
        const int k = hairlut_axis_nearer(a, found.cell, &high);
        const hairlut_cell cell = hairlut_axis_cell(a, found.row.j, t, k, high);
        width[i] = fabsf(hairlut_axis_cell(a, found.row.j, t, k + 1, high).x0 - cell.x0);
    }
}

static int same_axis(const hairlut_axis *a, const hairlut_axis *b)
{
    const size_t rows = (size_t)HAIRLUT_STORED(a->columns, a->height), cells = (size_t)HAIRLUT_CELLS(a->columns, a->height);
    return a->columns == b->columns && a->height == b->height && a->row_origin == b->row_origin
           && a->row_scale == b->row_scale && a->warp == b->warp && a->e == b->e && a->scale == b->scale
           && a->origin == b->origin && a->low == b->low && a->high == b->high
           && memcmp(a->rows, b->rows, rows * sizeof(float)) == 0
           && memcmp(a->ends[0], b->ends[0], cells * sizeof(float)) == 0;
}

/* Whether two models hold the same tables, bit for bit. */
LOOP int same_tables(const hairlut_model *a, const hairlut_model *b)
{
    return same_axis(&a->direct_theta, &b->direct_theta) && same_axis(&a->direct_phi, &b->direct_phi)
           && same_axis(&a->multiple_theta, &b->multiple_theta) && a->azimuth == b->azimuth;
}
