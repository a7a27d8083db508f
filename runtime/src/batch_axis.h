/* SPDX-License-Identifier: BSD-3-Clause */
/* An axis for a block of samples or directions: axis.h, operation by operation, in passes over the block. */
#ifndef HAIRLUT_BATCH_AXIS_H
#define HAIRLUT_BATCH_AXIS_H

#include "axis.h"
#include "batch.h"

/* Samples a pass; the arrays of a block have room for a vector more, which a group that ends within it writes. */
enum { BLOCK = 256, ROOM = BLOCK + LANES };

/* Samples on an axis. A pass stores its results in place of what it no longer needs, so that all of it stays in the first-level
 * cache, beside the table. */
typedef struct axis_samples {
    int at[BLOCK];   /* the offset of the cell */
    int knot[BLOCK]; /* the offset of its knot */
    float t[BLOCK];  /* the weight of the row above; from fetch_samples on: the blended cell's w, scaled, as x0, d0 and d1 */
    float m[BLOCK];  /* of hairlut_place; from fetch_samples on: (m - u0) / h */
    float x0[BLOCK];
    float d0[BLOCK];
    float d1[BLOCK];
    float rate[BLOCK]; /* 1 / h, over the scale */
} axis_samples;

/* Directions on an axis. */
typedef struct axis_searches {
    int j[BLOCK];    /* the row */
    int cell[BLOCK]; /* as far as it is known, counted from the low end */
    int at[BLOCK];   /* where to read on: an offset among the rows, then among the cells */
    float t[BLOCK];  /* the weight of the row above; from fetch_searches on: the blended cell's w, scaled, as d0 and d1 */
    float x[BLOCK];  /* the angle; from fetch_searches on: its distance from the cell's nearer end, scaled */
    float d0[BLOCK];
    float d1[BLOCK];
    float width[BLOCK]; /* h, scaled */
} axis_searches;

typedef struct cells {
    real x0, d0, w, d1;
} cells;

static inline real clamp(real x, real low, real high)
{
    return smaller(larger(x, low), high);
}

/* hairlut_axis_row */
HAIRLUT_INLINE whole find_row(const hairlut_axis *axis, real theta_r, real *t)
{
    const real scaled = mul(sub(theta_r, all(axis->row_origin)), all(axis->row_scale));
    const real r = clamp(scaled, all(0.0f), all(axis->row_last));
    const whole j = truncated(r);
    *t = sub(r, converted(j));
    return j;
}

/* The offset of cell i, counted from an end, of row j. */
HAIRLUT_INLINE whole cell_offset(const hairlut_axis *axis, whole j, whole i, mask high)
{
    const whole cell = imul(i, iall(axis->pitch));
    const whole half = iwhere(high, iall((int)(axis->ends[1] - axis->ends[0])));
    return iadd(iadd(cell, half), imul(j, iall(HAIRLUT_CELL)));
}

/* hairlut_axis_place, and where to read */
HAIRLUT_INLINE void place(const hairlut_axis *axis, size_t n, const float *theta_r, const float *u, axis_samples *q)
{
    for (size_t s = 0; s < n; s += LANES) {
        real t;
        const real number = load(u + s);
        const whole j = find_row(axis, load(theta_r + s), &t);
        const real m = larger(smaller(number, sub(all(1.0f), number)), all(0.0f));
        const real y = axis->warp == HAIRLUT_WARP_OCTAVES ? shifted(add(m, all(axis->e))) : m;
        const whole i = truncated(sub(mul(y, all(axis->scale)), all(axis->origin)));
        istore(q->at + s, cell_offset(axis, j, i, greater(number, all(0.5f))));
        istore(q->knot + s, imul(i, iall(HAIRLUT_KNOT)));
        store(q->t + s, t);
        store(q->m + s, m);
    }
}

/* How many texels of a group are at most x, of n samples in groups of `size`, which is to be a constant; `groups` are those of row 0.
 * alike: whether all rows are the same; then the row above is not read. */
HAIRLUT_INLINE void count(const hairlut_axis *axis, const float *groups, size_t n, const axis_searches *q, int size,
                          int alike, int *counts)
{
    const float *above = groups + (size == HAIRLUT_SMALL_GROUP ? HAIRLUT_SMALL_GROUP : axis->stride);
#ifdef HAIRLUT_COUNTS
    for (size_t s = 0; s < n; s += LANES)
        istore(counts + s, HAIRLUT_COUNTS(groups, above, q->at + s, q->t + s, q->x + s, size, alike));
#else
    HAIRLUT_UNROLLED
    for (size_t k = 0; k < n; ++k) {
        const hairlut_quad t = hairlut_quad_all(q->t[k]), x = hairlut_quad_all(q->x[k]);
        const float *group = groups + q->at[k];
        if (size == HAIRLUT_GROUP)
            counts[k] = (int)hairlut_axis_count_large(group, above + q->at[k], t, x);
        else if (alike)
            counts[k] = (int)hairlut_quad_count_two(hairlut_quad_load(group), hairlut_quad_load(group + 4), x);
        else
            counts[k] = (int)hairlut_count_eight(group, t, x);
    }
#endif
}

/* From the numbers of blocks, of groups of `size`, to the first cell of each, and the offset of its first group */
static inline void enter_blocks(const hairlut_axis *axis, size_t n, axis_searches *q, int size)
{
    const int step = axis->step, floats = HAIRLUT_LINE / size * step; /* of a block */
    for (size_t s = 0; s < n; s += LANES) {
        const whole block = iload(q->cell + s);
        istore(q->cell + s, imul(block, iall(step)));
        istore(q->at + s, iadd(iload(q->at + s), imul(block, iall(floats))));
    }
}

/* hairlut_halve */
static inline void halve_blocks(const hairlut_axis *axis, size_t n, axis_searches *q)
{
    const float *groups = axis->rows + HAIRLUT_LINE;
    for (size_t k = 0; axis->step > HAIRLUT_GROUP && k < n; ++k) {
        const int halved = (int)hairlut_halve(groups + q->at[k], axis->stride, q->t[k], q->x[k], (unsigned)axis->step);
        q->cell[k] += halved;
        q->at[k] += halved;
    }
}

/* The widths h of the columns of a half of a small table, scaled, as whole vectors. */
typedef struct column_widths {
    float h[HAIRLUT_WHOLE(HAIRLUT_HALF(HAIRLUT_SMALL_COLUMNS), LANES)];
    int vectors;
} column_widths;

static inline void read_widths(const hairlut_axis *axis, column_widths *widths)
{
    const int half = HAIRLUT_HALF(axis->columns);
    widths->vectors = (half + LANES - 1) / LANES;
    for (int i = 0; i < widths->vectors * LANES; ++i)
        widths->h[i] = axis->knots[HAIRLUT_KNOT * (i < half ? i : 0) + 2];
}

/* From the last counts to where to read the cells of a small table: what its links say, without a load for each sample */
HAIRLUT_INLINE void find_small_cells(const hairlut_axis *axis, size_t n, axis_searches *q, const int *counts)
{
    column_widths widths;
    read_widths(axis, &widths);
    for (size_t s = 0; s < n; s += LANES) {
        const whole cell = iadd(iload(q->cell + s), iload(counts + s)), mirrored = isub(iall(axis->columns - 2), cell);
        const whole i = ismaller(cell, mirrored);
        istore(q->at + s, cell_offset(axis, iload(q->j + s), i, igreater(cell, mirrored)));
        store(q->width + s, lookup(widths.h, widths.vectors, i));
    }
}

/* The same of any table: hairlut_axis_find */
HAIRLUT_INLINE void find_cells(const hairlut_axis *axis, size_t n, axis_searches *q, const int *counts)
{
    for (size_t s = 0; s < n; s += LANES) {
        whole offset;
        real h;
        istore(q->cell + s, iadd(iload(q->cell + s), iload(counts + s)));
        gather_links(axis->links, q->cell + s, &offset, &h);
        istore(q->at + s, iadd(offset, imul(iload(q->j + s), iall(HAIRLUT_CELL))));
        store(q->width + s, h);
    }
}

/* Searches the cells of all, in groups of `size`. */
HAIRLUT_INLINE void search(const hairlut_axis *axis, size_t n, axis_searches *q, int size, int alike)
{
    int counts[BLOCK];
    count(axis, axis->rows, n, q, size, alike, q->cell);
    enter_blocks(axis, n, q, size);
    halve_blocks(axis, n, q);
    count(axis, axis->rows + HAIRLUT_LINE, n, q, size, alike, counts);
    if (size == HAIRLUT_SMALL_GROUP)
        find_small_cells(axis, n, q, counts);
    else
        find_cells(axis, n, q, counts);
}

/* hairlut_axis_blend, of cells of the row below and of that above; t is that of hairlut_row */
HAIRLUT_INLINE cells blend_rows(const real p[HAIRLUT_CELL], const real q[HAIRLUT_CELL], real t)
{
    const real scale = all(HAIRLUT_SCALE), below = mul(scale, sub(all(1.0f), t)), above = mul(scale, t);
    const cells cell = {add(mul(below, p[0]), mul(above, q[0])), add(mul(below, p[1]), mul(above, q[1])),
                        add(mul(below, p[2]), mul(above, q[2])), add(mul(below, p[3]), mul(above, q[3]))};
    return cell;
}

HAIRLUT_INLINE cells load_cells(const hairlut_axis *axis, const int *at, real t, int alike)
{
    real p[HAIRLUT_CELL], q[HAIRLUT_CELL];
    gather4(axis->ends[0], at, p);
    if (alike)
        return blend_rows(p, p, t);
    gather4(axis->ends[0] + HAIRLUT_CELL, at, q);
    return blend_rows(p, q, t);
}

/* The cells of samples s .. s+LANES-1, and their knots */
HAIRLUT_INLINE void store_samples(const hairlut_axis *axis, axis_samples *q, size_t s, cells cell)
{
    real knot[HAIRLUT_KNOT];
    gather4(axis->knots, q->knot + s, knot);
    store(q->m + s, mul(sub(load(q->m + s), knot[0]), knot[1]));
    store(q->rate + s, knot[3]);
    store(q->x0 + s, cell.x0);
    store(q->d0 + s, cell.d0);
    store(q->t + s, cell.w);
    store(q->d1 + s, cell.d1);
}

HAIRLUT_INLINE void fetch_samples(const hairlut_axis *axis, size_t n, axis_samples *q)
{
    for (size_t s = 0; s < n; s += LANES)
        store_samples(axis, q, s, load_cells(axis, q->at + s, load(q->t + s), 0));
}

/* The cells of directions s .. s+LANES-1 */
HAIRLUT_INLINE void store_searches(axis_searches *q, size_t s, cells cell)
{
    const real w = magnitude(cell.w);
    const real beyond = flipped(sub(mul(load(q->x + s), all(HAIRLUT_SCALE)), cell.x0), cell.w);
    store(q->x + s, clamp(beyond, all(0.0f), w));
    store(q->d0 + s, magnitude(cell.d0));
    store(q->t + s, w);
    store(q->d1 + s, magnitude(cell.d1));
}

HAIRLUT_INLINE void fetch_searches(const hairlut_axis *axis, size_t n, axis_searches *q, int alike)
{
    for (size_t s = 0; s < n; s += LANES)
        store_searches(q, s, load_cells(axis, q->at + s, load(q->t + s), alike));
}

/* hairlut_draw_two, of an axis, of samples s .. s+LANES-1 that were placed and fetched */
HAIRLUT_INLINE real draw(const axis_samples *q, size_t s, real *slope)
{
    const real along = load(q->m + s), w = load(q->t + s), d0 = load(q->d0 + s), d1 = load(q->d1 + s), twice = add(w, w);
    const real xi = larger(along, all(0.0f)), rest = larger(sub(all(1.0f), along), all(0.0f));
    const real xi2 = mul(xi, xi), rest2 = mul(rest, rest), p = mul(xi, rest);
    const real ratio = over(w, add(w, mul(sub(add(d0, d1), twice), p)));
    const real bent = add(add(mul(d1, xi2), mul(d0, rest2)), mul(twice, p));
    *slope = magnitude(mul(mul(mul(ratio, ratio), bent), load(q->rate + s)));
    return mul(add(load(q->x0 + s), mul(ratio, add(mul(w, xi2), mul(d0, p)))), all(1.0f / HAIRLUT_SCALE));
}

/* Begins a search. Returns whether the domain contains x. */
HAIRLUT_INLINE mask begin_search(const hairlut_axis *axis, real theta_r, real x, axis_searches *q, size_t s)
{
    const real low = all(axis->low), high = all(axis->high);
    real t;
    const whole j = find_row(axis, theta_r, &t);
    istore(q->j + s, j);
    istore(q->at + s, imul(j, iall(axis->stride)));
    store(q->t + s, t);
    store(q->x + s, clamp(x, low, high));
    return both(at_least(x, low), at_least(high, x));
}

/* The rest of the search, and the cells. */
HAIRLUT_INLINE void end_search(const hairlut_axis *axis, size_t n, axis_searches *q)
{
    const int small = HAIRLUT_IS_SMALL(axis->columns);
    if (small && axis->alike) {
        search(axis, n, q, HAIRLUT_SMALL_GROUP, 1);
        fetch_searches(axis, n, q, 1);
        return;
    }
    if (small)
        search(axis, n, q, HAIRLUT_SMALL_GROUP, 0);
    else
        search(axis, n, q, HAIRLUT_GROUP, 0);
    fetch_searches(axis, n, q, 0);
}

/* hairlut_invert, of an axis: bend and root of directions s .. s+LANES-1 */
HAIRLUT_INLINE real inverse(const axis_searches *q, size_t s, real *root_of)
{
    const real w = load(q->t + s), d0 = load(q->d0 + s), d1 = load(q->d1 + s), from = load(q->x + s), to = sub(w, from);
    const real twice = add(w, w), wx = mul(twice, from), wz = mul(twice, to), h = load(q->width + s);
    const real balance = sub(mul(d0, to), mul(d1, from));
    *root_of = root(add(mul(balance, balance), mul(wx, wz)));
    const real sum = add(*root_of, magnitude(balance)), side = by_sign(balance, wz, wx), of_both = add(side, sum);
    const real product = over(mul(side, sum), mul(of_both, of_both));
    return add(mul(h, w), mul(mul(h, sub(add(d0, d1), twice)), product));
}

#endif
