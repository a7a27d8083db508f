/* SPDX-License-Identifier: BSD-3-Clause */
/* World directions and (theta, phi) in a fibre frame. */
#include <math.h>

#include "angle.h"
#include "hairlut.h"

static float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static float largest(const float a[3])
{
    const float x = fabsf(a[0]), y = fabsf(a[1]), z = fabsf(a[2]);
    const float m = x > y ? x : y;
    return m > z ? m : z;
}

void hairlut_angles(const hairlut_frame *frame, const float direction[3], float *theta, float *phi)
{
    /* scaled first, so that no square overflows or vanishes */
    const float scale = largest(direction);
    const float w[3] = {direction[0] / scale, direction[1] / scale, direction[2] / scale};
    const float t = dot(w, frame->tangent), n = dot(w, frame->normal), b = dot(w, frame->binormal);
    const float across = sqrtf(n * n + b * b);
    const int known = hairlut_is_finite(t) && hairlut_is_finite(across);
    /* atan2 keeps its precision next to the pole, where asin loses half the digits */
    *theta = known ? atan2f(t, across) : 0.0f;
    *phi = known && across > 0.0f ? hairlut_wrap(atan2f(b, n), -hairlut_pi) : 0.0f;
}

void hairlut_direction(const hairlut_frame *frame, float theta, float phi, float direction[3])
{
    const float half_pi = hairlut_half_pi_high;
    const float inclination = theta >= -half_pi && theta <= half_pi ? theta : theta > 0.0f ? half_pi : -half_pi;
    const float azimuth = hairlut_wrap(phi, -hairlut_pi);
    /* never negative: next to the pole the direction keeps its azimuth */
    const float c = hairlut_cos(inclination), s = sinf(inclination);
    const float cn = c * cosf(azimuth), cb = c * sinf(azimuth);
    for (int k = 0; k < 3; ++k)
        direction[k] = s * frame->tangent[k] + cn * frame->normal[k] + cb * frame->binormal[k];
}
