/* The one reading of a table, shared by sample, pdf and invert (luts/FORMAT.md, "Reading").
 *
 * The cells of two neighbouring rows are blended linearly in theta_r. Within a blended cell, with d = m - u0 the distance in u
 * from its nearer knot,
 *
 *     x = x0 + d (a - c d),     dx/dm = a - 2 c d,     density = 1 / |dx/dm|,     (dx/dm)^2 = a^2 - 4 c (x - x0),
 *
 * where a is the slope at that knot and c the cell's curvature. All is counted from the nearer end of the u axis: m is
 * min(u, 1-u), and in the high half of a row a is negative. */
#ifndef HAIRLUT_AXIS_H
#define HAIRLUT_AXIS_H

#include <math.h>
#include <stddef.h>

#include "internal.h"
#include "quad.h"

static const float hairlut_least_square = 6.5e-4f; /* below (0.05 / 1.95)^2 */

/* Where theta_r lies: the row below it, and the weight of the row above, in [0,1). */
typedef struct hairlut_row {
    int j;
    float t;
} hairlut_row;

typedef struct hairlut_cell {
    float x0, a, c, u0;
} hairlut_cell;

/* A place on the u axis: m = min(u, 1-u), and its cell, counted from the low or the high end. */
typedef struct hairlut_knot {
    int i;
    int high;
    float m;
} hairlut_knot;

/* An angle drawn, and |dx/du| there: the density is one over it, which the caller takes of all its axes at once. */
typedef struct hairlut_draw {
    float x;
    float slope;
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
    return hairlut_clamp((theta_r - axis->row_origin) * axis->row_scale, hairlut_constant(0.0f), axis->row_last);
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
    const unsigned column = (unsigned)i * (unsigned)axis->pitch; /* unsigned: an address needs no sign extended */
    const float *p = axis->ends[high] + column + (unsigned)j * HAIRLUT_CELL, *q = p + HAIRLUT_CELL;
    const hairlut_quad below = hairlut_quad_mul(hairlut_quad_sub(hairlut_quad_all(1.0f), t), hairlut_quad_load(p));
    const hairlut_quad above = hairlut_quad_mul(t, hairlut_quad_load(q));
    float part[3];
    hairlut_quad_first3(hairlut_quad_add(below, above), part);
    const hairlut_cell cell = {part[0], part[1], part[2], p[3]};
    return cell;
}

/* u to cell. The fold at u = 1/2 keeps the relative precision of both tails, and chooses the half without a branch: u is
 * as good as random, and so would be the branch. */
HAIRLUT_INLINE hairlut_knot hairlut_axis_knot(const hairlut_axis *axis, float u)
{
    const float m = hairlut_max(hairlut_min(u, 1.0f - u), hairlut_constant(0.0f));
    const float y = axis->warp == HAIRLUT_WARP_OCTAVES ? hairlut_shifted(m + axis->e) : m;
    const hairlut_knot knot = {(int)(y * axis->scale - axis->origin), u > 0.5f, m};
    return knot;
}

/* How many of a group's n texels, blended with those of the row above, are at most x; n is that of a group. `above` is the
 * group of the row above, or in a small table the changes to it. A count has no branch that depends on x. */
static inline int hairlut_count(const float *group, const float *above, float t, float x, int n)
{
    hairlut_tally tally = hairlut_tally_zero();
    for (int k = 0; k < n; k += 4) {
        const hairlut_quad from = hairlut_quad_load(group + k), to = hairlut_quad_load(above + k);
        const hairlut_quad change = n == HAIRLUT_SMALL_GROUP ? to : hairlut_quad_sub(to, from);
        tally = hairlut_tally_at_most(tally, hairlut_quad_add(from, hairlut_quad_mul(hairlut_quad_all(t), change)), x);
    }
    return hairlut_tally_sum(tally);
}

/* hairlut_count of a table's group */
HAIRLUT_INLINE int hairlut_axis_count(const hairlut_axis *axis, const float *group, float t, float x)
{
    if (HAIRLUT_IS_SMALL(axis->columns))
        return hairlut_count(group, group + HAIRLUT_SMALL_GROUP, t, x, HAIRLUT_SMALL_GROUP);
    return hairlut_count(group, group + axis->stride, t, x, HAIRLUT_GROUP);
}

/* Halves a block of n cells, n a power of two, until the part in which x lies is a group's: its first cell. Not for small
 * tables, whose blocks are groups. */
static inline int hairlut_halve(const float *groups, int stride, float t, float x, int n)
{
    int first = 0;
    for (n /= 2; n >= HAIRLUT_GROUP; n /= 2) {
        const float *low_end = groups + first + n - 1, from = low_end[0], to = low_end[stride]; /* of the upper half */
        first += from + t * (to - from) <= x ? n : 0;
    }
    return first;
}

/* The row and the cell of an angle. */
typedef struct hairlut_found {
    hairlut_row row;
    int cell; /* counted from the low end */
} hairlut_found;

/* A search as far as the first group takes it: the row, the angle, moved into the domain, and the first cell of its block. */
typedef struct hairlut_query {
    hairlut_row row;
    float x;
    int first;
} hairlut_query;

/* The first half of a search. x outside the domain is moved to its end, NaN to the low one: what is looked for is what a
 * row holds, not infinity. */
HAIRLUT_INLINE hairlut_query hairlut_axis_ask(const hairlut_axis *axis, float theta_r, float x)
{
    hairlut_query query = {hairlut_axis_row(axis, theta_r), hairlut_axis_inside(axis, x), 0};
    const float *group = axis->rows + (ptrdiff_t)query.row.j * axis->stride;
    query.first = axis->step * hairlut_axis_count(axis, group, query.row.t, query.x);
    return query;
}

/* The rest of it: the cell whose blended texels enclose x. */
HAIRLUT_INLINE hairlut_found hairlut_axis_find(const hairlut_axis *axis, hairlut_query query)
{
    const float t = query.row.t, *groups = axis->rows + (ptrdiff_t)query.row.j * axis->stride + HAIRLUT_LINE;
    hairlut_found found = {query.row, query.first};
    if (!HAIRLUT_IS_SMALL(axis->columns))
        found.cell += hairlut_halve(groups + found.cell, axis->stride, t, query.x, axis->step);
    found.cell += hairlut_axis_count(axis, groups + HAIRLUT_SPREAD(axis->columns) * found.cell, t, query.x);
    return found;
}

/* Where there are several axes, ask of all before any is found: one waits for its loads while the other goes on. */
HAIRLUT_INLINE hairlut_found hairlut_axis_look_up(const hairlut_axis *axis, float theta_r, float x)
{
    return hairlut_axis_find(axis, hairlut_axis_ask(axis, theta_r, x));
}

/* |dx/du| where a cell is at x. A curvature is at most 0.95 of a width, so that no slope is below 0.05 / 1.95 of another in the
 * cell, whatever rounding does. Near that bound the difference cancels, no more than x itself is rounded. */
static inline float hairlut_cell_slope(const hairlut_cell *cell, float x)
{
    const float square = cell->a * cell->a;
    return sqrtf(hairlut_max(square - 4.0f * cell->c * (x - cell->x0), hairlut_least_square * square));
}

/* A cell counted from the nearer end of a row. *high gets whether that is the high end. */
static inline int hairlut_axis_nearer(const hairlut_axis *axis, int cell, int *high)
{
    const int mirrored = axis->columns - 2 - cell, i = cell < mirrored ? cell : mirrored;
    *high = i != cell;
    return i;
}

/* The cell that look_up found, as stored: from the nearer end of the row. */
static inline hairlut_cell hairlut_axis_found(const hairlut_axis *axis, hairlut_found found, int *high)
{
    const int i = hairlut_axis_nearer(axis, found.cell, high);
    return hairlut_axis_cell(axis, found.row.j, hairlut_quad_all(found.row.t), i, *high);
}

/* x may be beyond an end of the domain by the rounding of a blend, two steps of a float: hairlut_axis_inside moves it back,
 * where what uses x does not have to wait for that. */
HAIRLUT_INLINE hairlut_draw hairlut_axis_sample(const hairlut_axis *axis, float theta_r, float u)
{
    int j;
    const hairlut_quad t = hairlut_quad_split(hairlut_axis_position(axis, theta_r), &j);
    const hairlut_knot knot = hairlut_axis_knot(axis, u);
    const hairlut_cell cell = hairlut_axis_cell(axis, j, t, knot.i, knot.high);
    const float d = knot.m - cell.u0, bend = cell.c * d, mean_slope = cell.a - bend;
    const hairlut_draw draw = {cell.x0 + d * mean_slope, fabsf(mean_slope - bend)};
    return draw;
}

/* |dx/du| at x, which look_up found. */
HAIRLUT_INLINE float hairlut_axis_slope(const hairlut_axis *axis, hairlut_found found, float x)
{
    int high;
    const hairlut_cell cell = hairlut_axis_found(axis, found, &high);
    return hairlut_cell_slope(&cell, x);
}

/* 1 in the domain, 0 outside. */
static inline float hairlut_axis_holds(const hairlut_axis *axis, float x)
{
    return (float)(x >= axis->low && x <= axis->high);
}

static inline float hairlut_axis_invert(const hairlut_axis *axis, float theta_r, float x)
{
    int high;
    const float inside = hairlut_axis_inside(axis, x);
    const hairlut_cell cell = hairlut_axis_found(axis, hairlut_axis_look_up(axis, theta_r, x), &high);
    const float slope = copysignf(hairlut_cell_slope(&cell, inside), cell.a);
    const float m = hairlut_clamp(cell.u0 + 2.0f * (inside - cell.x0) / (cell.a + slope), 0.0f, 1.0f);
    return high ? 1.0f - m : m;
}

#endif
