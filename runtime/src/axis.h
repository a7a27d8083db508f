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

typedef struct hairlut_cell {
    float x0, d0, w, d1;
} hairlut_cell;

/* A place on the u axis: m = min(u, 1-u), and its cell, counted from the low or the high end. */
typedef struct hairlut_place {
    int i;
    int high;
    float m;
} hairlut_place;

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

/* Cell i of rows j and j+1, from an end; `below` and `above`, in all lanes, are their weights. Blended as (1-t) p + t q, which
 * keeps a slope above zero at every t, as p + t (q-p) does not where q is far below p. */
HAIRLUT_INLINE hairlut_cell hairlut_axis_cell(const hairlut_axis *axis, int j, hairlut_quad below, hairlut_quad above, int i,
                                              int high)
{
    const unsigned column = (unsigned)i * (unsigned)axis->pitch; /* unsigned: an address needs no sign extended */
    const float *p = axis->ends[high] + column + (unsigned)j * HAIRLUT_CELL, *q = p + HAIRLUT_CELL;
    float part[4];
    hairlut_quad_lanes(hairlut_quad_add(hairlut_quad_mul(below, hairlut_quad_load(p)), hairlut_quad_mul(above, hairlut_quad_load(q))),
                       part);
    const hairlut_cell cell = {part[0], part[1], part[2], part[3]};
    return cell;
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
    hairlut_row row;
    float x;
    int first;
} hairlut_search;

/* The first half of a search. x outside the domain is moved to its end, NaN to the low one. */
HAIRLUT_INLINE hairlut_search hairlut_axis_begin_search(const hairlut_axis *axis, float theta_r, float x)
{
    hairlut_search search = {hairlut_axis_row(axis, theta_r), hairlut_axis_inside(axis, x), 0};
    const float *group = axis->rows + (ptrdiff_t)search.row.j * axis->stride;
    search.first = axis->step * hairlut_axis_count(axis, group, search.row.t, search.x);
    return search;
}

/* The rest of it: the cell whose blended ends enclose x, counted from the low end. Where there are several axes, begin all
 * searches before ending any: one waits for its loads while the other goes on. */
HAIRLUT_INLINE int hairlut_axis_end_search(const hairlut_axis *axis, const hairlut_search *search)
{
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

/* Where x lies in a cell: xi : q = a : b, and |dx/dm| = root / bend, the R and the h |G| of above. */
typedef struct hairlut_inverse {
    float a, b;
    float root, bend;
    float knot, width; /* of the cell, in m */
    int high;
} hairlut_inverse;

/* Angles are multiplied by HAIRLUT_SCALE, through the weights of the two rows: no product of four of them, as in R^2, leaves the
 * range of a float, whether a cell is 1e-12 or 2 pi rad wide. In the high half also by -1: w, D, X and Z are never negative. */
HAIRLUT_INLINE hairlut_inverse hairlut_axis_inverse(const hairlut_axis *axis, const hairlut_search *search, int found)
{
    hairlut_inverse inverse;
    const int i = hairlut_axis_nearer(axis, found, &inverse.high);
    const float t = search->row.t, *knot = axis->knots + HAIRLUT_KNOT * i;
    const float scale = inverse.high ? -HAIRLUT_SCALE : HAIRLUT_SCALE;
    const hairlut_cell cell = hairlut_axis_cell(axis, search->row.j, hairlut_quad_all(scale * (1.0f - t)), hairlut_quad_all(scale * t), i,
                                                inverse.high);
    const float w = cell.w, from = hairlut_clamp(scale * search->x - cell.x0, hairlut_constant(0.0f), w), to = w - from;
    const float wx = w * from, wz = w * to;
    const float balance = cell.d0 * to - cell.d1 * from;
    const float root = sqrtf(balance * balance + 4.0f * (wx * wz)), sum = root + fabsf(balance);
    inverse.a = balance >= 0.0f ? 2.0f * wx : sum;
    inverse.b = balance >= 0.0f ? sum : 2.0f * wz;
    const float total = inverse.a + inverse.b, unit = 1.0f / total, xi = inverse.a * unit, q = inverse.b * unit;
    inverse.root = root;
    inverse.bend = knot[2] * (w * (xi * xi + q * q) + (cell.d0 + cell.d1) * (xi * q));
    inverse.knot = knot[0];
    inverse.width = knot[2] * (1.0f / HAIRLUT_SCALE);
    return inverse;
}

/* x may be beyond an end of the domain by the rounding of a blend, two steps of a float: hairlut_axis_inside moves it back,
 * where what uses x does not have to wait for that. xi and q are kept above 0, where rounding chose the cell beside. */
HAIRLUT_INLINE hairlut_draw hairlut_axis_sample(const hairlut_axis *axis, float theta_r, float u)
{
    int j;
    const hairlut_quad t = hairlut_quad_split(hairlut_axis_position(axis, theta_r), &j);
    const hairlut_place place = hairlut_axis_place(axis, u);
    const float *knot = axis->knots + HAIRLUT_KNOT * place.i;
    const hairlut_cell cell = hairlut_axis_cell(axis, j, hairlut_quad_sub(hairlut_quad_all(1.0f), t), t, place.i, place.high);
    const float along = (place.m - knot[0]) * knot[1];
    const float xi = hairlut_max(along, hairlut_constant(0.0f)), q = hairlut_max(1.0f - along, hairlut_constant(0.0f));
    const float xi2 = xi * xi, q2 = q * q, p = xi * q, w = cell.w;
    const float ratio = w / (w * (xi2 + q2) + (cell.d0 + cell.d1) * p);
    const float slope = ratio * ratio * (cell.d1 * xi2 + 2.0f * w * p + cell.d0 * q2);
    const hairlut_draw draw = {cell.x0 + ratio * (w * xi2 + cell.d0 * p), fabsf(slope * knot[1])};
    return draw;
}

/* 1 in the domain, 0 outside. */
static inline float hairlut_axis_contains(const hairlut_axis *axis, float x)
{
    return (float)(x >= axis->low && x <= axis->high);
}

/* The u from which hairlut_axis_sample draws x. */
static inline float hairlut_axis_invert(const hairlut_axis *axis, float theta_r, float x)
{
    const hairlut_search search = hairlut_axis_begin_search(axis, theta_r, x);
    const hairlut_inverse inverse = hairlut_axis_inverse(axis, &search, hairlut_axis_end_search(axis, &search));
    const float xi = inverse.a / (inverse.a + inverse.b);
    const float m = hairlut_clamp(inverse.knot + inverse.width * xi, 0.0f, 1.0f);
    return inverse.high ? 1.0f - m : m;
}

#endif
