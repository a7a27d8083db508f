/* SPDX-License-Identifier: BSD-3-Clause */
/* A table at a strand: axis.h, of rows and cells that are blended over the corners of the parameters first.
 *
 * A function whose last argument is n reads n corners. */
#ifndef HAIRLUT_STRAND_AXIS_H
#define HAIRLUT_STRAND_AXIS_H

#include "axis.h"
#include "corners.h"

/* A table at a strand. */
typedef struct hairlut_blended {
    const hairlut_axis *axis;
    const hairlut_spacing *nodes;
    const float *weight; /* of the corners */
    ptrdiff_t first;     /* floats from the axis' own arrays to those of the first corner */
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
    hairlut_quad sum = hairlut_quad_mul(hairlut_quad_all(table->weight[0]), hairlut_quad_load(p));
    for (int c = 1; c < n; ++c)
        sum = hairlut_quad_add(
            sum, hairlut_quad_mul(hairlut_quad_all(table->weight[c]), hairlut_quad_load(p + table->nodes->corner[c])));
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

/* A search of an angle, in steps, so that those of several tables run side by side: their loads overlap. */
typedef struct hairlut_strand_search {
    hairlut_blended table;
    const hairlut_row *row;
    const float *groups; /* of the row, in the first corner's arrays */
    float x, given;
    unsigned cell; /* as far as it is known, counted from the low end */
    hairlut_found *found;
} hairlut_strand_search;

/* The block of cells. Of at most five small ones, four texels are the ends of all but the last. */
HAIRLUT_INLINE unsigned hairlut_strand_block(const hairlut_strand_search *s, int n)
{
    const hairlut_axis *axis = s->table.axis;
    const hairlut_quad t = s->row->t, x = hairlut_quad_all(s->x);
    if (axis->columns <= 5 * HAIRLUT_SMALL_GROUP + 1)
        return HAIRLUT_SMALL_GROUP * hairlut_quad_count(hairlut_strand_texels(&s->table, s->groups, t, 1, n), x);
    if (HAIRLUT_IS_SMALL(axis->columns))
        return HAIRLUT_SMALL_GROUP * hairlut_strand_count(&s->table, s->groups, t, x, HAIRLUT_SMALL_GROUP, n);
    return (unsigned)axis->step * hairlut_strand_count(&s->table, s->groups, t, x, HAIRLUT_GROUP, n);
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

/* The cell, from its block on. */
HAIRLUT_INLINE unsigned hairlut_strand_cell_of(const hairlut_strand_search *s, int n)
{
    const hairlut_quad t = s->row->t, x = hairlut_quad_all(s->x);
    const float *groups = s->groups + HAIRLUT_LINE;
    if (HAIRLUT_IS_SMALL(s->table.axis->columns))
        return s->cell + hairlut_strand_count(&s->table, groups + 2 * (size_t)s->cell, t, x, HAIRLUT_SMALL_GROUP, n);
    const unsigned first = s->cell + hairlut_strand_halve(&s->table, groups + s->cell, t, s->x);
    return first + hairlut_strand_count(&s->table, groups + first, t, x, HAIRLUT_GROUP, n);
}

/* hairlut_axis_blend of blended cells */
HAIRLUT_INLINE hairlut_quad hairlut_strand_cell(const hairlut_blended *table, const hairlut_row *row, const float *p, int n)
{
    return hairlut_quad_add(hairlut_quad_mul(row->below, hairlut_blend_quad(table, p, n)),
                            hairlut_quad_mul(row->above, hairlut_blend_quad(table, p + HAIRLUT_CELL, n)));
}

/* hairlut_axis_find from the search on */
HAIRLUT_INLINE hairlut_found hairlut_strand_read(const hairlut_strand_search *s, int n)
{
    const hairlut_axis *axis = s->table.axis;
    const hairlut_link *link = axis->links + s->cell;
    const float *p = axis->ends[0] + s->table.first + (link->offset + HAIRLUT_CELL * (unsigned)s->row->j);
    const hairlut_found found = {s->x, s->given, link->h, hairlut_strand_cell(&s->table, s->row, p, n)};
    return found;
}

HAIRLUT_INLINE void hairlut_strand_begin_search(hairlut_strand_search *s, hairlut_blended table, const hairlut_row *row,
                                                float given, hairlut_found *found, int n)
{
    s->table = table;
    s->row = row;
    s->groups = table.axis->rows + table.first + (unsigned)row->j * (unsigned)table.axis->stride;
    s->x = hairlut_axis_inside(table.axis, given);
    s->given = given;
    s->found = found;
    s->cell = hairlut_strand_block(s, n > 0 ? n : table.nodes->count);
}

/* The rest of all that were begun, to their places. */
HAIRLUT_INLINE void hairlut_strand_end_searches(hairlut_strand_search *search, int count, int n)
{
    for (hairlut_strand_search *s = search; s < search + count; ++s)
        s->cell = hairlut_strand_cell_of(s, n > 0 ? n : s->table.nodes->count);
    for (const hairlut_strand_search *s = search; s < search + count; ++s)
        *s->found = hairlut_strand_read(s, n > 0 ? n : s->table.nodes->count);
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
