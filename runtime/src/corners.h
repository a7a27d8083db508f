/* SPDX-License-Identifier: BSD-3-Clause */
/* The nodes around a strand's parameters, and their multilinear weights. */
#ifndef HAIRLUT_CORNERS_H
#define HAIRLUT_CORNERS_H

#include "nodes.h"
#include "strand.h"

/* The corners around a strand, from its places on the scales; `axes` is how many the grid has. */
HAIRLUT_INLINE void hairlut_corners_of(const hairlut_node_grid *grid, const hairlut_node *places, int axes,
                                       hairlut_corners *corners)
{
    int node = 0;
    corners->weight[0] = 1.0f;
    corners->weight[1] = 0.0f; /* without axes: as if it had one */
    for (int a = 0; a < axes; ++a) {
        const hairlut_node place = places[grid->scale[a]];
        const float upper = place.t, lower = 1.0f - place.t;
        const int count = 1 << a;
        node += grid->stride[a] * place.j;
        for (int c = 0; c < count; ++c) {
            corners->weight[count + c] = corners->weight[c] * upper;
            corners->weight[c] *= lower;
        }
    }
    corners->node = node;
}

#endif
