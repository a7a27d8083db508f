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

/* The azimuth x by which a lobe's table is read: that of phi_i relative to phi_r, where a mixture mirrors it (side is -1) and turns
 * it: relative = phi_i + sign phi_r, and x = side relative - turn, in [0, 2 pi). r and i are phi_r and phi_i in [-pi, pi). */
static inline float hairlut_table_azimuth(const hairlut_lobe *lobe, float r, float i, float turn, float side)
{
    return hairlut_wrap_near(side * (i + lobe->sign * r) - turn, 0.0f);
}

/* And back: phi_i in [-pi, pi) */
static inline float hairlut_incident_azimuth(const hairlut_lobe *lobe, float r, float x, float turn, float side)
{
    return hairlut_wrap_near(side * (x + turn) - lobe->sign * r, -hairlut_pi);
}

/* The row of theta_r on the lobe's azimuth axis, from that on its other one. */
HAIRLUT_INLINE hairlut_row hairlut_phi_row(const hairlut_lobe *lobe, float theta_r, const hairlut_row *theta_row)
{
    return lobe->phi.grid == lobe->theta.grid ? *theta_row : hairlut_axis_row(&lobe->phi, theta_r);
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

/* *row is that of theta_r on the axis of theta_i. */
HAIRLUT_INLINE hairlut_drawn hairlut_lobe_draw(const hairlut_lobe *lobe, float theta_r, const hairlut_row *row,
                                               float u_theta, float u_phi)
{
    const hairlut_placed theta = hairlut_axis_find_place(&lobe->theta, row, u_theta);
    if (lobe->uniform)
        return hairlut_draw_uniform(&theta, u_phi);
    const hairlut_row phi_row = hairlut_phi_row(lobe, theta_r, row);
    const hairlut_placed phi = hairlut_axis_find_place(&lobe->phi, &phi_row, u_phi);
    return hairlut_draw_both(&theta, &phi);
}

/* Any direction on the axis of a uniform azimuth: one straight cell, whose density is 1 / (2 pi) exactly. */
HAIRLUT_INLINE hairlut_found hairlut_find_uniform(void)
{
    static const float HAIRLUT_LINE_ALIGNED straight[HAIRLUT_CELL] = {0.0f, 1.0f, 1.0f, 1.0f};
    const hairlut_found found = {0.0f, 0.0f, hairlut_inverse_two_pi, hairlut_quad_load(straight)};
    return found;
}

static inline hairlut_sample hairlut_finish(float theta_i, float phi_i, float pdf)
{
    const hairlut_sample s = {theta_i, phi_i, pdf, hairlut_per_steradian(pdf, theta_i)};
    return s;
}

#endif
