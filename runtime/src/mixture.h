/* SPDX-License-Identifier: BSD-3-Clause */
/* The mixture at one theta_r and offset: each lobe's weight and turn (luts/FORMAT.md, "Mixture"), four lobes at once.
 *
 * Over parameters, shares and turns are first blended over the corners around the strand: turns as t0 + sum w_i wrap(t_i - t0), t0
 * that of the first corner. Then shares are bilinear in theta_r and asin(offset). A turn is blended along theta_r at both offsets,
 * then between these, each time along the shorter arc: blend(a, b, t) = a + t wrap(b - a), with wrap to [-pi, pi). */
#ifndef HAIRLUT_MIXTURE_H
#define HAIRLUT_MIXTURE_H

#include "angle.h"
#include "corners.h"
#include "turns.h"

/* Shares are multiplied by a power of two if their sum is far from 1, so that none overflows or vanishes. */
static const float hairlut_large_share = 1.26765060e30f /* 2^100 */, hairlut_small_share = 9.09494702e-13f; /* 2^-40 */
static const float hairlut_shrink = 9.09494702e-13f /* 2^-40 */, hairlut_grow = 1.23794004e27f;             /* 2^90 */

/* Turns in floats are in units of 2 pi / 2^32 too. Adding 3 2^54 rounds one to whole turns; a millionth of a turn before that, ties go
 * up. */
static const float hairlut_whole_turns = 5.40431955e16f, hairlut_turn_ties = 1024.0f /* 2^10 */;
static const float hairlut_turn_radians = 1.46291808e-9f /* 2 pi / 2^32 */;

/* The factor that brings the sum of shares, each not negative and not NaN, near 1; 1 for all that people write. */
static inline float hairlut_share_unit(float sum)
{
    return sum > hairlut_large_share ? hairlut_shrink : sum < hairlut_small_share ? hairlut_grow : 1.0f;
}

/* The caller's shares of the lobes; 0 in place of negative ones. */
HAIRLUT_INLINE void hairlut_mixture_given(int count, const float *shares, hairlut_mix *mix)
{
    float sum = 0.0f, finite = 0.0f;
    for (int k = 0; k < count; ++k) {
        finite += shares[k] - shares[k]; /* NaN if it is infinite or NaN */
        mix->share[k] = hairlut_max(shares[k], hairlut_constant(0.0f));
        sum += mix->share[k];
    }
    const float unit = hairlut_share_unit(sum);
    mix->sum = 0.0f;
    for (int k = 0; k < count; ++k)
        mix->sum += mix->share[k] *= unit;
    mix->sum = finite == 0.0f ? mix->sum : 0.0f;
}

/* Four lobes at the four nodes of theta_r and the offset around a place: at the lower and the upper theta_r of the lower offset,
 * then of the upper one. */
typedef struct hairlut_four_nodes {
    hairlut_quad share[4], turn[4];
} hairlut_four_nodes;

static inline hairlut_four_nodes hairlut_read_fours(const hairlut_four *four, const ptrdiff_t node[4])
{
    hairlut_four_nodes read;
    HAIRLUT_UNROLLED
    for (int l = 0; l < 4; ++l) {
        read.share[l] = hairlut_quad_anywhere(four[node[l]].share);
        read.turn[l] = hairlut_turns_float(hairlut_turns_load(four[node[l]].turn));
    }
    return read;
}

/* Those of the corners of a strand, blended; `four` is that of the first corner. */
HAIRLUT_INLINE hairlut_four_nodes hairlut_blend_fours(const hairlut_model *model, const hairlut_corners *corners,
                                                      const hairlut_four *four, const ptrdiff_t node[4])
{
    const hairlut_spacing *spacing = &model->strands->mixture;
    hairlut_four_nodes blend = hairlut_read_fours(four, node);
    for (int l = 0; l < 4; ++l)
        blend.share[l] = hairlut_quad_mul(hairlut_quad_all(corners->weight[0]), blend.share[l]);
    for (int c = 1; c < spacing->count; ++c) {
        const hairlut_four *here = four + spacing->corner[c];
        const hairlut_quad weight = hairlut_quad_all(corners->weight[c]);
        HAIRLUT_UNROLLED
        for (int l = 0; l < 4; ++l)
            blend.share[l] =
                hairlut_quad_add(blend.share[l], hairlut_quad_mul(weight, hairlut_quad_anywhere(here[node[l]].share)));
        if (!model->mixture.turns_vary)
            continue;
        HAIRLUT_UNROLLED
        for (int l = 0; l < 4; ++l) {
            const hairlut_turns arc =
                hairlut_turns_sub(hairlut_turns_load(here[node[l]].turn), hairlut_turns_load(four[node[l]].turn));
            blend.turn[l] = hairlut_quad_add(blend.turn[l], hairlut_quad_mul(weight, hairlut_turns_float(arc)));
        }
    }
    return blend;
}

static inline hairlut_quad hairlut_blend_shares(hairlut_quad a, hairlut_quad b, hairlut_quad t)
{
    const hairlut_quad rest = hairlut_quad_sub(hairlut_quad_all(1.0f), t);
    return hairlut_quad_add(hairlut_quad_mul(rest, a), hairlut_quad_mul(t, b));
}

/* Less whole turns: from minus half a turn, or a millionth below it, to half a turn */
static inline hairlut_quad hairlut_wrap_turns(hairlut_quad a)
{
    const hairlut_quad round = hairlut_quad_all(hairlut_whole_turns), up = hairlut_quad_all(hairlut_turn_ties);
    return hairlut_quad_sub(a, hairlut_quad_sub(hairlut_quad_add(hairlut_quad_add(a, up), round), round));
}

static inline hairlut_quad hairlut_blend_turns(hairlut_quad a, hairlut_quad b, hairlut_quad t)
{
    return hairlut_quad_add(a, hairlut_quad_mul(t, hairlut_wrap_turns(hairlut_quad_sub(b, a))));
}

/* Shares and turns between nodes; a NaN offset counts as -1, its density is 0. corners: those of the strand, or NULL. */
HAIRLUT_INLINE void hairlut_mixture_between(const hairlut_model *model, const hairlut_corners *corners, float theta_r,
                                            float h, hairlut_mix *mix)
{
    const hairlut_mixture *m = &model->mixture;
    const hairlut_node row = hairlut_nodes_place(&m->theta_r, theta_r);
    const hairlut_node column = hairlut_nodes_place(&m->arc, hairlut_asin(m->mirrored ? fabsf(h) : h));
    const ptrdiff_t node[4] = {0, m->above, m->beside, m->above + m->beside};
    const hairlut_quad t = hairlut_quad_all(row.t), s = hairlut_quad_all(column.t);
    const hairlut_four *four = m->fours + (ptrdiff_t)row.j * m->above + (ptrdiff_t)column.j * m->beside;
    if (corners)
        four += (corners->node + 1) * model->strands->mixture.pitch;
    for (int q = 0; q < m->four_count; ++q, ++four) {
        const hairlut_four_nodes at =
            corners ? hairlut_blend_fours(model, corners, four, node) : hairlut_read_fours(four, node);
        const hairlut_quad low = hairlut_blend_shares(at.share[0], at.share[1], t),
                           high = hairlut_blend_shares(at.share[2], at.share[3], t);
        const hairlut_quad turn = hairlut_blend_turns(hairlut_blend_turns(at.turn[0], at.turn[1], t),
                                                      hairlut_blend_turns(at.turn[2], at.turn[3], t), s);
        hairlut_quad_store(mix->share + 4 * q, hairlut_blend_shares(low, high, s));
        hairlut_quad_store(mix->turn + 4 * q,
                           hairlut_quad_mul(hairlut_quad_all(hairlut_turn_radians), hairlut_wrap_turns(turn)));
    }
}

/* Weights, and which lobes have one, from shares and their sum. */
HAIRLUT_INLINE void hairlut_mixture_weigh(int fours, hairlut_mix *mix)
{
    const hairlut_quad unit = hairlut_quad_all(1.0f / mix->sum);
    int count = 0;
    for (int q = 0; q < fours; ++q) {
        const hairlut_quad share = hairlut_quad_anywhere(mix->share + 4 * q);
        count += hairlut_quad_list(share, 4 * q, mix->lobes + count);
        hairlut_quad_store(mix->weight + 4 * q, hairlut_quad_mul(share, unit));
    }
    mix->count = count;
    if (count == 0) /* then a draw is of lobe 0 */
        mix->lobes[0] = 0;
}

/* Fills *mix. shares: the caller's, or NULL; corners: those of a strand, or NULL for the standard values. */
HAIRLUT_INLINE void hairlut_mixture_fill(const hairlut_model *model, const hairlut_corners *corners, const float *shares,
                                         float theta_r, float offset, hairlut_mix *mix)
{
    const float h = hairlut_clamp(offset, hairlut_constant(-1.0f), hairlut_constant(1.0f));
    mix->side = (float)(1 - 2 * (model->mixture.mirrored & (h < 0.0f)));
    hairlut_mixture_between(model, corners, theta_r, h, mix);
    mix->sum = 0.0f;
    for (int k = 0; k < 4 * model->mixture.four_count; ++k) /* of those beyond the last lobe: 0 */
        mix->sum += mix->share[k];
    if (shares)
        hairlut_mixture_given(model->lobe_count, shares, mix);
    hairlut_mixture_weigh(model->mixture.four_count, mix);
}

static void hairlut_mixture_standard(const hairlut_model *model, const float *shares, float theta_r, float offset,
                                     hairlut_mix *mix)
{
    hairlut_mixture_fill(model, NULL, shares, theta_r, offset, mix);
}

/* The mixture there: the model's, where it is constant, else *own, filled. */
HAIRLUT_INLINE const hairlut_mix *hairlut_mixture_at(const hairlut_model *model, const float *shares, float theta_r,
                                                     float offset, hairlut_mix *own)
{
    if (model->mixture.constant && !shares)
        return &model->mixture.mix;
    hairlut_mixture_standard(model, shares, theta_r, offset, own);
    return own;
}

/* Which of mix->lobes u draws: the first at which u sum is below the sum of the shares so far, or the last. */
HAIRLUT_INLINE int hairlut_mixture_choose(const hairlut_mix *mix, float u)
{
    const float target = hairlut_clamp(u, hairlut_constant(0.0f), hairlut_constant(1.0f)) * mix->sum;
    float below = 0.0f;
    int chosen = 0;
    for (int n = 0; n + 1 < mix->count; ++n) {
        below += mix->share[mix->lobes[n]];
        chosen += target >= below;
    }
    return chosen;
}

#endif
