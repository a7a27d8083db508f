/* SPDX-License-Identifier: BSD-3-Clause */
/* A table at a strand: axis.h, of rows and cells that are blended over the corners of the parameters first. */
#ifndef HAIRLUT_STRAND_AXIS_H
#define HAIRLUT_STRAND_AXIS_H

#include "axis.h"
#include "strand.h"

/* A table, and where a strand's nodes of it are. */
typedef struct hairlut_blended {
    const hairlut_axis *axis;
    const hairlut_corners *corners;
    ptrdiff_t pitch;
} hairlut_blended;

/* Floats from the axis' own arrays to those of a corner's node */
static inline ptrdiff_t hairlut_corner_offset(const hairlut_blended *table, int c)
{
    return (table->corners->node[c] + 1) * table->pitch;
}

static inline hairlut_quad hairlut_blend_quad(const hairlut_blended *table, const float *p)
{
    hairlut_quad sum = hairlut_quad_all(0.0f);
    for (int c = 0; c < table->corners->count; ++c)
        sum = hairlut_quad_add(sum, hairlut_quad_mul(hairlut_quad_all(table->corners->weight[c]),
                                                     hairlut_quad_load(p + hairlut_corner_offset(table, c))));
    return sum;
}

static inline float hairlut_blend_float(const hairlut_blended *table, const float *p)
{
    float sum = 0.0f;
    for (int c = 0; c < table->corners->count; ++c)
        sum += table->corners->weight[c] * p[hairlut_corner_offset(table, c)];
    return sum;
}

/* hairlut_axis_count of a blended group */
HAIRLUT_INLINE int hairlut_strand_count(const hairlut_blended *table, const float *group, float t, float x)
{
    const int small = HAIRLUT_IS_SMALL(table->axis->columns), n = small ? HAIRLUT_SMALL_GROUP : HAIRLUT_GROUP;
    const float *above = group + (small ? HAIRLUT_SMALL_GROUP : table->axis->stride);
    float from[HAIRLUT_GROUP], to[HAIRLUT_GROUP];
    for (int k = 0; k < n; k += 4) {
        hairlut_quad_store(from + k, hairlut_blend_quad(table, group + k));
        hairlut_quad_store(to + k, hairlut_blend_quad(table, above + k));
    }
    return hairlut_count(from, to, t, x, n);
}

/* hairlut_halve of blended rows */
static inline int hairlut_strand_halve(const hairlut_blended *table, const float *groups, float t, float x)
{
    int first = 0;
    for (int n = table->axis->step / 2; n >= HAIRLUT_GROUP; n /= 2) {
        const float *low_end = groups + first + n - 1; /* of the upper half */
        const float from = hairlut_blend_float(table, low_end),
                    to = hairlut_blend_float(table, low_end + table->axis->stride);
        first += from + t * (to - from) <= x ? n : 0;
    }
    return first;
}

/* A search as far as the first group takes it, as hairlut_search. */
typedef struct hairlut_strand_search {
    hairlut_blended table;
    hairlut_row row;
    float x;
    int first;
} hairlut_strand_search;

HAIRLUT_INLINE hairlut_strand_search hairlut_strand_begin_search(hairlut_blended table, hairlut_row row, float x)
{
    const hairlut_axis *axis = table.axis;
    hairlut_strand_search search = {table, row, hairlut_axis_inside(axis, x), 0};
    const float *rows = axis->rows + (ptrdiff_t)row.j * axis->stride;
    search.first = axis->step * hairlut_strand_count(&table, rows, row.t, search.x);
    return search;
}

static inline int hairlut_strand_end_search(const hairlut_strand_search *search)
{
    const hairlut_axis *axis = search->table.axis;
    const float t = search->row.t, *groups = axis->rows + (ptrdiff_t)search->row.j * axis->stride + HAIRLUT_LINE;
    int cell = search->first;
    if (!HAIRLUT_IS_SMALL(axis->columns))
        cell += hairlut_strand_halve(&search->table, groups + cell, t, search->x);
    return cell + hairlut_strand_count(&search->table, groups + HAIRLUT_ROW_FLOATS(axis->columns) * cell, t, search->x);
}

/* hairlut_axis_cell of blended cells */
static inline hairlut_quad hairlut_strand_cell(const hairlut_blended *table, int j, hairlut_quad below, hairlut_quad above,
                                               int i, int high)
{
    const unsigned column = (unsigned)i * (unsigned)table->axis->pitch;
    const float *p = table->axis->ends[high] + column + (unsigned)j * HAIRLUT_CELL;
    return hairlut_quad_add(hairlut_quad_mul(below, hairlut_blend_quad(table, p)),
                            hairlut_quad_mul(above, hairlut_blend_quad(table, p + HAIRLUT_CELL)));
}

/* hairlut_axis_find */
static inline hairlut_found hairlut_strand_find(const hairlut_strand_search *search)
{
    hairlut_found found;
    const hairlut_axis *axis = search->table.axis;
    const int i = hairlut_axis_nearer(axis, hairlut_strand_end_search(search), &found.high);
    const float scale = found.high ? -HAIRLUT_SCALE : HAIRLUT_SCALE, t = search->row.t;
    found.cell = hairlut_strand_cell(&search->table, search->row.j, hairlut_quad_all(scale * (1.0f - t)),
                                     hairlut_quad_all(scale * t), i, found.high);
    found.x = scale * search->x;
    found.knot = axis->knots + HAIRLUT_KNOT * i;
    return found;
}

/* hairlut_axis_find_place */
static inline hairlut_placed hairlut_strand_find_place(const hairlut_blended *table, hairlut_row row, float u)
{
    const hairlut_place place = hairlut_axis_place(table->axis, u);
    const hairlut_quad t = hairlut_quad_all(row.t), below = hairlut_quad_sub(hairlut_quad_all(1.0f), t);
    const hairlut_placed placed = {hairlut_strand_cell(table, row.j, below, t, place.i, place.high),
                                   hairlut_quad_load(table->axis->knots + HAIRLUT_KNOT * place.i), place.m};
    return placed;
}

#endif
