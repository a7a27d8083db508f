/* The knots of the u axis in double precision (luts/FORMAT.md, "Knots"); axis.h is its single-precision reading. */
#ifndef HAIRLUT_WARP_H
#define HAIRLUT_WARP_H

#include <math.h>

#include "hairlut.h"

/* Folded column c = (F(m) - f0) / k of m = min(u, 1-u), F(m) = (m+e)^(1/4) or, uniform, F(m) = m. */
typedef struct hairlut_warp_scale {
    double e, f0, k;
} hairlut_warp_scale;

static inline hairlut_warp_scale hairlut_scale_warp(hairlut_warp warp, double e, int width)
{
    const int quartic = warp == HAIRLUT_WARP_QUARTIC;
    hairlut_warp_scale scale;
    scale.e = quartic ? e : 0.0;
    scale.f0 = quartic ? sqrt(sqrt(e)) : 0.0;
    scale.k = 2.0 * ((quartic ? sqrt(sqrt(0.5 + e)) : 0.5) - scale.f0) / (width - 1);
    return scale;
}

/* m at folded column c in [0, (width-1)/2] */
static inline double hairlut_warp_knot(hairlut_warp warp, const hairlut_warp_scale *scale, double c)
{
    const double f0 = scale->f0, y = f0 + scale->k * c;
    if (warp == HAIRLUT_WARP_UNIFORM)
        return scale->k * c;
    return scale->k * c * (y + f0) * (y * y + f0 * f0); /* y^4 - f0^4 without its cancellation */
}

#endif
