/* SPDX-License-Identifier: BSD-3-Clause */
/* The knots of the u axis in double precision (luts/FORMAT.md, "Knots"); axis.h computes the cell of a u in single precision. */
#ifndef HAIRLUT_WARP_H
#define HAIRLUT_WARP_H

#include <math.h>

#include "hairlut.h"

/* Folded column c = (F(m + e) - f0) / k of m = min(u, 1-u); uniform: c = m / k. */
typedef struct hairlut_warp_scale {
    double e, f0, k;
} hairlut_warp_scale;

/* F(s) = 2^q (1 + (r+g)/4) for s = 2^n (1+g), n + 3 = 4 q + r: near the fourth root, a straight line in each octave. */
static inline double hairlut_warp_curve(double s)
{
    int n;
    const double g = 2.0 * frexp(s, &n) - 1.0;
    const int quarters = n + 2 + 4096, r = quarters % 4; /* of a positive number: no division of negative ones */
    return ldexp(1.0 + (r + g) / 4.0, quarters / 4 - 1024);
}

/* s of y = F(s) */
static inline double hairlut_warp_uncurve(double y)
{
    int q;
    const double quarters = 4.0 * (2.0 * frexp(y, &q) - 1.0), r = floor(quarters);
    return ldexp(1.0 + quarters - r, 4 * (q - 1) + (int)r - 3);
}

static inline hairlut_warp_scale hairlut_scale_warp(hairlut_warp warp, double e, int width)
{
    const int octaves = warp == HAIRLUT_WARP_OCTAVES;
    hairlut_warp_scale scale;
    scale.e = octaves ? e : 0.0;
    scale.f0 = octaves ? hairlut_warp_curve(e) : 0.0;
    scale.k = 2.0 * ((octaves ? hairlut_warp_curve(0.5 + e) : 0.5) - scale.f0) / (width - 1);
    return scale;
}

/* m at folded column c in [0, (width-1)/2] */
static inline double hairlut_warp_knot(hairlut_warp warp, const hairlut_warp_scale *scale, double c)
{
    const double y = scale->f0 + scale->k * c;
    if (warp == HAIRLUT_WARP_UNIFORM)
        return y;
    return c > 0.0 ? hairlut_warp_uncurve(y) - scale->e : 0.0;
}

/* u of knot i counted from an end, i = 0 .. width-1: the distance in u from that end */
static inline double hairlut_warp_u(hairlut_warp warp, const hairlut_warp_scale *scale, int width, int i)
{
    const int mirrored = width - 1 - i;
    const double m = hairlut_warp_knot(warp, scale, (double)(i < mirrored ? i : mirrored));
    return i > mirrored ? 1.0 - m : m;
}

#endif
