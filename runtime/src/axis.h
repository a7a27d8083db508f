/* The one reading of a table, shared by sample, pdf and invert (luts/FORMAT.md, "Reading").
 *
 * The cells of two neighbouring rows are blended linearly in theta_r. Within a blended cell, with f in [0,1] its fraction,
 *
 *     x(f) = x0 + f (a - c f),     dx/df = a - 2 c f
 *
 * where c is the cell's curvature and a its slope at f = 0, its width d plus c. The density is du/|dx|. All is counted from
 * the nearer end of the u axis: in the high half of a row d and a are negative. */
#ifndef HAIRLUT_AXIS_H
#define HAIRLUT_AXIS_H

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "internal.h"
#include "quad.h"

#ifndef HAIRLUT_COUNT
#define HAIRLUT_COUNT hairlut_count /* a kernel with wider vectors defines its own, for n of 8 and 16 */
#endif

/* gcc -O2 would call the longer functions and pass what they return through memory: a density takes 1.6 times as long. */
#if defined(__GNUC__)
#define HAIRLUT_INLINE static inline __attribute__((always_inline))
#elif defined(_MSC_VER)
#define HAIRLUT_INLINE static __forceinline
#else
#define HAIRLUT_INLINE static inline
#endif

/* Where theta_r lies: the row below it, and the weight of the row above, in [0,1). */
typedef struct hairlut_row {
    int j;
    float t;
} hairlut_row;

typedef struct hairlut_cell {
    float x0, a, c;
} hairlut_cell;

/* A place on the u axis: its cell, counted from the low or the high end, the fraction in it, and |du/dcolumn| there. */
typedef struct hairlut_knot {
    int i;
    int high;
    float f;
    float du;
} hairlut_knot;

/* Where an angle lies: its cell, counted from the low or the high end, the fraction of it, counted likewise, |dx/df|. */
typedef struct hairlut_place {
    int i;
    int high;
    float f;
    float slope;
} hairlut_place;

typedef struct hairlut_draw {
    float x;
    float pdf;
} hairlut_draw;

/* The larger and the smaller of two numbers; NaN in x gives y. */
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

/* x moved into the domain; NaN to its low end. */
static inline float hairlut_axis_inside(const hairlut_axis *axis, float x)
{
    return hairlut_clamp(x, axis->low, axis->high);
}

/* theta_r counted in rows, from 0 to the last. */
static inline float hairlut_axis_position(const hairlut_axis *axis, float theta_r)
{
    return hairlut_clamp((theta_r - axis->row_origin) * axis->row_scale, 0.0f, axis->row_last);
}

static inline hairlut_row hairlut_axis_row(const hairlut_axis *axis, float theta_r)
{
    const float r = hairlut_axis_position(axis, theta_r);
    const int j = (int)r;
    const hairlut_row row = {j, r - (float)j};
    return row;
}

/* Cell i of rows j and j+1, from an end; t in all lanes. Blended as (1-t) p + t q, which keeps a slope above zero at
 * every t, as p + t (q-p) does not where q is far below p. */
HAIRLUT_INLINE hairlut_cell hairlut_axis_cell(const hairlut_axis *axis, int j, hairlut_quad t, int i, int high)
{
    const float *p = axis->ends[high] + (i * axis->pitch + j * HAIRLUT_CELL), *q = p + HAIRLUT_CELL;
    const hairlut_quad below = hairlut_quad_mul(hairlut_quad_sub(hairlut_quad_all(1.0f), t), hairlut_quad_load(p));
    const hairlut_quad above = hairlut_quad_mul(t, hairlut_quad_load(q));
    float part[3];
    hairlut_quad_first3(hairlut_quad_add(below, above), part);
    const hairlut_cell cell = {part[0], part[1], part[2]};
    return cell;
}

/* du/dcolumn, relative to axis->du, where the warp's curve has the value y. */
static inline float hairlut_axis_stretch(const hairlut_axis *axis, float y)
{
    return axis->warp == HAIRLUT_WARP_QUARTIC ? y * (y * y) : 1.0f;
}

/* u to column. The fold at u = 1/2 keeps the relative precision of both tails, and chooses the half without a branch: u is
 * as good as random, and so would be the branch. The column is not below 0, because f0 is this curve's value at m = 0 to the
 * last bit. */
HAIRLUT_INLINE hairlut_knot hairlut_axis_knot(const hairlut_axis *axis, float u)
{
    const float m = hairlut_max(hairlut_min(u, 1.0f - u), 0.0f);
    const float y = axis->warp == HAIRLUT_WARP_QUARTIC ? sqrtf(sqrtf(m + axis->e)) : m;
    const float c = (y - axis->f0) * axis->inverse_k;
    const int i = (int)c;
    const hairlut_knot knot = {i, u > 0.5f, c - (float)i, axis->du * hairlut_axis_stretch(axis, y)};
    return knot;
}

static inline float hairlut_blend(float a, float b, float t)
{
    return a + t * (b - a);
}

/* How many of the n blended texels a[0], a[1], ... are at most x; n is 8 or 16. A count has no branch that depends on x. */
static inline int hairlut_count(const float *a, int stride, float t, float x, int n)
{
    hairlut_tally tally = hairlut_tally_zero();
    for (int k = 0; k < n; k += 4) {
        const hairlut_quad low = hairlut_quad_load(a + k), high = hairlut_quad_load(a + stride + k);
        const hairlut_quad change = hairlut_quad_mul(hairlut_quad_all(t), hairlut_quad_sub(high, low));
        tally = hairlut_tally_at_most(tally, hairlut_quad_add(low, change), x);
    }
    return hairlut_tally_sum(tally);
}

/* Halves the n cells from a on in which x lies, n a power of two, down to at most HAIRLUT_PIVOTS: the first of those. */
static inline int hairlut_halve(const float *a, int stride, float t, float x, int n)
{
    int first = 0;
    for (; n > HAIRLUT_PIVOTS; n /= 2)
        first += hairlut_blend(a[first + n / 2], a[first + n / 2 + stride], t) <= x ? n / 2 : 0;
    return first;
}

/* The cell whose blended texels enclose x, counted from the low end: the pivots find its block. */
HAIRLUT_INLINE int hairlut_axis_find(const hairlut_axis *axis, hairlut_row row, float x)
{
    const int stride = axis->stride, step = axis->step, last = axis->columns - 2;
    const float *texels = axis->rows + (ptrdiff_t)row.j * stride, *pivots = texels - HAIRLUT_PIVOTS;
    int first, count; /* of a block; of its texels up to x, the first itself included */
    if (HAIRLUT_IS_SMALL(axis->columns)) {
        first = step * HAIRLUT_COUNT(pivots, stride, row.t, x, HAIRLUT_PIVOTS / 2);
        count = HAIRLUT_COUNT(texels + first, stride, row.t, x, HAIRLUT_PIVOTS / 2);
    } else {
        first = step * HAIRLUT_COUNT(pivots, stride, row.t, x, HAIRLUT_PIVOTS);
        first += hairlut_halve(texels + first, stride, row.t, x, step);
        count = HAIRLUT_COUNT(texels + first, stride, row.t, x, HAIRLUT_PIVOTS);
    }
    const int i = first + (count > 1 ? count - 1 : 0);
    return i < last ? i : last; /* x is the domain's end */
}

/* The fraction of a cell at which x lies; *slope gets |dx/df| there. The root of the quadratic is that slope, written as the
 * slope at the cell's flatter end and the distance from there, which cancels nothing. */
static inline float hairlut_cell_solve(const hairlut_cell *cell, float x, float *slope)
{
    const float sign = copysignf(1.0f, cell->a); /* no branch to predict, nor in what follows */
    const float a = sign * cell->a, c = sign * cell->c, d = a - c;
    const float distance = hairlut_clamp(sign * (x - cell->x0), 0.0f, d);
    const float flat = d - fabsf(c);
    const float far_end = 0.5f * (d + copysignf(d, c)); /* d or 0 */
    const float away = fabsf(far_end - distance);
    *slope = sqrtf(flat * flat + 4.0f * fabsf(c) * away);
    return hairlut_min(2.0f * distance / (a + *slope), 1.0f);
}

/* Cell `found`, counted from the low end, as stored: from the nearer end of the row. *i gets its index there, *high whether
 * that is the high end. */
static inline hairlut_cell hairlut_axis_found(const hairlut_axis *axis, hairlut_row row, int found, int *i, int *high)
{
    *high = found >= axis->columns / 2;
    *i = abs((-*high & (axis->columns - 2)) - found);
    return hairlut_axis_cell(axis, row.j, hairlut_quad_all(row.t), *i, *high);
}

/* The row and the cell of an angle. */
typedef struct hairlut_found {
    hairlut_row row;
    int cell; /* counted from the low end */
} hairlut_found;

/* x outside the domain is moved to its end, NaN to the low one: the search is for what a row holds, not for infinity. */
HAIRLUT_INLINE hairlut_found hairlut_axis_look_up(const hairlut_axis *axis, float theta_r, float x)
{
    const hairlut_row row = hairlut_axis_row(axis, theta_r);
    const hairlut_found found = {row, hairlut_axis_find(axis, row, hairlut_axis_inside(axis, x))};
    return found;
}

static inline hairlut_place hairlut_axis_locate(const hairlut_axis *axis, hairlut_found found, float x)
{
    hairlut_place place;
    const hairlut_cell cell = hairlut_axis_found(axis, found.row, found.cell, &place.i, &place.high);
    place.f = hairlut_cell_solve(&cell, x, &place.slope);
    return place;
}

/* x may be beyond an end of the domain by the rounding of a blend, two steps of a float: hairlut_axis_inside moves it back,
 * where what uses x does not have to wait for that. */
HAIRLUT_INLINE hairlut_draw hairlut_axis_sample(const hairlut_axis *axis, float theta_r, float u)
{
    int j;
    const hairlut_quad t = hairlut_quad_split(hairlut_axis_position(axis, theta_r), &j);
    const hairlut_knot knot = hairlut_axis_knot(axis, u);
    const hairlut_cell cell = hairlut_axis_cell(axis, j, t, knot.i, knot.high);
    const float bend = cell.c * knot.f, mean_slope = cell.a - bend;
    const hairlut_draw draw = {cell.x0 + knot.f * mean_slope, knot.du / fabsf(mean_slope - bend)};
    return draw;
}

/* The column, counted from the end that is nearer. The middle cell of an even number of columns is seen from the low end, and
 * beyond its middle the high end is nearer: hence the smaller of the distances from both. */
static inline float hairlut_axis_folded(const hairlut_axis *axis, hairlut_place place)
{
    const float column = (float)place.i + place.f;
    return hairlut_min(column, (float)(axis->columns - 1) - column);
}

/* The density at x, which look_up found. */
HAIRLUT_INLINE float hairlut_axis_density(const hairlut_axis *axis, hairlut_found found, float x)
{
    const hairlut_place place = hairlut_axis_locate(axis, found, x);
    const float y = axis->f0 + axis->k * hairlut_axis_folded(axis, place);
    const float pdf = hairlut_axis_stretch(axis, y) * (axis->du / place.slope);
    return x >= axis->low && x <= axis->high ? pdf : 0.0f;
}

static inline float hairlut_axis_pdf(const hairlut_axis *axis, float theta_r, float x)
{
    return hairlut_axis_density(axis, hairlut_axis_look_up(axis, theta_r, x), x);
}

static inline float hairlut_axis_invert(const hairlut_axis *axis, float theta_r, float x)
{
    const float f0 = axis->f0;
    const hairlut_place place = hairlut_axis_locate(axis, hairlut_axis_look_up(axis, theta_r, x), x);
    const float column = hairlut_axis_folded(axis, place);
    float m = axis->k * column;
    if (axis->warp == HAIRLUT_WARP_QUARTIC) {
        const float y = f0 + m;
        m *= (y + f0) * (y * y + f0 * f0); /* y^4 - f0^4 without its cancellation */
    }
    m = hairlut_clamp(m, 0.0f, 0.5f);
    const int high = place.high | (column < (float)place.i + place.f);
    return high ? 1.0f - m : m;
}

#endif
