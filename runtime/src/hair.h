/* SPDX-License-Identifier: BSD-3-Clause */
/* The whole hair: the mixture's density, and the azimuths of turned and mirrored lobes. */
#ifndef HAIRLUT_HAIR_H
#define HAIRLUT_HAIR_H

#include "lobe.h"
#include "mixture.h"

/* phi_i of a lobe's azimuth x: relative = side (x + turn), then phi_r + relative, or relative - phi_r. */
static inline float hairlut_turned_incident(int azimuth, float phi_r, float x, float turn, float side)
{
    const float relative = side * (x + turn), r = hairlut_wrap(phi_r, -hairlut_pi);
    return hairlut_wrap(azimuth == HAIRLUT_AZIMUTH_SUM ? relative - r : relative + r, -hairlut_pi);
}

/* x of phi_i, in [0, 2 pi). */
static inline float hairlut_turned_relative(int azimuth, float phi_r, float phi_i, float turn, float side)
{
    const float relative = hairlut_relative_azimuth(azimuth, phi_r, phi_i);
    return hairlut_wrap(side * relative - turn, 0.0f);
}

#endif
