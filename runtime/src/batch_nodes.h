/* SPDX-License-Identifier: BSD-3-Clause */
/* Places among nodes for a vector: nodes.h, operation by operation. */
#ifndef HAIRLUT_BATCH_NODES_H
#define HAIRLUT_BATCH_NODES_H

#include "batch_axis.h"
#include "nodes.h"

enum { COUNTED_NODES = 64 }; /* up to so many are counted for whole vectors, more are searched for single samples */

/* hairlut_nodes_place */
static inline real find_node(const hairlut_nodes *nodes, real x, real *t)
{
    float at[LANES];
    int place[LANES];
    whole j = iall(0);
    real node[4];
    *t = all(0.0f);
    if (nodes->count == 1)
        return *t;
    if (nodes->count <= COUNTED_NODES) {
        HAIRLUT_UNROLLED
        for (int k = 0; k < nodes->count - 2; ++k)
            j = iadd(j, iwhere(at_least(x, all(nodes->inner[k])), iall(1)));
    } else {
        store(at, x);
        for (int l = 0; l < LANES; ++l)
            place[l] = hairlut_nodes_place(nodes, at[l]).j;
        j = iload(place);
    }
    istore(place, iadd(j, j));
    gather4(nodes->pairs, place, node);
    *t = clamp(mul(sub(x, node[0]), node[1]), all(0.0f), all(1.0f));
    return converted(j);
}

#endif
