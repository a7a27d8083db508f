/* SPDX-License-Identifier: BSD-3-Clause */
/* The whole hair: the mixture's density, and the azimuths of turned and mirrored lobes. */
#ifndef HAIRLUT_HAIR_H
#define HAIRLUT_HAIR_H

#include "lobe.h"
#include "mixture.h"

/* phi_i of a lobe's azimuth x: relative = side (x + turn), then r + relative, or relative - r, with r = phi_r in [-pi, pi). */
static inline float hairlut_turned_incident(int azimuth, float r, float x, float turn, float side)
{
    const float relative = side * (x + turn);
    return hairlut_wrap(azimuth == HAIRLUT_AZIMUTH_SUM ? relative - r : relative + r, -hairlut_pi);
}

/* x of a relative azimuth, in [0, 2 pi). */
static inline float hairlut_turned_relative(float relative, float turn, float side)
{
    return hairlut_wrap(side * relative - turn, 0.0f);
}

#endif
