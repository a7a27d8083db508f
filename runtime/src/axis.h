/* SPDX-License-Identifier: BSD-3-Clause */
/* The one reading of a table, shared by sample, pdf and invert (luts/FORMAT.md, "Reading").
 *
 * The cells of two neighbouring rows are blended linearly in theta_r. Within a blended cell, x is the monotone rational
 * quadratic of Gregory and Delbourgo (1982): with xi = (m - u0) / h, q = 1 - xi, w the cell's width, and D = h dx/dm at its ends,
 *
 *     G = w (xi^2 + q^2) + (D0 + D1) xi q,        x = x0 + w (w xi^2 + D0 xi q) / G,
 *     h dx/dm = w^2 (D1 xi^2 + 2 w xi q + D0 q^2) / G^2,
 *
 * and back from x, with X = x - x0, Z = w - X, without cancellation:
 *
 *     B = D0 Z - D1 X,  R = sqrt(B^2 + 4 w^2 X Z),   xi : q = 2 w X : R + B where B >= 0, else R - B : 2 w Z,
 *     density = 1 / |dx/dm| = h |G| / R.
 *
 * A call computes with four axes at once, or with two: an axis is a lane of a quad.
 *
 * All is counted from the nearer end of the u axis: m is min(u, 1-u), and in the high half of a row w and D are stored negative. */
#ifndef HAIRLUT_AXIS_H
#define HAIRLUT_AXIS_H

#include <math.h>
#include <stddef.h>

#include "internal.h"
#include "quad.h"

/* Where theta_r lies: the row below it, and the weight of the row above, in [0,1). */
typedef struct hairlut_row {
    int j;
    float t;
} hairlut_row;

/* A place on the u axis: m = min(u, 1-u), and its cell, counted from the low or the high end. */
typedef struct hairlut_place {
    int i;
    int high;
    float m;
} hairlut_place;

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

/* Cell i of rows j and j+1, from an end: x0, D0, w, D1. `below` and `above`, in all lanes, are the rows' weights. Blended as
 * (1-t) p + t q, which keeps a slope above zero at every t, as p + t (q-p) does not where q is far below p. */
HAIRLUT_INLINE hairlut_quad hairlut_axis_cell(const hairlut_axis *axis, int j, hairlut_quad below, hairlut_quad above, int i,
                                              int high)
{
    const unsigned column = (unsigned)i * (unsigned)axis->pitch; /* unsigned: an address needs no sign extended */
    const float *p = axis->ends[high] + column + (unsigned)j * HAIRLUT_CELL, *q = p + HAIRLUT_CELL;
    return hairlut_quad_add(hairlut_quad_mul(below, hairlut_quad_load(p)), hairlut_quad_mul(above, hairlut_quad_load(q)));
}

/* u to cell. The fold at u = 1/2 keeps the relative precision of both tails, and chooses the half without a branch: u is
 * as good as random, and so would be the branch. */
HAIRLUT_INLINE hairlut_place hairlut_axis_place(const hairlut_axis *axis, float u)
{
    const float m = hairlut_max(hairlut_min(u, 1.0f - u), hairlut_constant(0.0f));
    const float y = axis->warp == HAIRLUT_WARP_OCTAVES ? hairlut_shifted(m + axis->e) : m;
    const hairlut_place place = {(int)(y * axis->scale - axis->origin), u > 0.5f, m};
    return place;
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

/* A search as far as the first group takes it: the row, the angle, moved into the domain, and the first cell of its block. */
typedef struct hairlut_search {
    const hairlut_axis *axis;
    hairlut_row row;
    float x;
    int first;
} hairlut_search;

/* The first half of a search. x outside the domain is moved to its end, NaN to the low one. */
HAIRLUT_INLINE hairlut_search hairlut_axis_begin_search(const hairlut_axis *axis, hairlut_row row, float x)
{
    hairlut_search search = {axis, row, hairlut_axis_inside(axis, x), 0};
    search.first = axis->step * hairlut_axis_count(axis, axis->rows + (ptrdiff_t)row.j * axis->stride, row.t, search.x);
    return search;
}

/* The rest of it: the cell whose blended ends enclose x, counted from the low end. With two axes, begin both
 * searches before ending either, so that their loads overlap. */
HAIRLUT_INLINE int hairlut_axis_end_search(const hairlut_search *search)
{
    const hairlut_axis *axis = search->axis;
    const float t = search->row.t, *groups = axis->rows + (ptrdiff_t)search->row.j * axis->stride + HAIRLUT_LINE;
    int cell = search->first;
    if (!HAIRLUT_IS_SMALL(axis->columns))
        cell += hairlut_halve(groups + cell, axis->stride, t, search->x, axis->step);
    return cell + hairlut_axis_count(axis, groups + HAIRLUT_ROW_FLOATS(axis->columns) * cell, t, search->x);
}

/* A cell counted from the nearer end of a row. *high gets whether that is the high end. */
static inline int hairlut_axis_nearer(const hairlut_axis *axis, int cell, int *high)
{
    const int mirrored = axis->columns - 2 - cell, i = cell < mirrored ? cell : mirrored;
    *high = i != cell;
    return i;
}

/* The cell of an angle, and what stands with its column. */
typedef struct hairlut_found {
    hairlut_quad cell; /* x0, D0, w, D1, times HAIRLUT_SCALE */
    float x;           /* likewise */
    const float *knot;
    int high;
} hairlut_found;

/* Angles are multiplied by HAIRLUT_SCALE, through the weights of the two rows: no product of four of them, as in R^2, leaves the
 * range of a float, whether a cell is 1e-12 or 2 pi rad wide. In the high half also by -1: w, D, X and Z are never negative. */
HAIRLUT_INLINE hairlut_found hairlut_axis_find(const hairlut_search *search)
{
    /* loaded: a branch on the half, which is as good as random, would be mispredicted half of the time */
    static const float scales[2] = {HAIRLUT_SCALE, -HAIRLUT_SCALE};
    hairlut_found found;
    const hairlut_axis *axis = search->axis;
    const int i = hairlut_axis_nearer(axis, hairlut_axis_end_search(search), &found.high);
    const float scale = scales[found.high], t = search->row.t;
    found.cell = hairlut_axis_cell(axis, search->row.j, hairlut_quad_all(scale * (1.0f - t)), hairlut_quad_all(scale * t), i,
                                   found.high);
    found.x = scale * search->x;
    found.knot = axis->knots + HAIRLUT_KNOT * i;
    return found;
}

/* Where angles lie in their cells, an axis a lane: |dx/dm| = root / bend, the R and the h |G| of above; and xi, or 1 - xi where
 * B is negative, as `part`. */
typedef struct hairlut_inverses {
    hairlut_quad root, bend, part, rest, balance;
} hairlut_inverses;

HAIRLUT_INLINE hairlut_inverses hairlut_invert_four(const hairlut_found found[4])
{
    hairlut_inverses inverse;
    hairlut_quad cell[4] = {found[0].cell, found[1].cell, found[2].cell, found[3].cell};
    hairlut_quad_transpose(cell);
    const hairlut_quad x = hairlut_quad_of_four(found[0].x, found[1].x, found[2].x, found[3].x),
                       two = hairlut_quad_all(2.0f);
    const hairlut_quad h = hairlut_quad_of_four(found[0].knot[2], found[1].knot[2], found[2].knot[2], found[3].knot[2]);
    const hairlut_quad d0 = cell[1], w = cell[2], d1 = cell[3];
    const hairlut_quad beyond = hairlut_quad_max(hairlut_quad_sub(x, cell[0]), hairlut_quad_all(0.0f));
    const hairlut_quad from = hairlut_quad_min(beyond, w), to = hairlut_quad_sub(w, from);
    const hairlut_quad wx = hairlut_quad_mul(w, from), wz = hairlut_quad_mul(w, to);
    inverse.balance = hairlut_quad_sub(hairlut_quad_mul(d0, to), hairlut_quad_mul(d1, from));
    const hairlut_quad four = hairlut_quad_mul(hairlut_quad_all(4.0f), hairlut_quad_mul(wx, wz));
    inverse.root = hairlut_quad_sqrt(hairlut_quad_add(hairlut_quad_mul(inverse.balance, inverse.balance), four));
    const hairlut_quad sum = hairlut_quad_add(inverse.root, hairlut_quad_abs(inverse.balance));
    const hairlut_quad side = hairlut_quad_mul(two, hairlut_quad_by_sign(inverse.balance, wz, wx));
    const hairlut_quad unit = hairlut_quad_div(hairlut_quad_all(1.0f), hairlut_quad_add(side, sum));
    const hairlut_quad part = hairlut_quad_mul(side, unit), rest = hairlut_quad_mul(sum, unit);
    const hairlut_quad squares = hairlut_quad_add(hairlut_quad_mul(part, part), hairlut_quad_mul(rest, rest));
    const hairlut_quad slopes = hairlut_quad_mul(hairlut_quad_add(d0, d1), hairlut_quad_mul(part, rest));
    inverse.bend = hairlut_quad_mul(h, hairlut_quad_add(hairlut_quad_mul(w, squares), slopes));
    inverse.part = part;
    inverse.rest = rest;
    return inverse;
}

/* The place of u on the axis at theta_r, and its cell. */
typedef struct hairlut_placed {
    hairlut_quad cell; /* x0, D0, w, D1 */
    hairlut_quad knot;
    float m;
} hairlut_placed;

HAIRLUT_INLINE hairlut_placed hairlut_axis_find_place(const hairlut_axis *axis, hairlut_row row, float u)
{
    const hairlut_place place = hairlut_axis_place(axis, u);
    const hairlut_quad t = hairlut_quad_all(row.t), below = hairlut_quad_sub(hairlut_quad_all(1.0f), t);
    const hairlut_placed placed = {hairlut_axis_cell(axis, row.j, below, t, place.i, place.high),
                                   hairlut_quad_load(axis->knots + HAIRLUT_KNOT * place.i), place.m};
    return placed;
}

/* Two angles drawn, and |dx/du| there: the density is one over it, which the caller takes of all its axes at once. */
typedef struct hairlut_draws {
    hairlut_quad x, slope; /* lanes 0 and 1 */
} hairlut_draws;

/* x may be beyond an end of the domain by the rounding of a blend, two steps of a float: hairlut_axis_inside moves it back,
 * where what uses x does not have to wait for that. xi and q are kept above 0, where rounding chose the cell beside. */
HAIRLUT_INLINE hairlut_draws hairlut_draw_two(const hairlut_placed *a, const hairlut_placed *b)
{
    hairlut_quad cell[4], knot[4];
    hairlut_quad_pair(a->cell, b->cell, cell);
    hairlut_quad_pair(a->knot, b->knot, knot);
    const hairlut_quad d0 = cell[1], w = cell[2], d1 = cell[3], zero = hairlut_quad_all(0.0f), two = hairlut_quad_all(2.0f);
    const hairlut_quad along = hairlut_quad_mul(hairlut_quad_sub(hairlut_quad_of_two(a->m, b->m), knot[0]), knot[1]);
    const hairlut_quad xi = hairlut_quad_max(along, zero);
    const hairlut_quad q = hairlut_quad_max(hairlut_quad_sub(hairlut_quad_all(1.0f), along), zero);
    const hairlut_quad xi2 = hairlut_quad_mul(xi, xi), q2 = hairlut_quad_mul(q, q), p = hairlut_quad_mul(xi, q);
    const hairlut_quad slopes = hairlut_quad_mul(hairlut_quad_add(d0, d1), p);
    const hairlut_quad ratio = hairlut_quad_div(w, hairlut_quad_add(hairlut_quad_mul(w, hairlut_quad_add(xi2, q2)), slopes));
    const hairlut_quad middle = hairlut_quad_mul(hairlut_quad_mul(two, w), p);
    const hairlut_quad bent =
        hairlut_quad_add(hairlut_quad_add(hairlut_quad_mul(d1, xi2), middle), hairlut_quad_mul(d0, q2));
    const hairlut_quad slope = hairlut_quad_mul(hairlut_quad_mul(hairlut_quad_mul(ratio, ratio), bent), knot[1]);
    const hairlut_quad rise = hairlut_quad_add(hairlut_quad_mul(w, xi2), hairlut_quad_mul(d0, p));
    const hairlut_draws draws = {hairlut_quad_add(cell[0], hairlut_quad_mul(ratio, rise)), hairlut_quad_abs(slope)};
    return draws;
}

/* 1 in the domain, 0 outside. */
static inline float hairlut_axis_contains(const hairlut_axis *axis, float x)
{
    return (float)(x >= axis->low && x <= axis->high);
}

/* The u from which x is drawn. */
static inline float hairlut_axis_invert(const hairlut_axis *axis, float theta_r, float x)
{
    const hairlut_search search = hairlut_axis_begin_search(axis, hairlut_axis_row(axis, theta_r), x);
    const hairlut_found one = hairlut_axis_find(&search), found[4] = {one, one, one, one};
    const hairlut_inverses inverse = hairlut_invert_four(found);
    const float xi = hairlut_quad_first(hairlut_quad_by_sign(inverse.balance, inverse.rest, inverse.part));
    const float m = hairlut_clamp(one.knot[0] + one.knot[2] * (1.0f / HAIRLUT_SCALE) * xi, 0.0f, 1.0f);
    return one.high ? 1.0f - m : m;
}

#endif
