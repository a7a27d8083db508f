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

/* hairlut_count of a blended group of `size` */
HAIRLUT_INLINE int hairlut_strand_count(const hairlut_blended *table, const float *group, hairlut_quad t, float x, int size,
                                        int n)
{
    const int small = size <= HAIRLUT_SMALL_GROUP; /* then the changes to the row above stand behind the texels */
    const float *above = group + (small ? HAIRLUT_SMALL_GROUP : table->axis->stride);
    hairlut_tally tally = hairlut_tally_zero();
    for (int k = 0; k < size; k += 4) {
        const hairlut_quad from = hairlut_blend_quad(table, group + k, n), to = hairlut_blend_quad(table, above + k, n);
        const hairlut_quad change = small ? to : hairlut_quad_sub(to, from);
        tally = hairlut_tally_at_most(tally, hairlut_quad_add(from, hairlut_quad_mul(t, change)), x);
    }
    return hairlut_tally_sum(tally);
}

/* hairlut_halve of blended rows; `groups` are those of the first corner. */
static inline int hairlut_strand_halve(const hairlut_blended *table, const float *groups, hairlut_quad t, float x)
{
    const int stride = table->axis->stride, n = table->nodes->count;
    int first = 0;
    for (int part = table->axis->step / 2; part >= HAIRLUT_GROUP; part /= 2) {
        const float *low_end = groups + first + part - 4; /* its last float is that of the upper half */
        const hairlut_quad from = hairlut_blend_quad(table, low_end, n), to = hairlut_blend_quad(table, low_end + stride, n);
        const hairlut_quad blend = hairlut_quad_add(from, hairlut_quad_mul(t, hairlut_quad_sub(to, from)));
        first += hairlut_quad_last(blend) <= x ? part : 0;
    }
    return first;
}

/* A search, as hairlut_search; x is within the domain. */
typedef struct hairlut_strand_search {
    hairlut_blended table;
    const float *row; /* of the first corner */
    hairlut_row place;
    float x;
    int cell;
} hairlut_strand_search;

/* hairlut_axis_cell of blended cells */
HAIRLUT_INLINE hairlut_quad hairlut_strand_cell(const hairlut_blended *table, int j, hairlut_quad below, hairlut_quad above,
                                                int i, int high, int n)
{
    const unsigned column = (unsigned)i * (unsigned)table->axis->pitch;
    const float *p = table->axis->ends[high] + column + (unsigned)j * HAIRLUT_CELL + table->first;
    return hairlut_quad_add(hairlut_quad_mul(below, hairlut_blend_quad(table, p, n)),
                            hairlut_quad_mul(above, hairlut_blend_quad(table, p + HAIRLUT_CELL, n)));
}

HAIRLUT_INLINE int hairlut_strand_begin(const hairlut_strand_search *search, int n)
{
    const hairlut_axis *axis = search->table.axis;
    const hairlut_quad t = hairlut_quad_all(search->place.t);
    if (axis->columns <= 5 * HAIRLUT_SMALL_GROUP + 1) /* at most five blocks */
        return HAIRLUT_SMALL_GROUP * hairlut_strand_count(&search->table, search->row, t, search->x, 4, n);
    if (HAIRLUT_IS_SMALL(axis->columns))
        return HAIRLUT_SMALL_GROUP * hairlut_strand_count(&search->table, search->row, t, search->x, HAIRLUT_SMALL_GROUP, n);
    return axis->step * hairlut_strand_count(&search->table, search->row, t, search->x, HAIRLUT_GROUP, n);
}

HAIRLUT_INLINE void hairlut_strand_begin_search(hairlut_strand_search *search, const hairlut_blended *table,
                                                hairlut_row place, float x)
{
    search->table = *table;
    search->row = table->axis->rows + table->first + (ptrdiff_t)place.j * table->axis->stride;
    search->place = place;
    search->x = x;
    search->cell = table->nodes->count == 2   ? hairlut_strand_begin(search, 2)
                   : table->nodes->count == 1 ? hairlut_strand_begin(search, 1)
                                              : hairlut_strand_begin(search, table->nodes->count);
}

HAIRLUT_INLINE int hairlut_strand_end(const hairlut_strand_search *search, int n)
{
    const hairlut_axis *axis = search->table.axis;
    const hairlut_quad t = hairlut_quad_all(search->place.t);
    const float *groups = search->row + HAIRLUT_LINE;
    int cell = search->cell;
    if (HAIRLUT_IS_SMALL(axis->columns))
        return cell + hairlut_strand_count(&search->table, groups + 2 * cell, t, search->x, HAIRLUT_SMALL_GROUP, n);
    cell += hairlut_strand_halve(&search->table, groups + cell, t, search->x);
    return cell + hairlut_strand_count(&search->table, groups + cell, t, search->x, HAIRLUT_GROUP, n);
}

HAIRLUT_INLINE void hairlut_strand_end_search(hairlut_strand_search *search)
{
    const int count = search->table.nodes->count;
    search->cell = count == 2   ? hairlut_strand_end(search, 2)
                   : count == 1 ? hairlut_strand_end(search, 1)
                                : hairlut_strand_end(search, count);
}

HAIRLUT_INLINE hairlut_found hairlut_strand_find_of(const hairlut_strand_search *search, int n)
{
    static const float scales[2] = {HAIRLUT_SCALE, -HAIRLUT_SCALE};
    hairlut_found found;
    const hairlut_axis *axis = search->table.axis;
    const int i = hairlut_axis_nearer(axis, search->cell, &found.high);
    const float scale = scales[found.high], t = search->place.t;
    found.cell = hairlut_strand_cell(&search->table, search->place.j, hairlut_quad_all(scale * (1.0f - t)),
                                     hairlut_quad_all(scale * t), i, found.high, n);
    found.x = scale * search->x;
    found.knot = axis->knots + HAIRLUT_KNOT * i;
    return found;
}

HAIRLUT_INLINE hairlut_found hairlut_strand_find(const hairlut_strand_search *search)
{
    const int count = search->table.nodes->count;
    return count == 2   ? hairlut_strand_find_of(search, 2)
           : count == 1 ? hairlut_strand_find_of(search, 1)
                        : hairlut_strand_find_of(search, count);
}

/* hairlut_axis_find_place */
static inline hairlut_placed hairlut_strand_find_place(const hairlut_blended *table, hairlut_row row, float u)
{
    const hairlut_place place = hairlut_axis_place(table->axis, u);
    const hairlut_quad t = hairlut_quad_all(row.t), below = hairlut_quad_sub(hairlut_quad_all(1.0f), t);
    const hairlut_placed placed = {hairlut_strand_cell(table, row.j, below, t, place.i, place.high, table->nodes->count),
                                   hairlut_quad_load(table->axis->knots + HAIRLUT_KNOT * place.i), place.m};
    return placed;
}

#endif
