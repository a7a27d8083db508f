/* SPDX-License-Identifier: BSD-3-Clause */
/* The one reading of a table, shared by sample, pdf and invert (luts/FORMAT.md, "Reading").
 *
 * The cells of two neighbouring rows are blended linearly in theta_r. Within a blended cell, x is the monotone rational
 * quadratic of Gregory and Delbourgo (1982): with xi = (m - u0) / h, q = 1 - xi, w the cell's width, and D = h dx/dm at its ends,
 *
 *     G = w + (D0 + D1 - 2 w) xi q,        x = x0 + w (w xi^2 + D0 xi q) / G,
 *     h dx/dm = w^2 (D1 xi^2 + 2 w xi q + D0 q^2) / G^2,
 *
 * and back from x, with X = x - x0, Z = w - X, without cancellation:
 *
 *     B = D0 Z - D1 X,  R = sqrt(B^2 + 4 w^2 X Z),   xi : q = 2 w X : R + B where B >= 0, else R - B : 2 w Z,
 *     density = 1 / |dx/dm| = h G / R.
 *
 * A call computes with four axes at once, or with two: an axis is a lane of a quad.
 *
 * All is counted from the nearer end of the u axis: m is min(u, 1-u), and in the high half of a row w and D are stored negative:
 * for the way back, X and they change their signs there. */
#ifndef HAIRLUT_AXIS_H
#define HAIRLUT_AXIS_H

#include <math.h>
#include <stddef.h>

#include "internal.h"
#include "oct.h"

/* Where theta_r lies: the row below it, the weight of the row above, in [0,1), and the weights of both times HAIRLUT_SCALE, all
 * in all lanes. Angles are multiplied by that scale with the blend: no product of four of them, as in R^2, leaves the range of a
 * float, whether a cell is 1e-12 or 2 pi rad wide. */
typedef struct hairlut_row {
    int j;
    hairlut_quad t, below, above;
} hairlut_row;

/* A place between two nodes of any other kind: the one below, and the weight of the next, in [0,1]. */
typedef struct hairlut_node {
    int j;
    float t;
} hairlut_node;

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
    const hairlut_quad scale = hairlut_quad_all(HAIRLUT_SCALE);
    hairlut_row row;
    row.t = hairlut_quad_split(hairlut_axis_position(axis, theta_r), &row.j);
    row.below = hairlut_quad_mul(scale, hairlut_quad_sub(hairlut_quad_all(1.0f), row.t));
    row.above = hairlut_quad_mul(scale, row.t);
    return row;
}

/* The blend of a cell whose floats of the row below are p: x0, D0, w, D1, scaled. As (1-t) p + t q, which keeps a slope above zero
 * at every t, as p + t (q-p) does not where q is far below p. */
HAIRLUT_INLINE hairlut_quad hairlut_axis_blend(const hairlut_row *row, const float *p)
{
    return hairlut_quad_add(hairlut_quad_mul(row->below, hairlut_quad_load(p)),
                            hairlut_quad_mul(row->above, hairlut_quad_load(p + HAIRLUT_CELL)));
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

/* The cell of a small table whose blended ends enclose x, counted from the low end; `groups` are those of the row. A count has no
 * branch that depends on x. */
HAIRLUT_INLINE unsigned hairlut_axis_search_small(const float *groups, hairlut_quad t, hairlut_quad x)
{
    const size_t block = hairlut_count_eight(groups, t, x);
    return (unsigned)block * HAIRLUT_SMALL_GROUP + hairlut_count_eight(groups + HAIRLUT_LINE + HAIRLUT_LINE * block, t, x);
}

#ifdef HAIRLUT_OCT_AVX2
/* -1 in the lanes of the blended texels of group g that are at most x */
HAIRLUT_INLINE __m256i hairlut_axis_compared(const float *groups, int g, hairlut_oct t, hairlut_oct x)
{
    const float *group = groups + (g + 1) * HAIRLUT_LINE;
    const hairlut_oct texels =
        hairlut_oct_add(hairlut_oct_load(group), hairlut_oct_mul(t, hairlut_oct_load(group + HAIRLUT_SMALL_GROUP)));
    return _mm256_castps_si256(_mm256_cmp_ps(texels, x, _CMP_LE_OQ));
}

/* The same by one count of all texels, where eight comparisons are one instruction: none waits for the block. An `if` goes the
 * same way at every call for a table. */
HAIRLUT_INLINE unsigned hairlut_axis_search_whole(const float *groups, int count, hairlut_quad t4, float angle)
{
    const hairlut_oct t = hairlut_oct_of(t4, t4), x = hairlut_oct_all(angle);
    const __m256i first = _mm256_packs_epi32(hairlut_axis_compared(groups, 0, t, x), hairlut_axis_compared(groups, 1, t, x));
    __m256i third = _mm256_setzero_si256(), fourth = third;
    unsigned fifth = 0;
    if (count > 2)
        third = hairlut_axis_compared(groups, 2, t, x);
    if (count > 3)
        fourth = hairlut_axis_compared(groups, 3, t, x);
    if (count > 4)
        fifth = (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(hairlut_axis_compared(groups, 4, t, x)));
    const unsigned four = (unsigned)_mm256_movemask_epi8(_mm256_packs_epi16(first, _mm256_packs_epi32(third, fourth)));
    return (unsigned)_mm_popcnt_u32(four) + (unsigned)_mm_popcnt_u32(fifth);
}
#endif

/* How many of the 16 texels of a group, blended with those of the row above, are at most x. */
static inline unsigned hairlut_axis_count_large(const float *group, const float *above, hairlut_quad t, hairlut_quad x)
{
    hairlut_quad texels[4];
    for (int k = 0; k < 4; ++k) {
        const hairlut_quad from = hairlut_quad_load(group + 4 * k), to = hairlut_quad_load(above + 4 * k);
        texels[k] = hairlut_quad_add(from, hairlut_quad_mul(t, hairlut_quad_sub(to, from)));
    }
    return hairlut_quad_count_two(texels[0], texels[1], x) + hairlut_quad_count_two(texels[2], texels[3], x);
}

/* Halves a block of n cells, n a power of two, until the part in which x lies is a group's: its first cell. Not for small
 * tables, whose blocks are groups. */
static inline unsigned hairlut_halve(const float *groups, int stride, float t, float x, unsigned n)
{
    unsigned first = 0;
    for (n /= 2; n >= HAIRLUT_GROUP; n /= 2) {
        const float *low_end = groups + first + n - 1, from = low_end[0], to = low_end[stride]; /* of the upper half */
        first += from + t * (to - from) <= x ? n : 0;
    }
    return first;
}

/* The cell of any other table. */
static inline unsigned hairlut_axis_search_large(const float *groups, const hairlut_axis *axis, hairlut_quad t,
                                                 hairlut_quad x)
{
    const int stride = axis->stride;
    const unsigned step = (unsigned)axis->step, first = step * hairlut_axis_count_large(groups, groups + stride, t, x);
    const float *block = groups + HAIRLUT_LINE + first;
    const unsigned halved = hairlut_halve(block, stride, hairlut_quad_first(t), hairlut_quad_first(x), step);
    return first + halved + hairlut_axis_count_large(block + halved, block + halved + stride, t, x);
}

/* The cell of an angle in the domain. */
HAIRLUT_INLINE unsigned hairlut_axis_search(const hairlut_axis *axis, const hairlut_row *row, float angle)
{
    const float *groups = axis->rows + (unsigned)row->j * (unsigned)axis->stride; /* unsigned: no sign is extended */
#ifdef HAIRLUT_OCT_AVX2
    if (HAIRLUT_MOSTLY(axis->groups))
        return hairlut_axis_search_whole(groups, axis->groups, row->t, angle);
#endif
    const hairlut_quad x = hairlut_quad_all(angle);
    return HAIRLUT_IS_SMALL(axis->columns) ? hairlut_axis_search_small(groups, row->t, x)
                                           : hairlut_axis_search_large(groups, axis, row->t, x);
}

/* An angle on an axis, moved into the domain, NaN to its low end; the angle as it was given; its blended cell; and the width of
 * that in m, h. The cell and h are scaled. */
typedef struct hairlut_found {
    float x, given, h;
    hairlut_quad cell;
} hairlut_found;

HAIRLUT_INLINE hairlut_found hairlut_axis_find(const hairlut_axis *axis, const hairlut_row *row, float given)
{
    const float x = hairlut_axis_inside(axis, given);
    const hairlut_link *link = axis->links + hairlut_axis_search(axis, row, x);
    const float *cell = axis->ends[0] + (link->offset + HAIRLUT_CELL * (unsigned)row->j);
    const hairlut_found found = {x, given, link->h, hairlut_axis_blend(row, cell)};
    return found;
}

/* What was found on four axes, an axis a lane; or on two, in lanes 0 and 1. */
typedef struct hairlut_axes {
    hairlut_quad x, given, h, cell[4];
} hairlut_axes;

HAIRLUT_INLINE hairlut_axes hairlut_four_axes(const hairlut_found found[4])
{
    hairlut_axes axes;
    for (int l = 0; l < 4; ++l)
        axes.cell[l] = found[l].cell;
    hairlut_quad_transpose(axes.cell);
    axes.x = hairlut_quad_of_four(found[0].x, found[1].x, found[2].x, found[3].x);
    axes.given = hairlut_quad_of_four(found[0].given, found[1].given, found[2].given, found[3].given);
    axes.h = hairlut_quad_of_four(found[0].h, found[1].h, found[2].h, found[3].h);
    return axes;
}

HAIRLUT_INLINE hairlut_axes hairlut_two_axes(const hairlut_found found[2])
{
    hairlut_axes axes;
    hairlut_quad_pair(found[0].cell, found[1].cell, axes.cell);
    axes.x = hairlut_quad_of_two(found[0].x, found[1].x);
    axes.given = hairlut_quad_of_two(found[0].given, found[1].given);
    axes.h = hairlut_quad_of_two(found[0].h, found[1].h);
    return axes;
}

/* Where angles lie in their cells, an axis a lane: |dx/dm| = root / bend, the R and the h G of above; xi : q = side : sum, or
 * sum : side where `balance`, B, is negative. */
typedef struct hairlut_inverses {
    hairlut_quad root, bend, balance, side, sum;
} hairlut_inverses;

HAIRLUT_INLINE hairlut_inverses hairlut_invert(const hairlut_axes *axes)
{
    hairlut_inverses inverse;
    const hairlut_quad *cell = axes->cell, x = axes->x, h = axes->h;
    const hairlut_quad d0 = hairlut_quad_abs(cell[1]), w = hairlut_quad_abs(cell[2]), d1 = hairlut_quad_abs(cell[3]);
    const hairlut_quad scaled = hairlut_quad_mul(x, hairlut_quad_all(HAIRLUT_SCALE)), twice = hairlut_quad_add(w, w);
    const hairlut_quad beyond = hairlut_quad_flipped(hairlut_quad_sub(scaled, cell[0]), cell[2]);
    const hairlut_quad from = hairlut_quad_min(hairlut_quad_max(beyond, hairlut_quad_all(0.0f)), w);
    const hairlut_quad to = hairlut_quad_sub(w, from);
    const hairlut_quad wx = hairlut_quad_mul(twice, from), wz = hairlut_quad_mul(twice, to);
    const hairlut_quad balance = hairlut_quad_sub(hairlut_quad_mul(d0, to), hairlut_quad_mul(d1, from));
    inverse.balance = balance;
    inverse.root = hairlut_quad_sqrt(hairlut_quad_add(hairlut_quad_mul(balance, balance), hairlut_quad_mul(wx, wz)));
    inverse.sum = hairlut_quad_add(inverse.root, hairlut_quad_abs(balance));
    inverse.side = hairlut_quad_by_sign(balance, wz, wx);
    const hairlut_quad of_both = hairlut_quad_add(inverse.side, inverse.sum);
    const hairlut_quad product =
        hairlut_quad_div(hairlut_quad_mul(inverse.side, inverse.sum), hairlut_quad_mul(of_both, of_both));
    const hairlut_quad excess = hairlut_quad_sub(hairlut_quad_add(d0, d1), twice);
    inverse.bend = hairlut_quad_add(hairlut_quad_mul(h, w), hairlut_quad_mul(hairlut_quad_mul(h, excess), product));
    return inverse;
}

/* The densities of two lobes, in lanes 0 and 2: products of those of two axes each, 0 where a lobe's domain does not contain the
 * direction. */
HAIRLUT_INLINE hairlut_quad hairlut_densities_of(const hairlut_axes *axes)
{
    const hairlut_inverses inverse = hairlut_invert(axes);
    const hairlut_quad bend = hairlut_quad_where_equal(axes->given, axes->x, inverse.bend);
    return hairlut_quad_div(hairlut_quad_mul(bend, hairlut_quad_swapped(bend)),
                            hairlut_quad_mul(inverse.root, hairlut_quad_swapped(inverse.root)));
}

HAIRLUT_INLINE hairlut_quad hairlut_densities(const hairlut_found found[4])
{
    const hairlut_axes axes = hairlut_four_axes(found);
    return hairlut_densities_of(&axes);
}

/* That of one lobe. */
HAIRLUT_INLINE float hairlut_density(const hairlut_found found[2])
{
    const hairlut_axes axes = hairlut_two_axes(found);
    return hairlut_quad_first(hairlut_densities_of(&axes));
}

/* The place of u on the axis at theta_r, and its cell, scaled. */
typedef struct hairlut_placed {
    hairlut_quad cell, knot;
    float m;
} hairlut_placed;

/* The floats of its cell in the row below */
HAIRLUT_INLINE const float *hairlut_axis_placed_cell(const hairlut_axis *axis, const hairlut_row *row, hairlut_place place)
{
    return axis->ends[place.high] + (unsigned)place.i * (unsigned)axis->pitch + (unsigned)row->j * HAIRLUT_CELL;
}

HAIRLUT_INLINE hairlut_placed hairlut_axis_find_place(const hairlut_axis *axis, const hairlut_row *row, float u)
{
    const hairlut_place place = hairlut_axis_place(axis, u);
    const hairlut_placed placed = {hairlut_axis_blend(row, hairlut_axis_placed_cell(axis, row, place)),
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
    const hairlut_quad d0 = cell[1], w = cell[2], d1 = cell[3], zero = hairlut_quad_all(0.0f),
                       twice = hairlut_quad_add(w, w);
    const hairlut_quad along = hairlut_quad_mul(hairlut_quad_sub(hairlut_quad_of_two(a->m, b->m), knot[0]), knot[1]);
    const hairlut_quad xi = hairlut_quad_max(along, zero);
    const hairlut_quad q = hairlut_quad_max(hairlut_quad_sub(hairlut_quad_all(1.0f), along), zero);
    const hairlut_quad xi2 = hairlut_quad_mul(xi, xi), q2 = hairlut_quad_mul(q, q), p = hairlut_quad_mul(xi, q);
    const hairlut_quad excess = hairlut_quad_sub(hairlut_quad_add(d0, d1), twice);
    const hairlut_quad ratio = hairlut_quad_div(w, hairlut_quad_add(w, hairlut_quad_mul(excess, p)));
    const hairlut_quad ends = hairlut_quad_add(hairlut_quad_mul(d1, xi2), hairlut_quad_mul(d0, q2));
    const hairlut_quad bent = hairlut_quad_add(ends, hairlut_quad_mul(twice, p));
    const hairlut_quad slope = hairlut_quad_mul(hairlut_quad_mul(hairlut_quad_mul(ratio, ratio), bent), knot[3]);
    const hairlut_quad rise = hairlut_quad_add(hairlut_quad_mul(w, xi2), hairlut_quad_mul(d0, p));
    const hairlut_quad scaled = hairlut_quad_add(cell[0], hairlut_quad_mul(ratio, rise));
    const hairlut_draws draws = {hairlut_quad_mul(scaled, hairlut_quad_all(1.0f / HAIRLUT_SCALE)), hairlut_quad_abs(slope)};
    return draws;
}

/* The u from which x is drawn. */
static inline float hairlut_axis_invert(const hairlut_axis *axis, float theta_r, float x)
{
    const hairlut_row row = hairlut_axis_row(axis, theta_r);
    const int cell = (int)hairlut_axis_search(axis, &row, hairlut_axis_inside(axis, x)), mirrored = axis->columns - 2 - cell;
    const hairlut_found one = hairlut_axis_find(axis, &row, x), two[2] = {one, one};
    const hairlut_axes axes = hairlut_two_axes(two);
    const hairlut_inverses inverse = hairlut_invert(&axes);
    const hairlut_quad part = hairlut_quad_by_sign(inverse.balance, inverse.sum, inverse.side);
    const float xi = hairlut_quad_first(hairlut_quad_div(part, hairlut_quad_add(inverse.side, inverse.sum)));
    const float u0 = axis->knots[HAIRLUT_KNOT * (cell < mirrored ? cell : mirrored)];
    const float m = hairlut_clamp(u0 + one.h * (1.0f / HAIRLUT_SCALE) * xi, 0.0f, 1.0f);
    return cell > mirrored ? 1.0f - m : m;
}

#endif
