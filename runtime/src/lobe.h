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

/* phi_i relative to phi_r, as the lobe's table has it, in [0, 2 pi). */
static inline float hairlut_relative_azimuth(int azimuth, float phi_r, float phi_i)
{
    const float r = hairlut_wrap(phi_r, -hairlut_pi), i = hairlut_wrap(phi_i, -hairlut_pi);
    return hairlut_wrap_up(azimuth == HAIRLUT_AZIMUTH_SUM ? i + r : i - r, 0.0f);
}

/* What a lobe draws: theta_i, as the axis gives it; the azimuth relative to phi_r, or of its own where it is uniform; the density. */
typedef struct hairlut_drawn {
    float theta, phi, pdf;
} hairlut_drawn;

HAIRLUT_INLINE hairlut_drawn hairlut_lobe_draw(const hairlut_lobe *lobe, float theta_r, float u_theta, float u_phi)
{
    const hairlut_draw theta = hairlut_axis_sample(&lobe->theta, theta_r, u_theta);
    if (lobe->uniform) {
        const float u = hairlut_clamp(u_phi, hairlut_constant(0.0f), hairlut_constant(1.0f));
        const float phi = hairlut_two_pi * u - hairlut_pi;
        const hairlut_drawn drawn = {theta.x, phi < hairlut_pi ? phi : -hairlut_pi, hairlut_inverse_two_pi / theta.slope};
        return drawn;
    }
    const hairlut_draw phi = hairlut_axis_sample(&lobe->phi, theta_r, u_phi);
    const hairlut_drawn drawn = {theta.x, phi.x, 1.0f / (theta.slope * phi.slope)};
    return drawn;
}

/* A density in two parts: searches that are under way, and the rest. phi is the relative azimuth, not used where it is uniform. */
typedef struct hairlut_lobe_search {
    hairlut_search theta, phi;
    float contains; /* 1 where the lobe's domain contains the direction, else 0 */
} hairlut_lobe_search;

HAIRLUT_INLINE hairlut_lobe_search hairlut_lobe_begin_search(const hairlut_lobe *lobe, float theta_r, float theta_i, float phi)
{
    hairlut_lobe_search search;
    search.theta = hairlut_axis_begin_search(&lobe->theta, theta_r, theta_i);
    search.contains = hairlut_axis_contains(&lobe->theta, theta_i);
    if (!lobe->uniform) {
        search.phi = hairlut_axis_begin_search(&lobe->phi, theta_r, phi);
        search.contains *= hairlut_axis_contains(&lobe->phi, phi);
    }
    return search;
}

HAIRLUT_INLINE float hairlut_lobe_end_search(const hairlut_lobe *lobe, const hairlut_lobe_search *search)
{
    const int theta_cell = hairlut_axis_end_search(&lobe->theta, &search->theta);
    if (lobe->uniform) {
        const hairlut_inverse theta = hairlut_axis_inverse(&lobe->theta, &search->theta, theta_cell);
        return search->contains * hairlut_inverse_two_pi * theta.bend / theta.root;
    }
    const int phi_cell = hairlut_axis_end_search(&lobe->phi, &search->phi);
    const hairlut_inverse theta = hairlut_axis_inverse(&lobe->theta, &search->theta, theta_cell);
    const hairlut_inverse phi = hairlut_axis_inverse(&lobe->phi, &search->phi, phi_cell);
    return search->contains * (theta.bend * phi.bend) / (theta.root * phi.root);
}

static inline hairlut_sample hairlut_finish(float theta_i, float phi_i, float pdf)
{
    const hairlut_sample s = {theta_i, phi_i, pdf, hairlut_per_steradian(pdf, theta_i)};
    return s;
}

#endif
