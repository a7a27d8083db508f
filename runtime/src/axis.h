/* The one reading of a table, shared by sample, pdf and invert (luts/FORMAT.md, "Reading").
 *
 * Two neighbouring rows are blended linearly in theta_r. Within a cell of the blended row, with f in [0,1] its fraction,
 *
 *     x(f) = x0 + f (d + c (1-f)),     dx/df = d + c (1-2f)
 *
 * where d is the cell's width and c its curvature, taken from the widths of both neighbours. The density is du/dx. */
#ifndef HAIRLUT_AXIS_H
#define HAIRLUT_AXIS_H

#include <math.h>

#include "internal.h"

typedef struct hairlut_rows {
    const float *a; /* padded row below theta_r, and the one above it at a + stride */
    int stride;
    float t; /* weight of the upper row, in [0,1] */
} hairlut_rows;

typedef struct hairlut_cell {
    float x0, d, c;
} hairlut_cell;

/* A place on the u axis: cell index, fraction in it, and du/dcolumn there. */
typedef struct hairlut_knot {
    int i;
    float f;
    float du;
} hairlut_knot;

typedef struct hairlut_draw {
    float x;
    float pdf;
} hairlut_draw;

/* NaN gives low. */
static inline float hairlut_clamp(float x, float low, float high)
{
    x = x > low ? x : low;
    return x < high ? x : high;
}

static inline hairlut_rows hairlut_axis_rows(const hairlut_axis *axis, float theta_r)
{
    const float last = (float)(axis->height - 1);
    const float r = hairlut_clamp((theta_r - axis->row_origin) * axis->row_scale, 0.0f, last);
    int j = (int)r;
    j = j < axis->height - 2 ? j : axis->height - 2;
    const int stride = axis->columns + 2;
    const hairlut_rows rows = {axis->rows + (size_t)j * (size_t)stride, stride, r - (float)j};
    return rows;
}

static inline float hairlut_blend(float a, float b, float t)
{
    return a + t * (b - a);
}

/* The same for widths: positive for positive a and b at every t, which the form above is not where b is far below a. */
static inline float hairlut_blend_width(float a, float b, float t)
{
    return (1.0f - t) * a + t * b;
}

/* The blended texel of knot i. */
static inline float hairlut_texel(const hairlut_rows *rows, int i)
{
    const float *a = rows->a + i + 1;
    return hairlut_blend(a[0], a[rows->stride], rows->t);
}

/* Differences are taken in each row before they are blended: neighbouring texels subtract without rounding. */
static inline hairlut_cell hairlut_axis_cell(const hairlut_axis *axis, const hairlut_rows *rows, int i)
{
    const float *a = rows->a + i;
    const float *b = a + rows->stride;
    const float t = rows->t;
    const float before = hairlut_blend_width(a[1] - a[0], b[1] - b[0], t);
    const float d = hairlut_blend_width(a[2] - a[1], b[2] - b[1], t);
    const float after = hairlut_blend_width(a[3] - a[2], b[3] - b[2], t);
    const float bound = axis->limit * d;
    const hairlut_cell cell = {hairlut_blend(a[1], b[1], t), d, hairlut_clamp(0.25f * (before - after), -bound, bound)};
    return cell;
}

/* u to column. The fold at u = 1/2 keeps the relative precision of both tails. */
static inline hairlut_knot hairlut_axis_knot(const hairlut_axis *axis, float u)
{
    u = hairlut_clamp(u, 0.0f, 1.0f);
    const float m = u <= 0.5f ? u : 1.0f - u;
    float c, du;
    if (axis->warp == HAIRLUT_WARP_QUARTIC) {
        const float y = sqrtf(sqrtf(m + axis->e));
        c = (y - axis->f0) / axis->k;
        du = 4.0f * axis->k * y * y * y;
    } else {
        c = m / axis->k;
        du = axis->k;
    }
    const int last = axis->columns - 2;
    c = hairlut_clamp(c, 0.0f, 0.5f * (float)(axis->columns - 1));
    int i = (int)c;
    float f = c - (float)i;
    if (u > 0.5f) {
        i = last - i;
        f = 1.0f - f;
    }
    const hairlut_knot knot = {i, f, du};
    return knot;
}

/* Distances, in columns, of a place from both ends of the axis; the smaller one is the folded column. */
static inline float hairlut_from_low(int i, float f)
{
    return (float)i + f;
}

static inline float hairlut_from_high(const hairlut_axis *axis, int i, float f)
{
    return (float)(axis->columns - 2 - i) + (1.0f - f);
}

static inline float hairlut_fold(const hairlut_axis *axis, int i, float f)
{
    const float low = hairlut_from_low(i, f), high = hairlut_from_high(axis, i, f);
    return low <= high ? low : high;
}

/* du/dcolumn at a place given by cell and fraction. */
static inline float hairlut_axis_du(const hairlut_axis *axis, int i, float f)
{
    if (axis->warp != HAIRLUT_WARP_QUARTIC)
        return axis->k;
    const float y = axis->f0 + axis->k * hairlut_fold(axis, i, f);
    return 4.0f * axis->k * y * y * y;
}

/* Column to u. */
static inline float hairlut_axis_u(const hairlut_axis *axis, int i, float f)
{
    float m = axis->k * hairlut_fold(axis, i, f);
    if (axis->warp == HAIRLUT_WARP_QUARTIC) {
        const float f0 = axis->f0, y = f0 + m;
        m *= (y + f0) * (y * y + f0 * f0); /* y^4 - f0^4 without its cancellation */
    }
    m = hairlut_clamp(m, 0.0f, 0.5f);
    return hairlut_from_low(i, f) <= hairlut_from_high(axis, i, f) ? m : 1.0f - m;
}

/* The cell whose blended texels enclose x. */
static inline int hairlut_axis_find(const hairlut_axis *axis, const hairlut_rows *rows, float x)
{
    int i = 0;
    for (int n = axis->columns - 1; n > 1;) {
        const int half = n / 2;
        i += hairlut_texel(rows, i + half) <= x ? half : 0;
        n -= half;
    }
    return i;
}

/* The fraction of a cell at which x lies; *slope gets dx/df there. The root of the quadratic is that slope. */
static inline float hairlut_cell_solve(const hairlut_cell *cell, float x, float *slope)
{
    const float d = hairlut_clamp(x - cell->x0, 0.0f, cell->d);
    const float s = cell->d + cell->c;
    const float square = s * s - 4.0f * cell->c * d;
    *slope = sqrtf(square > 0.0f ? square : 0.0f);
    return hairlut_clamp(2.0f * d / (s + *slope), 0.0f, 1.0f);
}

static inline hairlut_draw hairlut_axis_sample(const hairlut_axis *axis, float theta_r, float u)
{
    const hairlut_rows rows = hairlut_axis_rows(axis, theta_r);
    const hairlut_knot knot = hairlut_axis_knot(axis, u);
    const hairlut_cell cell = hairlut_axis_cell(axis, &rows, knot.i);
    const float f = knot.f;
    const float x = cell.x0 + f * (cell.d + cell.c * (1.0f - f));
    const float slope = cell.d + cell.c * (1.0f - 2.0f * f);
    const hairlut_draw draw = {hairlut_clamp(x, axis->low, axis->high), knot.du / slope};
    return draw;
}

static inline float hairlut_axis_pdf(const hairlut_axis *axis, float theta_r, float x)
{
    if (!(x >= axis->low && x <= axis->high))
        return 0.0f;
    const hairlut_rows rows = hairlut_axis_rows(axis, theta_r);
    const int i = hairlut_axis_find(axis, &rows, x);
    const hairlut_cell cell = hairlut_axis_cell(axis, &rows, i);
    float slope;
    const float f = hairlut_cell_solve(&cell, x, &slope);
    return hairlut_axis_du(axis, i, f) / slope;
}

static inline float hairlut_axis_invert(const hairlut_axis *axis, float theta_r, float x)
{
    const hairlut_rows rows = hairlut_axis_rows(axis, theta_r);
    const int i = hairlut_axis_find(axis, &rows, x);
    const hairlut_cell cell = hairlut_axis_cell(axis, &rows, i);
    float slope;
    const float f = hairlut_cell_solve(&cell, x, &slope);
    return hairlut_axis_u(axis, i, f);
}

#endif
