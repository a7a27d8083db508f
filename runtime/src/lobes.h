/* The two lobes as products of axes: what sample, pdf, invert and the mixture of one direction have in common. */
#ifndef HAIRLUT_LOBES_H
#define HAIRLUT_LOBES_H

#include "angle.h"
#include "axis.h"

/* NaN anywhere, or an infinite azimuth: the density is 0. */
static inline int hairlut_known(float theta_r, float phi_r, float a, float b)
{
    return !isunordered(theta_r, a) && !isunordered(b, phi_r - phi_r); /* infinity less itself is NaN */
}

/* The azimuth that the table direct_phi holds, in [0, 2 pi). */
static inline float hairlut_relative_azimuth(const hairlut_model *model, float phi_r, float phi_i)
{
    const float r = hairlut_wrap(phi_r, -hairlut_pi);
    const float i = hairlut_wrap(phi_i, -hairlut_pi);
    return hairlut_wrap_up(model->azimuth == HAIRLUT_AZIMUTH_SUM ? i + r : i - r, 0.0f);
}

/* phi_i in [-pi, pi) from the azimuth in the table. */
static inline float hairlut_incident_azimuth(const hairlut_model *model, float phi_r, float phi)
{
    const float r = hairlut_wrap(phi_r, -hairlut_pi);
    return hairlut_wrap_down(model->azimuth == HAIRLUT_AZIMUTH_SUM ? phi - r : phi + r, -hairlut_pi);
}

/* The density of a mixture, from the densities of both lobes. */
static inline float hairlut_mix(float direct_weight, float direct, float multiple)
{
    return direct_weight * direct + (1.0f - direct_weight) * multiple;
}

static inline hairlut_sample hairlut_finish(float theta_i, float phi_i, float pdf)
{
    const hairlut_sample s = {theta_i, phi_i, pdf, hairlut_per_steradian(pdf, theta_i)};
    return s;
}

#endif
