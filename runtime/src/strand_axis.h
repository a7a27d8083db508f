/* SPDX-License-Identifier: BSD-3-Clause */
/* A table at a strand: axis.h, of rows and cells that are blended over the corners of the parameters first.
 *
 * A function whose last argument is n reads n corners. */
#ifndef HAIRLUT_STRAND_AXIS_H
#define HAIRLUT_STRAND_AXIS_H

#include "axis.h"
#include "corners.h"
#include "oct.h"

/* The search of an angle in a table at a strand, in steps, so that those of several tables run side by side: their loads overlap.
 * Filled field by field, as what is read again at another width has to wait for. */
typedef struct hairlut_strand_search {
    const hairlut_strand_table *table;
    const hairlut_row *row; /* of theta_r */
    const float *weight;    /* of the corners */
    ptrdiff_t first;        /* floats from the first node's arrays to those of the first corner */
    const float *groups;    /* of the row, in the first corner's arrays */
    float x, given;
    unsigned cell; /* as far as it is known, counted from the low end */
} hairlut_strand_search;

HAIRLUT_INLINE void hairlut_strand_start(hairlut_strand_search *s, const hairlut_strand_table *table,
                                         const hairlut_row *rows, const hairlut_corners *corners)
{
    const hairlut_corners *mine = &corners[table->nodes.grid];
    s->table = table;
    s->row = &rows[table->grid];
    s->weight = mine->weight;
    s->first = mine->node * table->pitch;
}

/* Eight floats that stand at p in the arrays of the first corner */
HAIRLUT_INLINE hairlut_oct hairlut_blend_oct(const hairlut_strand_search *s, const float *p, int n)
{
    hairlut_oct sum = hairlut_oct_mul(hairlut_oct_all(s->weight[0]), hairlut_oct_load(p));
    if (n == 2)
        return hairlut_oct_add(sum, hairlut_oct_mul(hairlut_oct_all(s->weight[1]), hairlut_oct_load(p + s->table->second)));
    for (int c = 1; c < n; ++c)
        sum = hairlut_oct_add(
            sum, hairlut_oct_mul(hairlut_oct_all(s->weight[c]), hairlut_oct_load(p + s->table->nodes.corner[c])));
    return sum;
}

/* A bit for each of the eight blended texels of a small table's group that is at most x; the changes to the row above stand behind
 * them, and are 0 where all rows are alike. */
HAIRLUT_INLINE unsigned hairlut_strand_mask(const hairlut_strand_search *s, const float *group, hairlut_oct t, hairlut_oct x,
                                            int n)
{
    const hairlut_oct from = hairlut_blend_oct(s, group, n);
    if (s->table->alike)
        return hairlut_oct_mask(from, x);
    const hairlut_oct change = hairlut_blend_oct(s, group + HAIRLUT_SMALL_GROUP, n);
    return hairlut_oct_mask(hairlut_oct_add(from, hairlut_oct_mul(t, change)), x);
}

/* hairlut_axis_search_small of a row of up to four groups, without waiting for the first of its two counts: the last texel of a group
 * is the end of its block. */
HAIRLUT_INLINE unsigned hairlut_strand_search_row(const hairlut_strand_search *s, const float *groups, int count,
                                                  hairlut_oct t, hairlut_oct x, int n)
{
    unsigned bits = hairlut_strand_mask(s, groups, t, x, n);
    if (count > 1)
        bits |= hairlut_strand_mask(s, groups + HAIRLUT_LINE, t, x, n) << 8;
    for (int g = 2; g < count; ++g)
        bits |= hairlut_strand_mask(s, groups + g * HAIRLUT_LINE, t, x, n) << 8 * g;
    const unsigned before =
        ((bits >> 7 & 0x01010101u) * 0x08080808u) >> 24; /* cells of the blocks whose ends are at most x */
    return before + hairlut_count_bits(bits >> before & 255);
}

/* Eight blended texels from p on, blended with those of the row above. */
HAIRLUT_INLINE hairlut_oct hairlut_strand_texels(const hairlut_strand_search *s, const float *p, hairlut_oct t)
{
    const hairlut_oct from = hairlut_blend_oct(s, p, s->table->nodes.count),
                      to = hairlut_blend_oct(s, p + s->table->stride, s->table->nodes.count);
    return hairlut_oct_add(from, hairlut_oct_mul(t, hairlut_oct_sub(to, from)));
}

/* hairlut_axis_count_large */
static HAIRLUT_APART unsigned hairlut_strand_count_large(const hairlut_strand_search *s, const float *group, hairlut_oct t,
                                                         hairlut_oct x)
{
    return hairlut_oct_count(hairlut_strand_texels(s, group, t), x) +
           hairlut_oct_count(hairlut_strand_texels(s, group + 8, t), x);
}

/* hairlut_halve */
static HAIRLUT_APART unsigned hairlut_strand_halve(const hairlut_strand_search *s, const float *groups, hairlut_oct t)
{
    unsigned first = 0;
    for (unsigned part = (unsigned)s->table->axis->step / 2; part >= HAIRLUT_GROUP; part /= 2) {
        const float *low_end = groups + first + part - 8; /* its last float is that of the upper half */
        const hairlut_quad last = hairlut_oct_high(hairlut_strand_texels(s, low_end, t));
        first += hairlut_quad_last(last) <= s->x ? part : 0;
    }
    return first;
}

/* hairlut_axis_blend of blended cells: the two rows of a cell stand side by side, and so do their weights. */
HAIRLUT_INLINE hairlut_quad hairlut_strand_cell(const hairlut_strand_search *s, const float *p, int n)
{
    const hairlut_oct rows = hairlut_oct_mul(hairlut_oct_of(s->row->below, s->row->above), hairlut_blend_oct(s, p, n));
    return hairlut_quad_add(hairlut_oct_low(rows), hairlut_oct_high(rows));
}

/* Finds the block of cells of an angle; in a table of few columns, the cell. */
HAIRLUT_INLINE void hairlut_strand_begin_search(hairlut_strand_search *s, float given, int n)
{
    const hairlut_strand_table *table = s->table;
    const float x = hairlut_clamp(given, table->low, table->high);
    const float *groups = table->rows + s->first + (unsigned)s->row->j * (unsigned)table->stride;
    const hairlut_oct all = hairlut_oct_all(x), t = hairlut_oct_of(s->row->t, s->row->t);
    s->groups = groups;
    s->x = x;
    s->given = given;
    if (table->groups > 0)
        s->cell = hairlut_strand_search_row(s, groups + HAIRLUT_LINE, table->groups, t, all, n);
    else if (table->small)
        s->cell = HAIRLUT_SMALL_GROUP * hairlut_count_bits(hairlut_strand_mask(s, groups, t, all, n));
    else
        s->cell = (unsigned)table->axis->step * hairlut_strand_count_large(s, groups, t, all);
}

/* Finds the cell. */
HAIRLUT_INLINE void hairlut_strand_end_search(hairlut_strand_search *s, int n)
{
    const hairlut_oct all = hairlut_oct_all(s->x), t = hairlut_oct_of(s->row->t, s->row->t);
    const float *groups = s->groups + HAIRLUT_LINE;
    unsigned cell = s->cell;
    if (s->table->groups > 0)
        return;
    if (s->table->small) {
        cell += hairlut_count_bits(hairlut_strand_mask(s, groups + 2 * (size_t)cell, t, all, n));
    } else {
        cell += hairlut_strand_halve(s, groups + cell, t);
        cell += hairlut_strand_count_large(s, groups + cell, t, all);
    }
    s->cell = cell;
}

/* hairlut_axis_find from the search on */
HAIRLUT_INLINE void hairlut_strand_read(const hairlut_strand_search *s, hairlut_found *found, int n)
{
    const hairlut_link *link = s->table->links + s->cell;
    const float *p = s->table->cells + s->first + (link->offset + HAIRLUT_CELL * (unsigned)s->row->j);
    found->x = s->x;
    found->given = s->given;
    found->h = link->h;
    found->cell = hairlut_strand_cell(s, p, n);
}

/* hairlut_axis_find_place */
HAIRLUT_INLINE hairlut_placed hairlut_strand_find_place(const hairlut_strand_search *s, float u, int n)
{
    const hairlut_axis *axis = s->table->axis;
    const hairlut_place place = hairlut_axis_place(axis, u);
    const float *p = hairlut_axis_placed_cell(axis, s->row, place) + (s->table->pitch + s->first);
    const hairlut_placed placed = {hairlut_strand_cell(s, p, n), hairlut_quad_load(axis->knots + HAIRLUT_KNOT * place.i),
                                   place.m};
    return placed;
}

#endif
