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
    float at[LANES], place[LANES];
    real j = all(0.0f);
    *t = all(0.0f);
    if (nodes->count == 1)
        return j;
    if (nodes->count <= COUNTED_NODES) {
        for (int k = 0; k + 2 < nodes->count; ++k)
            j = add(j, choose(at_least(x, all(nodes->inner[k])), all(1.0f), all(0.0f)));
    } else {
        store(at, x);
        for (int l = 0; l < LANES; ++l)
            place[l] = (float)hairlut_nodes_place(nodes, at[l]).j;
        j = load(place);
    }
    int offset[LANES];
    real node[4];
    istore(offset, truncated(add(j, j)));
    gather4(nodes->pairs, offset, node);
    *t = clamp(mul(sub(x, node[0]), node[1]), all(0.0f), all(1.0f));
    return j;
}

#endif
