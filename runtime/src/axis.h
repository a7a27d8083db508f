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
#include <stdlib.h>

#include "internal.h"
#include "quad.h"

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

/* The larger and the smaller of two numbers; NaN in x gives y. Each is one instruction. */
static inline float hairlut_max(float x, float y)
{
    return x > y ? x : y;
}

static inline float hairlut_min(float x, float y)
{
    return x < y ? x : y;
}

/* NaN gives low. */
static inline float hairlut_clamp(float x, float low, float high)
{
    return hairlut_min(hairlut_max(x, low), high);
}

static inline hairlut_rows hairlut_axis_rows(const hairlut_axis *axis, float theta_r)
{
    const float r = hairlut_clamp((theta_r - axis->row_origin) * axis->row_scale, 0.0f, axis->row_last);
    const int row = (int)r, last = axis->height - 2;
    const int j = row < last ? row : last;
    const hairlut_rows rows = {axis->rows + (size_t)j * (size_t)axis->stride, axis->stride, r - (float)j};
    return rows;
}

static inline float hairlut_blend(float a, float b, float t)
{
    return a + t * (b - a);
}

/* Widths are taken in each row before they are blended, because neighbouring texels subtract without rounding; and
 * blended as (1-t) a + t b, which stays positive at every t, as a + t (b-a) does not where b is far below a. */
static inline hairlut_cell hairlut_axis_cell(const hairlut_axis *axis, const hairlut_rows *rows, int i)
{
    const float *a = rows->a + i, *b = a + rows->stride;
    const hairlut_quad widths_a = hairlut_quad_sub(hairlut_quad_load(a + 1), hairlut_quad_load(a));
    const hairlut_quad widths_b = hairlut_quad_sub(hairlut_quad_load(b + 1), hairlut_quad_load(b));
    const hairlut_quad t = hairlut_quad_all(rows->t), s = hairlut_quad_all(1.0f - rows->t);
    float width[3]; /* of the cell before, of this one, and of the one after */
    hairlut_quad_first3(hairlut_quad_add(hairlut_quad_mul(s, widths_a), hairlut_quad_mul(t, widths_b)), width);
    const float d = width[1], bound = axis->limit * d;
    const hairlut_cell cell = {hairlut_blend(a[1], b[1], rows->t), d,
                               hairlut_clamp(0.25f * (width[0] - width[2]), -bound, bound)};
    return cell;
}

static inline float hairlut_cell_angle(const hairlut_cell *cell, float f)
{
    return cell->x0 + f * (cell->d + cell->c * (1.0f - f));
}

static inline float hairlut_cell_slope(const hairlut_cell *cell, float f)
{
    return cell->d + cell->c * (1.0f - 2.0f * f);
}

/* du/dcolumn where the warp's curve has the value y. */
static inline float hairlut_axis_du(const hairlut_axis *axis, float y)
{
    return axis->warp == HAIRLUT_WARP_QUARTIC ? axis->du * (y * (y * y)) : axis->du;
}

/* u to column. The fold at u = 1/2 keeps the relative precision of both tails, and mirrors without a branch: u is as
 * good as random, and so would be the branch. c >= 0, because f0 is this curve's value at m = 0 to the last bit. */
static inline hairlut_knot hairlut_axis_knot(const hairlut_axis *axis, float u)
{
    const float m = hairlut_max(hairlut_min(u, 1.0f - u), 0.0f);
    const float y = axis->warp == HAIRLUT_WARP_QUARTIC ? sqrtf(sqrtf(m + axis->e)) : m;
    const float c = (y - axis->f0) * axis->inverse_k;
    const int upper = u > 0.5f;
    const int i = (int)c;
    const float f = c - (float)i;
    const hairlut_knot knot = {abs((-upper & (axis->columns - 2)) - i), fabsf((float)upper - f), hairlut_axis_du(axis, y)};
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
    return hairlut_min(hairlut_from_low(i, f), hairlut_from_high(axis, i, f));
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

/* How many of the n blended texels from a on are at most x: a count has no branch that depends on x. Up to three floats
 * beyond the n are read. */
static inline int hairlut_count(const float *a, int stride, float t, float x, int n)
{
    hairlut_tally tally = hairlut_tally_zero();
    for (int k = 0; k < n; k += 4) {
        const hairlut_quad low = hairlut_quad_load(a + k), high = hairlut_quad_load(a + stride + k);
        const hairlut_quad change = hairlut_quad_mul(hairlut_quad_all(t), hairlut_quad_sub(high, low));
        tally = hairlut_tally_at_most(tally, hairlut_quad_add(low, change), x, n - k);
    }
    return hairlut_tally_sum(tally);
}

/* Halves the range of `cells` cells from `first` on in which x lies down to HAIRLUT_PIVOTS cells; its first cell. */
static inline int hairlut_halve(const float *row, int stride, float t, float x, int first, int *cells)
{
    for (; *cells > HAIRLUT_PIVOTS; *cells -= *cells / 2) {
        const float *a = row + first + *cells / 2 + 1;
        first += hairlut_blend(a[0], a[stride], t) <= x ? *cells / 2 : 0;
    }
    return first;
}

/* The cell whose blended texels enclose x: the pivots narrow it down to `step` cells, halving (of tables wider than 257)
 * to 16, a count to one. */
static inline int hairlut_axis_find(const hairlut_axis *axis, const hairlut_rows *rows, float x)
{
    const float *row = rows->a;
    const float t = rows->t;
    const int stride = rows->stride, step = axis->step;
    int first = step * hairlut_count(row - HAIRLUT_PIVOTS, stride, t, x, HAIRLUT_PIVOTS);
    int cells = axis->columns - 1 - first;
    cells = cells < step ? cells : step;
    first = hairlut_halve(row, stride, t, x, first, &cells);
    return first + hairlut_count(row + first + 2, stride, t, x, cells - 1);
}

/* The fraction of a cell at which x lies; *slope gets dx/df there. The root of the quadratic is that slope, written as the
 * slope at the cell's flatter end and the distance from there, which cancels nothing. */
static inline float hairlut_cell_solve(const hairlut_cell *cell, float x, float *slope)
{
    const float d = hairlut_clamp(x - cell->x0, 0.0f, cell->d);
    const float flat = cell->d - fabsf(cell->c);
    const float far_end = 0.5f * (cell->d + copysignf(cell->d, cell->c)); /* d or 0: c's sign is no branch to predict */
    const float away = fabsf(far_end - d);
    *slope = sqrtf(flat * flat + 4.0f * fabsf(cell->c) * away);
    return hairlut_min(2.0f * d / (cell->d + cell->c + *slope), 1.0f);
}

static inline hairlut_draw hairlut_axis_sample(const hairlut_axis *axis, float theta_r, float u)
{
    const hairlut_rows rows = hairlut_axis_rows(axis, theta_r);
    const hairlut_knot knot = hairlut_axis_knot(axis, u);
    const hairlut_cell cell = hairlut_axis_cell(axis, &rows, knot.i);
    /* not below the domain: the first texel is its end, and widths are positive */
    const hairlut_draw draw = {hairlut_min(hairlut_cell_angle(&cell, knot.f), axis->high),
                               knot.du / hairlut_cell_slope(&cell, knot.f)};
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
    return hairlut_axis_du(axis, axis->f0 + axis->k * hairlut_fold(axis, i, f)) / slope;
}

static inline float hairlut_axis_invert(const hairlut_axis *axis, float theta_r, float x)
{
    x = hairlut_clamp(x, axis->low, axis->high); /* the search is for what a row holds, not for infinity */
    const hairlut_rows rows = hairlut_axis_rows(axis, theta_r);
    const int i = hairlut_axis_find(axis, &rows, x);
    const hairlut_cell cell = hairlut_axis_cell(axis, &rows, i);
    float slope;
    const float f = hairlut_cell_solve(&cell, x, &slope);
    return hairlut_axis_u(axis, i, f);
}

#endif
