/* SPDX-License-Identifier: BSD-3-Clause */
/* The nodes around a strand's parameters, and their multilinear weights. */
#ifndef HAIRLUT_CORNERS_H
#define HAIRLUT_CORNERS_H

#include "nodes.h"
#include "strand.h"

/* Where the parameters lie among the nodes of axis a. */
HAIRLUT_INLINE hairlut_node hairlut_corner_place(const hairlut_node_grid *grid, int a, const float *parameters)
{
    return hairlut_nodes_place(&grid->scale[a]->nodes, parameters[grid->scale[a]->parameter]);
}

static HAIRLUT_APART void hairlut_more_corners(const hairlut_node_grid *grid, const float *parameters,
                                               hairlut_corners *corners)
{
    for (int a = 1; a < grid->axis_count; ++a) {
        const hairlut_node place = hairlut_corner_place(grid, a, parameters);
        const int count = 1 << a;
        for (int c = 0; c < count; ++c) {
            corners->weight[count + c] = corners->weight[c] * place.t;
            corners->weight[c] *= 1.0f - place.t;
        }
        corners->node += grid->stride[a] * place.j;
    }
}

/* The corners around a strand's parameters. */
HAIRLUT_INLINE void hairlut_corners_of(const hairlut_node_grid *grid, const float *parameters, hairlut_corners *corners)
{
    hairlut_node first = {0, 0.0f};
    if (grid->axis_count > 0)
        first = hairlut_corner_place(grid, 0, parameters);
    corners->weight[0] = 1.0f - first.t;
    corners->weight[1] = first.t;
    corners->node = first.j;
    if (grid->axis_count > 1)
        hairlut_more_corners(grid, parameters, corners);
}

#endif
