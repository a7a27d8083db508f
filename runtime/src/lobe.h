/* SPDX-License-Identifier: BSD-3-Clause */
/* A lobe as the product of two axes: what sample, pdf and invert have in common with the whole hair. */
#ifndef HAIRLUT_LOBE_H
#define HAIRLUT_LOBE_H

#include "angle.h"
#include "axis.h"

/* NaN anywhere, or an infinite azimuth: the density is 0. */
static inline int hairlut_known(float theta_r, float phi_r, float a, float b)
{
    return !isunordered(theta_r, a) && !isunordered(b, phi_r - phi_r); /* infinity less itself is NaN */
}

/* phi_i relative to phi_r, as the lobe's table has it, in [0, 2 pi). Both are in [-pi, pi). */
static inline float hairlut_relative_azimuth(int azimuth, float r, float i)
{
    return hairlut_wrap_up(azimuth == HAIRLUT_AZIMUTH_SUM ? i + r : i - r, 0.0f);
}

/* The row of theta_r on the lobe's azimuth axis, from that on its other one. */
HAIRLUT_INLINE hairlut_row hairlut_phi_row(const hairlut_lobe *lobe, float theta_r, hairlut_row theta_row)
{
    return lobe->phi.grid == lobe->theta.grid ? theta_row : hairlut_axis_row(&lobe->phi, theta_r);
}

/* What a lobe draws: theta_i, as the axis gives it; the azimuth relative to phi_r, or of its own where it is uniform; the density. */
typedef struct hairlut_drawn {
    float theta, phi, pdf;
} hairlut_drawn;

/* From places on a lobe's axes; where the azimuth is uniform, on that of theta_i. */
HAIRLUT_INLINE hairlut_drawn hairlut_draw_uniform(const hairlut_placed *theta, float u_phi)
{
    const hairlut_draws two = hairlut_draw_two(theta, theta);
    const float u = hairlut_clamp(u_phi, hairlut_constant(0.0f), hairlut_constant(1.0f));
    const float phi = hairlut_two_pi * u - hairlut_pi;
    const hairlut_drawn drawn = {hairlut_quad_first(two.x), phi < hairlut_pi ? phi : -hairlut_pi,
                                 hairlut_inverse_two_pi / hairlut_quad_first(two.slope)};
    return drawn;
}

HAIRLUT_INLINE hairlut_drawn hairlut_draw_both(const hairlut_placed *theta, const hairlut_placed *phi)
{
    const hairlut_draws two = hairlut_draw_two(theta, phi);
    const float slope = hairlut_quad_first(two.slope) * hairlut_quad_second(two.slope);
    const hairlut_drawn drawn = {hairlut_quad_first(two.x), hairlut_quad_second(two.x), 1.0f / slope};
    return drawn;
}

HAIRLUT_INLINE hairlut_drawn hairlut_lobe_draw(const hairlut_lobe *lobe, float theta_r, float u_theta, float u_phi)
{
    const hairlut_row row = hairlut_axis_row(&lobe->theta, theta_r);
    const hairlut_placed theta = hairlut_axis_find_place(&lobe->theta, row, u_theta);
    if (lobe->uniform)
        return hairlut_draw_uniform(&theta, u_phi);
    const hairlut_placed phi = hairlut_axis_find_place(&lobe->phi, hairlut_phi_row(lobe, theta_r, row), u_phi);
    return hairlut_draw_both(&theta, &phi);
}

/* Searches that are under way, of the axes of some lobes: a lobe's theta, then its azimuth unless that is uniform. */
typedef struct hairlut_searches {
    hairlut_search search[2 * HAIRLUT_MAX_LOBES];
    int count;
} hairlut_searches;

/* Begins those of a lobe. phi is the relative azimuth, not used where it is uniform. Returns 1 where the lobe's domain contains
 * the direction, else 0. */
HAIRLUT_INLINE float hairlut_lobe_begin_search(const hairlut_lobe *lobe, float theta_r, hairlut_row row, float theta_i,
                                               float phi, hairlut_searches *under_way)
{
    hairlut_search *next = under_way->search + under_way->count;
    next[0] = hairlut_axis_begin_search(&lobe->theta, row, theta_i);
    under_way->count += lobe->uniform ? 1 : 2;
    if (lobe->uniform)
        return (float)(next[0].x == theta_i);
    next[1] = hairlut_axis_begin_search(&lobe->phi, hairlut_phi_row(lobe, theta_r, row), phi);
    return (float)((next[0].x == theta_i) & (next[1].x == phi));
}

/* The root and bend of all searches; whole quads are written. */
HAIRLUT_INLINE void hairlut_end_searches(const hairlut_searches *under_way, float *root, float *bend)
{
    for (int first = 0; first < under_way->count; first += 4) {
        const hairlut_search *search = under_way->search + first;
        const int count = under_way->count - first;
        hairlut_found found[4];
        found[0] = hairlut_axis_find(search);
        found[1] = count > 1 ? hairlut_axis_find(search + 1) : found[0];
        found[2] = count > 2 ? hairlut_axis_find(search + 2) : found[0];
        found[3] = count > 3 ? hairlut_axis_find(search + 3) : found[0];
        const hairlut_inverses inverse = hairlut_invert_four(found);
        hairlut_quad_store(root + first, inverse.root);
        hairlut_quad_store(bend + first, inverse.bend);
    }
}

/* A lobe's density, from the roots and bends of its axes. */
static inline float hairlut_lobe_density(const hairlut_lobe *lobe, float contains, const float *root, const float *bend)
{
    if (lobe->uniform)
        return contains * hairlut_inverse_two_pi * bend[0] / root[0];
    return contains * (bend[0] * bend[1]) / (root[0] * root[1]);
}

static inline hairlut_sample hairlut_finish(float theta_i, float phi_i, float pdf)
{
    const hairlut_sample s = {theta_i, phi_i, pdf, hairlut_per_steradian(pdf, theta_i)};
    return s;
}

#endif
