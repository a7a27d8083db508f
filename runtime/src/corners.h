/* SPDX-License-Identifier: BSD-3-Clause */
/* The nodes around a strand's parameters, and their multilinear weights. */
#ifndef HAIRLUT_CORNERS_H
#define HAIRLUT_CORNERS_H

#include "axis.h"
#include "strand.h"

/* Where a value lies among the nodes of a scale: outside, at its end; NaN counts as the first node. */
HAIRLUT_INLINE hairlut_node hairlut_scale_place(const hairlut_scale *scale, float x)
{
    int j = 0;
    for (int q = 0; q < scale->quads; ++q)
        j += (int)hairlut_quad_count(hairlut_quad_anywhere(scale->inner + 4 * q), hairlut_quad_all(x));
    const float *node = scale->nodes + 2 * j;
    const hairlut_node place = {j, hairlut_clamp((x - node[0]) * node[1], hairlut_constant(0.0f), hairlut_constant(1.0f))};
    return place;
}

/* The corners around a strand, from its places on the scales; `axes` is how many the grid has. */
HAIRLUT_INLINE void hairlut_corners_of(const hairlut_node_grid *grid, const hairlut_node *places, int axes,
                                       hairlut_corners *corners)
{
    int node = 0;
    corners->weight[0] = hairlut_quad_all(1.0f);
    corners->weight[1] = hairlut_quad_all(0.0f); /* without axes: as if it had one */
    for (int a = 0; a < axes; ++a) {
        const hairlut_node place = places[grid->scale[a]];
        const hairlut_quad upper = hairlut_quad_all(place.t), lower = hairlut_quad_sub(hairlut_quad_all(1.0f), upper);
        const int count = 1 << a;
        node += grid->stride[a] * place.j;
        HAIRLUT_UNROLLED
        for (int c = 0; c < count; ++c) {
            corners->weight[count + c] = hairlut_quad_mul(corners->weight[c], upper);
            corners->weight[c] = hairlut_quad_mul(corners->weight[c], lower);
        }
    }
    corners->node = node;
}

#endif
