/* SPDX-License-Identifier: BSD-3-Clause */
/* The mixture of a strand: four lobes at once, blended over the corners of the parameters at each of four nodes of theta_r and
 * the offset, then between those as in mixture.h. Turns: t0 + sum w_i wrap(t_i - t0), t0 that of the first corner. */
#ifndef HAIRLUT_STRAND_MIXTURE_H
#define HAIRLUT_STRAND_MIXTURE_H

#include "mixture.h"
#include "strand.h"
#include "turns.h"

/* wrap to [-1/2, 1/2) of |d| up to 2^21; adding 3 2^22 rounds to an integer, half of the ties upwards. */
static inline hairlut_quad hairlut_wrap_turns(hairlut_quad d)
{
    const hairlut_quad round = hairlut_quad_all(12582912.0f), half = hairlut_quad_all(0.5f), one = hairlut_quad_all(1.0f);
    const hairlut_quad r = hairlut_quad_sub(d, hairlut_quad_sub(hairlut_quad_add(d, round), round));
    return hairlut_quad_by_sign(hairlut_quad_sub(r, half), r, hairlut_quad_sub(r, one));
}

/* a + t wrap(b - a) */
static inline hairlut_quad hairlut_blend_arcs(hairlut_quad a, hairlut_quad b, hairlut_quad t)
{
    return hairlut_quad_add(a, hairlut_quad_mul(t, hairlut_wrap_turns(hairlut_quad_sub(b, a))));
}

static inline hairlut_quad hairlut_blend_linearly(hairlut_quad a, hairlut_quad b, hairlut_quad t)
{
    const hairlut_quad rest = hairlut_quad_sub(hairlut_quad_all(1.0f), t);
    return hairlut_quad_add(hairlut_quad_mul(rest, a), hairlut_quad_mul(t, b));
}

/* Four lobes at the four nodes of theta_r and the offset around a place: at the lower and the upper theta_r of the lower offset,
 * then of the upper one. Turns in units of 2 pi / 2^32. */
typedef struct hairlut_four_nodes {
    hairlut_quad share[4], turn[4];
} hairlut_four_nodes;

/* Blended over the corners of the parameters; `four` is that of the first, at the first node, and the others are so many fours
 * from there. */
HAIRLUT_INLINE hairlut_four_nodes hairlut_blend_fours(const hairlut_strands *strands, const hairlut_corners *corners,
                                                      const hairlut_four *four, const ptrdiff_t node[4])
{
    hairlut_four_nodes blend;
    hairlut_turns first[4];
    HAIRLUT_UNROLLED
    for (int l = 0; l < 4; ++l) {
        first[l] = hairlut_turns_load(four[node[l]].turn);
        blend.share[l] = hairlut_quad_mul(corners->weight[0], hairlut_quad_anywhere(four[node[l]].share));
        blend.turn[l] = hairlut_turns_float(first[l]);
    }
    for (int c = 1; c < strands->mixture.count; ++c) {
        const hairlut_four *here = four + strands->mixture.corner[c];
        const hairlut_quad weight = corners->weight[c];
        HAIRLUT_UNROLLED
        for (int l = 0; l < 4; ++l)
            blend.share[l] =
                hairlut_quad_add(blend.share[l], hairlut_quad_mul(weight, hairlut_quad_anywhere(here[node[l]].share)));
        if (!strands->turns_vary)
            continue;
        HAIRLUT_UNROLLED
        for (int l = 0; l < 4; ++l) {
            const hairlut_turns arc = hairlut_turns_sub(hairlut_turns_load(here[node[l]].turn), first[l]);
            blend.turn[l] = hairlut_quad_add(blend.turn[l], hairlut_quad_mul(weight, hairlut_turns_float(arc)));
        }
    }
    return blend;
}

/* The shares and turns of the model at the strand; NaN in h counts as -1. */
HAIRLUT_INLINE void hairlut_strand_mixture(const hairlut_model *model, const hairlut_corners *corners, float theta_r,
                                           float h, hairlut_mix *mix)
{
    const hairlut_mixture *m = &model->mixture;
    const hairlut_strands *strands = model->strands;
    const hairlut_node row = hairlut_mixture_node(m->theta_r, m->rows, theta_r);
    const hairlut_node column = hairlut_mixture_node(m->arc, m->columns, hairlut_asin(m->mirrored ? fabsf(h) : h));
    const ptrdiff_t beside = strands->four_count, above = beside * m->columns;
    const ptrdiff_t up = m->rows > 1 ? above : 0, along = m->columns > 1 ? beside : 0, node[4] = {0, up, along, up + along};
    const hairlut_quad t = hairlut_quad_all(row.t), s = hairlut_quad_all(column.t),
                       unit = hairlut_quad_all(2.32830644e-10f); /* 2^-32 */
    const hairlut_four *four = strands->fours + corners->node * strands->mixture.pitch + row.j * above + column.j * beside;
    for (int q = 0; q < strands->four_count; ++q, ++four) {
        const hairlut_four_nodes b = hairlut_blend_fours(strands, corners, four, node);
        const hairlut_quad share = hairlut_blend_linearly(hairlut_blend_linearly(b.share[0], b.share[1], t),
                                                          hairlut_blend_linearly(b.share[2], b.share[3], t), s);
        hairlut_quad turn[4];
        for (int l = 0; l < 4; ++l)
            turn[l] = hairlut_quad_mul(unit, b.turn[l]);
        const hairlut_quad arc =
            hairlut_blend_arcs(hairlut_blend_arcs(turn[0], turn[1], t), hairlut_blend_arcs(turn[2], turn[3], t), s);
        hairlut_quad_store(mix->share + 4 * q, share);
        hairlut_quad_store(mix->turn + 4 * q, hairlut_quad_mul(hairlut_quad_all(hairlut_two_pi), hairlut_wrap_turns(arc)));
    }
}

#endif
