/* SPDX-License-Identifier: BSD-3-Clause */
/* The strands of a block: corners.h, operation by operation. */
#ifndef HAIRLUT_BATCH_STRAND_H
#define HAIRLUT_BATCH_STRAND_H

#include "batch_nodes.h"
#include "corners.h"

/* The parameters of a block: parameter p's from values + p * stride on. NULL: the standard ones, which nothing here reads. */
typedef struct given_strands {
    const float *values;
    size_t stride;
} given_strands;

/* Where a vector of strands lies on a grid: the number of the first corner, which a float counts exactly, and on each axis the weight
 * of the upper node. */
typedef struct strand_place {
    real node, t[HAIRLUT_MAX_AXES];
} strand_place;

/* Of strands s .. s+LANES-1 */
static inline void find_strands(const hairlut_strands *strands, int number, given_strands given, size_t s,
                                strand_place *place)
{
    const hairlut_node_grid *grid = &strands->grids[number];
    place->node = all(0.0f);
    for (int a = 0; a < grid->axis_count; ++a) {
        const hairlut_scale *scale = grid->scale[a];
        const int p = scale->parameter;
        const real x = load(given.values + (size_t)p * given.stride + s);
        const real inside = clamp(x, all(strands->least[p]), all(strands->most[p]));
        const real j = find_node(&scale->nodes, inside, &place->t[a]);
        place->node = add(place->node, mul(j, all((float)grid->stride[a])));
    }
}

/* The weights of all corners: hairlut_corners_of */
HAIRLUT_INLINE void weigh_corners(const real *t, int axes, real weight[HAIRLUT_CORNERS])
{
    weight[0] = all(1.0f);
    for (int a = 0; a < axes; ++a)
        for (int count = 1 << a, k = 0; k < count; ++k) {
            weight[count + k] = mul(weight[k], t[a]);
            weight[k] = mul(weight[k], sub(all(1.0f), t[a]));
        }
}

/* Whether none of the parameters of strands s .. s+LANES-1 is NaN; true without parameters */
static inline mask known_strands(const hairlut_strands *strands, given_strands given, size_t s)
{
    mask known = numbers(all(0.0f), all(0.0f));
    for (int p = 0; given.values && p < strands->parameter_count; ++p) {
        const real x = load(given.values + (size_t)p * given.stride + s);
        known = both(known, numbers(x, x));
    }
    return known;
}

/* Places of all strands of a block on one grid. */
typedef struct block_places {
    int grid; /* its number; -1: none yet */
    int node[ROOM];
    float t[HAIRLUT_MAX_AXES][ROOM];
} block_places;

static inline void place_block(const hairlut_strands *strands, int number, given_strands given, size_t n,
                               block_places *block)
{
    block->grid = number;
    for (size_t s = 0; s < n; s += LANES) {
        strand_place place;
        find_strands(strands, number, given, s, &place);
        istore(block->node + s, truncated(place.node));
        for (int a = 0; a < strands->grids[number].axis_count; ++a)
            store(block->t[a] + s, place.t[a]);
    }
}

#endif
