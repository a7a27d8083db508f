/* SPDX-License-Identifier: BSD-3-Clause */
/* The mixture at one theta_r and offset: each lobe's weight and turn (luts/FORMAT.md, "Mixture").
 *
 * Shares are bilinear in theta_r and asin(offset). A turn is blended along theta_r at both offsets, then between these, each
 * time along the shorter arc: blend(a, b, t) = a + t wrap(b - a), with wrap to [-pi, pi). */
#ifndef HAIRLUT_MIXTURE_H
#define HAIRLUT_MIXTURE_H

#include "angle.h"
#include "axis.h"

/* Shares are multiplied by a power of two if their sum is far from 1, so that none overflows or vanishes. */
static const float hairlut_large_share = 1.26765060e30f /* 2^100 */, hairlut_small_share = 9.09494702e-13f; /* 2^-40 */
static const float hairlut_shrink = 9.09494702e-13f /* 2^-40 */, hairlut_grow = 1.23794004e27f;             /* 2^90 */

/* Where x lies among `count` nodes of an axis. NaN, and what is below the first, gives the first. */
HAIRLUT_INLINE hairlut_node hairlut_mixture_node(const float *nodes, int count, float x)
{
    int j = 0;
    for (int n = count - 1; n > 1;) {
        const int half = n / 2;
        j += nodes[2 * (j + half)] <= x ? half : 0;
        n -= half;
    }
    const hairlut_node node = {j, hairlut_clamp((x - nodes[2 * j]) * nodes[2 * j + 1], 0.0f, 1.0f)};
    return node;
}

/* The factor that brings the sum of shares, each not negative and not NaN, near 1; 1 for all that people write. */
static inline float hairlut_share_unit(float sum)
{
    return sum > hairlut_large_share ? hairlut_shrink : sum < hairlut_small_share ? hairlut_grow : 1.0f;
}

/* The caller's shares, lobe k's at shares[k * stride]; 0 in place of negative ones. */
HAIRLUT_INLINE void hairlut_mixture_given(int count, const float *shares, size_t stride, hairlut_mix *mix)
{
    float sum = 0.0f, finite = 0.0f;
    for (int k = 0; k < count; ++k) {
        const float share = shares[(size_t)k * stride];
        finite += share - share; /* NaN if it is infinite or NaN */
        mix->share[k] = hairlut_max(share, hairlut_constant(0.0f));
        sum += mix->share[k];
    }
    const float unit = hairlut_share_unit(sum);
    mix->sum = 0.0f;
    for (int k = 0; k < count; ++k)
        mix->sum += mix->share[k] *= unit;
    mix->sum = finite == 0.0f ? mix->sum : 0.0f;
}

/* The share of a lobe from the four corners around: along theta_r by t, then along the offset by s. */
static inline float hairlut_blend_shares(const float *low, const float *low_above, const float *high,
                                         const float *high_above, float t, float s)
{
    const float from = (1.0f - t) * low[0] + t * low_above[0], to = (1.0f - t) * high[0] + t * high_above[0];
    return (1.0f - s) * from + s * to;
}

static inline float hairlut_blend_turns(const float *low, const float *high, float t, float s)
{
    const float from = low[1] + t * low[2], to = high[1] + t * high[2];
    return hairlut_wrap_near(from + s * hairlut_wrap_near(to - from, -hairlut_pi), -hairlut_pi);
}

/* Between nodes; a NaN offset counts as -1; its density is 0. */
static inline void hairlut_mixture_between(const hairlut_model *model, float theta_r, float h, hairlut_mix *mix)
{
    const hairlut_mixture *m = &model->mixture;
    const int count = model->lobe_count;
    const hairlut_node row = hairlut_mixture_node(m->theta_r, m->rows, theta_r);
    const hairlut_node column = hairlut_mixture_node(m->arc, m->columns, hairlut_asin(m->mirrored ? fabsf(h) : h));
    const int node = HAIRLUT_CORNER * count, above = m->rows > 1 ? node * m->columns : 0, beside = m->columns > 1 ? node : 0;
    const float *corner = m->corners + (ptrdiff_t)row.j * above + (ptrdiff_t)column.j * beside;
    mix->sum = 0.0f;
    for (int k = 0; k < count; ++k, corner += HAIRLUT_CORNER) {
        mix->share[k] =
            hairlut_blend_shares(corner, corner + above, corner + beside, corner + above + beside, row.t, column.t);
        mix->sum += mix->share[k];
        mix->turn[k] = m->turned ? hairlut_blend_turns(corner, corner + beside, row.t, column.t) : 0.0f;
    }
}

/* The same of the only node: what blending it with itself gives. */
static inline void hairlut_mixture_alone(const hairlut_model *model, hairlut_mix *mix)
{
    const float *corner = model->mixture.corners;
    mix->sum = 0.0f;
    for (int k = 0; k < model->lobe_count; ++k, corner += HAIRLUT_CORNER) {
        mix->sum += mix->share[k] = corner[0];
        mix->turn[k] = corner[1];
    }
}

/* Weights, and which lobes have one, from shares and their sum. */
static inline void hairlut_mixture_weigh(int count, hairlut_mix *mix)
{
    const float unit = 1.0f / mix->sum;
    mix->count = 0;
    for (int k = 0; k < count; ++k) {
        mix->weight[k] = mix->share[k] * unit;
        mix->lobes[mix->count] = k;
        mix->count += mix->weight[k] > 0.0f;
    }
    if (mix->count == 0) /* then a draw is of lobe 0 */
        mix->lobes[0] = 0;
}

/* Fills *mix. shares: the caller's, as hairlut_mixture_given takes them, or NULL. */
static inline void hairlut_mixture_fill(const hairlut_model *model, const float *shares, size_t stride, float theta_r,
                                        float offset, hairlut_mix *mix)
{
    const int mirrored = model->mixture.mirrored, alone = model->mixture.rows == 1 && model->mixture.columns == 1;
    const float h = hairlut_clamp(offset, hairlut_constant(-1.0f), hairlut_constant(1.0f));
    mix->side = (float)(1 - 2 * (mirrored & (h < 0.0f)));
    if (alone)
        hairlut_mixture_alone(model, mix);
    else
        hairlut_mixture_between(model, theta_r, h, mix);
    if (shares)
        hairlut_mixture_given(model->lobe_count, shares, stride, mix);
    hairlut_mixture_weigh(model->lobe_count, mix);
}

/* The mixture there: the model's, where it is constant, else *own, filled. */
HAIRLUT_INLINE const hairlut_mix *hairlut_mixture_at(const hairlut_model *model, const float *shares, float theta_r,
                                                     float offset, hairlut_mix *own)
{
    if (model->mixture.constant && !shares)
        return &model->mixture.mix;
    hairlut_mixture_fill(model, shares, 1, theta_r, offset, own);
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
