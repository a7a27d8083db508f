/* SPDX-License-Identifier: BSD-3-Clause */
/* A place among the nodes of an axis of a mixture or of a parameter. */
#ifndef HAIRLUT_NODES_H
#define HAIRLUT_NODES_H

#include "axis.h"
#include "oct.h"

/* Where x lies: beyond an end, at that end; NaN counts as the first node. Eights of nodes are halved until a few are left, which
 * are counted: a count has no branch that depends on x. */
HAIRLUT_INLINE hairlut_node hairlut_nodes_place(const hairlut_nodes *nodes, float x)
{
    enum { COUNTED_EIGHTS = 8 };
    const float *inner = nodes->inner, inside = hairlut_min(nodes->last, x); /* not infinity, nor what fills up eights */
    const hairlut_oct all = hairlut_oct_all(inside);
    int eights = nodes->eights;
    while (eights > COUNTED_EIGHTS) {
        const int half = eights / 2, beyond = inner[8 * half - 1] <= inside;
        inner += beyond ? 8 * half : 0;
        eights = beyond ? eights - half : half;
    }
    int j = (int)(inner - nodes->inner);
    for (int e = 0; e < eights; ++e)
        j += (int)hairlut_oct_count(hairlut_oct_load(inner + 8 * e), all);
    const float *pair = nodes->pairs + 2 * j;
    const hairlut_node place = {j, hairlut_clamp((x - pair[0]) * pair[1], hairlut_constant(0.0f), hairlut_constant(1.0f))};
    return place;
}

#endif
