/* SPDX-License-Identifier: BSD-3-Clause */
/* A table at the strands of a block: strand_axis.h, operation by operation; batch_axis.h, of rows and cells that are blended over the
 * corners first.
 *
 * A function whose last argument is `axes` is of a table with so many axes of parameters. */
#ifndef HAIRLUT_BATCH_STRAND_AXIS_H
#define HAIRLUT_BATCH_STRAND_AXIS_H

#include "batch_strand.h"
#include "oct.h"

/* A table at strands: the first corners, and the weights of the upper nodes of axis a from t + a * ROOM on. */
typedef struct strand_table {
    const hairlut_spacing *spacing; /* NULL: the table depends on no parameter, and the rest is not set */
    int axes;
    const int *node;
    const float *t;
} strand_table;

/* The strands of a block: their parameters, in the order of its samples or directions, and one vector beyond; and their places on
 * the grids that tables were read at last. */
typedef struct strand_block {
    const hairlut_strands *strands;
    size_t n; /* and that vector */
    float values[HAIRLUT_MAX_PARAMETERS][ROOM];
    block_places theta, phi, listed_theta, listed_phi;
} strand_block;

/* Before the parameters of n strands are set */
static inline void begin_strands(const hairlut_strands *strands, size_t n, strand_block *block)
{
    block->strands = strands;
    block->n = n + LANES;
    block->theta.grid = block->phi.grid = -1;
    for (int p = 0; p < strands->parameter_count; ++p)
        store(block->values[p] + n, all(0.0f));
}

/* A table at the strands from `from` on */
static inline strand_table table_at(strand_block *block, const hairlut_spacing *spacing, block_places *places, size_t from)
{
    static const strand_table independent;
    const given_strands all_values = {block->values[0], ROOM};
    const strand_table table = {spacing, block->strands->grids[spacing->grid].axis_count, places->node + from,
                                places->t[0] + from};
    if (table.axes == 0)
        return independent;
    if (places->grid != spacing->grid)
        place_block(block->strands, spacing->grid, all_values, block->n, places);
    return table;
}

/* Makes it the table at the strands of a list. */
static inline void list_strands(strand_table *table, const int *list, size_t n, block_places *listed)
{
    for (size_t s = 0; table->spacing && s < n; ++s) {
        listed->node[s] = table->node[list[s]];
        for (int a = 0; a < table->axes; ++a)
            listed->t[a][s] = table->t[a * ROOM + list[s]];
    }
    table->node = listed->node;
    table->t = listed->t[0];
}

/* Moves offsets to the first corners' arrays. */
static inline void enter_corners(const strand_table *table, size_t n, int *at)
{
    const int pitch = (int)table->spacing->pitch;
    for (size_t s = 0; s < n; s += LANES)
        istore(at + s, iadd(iload(at + s), iproduct(iadd(iload(table->node + s), iall(1)), iall(pitch))));
}

/* ---- searches ------------------------------------------------------------------------------------------------- */

/* The weights of the corners of strands s .. s+LANES-1 */
HAIRLUT_INLINE void load_weights(const strand_table *table, size_t s, real weight[HAIRLUT_CORNERS], int axes)
{
    real t[HAIRLUT_MAX_AXES];
    for (int a = 0; a < axes; ++a)
        t[a] = load(table->t + (size_t)a * ROOM + s);
    weigh_corners(t, axes, weight);
}

/* Lane l of x[k] is the blend of what stands k floats behind at[l], which is in the first corner's arrays. */
HAIRLUT_INLINE void gather_blends(const hairlut_spacing *spacing, const real *weight, const float *p, const int *at,
                                  real x[4], int axes)
{
    gather4(p, at, x);
    for (int k = 0; k < 4; ++k)
        x[k] = mul(weight[0], x[k]);
    for (int c = 1; c < 1 << axes; ++c) {
        real y[4];
        gather4(p + spacing->corner[c], at, y);
        for (int k = 0; k < 4; ++k)
            x[k] = add(x[k], mul(weight[c], y[k]));
    }
}

/* The same, to be read one strand after the other */
typedef struct corner_weights {
    float of[HAIRLUT_CORNERS][LANES];
} corner_weights;

HAIRLUT_INLINE void store_corner_weights(const strand_table *table, size_t s, corner_weights *weights, int axes)
{
    real weight[HAIRLUT_CORNERS];
    load_weights(table, s, weight, axes);
    for (int c = 0; c < 1 << axes; ++c)
        store(weights->of[c], weight[c]);
}

/* Eight texels of strand l of a vector; p is in the first corner's arrays. */
HAIRLUT_INLINE hairlut_oct blend_texels(const hairlut_spacing *spacing, const corner_weights *weights, int l, const float *p,
                                        int axes)
{
    hairlut_oct sum = hairlut_oct_mul(hairlut_oct_all(weights->of[0][l]), hairlut_oct_load(p));
    for (int c = 1; c < 1 << axes; ++c)
        sum = hairlut_oct_add(sum,
                              hairlut_oct_mul(hairlut_oct_all(weights->of[c][l]), hairlut_oct_load(p + spacing->corner[c])));
    return sum;
}

/* How many texels of a group of `size` are at most x. Where rows are alike, none is blended with the row above. */
HAIRLUT_INLINE int count_strand(const hairlut_spacing *spacing, const corner_weights *weights, int l, const float *group,
                                const float *above, float t, float x, int size, int alike, int axes)
{
    unsigned counted = 0;
    for (int k = 0; k < size; k += 8) {
        hairlut_oct texels = blend_texels(spacing, weights, l, group + k, axes);
        if (!alike) {
            const hairlut_oct to = blend_texels(spacing, weights, l, above + k, axes);
            const hairlut_oct change = size == HAIRLUT_SMALL_GROUP ? to : hairlut_oct_sub(to, texels);
            texels = hairlut_oct_add(texels, hairlut_oct_mul(hairlut_oct_all(t), change));
        }
        counted += hairlut_oct_count(texels, hairlut_oct_all(x));
    }
    return (int)counted;
}

HAIRLUT_INLINE void count_strands(const hairlut_axis *axis, const strand_table *table, const float *groups, size_t n,
                                  const axis_searches *q, int size, int alike, int *counts, int axes)
{
    const float *above = groups + (size == HAIRLUT_SMALL_GROUP ? HAIRLUT_SMALL_GROUP : axis->stride);
    for (size_t s = 0; s < n; s += LANES) {
        corner_weights weights;
        store_corner_weights(table, s, &weights, axes);
        HAIRLUT_UNROLLED
        for (int l = 0; l < LANES; ++l) {
            const size_t k = s + (size_t)l;
            counts[k] = count_strand(table->spacing, &weights, l, groups + q->at[k], above + q->at[k], q->t[k], q->x[k],
                                     size, alike, axes);
        }
    }
}

/* One texel of strand l of a vector */
static inline float blend_texel(const hairlut_spacing *spacing, const corner_weights *weights, int l, const float *p)
{
    float sum = weights->of[0][l] * p[0];
    for (int c = 1; c < spacing->count; ++c)
        sum += weights->of[c][l] * p[spacing->corner[c]];
    return sum;
}

/* hairlut_strand_halve, of strand k, which is number l of its vector */
static inline void halve_strand(const hairlut_axis *axis, const hairlut_spacing *spacing, const corner_weights *weights,
                                int l, axis_searches *q, size_t k)
{
    for (int part = axis->step / 2; part >= HAIRLUT_GROUP; part /= 2) {
        const float *low_end = axis->rows + HAIRLUT_LINE + q->at[k] + part - 1; /* of the upper half */
        const float from = blend_texel(spacing, weights, l, low_end);
        const float to = blend_texel(spacing, weights, l, low_end + axis->stride);
        const int first = from + q->t[k] * (to - from) <= q->x[k] ? part : 0;
        q->cell[k] += first;
        q->at[k] += first;
    }
}

static inline void halve_strands(const hairlut_axis *axis, const strand_table *table, size_t n, axis_searches *q, int axes)
{
    for (size_t s = 0; axis->step > HAIRLUT_GROUP && s < n; s += LANES) {
        corner_weights weights;
        store_corner_weights(table, s, &weights, axes);
        for (int l = 0; l < LANES; ++l)
            halve_strand(axis, table->spacing, &weights, l, q, s + (size_t)l);
    }
}

/* Searches the cells of all, in groups of `size`. */
HAIRLUT_INLINE void search_strands(const hairlut_axis *axis, const strand_table *table, size_t n, axis_searches *q, int size,
                                   int alike, int axes)
{
    int counts[BLOCK];
    enter_corners(table, n, q->at);
    count_strands(axis, table, axis->rows, n, q, size, alike, q->cell, axes);
    enter_blocks(axis, n, q, size);
    halve_strands(axis, table, n, q, axes);
    count_strands(axis, table, axis->rows + HAIRLUT_LINE, n, q, size, alike, counts, axes);
    find_cells(axis, n, q, counts);
    enter_corners(table, n, q->at);
}

/* ---- cells ---------------------------------------------------------------------------------------------------- */

/* hairlut_strand_cell of strands s .. s+LANES-1 */
HAIRLUT_INLINE cells blend_cells(const hairlut_axis *axis, const strand_table *table, size_t s, const int *at, real t,
                                 int alike, int axes)
{
    real weight[HAIRLUT_CORNERS], below[HAIRLUT_CELL], above[HAIRLUT_CELL];
    load_weights(table, s, weight, axes);
    gather_blends(table->spacing, weight, axis->ends[0], at, below, axes);
    if (alike)
        return blend_rows(below, below, t);
    gather_blends(table->spacing, weight, axis->ends[0] + HAIRLUT_CELL, at, above, axes);
    return blend_rows(below, above, t);
}

HAIRLUT_INLINE void find_strand_cells(const hairlut_axis *axis, const strand_table *table, size_t n, axis_searches *q,
                                      int alike, int axes)
{
    if (HAIRLUT_IS_SMALL(axis->columns))
        search_strands(axis, table, n, q, HAIRLUT_SMALL_GROUP, alike, axes);
    else
        search_strands(axis, table, n, q, HAIRLUT_GROUP, 0, axes);
    for (size_t s = 0; s < n; s += LANES)
        store_searches(q, s, blend_cells(axis, table, s, q->at + s, load(q->t + s), alike, axes));
}

HAIRLUT_INLINE void fetch_strand_samples(const hairlut_axis *axis, const strand_table *table, size_t n, axis_samples *q,
                                         int alike, int axes)
{
    enter_corners(table, n, q->at);
    for (size_t s = 0; s < n; s += LANES)
        store_samples(axis, q, s, blend_cells(axis, table, s, q->at + s, load(q->t + s), alike, axes));
}

/* ---- with parameters or without ------------------------------------------------------------------------------- */

/* Most tables have one axis: it gets code of its own, and so do rows that are all alike. Apart from the code without parameters,
 * which is inlined where it is used. */
HAIRLUT_APART static void end_strand_search(const hairlut_axis *axis, const strand_table *table, size_t n, axis_searches *q)
{
    if (table->axes == 1 && axis->alike)
        find_strand_cells(axis, table, n, q, 1, 1);
    else if (table->axes == 1)
        find_strand_cells(axis, table, n, q, 0, 1);
    else
        find_strand_cells(axis, table, n, q, 0, table->axes);
}

HAIRLUT_APART static void fetch_strands(const hairlut_axis *axis, const strand_table *table, size_t n, axis_samples *q)
{
    if (table->axes == 1 && axis->alike)
        fetch_strand_samples(axis, table, n, q, 1, 1);
    else if (table->axes == 1)
        fetch_strand_samples(axis, table, n, q, 0, 1);
    else
        fetch_strand_samples(axis, table, n, q, 0, table->axes);
}

HAIRLUT_INLINE void end_search_at(const hairlut_axis *axis, const strand_table *table, size_t n, axis_searches *q)
{
    if (table->spacing)
        end_strand_search(axis, table, n, q);
    else
        end_search(axis, n, q);
}

HAIRLUT_INLINE void fetch_samples_at(const hairlut_axis *axis, const strand_table *table, size_t n, axis_samples *q)
{
    if (table->spacing)
        fetch_strands(axis, table, n, q);
    else
        fetch_samples(axis, n, q);
}

#endif
