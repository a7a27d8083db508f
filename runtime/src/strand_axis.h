/* SPDX-License-Identifier: BSD-3-Clause */
/* A table at a strand: axis.h, of rows and cells that are blended over the corners of the parameters first.
 *
 * The functions of a search are compiled once for each number of corners that is common: then no loop over them is left. */
#ifndef HAIRLUT_STRAND_AXIS_H
#define HAIRLUT_STRAND_AXIS_H

#include "axis.h"
#include "corners.h"

/* A table at a strand. */
typedef struct hairlut_blended {
    const hairlut_axis *axis;
    const hairlut_spacing *nodes;
    const hairlut_quad *weight; /* of the corners */
    ptrdiff_t first;            /* floats from the axis' own arrays to those of the first corner */
} hairlut_blended;

HAIRLUT_INLINE hairlut_blended hairlut_blended_table(const hairlut_axis *axis, const hairlut_spacing *nodes,
                                                     const hairlut_corners *corners)
{
    const hairlut_corners *mine = &corners[nodes->grid];
    const hairlut_blended table = {axis, nodes, mine->weight, (mine->node + 1) * nodes->pitch};
    return table;
}

/* Four floats that stand at p in the arrays of the first corner; n corners. */
HAIRLUT_INLINE hairlut_quad hairlut_blend_quad(const hairlut_blended *table, const float *p, int n)
{
    hairlut_quad sum = hairlut_quad_mul(table->weight[0], hairlut_quad_load(p));
    for (int c = 1; c < n; ++c)
        sum = hairlut_quad_add(sum, hairlut_quad_mul(table->weight[c], hairlut_quad_load(p + table->nodes->corner[c])));
    return sum;
}

/* Four blended texels from p on, blended with those of the row above; in a small table the changes to it stand behind them. */
HAIRLUT_INLINE hairlut_quad hairlut_strand_texels(const hairlut_blended *table, const float *p, hairlut_quad t, int small,
                                                  int n)
{
    const float *above = p + (small ? HAIRLUT_SMALL_GROUP : table->axis->stride);
    const hairlut_quad from = hairlut_blend_quad(table, p, n), to = hairlut_blend_quad(table, above, n);
    return hairlut_quad_add(from, hairlut_quad_mul(t, small ? to : hairlut_quad_sub(to, from)));
}

/* How many texels of a group of `size`, 8 or 16, are at most x. */
HAIRLUT_INLINE unsigned hairlut_strand_count(const hairlut_blended *table, const float *group, hairlut_quad t,
                                             hairlut_quad x, int size, int n)
{
    unsigned count = 0;
    for (int k = 0; k < size; k += 8)
        count += hairlut_quad_count_two(hairlut_strand_texels(table, group + k, t, size == HAIRLUT_SMALL_GROUP, n),
                                        hairlut_strand_texels(table, group + k + 4, t, size == HAIRLUT_SMALL_GROUP, n), x);
    return count;
}

/* hairlut_axis_search_small; of at most five blocks, four texels are the ends of all but the last. */
HAIRLUT_INLINE unsigned hairlut_strand_search_small(const hairlut_blended *table, const float *groups, hairlut_quad t,
                                                    hairlut_quad x, int n)
{
    const size_t block = table->axis->columns <= 5 * HAIRLUT_SMALL_GROUP + 1
                             ? hairlut_quad_count(hairlut_strand_texels(table, groups, t, 1, n), x)
                             : hairlut_strand_count(table, groups, t, x, HAIRLUT_SMALL_GROUP, n);
    return (unsigned)block * HAIRLUT_SMALL_GROUP +
           hairlut_strand_count(table, groups + HAIRLUT_LINE + HAIRLUT_LINE * block, t, x, HAIRLUT_SMALL_GROUP, n);
}

/* hairlut_halve of blended rows; `groups` are those of the first corner. */
static inline unsigned hairlut_strand_halve(const hairlut_blended *table, const float *groups, hairlut_quad t, float x)
{
    unsigned first = 0;
    for (unsigned part = (unsigned)table->axis->step / 2; part >= HAIRLUT_GROUP; part /= 2) {
        const float *low_end = groups + first + part - 4; /* its last float is that of the upper half */
        first += hairlut_quad_last(hairlut_strand_texels(table, low_end, t, 0, table->nodes->count)) <= x ? part : 0;
    }
    return first;
}

/* hairlut_axis_search_large */
HAIRLUT_INLINE unsigned hairlut_strand_search_large(const hairlut_blended *table, const float *groups, hairlut_quad t,
                                                    hairlut_quad x, int n)
{
    const unsigned first = (unsigned)table->axis->step * hairlut_strand_count(table, groups, t, x, HAIRLUT_GROUP, n);
    const float *block = groups + HAIRLUT_LINE + first;
    const unsigned halved = hairlut_strand_halve(table, block, t, hairlut_quad_first(x));
    return first + halved + hairlut_strand_count(table, block + halved, t, x, HAIRLUT_GROUP, n);
}

/* hairlut_axis_blend of blended cells */
HAIRLUT_INLINE hairlut_quad hairlut_strand_cell(const hairlut_blended *table, const hairlut_row *row, const float *p, int n)
{
    return hairlut_quad_add(hairlut_quad_mul(row->below, hairlut_blend_quad(table, p, n)),
                            hairlut_quad_mul(row->above, hairlut_blend_quad(table, p + HAIRLUT_CELL, n)));
}

HAIRLUT_INLINE hairlut_found hairlut_strand_find_of(const hairlut_blended *table, const hairlut_row *row, float given, int n)
{
    const hairlut_axis *axis = table->axis;
    const float *groups = axis->rows + table->first + (unsigned)row->j * (unsigned)axis->stride;
    const float x = hairlut_axis_inside(axis, given);
    const unsigned cell = HAIRLUT_IS_SMALL(axis->columns)
                              ? hairlut_strand_search_small(table, groups, row->t, hairlut_quad_all(x), n)
                              : hairlut_strand_search_large(table, groups, row->t, hairlut_quad_all(x), n);
    const hairlut_link *link = axis->links + cell;
    const float *p = axis->ends[0] + table->first + (link->offset + HAIRLUT_CELL * (unsigned)row->j);
    const hairlut_found found = {x, given, link->h, hairlut_strand_cell(table, row, p, n)};
    return found;
}

/* hairlut_axis_find */
HAIRLUT_INLINE hairlut_found hairlut_strand_find(const hairlut_blended *table, const hairlut_row *row, float given)
{
    const int count = table->nodes->count;
    return count == 2   ? hairlut_strand_find_of(table, row, given, 2)
           : count == 1 ? hairlut_strand_find_of(table, row, given, 1)
                        : hairlut_strand_find_of(table, row, given, count);
}

/* hairlut_axis_find_place */
static inline hairlut_placed hairlut_strand_find_place(const hairlut_blended *table, const hairlut_row *row, float u)
{
    const hairlut_place place = hairlut_axis_place(table->axis, u);
    const float *p = hairlut_axis_placed_cell(table->axis, row, place) + table->first;
    const hairlut_placed placed = {hairlut_strand_cell(table, row, p, table->nodes->count),
                                   hairlut_quad_load(table->axis->knots + HAIRLUT_KNOT * place.i), place.m};
    return placed;
}

#endif
