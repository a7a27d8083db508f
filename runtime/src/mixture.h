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

typedef struct hairlut_mix {
    float share[HAIRLUT_MAX_LOBES];  /* in a unit of their own */
    float weight[HAIRLUT_MAX_LOBES]; /* share / sum */
    float turn[HAIRLUT_MAX_LOBES];   /* [-pi, pi); not set where no lobe of the model is turned */
    float sum;                       /* of the shares; 0 where no density can be given */
    float side;                      /* -1 where the azimuth is mirrored, else 1 */
} hairlut_mix;

/* Where x lies among `count` nodes of an axis. NaN, and what is below the first, gives the first. */
HAIRLUT_INLINE hairlut_row hairlut_mixture_row(const float *nodes, int count, float x)
{
    int j = 0;
    for (int n = count - 1; n > 1;) {
        const int half = n / 2;
        j += nodes[2 * (j + half)] <= x ? half : 0;
        n -= half;
    }
    const hairlut_row row = {j, hairlut_clamp((x - nodes[2 * j]) * nodes[2 * j + 1], 0.0f, 1.0f)};
    return row;
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
    return hairlut_wrap(from + s * hairlut_wrap(to - from, -hairlut_pi), -hairlut_pi);
}

/* Between nodes; a NaN offset counts as -1; its density is 0. */
static inline void hairlut_mixture_between(const hairlut_model *model, float theta_r, float h, hairlut_mix *mix)
{
    const hairlut_mixture *m = &model->mixture;
    const int count = model->lobe_count;
    const hairlut_row row = hairlut_mixture_row(m->theta_r, m->rows, theta_r);
    const hairlut_row column = hairlut_mixture_row(m->arc, m->columns, hairlut_asin(m->mirrored ? fabsf(h) : h));
    const int node = HAIRLUT_CORNER * count, above = m->rows > 1 ? node * m->columns : 0, beside = m->columns > 1 ? node : 0;
    const float *corner = m->corners + (ptrdiff_t)row.j * above + (ptrdiff_t)column.j * beside;
    mix->sum = 0.0f;
    for (int k = 0; k < count; ++k, corner += HAIRLUT_CORNER) {
        mix->share[k] =
            hairlut_blend_shares(corner, corner + above, corner + beside, corner + above + beside, row.t, column.t);
        mix->sum += mix->share[k];
        if (m->turned)
            mix->turn[k] = hairlut_blend_turns(corner, corner + beside, row.t, column.t);
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
        mix->weight[k] = corner[3];
    }
}

/* shares: the caller's, as hairlut_mixture_given takes them, or NULL. */
HAIRLUT_INLINE void hairlut_mixture_at(const hairlut_model *model, const float *shares, size_t stride, float theta_r,
                                       float offset, hairlut_mix *mix)
{
    const int mirrored = model->mixture.mirrored, alone = model->mixture.rows == 1 && model->mixture.columns == 1;
    const float h = hairlut_clamp(offset, -1.0f, 1.0f);
    mix->side = (float)(1 - 2 * (mirrored & (h < 0.0f)));
    if (alone)
        hairlut_mixture_alone(model, mix);
    else
        hairlut_mixture_between(model, theta_r, h, mix);
    if (shares)
        hairlut_mixture_given(model->lobe_count, shares, stride, mix);
    if (shares || !alone) {
        const float unit = 1.0f / mix->sum;
        for (int k = 0; k < model->lobe_count; ++k)
            mix->weight[k] = mix->share[k] * unit;
    }
}

/* The lobe that u draws: the first k with u sum < share_0 + ... + share_k. Never one without share, also where u is 1. */
HAIRLUT_INLINE int hairlut_mixture_choose(const hairlut_mix *mix, int count, float u)
{
    const float target = hairlut_clamp(u, 0.0f, 1.0f) * mix->sum;
    float below = 0.0f;
    int chosen = 0;
    for (int k = 0; k < count && !(target < below); ++k) {
        below += mix->share[k];
        chosen = mix->share[k] > 0.0f ? k : chosen;
    }
    return chosen;
}

#endif
