/* SPDX-License-Identifier: BSD-3-Clause */
/* The mixture of a strand: four lobes at once, blended over the corners of the parameters at each of four nodes of theta_r and
 * the offset, then between those as in mixture.h. Turns: t0 + sum w_i wrap(t_i - t0), t0 that of the first corner. */
#ifndef HAIRLUT_STRAND_MIXTURE_H
#define HAIRLUT_STRAND_MIXTURE_H

#include "mixture.h"
#include "strand.h"
#include "turns.h"

/* Four lobes at one node of theta_r and the offset; turns in units of 2 pi. */
typedef struct hairlut_four_blend {
    hairlut_quad share, turn;
} hairlut_four_blend;

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

/* Over the corners: `four` is that of the parameters' node 0, pitch the fours from there to the next node. */
HAIRLUT_INLINE hairlut_four_blend hairlut_blend_four(const hairlut_four *four, ptrdiff_t pitch,
                                                     const hairlut_corners *corners)
{
    const hairlut_four *low = four + corners->node[0] * pitch;
    const hairlut_turns turn = hairlut_turns_load(low->turn);
    hairlut_quad share = hairlut_quad_mul(hairlut_quad_all(corners->weight[0]), hairlut_quad_load(low->share));
    hairlut_quad arc = hairlut_turns_float(turn);
    for (int c = 1; c < corners->count; ++c) {
        const hairlut_four *here = four + corners->node[c] * pitch;
        const hairlut_quad weight = hairlut_quad_all(corners->weight[c]);
        const hairlut_quad step = hairlut_turns_float(hairlut_turns_sub(hairlut_turns_load(here->turn), turn));
        share = hairlut_quad_add(share, hairlut_quad_mul(weight, hairlut_quad_load(here->share)));
        arc = hairlut_quad_add(arc, hairlut_quad_mul(weight, step));
    }
    const hairlut_four_blend blend = {share, hairlut_quad_mul(hairlut_quad_all(2.32830644e-10f), arc)}; /* 2^-32 */
    return blend;
}

/* The shares and turns of the model at the strand; NaN in h counts as -1. */
static inline void hairlut_strand_mixture(const hairlut_model *model, const hairlut_corners *corners, float theta_r, float h,
                                          hairlut_mix *mix)
{
    const hairlut_mixture *m = &model->mixture;
    const hairlut_strands *strands = model->strands;
    const hairlut_row row = hairlut_mixture_row(m->theta_r, m->rows, theta_r);
    const hairlut_row column = hairlut_mixture_row(m->arc, m->columns, hairlut_asin(m->mirrored ? fabsf(h) : h));
    const ptrdiff_t node = strands->four_count, line = node * m->columns, pitch = line * m->rows;
    const ptrdiff_t above = m->rows > 1 ? line : 0, beside = m->columns > 1 ? node : 0;
    const hairlut_quad t = hairlut_quad_all(row.t), s = hairlut_quad_all(column.t), turn = hairlut_quad_all(hairlut_two_pi);
    const hairlut_four *four = strands->fours + row.j * line + column.j * node;
    for (int q = 0; q < strands->four_count; ++q, ++four) {
        const hairlut_four_blend low = hairlut_blend_four(four, pitch, corners),
                                 low_above = hairlut_blend_four(four + above, pitch, corners),
                                 high = hairlut_blend_four(four + beside, pitch, corners),
                                 high_above = hairlut_blend_four(four + above + beside, pitch, corners);
        const hairlut_quad share = hairlut_blend_linearly(hairlut_blend_linearly(low.share, low_above.share, t),
                                                          hairlut_blend_linearly(high.share, high_above.share, t), s);
        const hairlut_quad arc = hairlut_blend_arcs(hairlut_blend_arcs(low.turn, low_above.turn, t),
                                                    hairlut_blend_arcs(high.turn, high_above.turn, t), s);
        hairlut_quad_store(mix->share + 4 * q, share);
        hairlut_quad_store(mix->turn + 4 * q, hairlut_quad_mul(turn, hairlut_wrap_turns(arc)));
    }
}

#endif
