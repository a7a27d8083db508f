/* SPDX-License-Identifier: BSD-3-Clause */
/* The nodes around a strand's parameters, and their multilinear weights. */
#ifndef HAIRLUT_CORNERS_H
#define HAIRLUT_CORNERS_H

#include "axis.h"
#include "strand.h"

/* Where a value lies among the nodes of a scale: outside, at its end; NaN counts as the first node. */
static inline hairlut_row hairlut_scale_place(const hairlut_scale *scale, float x)
{
    hairlut_tally tally = hairlut_tally_zero();
    for (int q = 0; q < scale->quads; ++q)
        tally = hairlut_tally_at_most(tally, hairlut_quad_load(scale->inner + 4 * q), x);
    const int j = hairlut_tally_sum(tally);
    const float *node = scale->nodes + 2 * j;
    const hairlut_row row = {j, hairlut_clamp((x - node[0]) * node[1], 0.0f, 1.0f)};
    return row;
}

/* The corners of a grid of nodes, from the places on its scales. Two for each axis: of each corner that there is, one keeps the
 * lower node, and one takes the upper. */
static inline void hairlut_corners_of(const hairlut_strands *strands, const hairlut_node_grid *grid,
                                      const hairlut_row *places, hairlut_corners *corners)
{
    int count = 1;
    corners->node[0] = 0;
    corners->weight[0] = 1.0f;
    for (int a = 0; a < grid->axis_count; ++a) {
        const hairlut_row place = places[grid->scale[a]];
        const int nodes = strands->scales[grid->scale[a]].count;
        for (int c = 0; c < count; ++c) {
            const int node = corners->node[c] * nodes + place.j;
            const float weight = corners->weight[c];
            corners->node[c] = node;
            corners->weight[c] = weight * (1.0f - place.t);
            corners->node[count + c] = node + 1;
            corners->weight[count + c] = weight * place.t;
        }
        count *= 2;
    }
    corners->count = count;
}

#endif
