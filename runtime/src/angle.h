/* Azimuths and cosines without libm. */
#ifndef HAIRLUT_ANGLE_H
#define HAIRLUT_ANGLE_H

#include <float.h>
#include <math.h>

static const float hairlut_two_pi = 6.28318548f;
static const float hairlut_pi = 3.14159274f;

static inline int hairlut_is_finite(float x)
{
    return fabsf(x) <= FLT_MAX;
}

/* phi modulo 2 pi, from [low, low + 2 pi). What no float resolves (phi beyond 2^24, infinity, NaN) gives low. */
static inline float hairlut_wrap(float phi, float low)
{
    const float r = phi - hairlut_two_pi * floorf((phi - low) / hairlut_two_pi);
    return r >= low && r < low + hairlut_two_pi ? r : low;
}

/* cos(theta) for |theta| <= pi/2 as the sine of the angle to the pole: 2 ulp up to the pole itself, where theta's
 * rounding would turn it negative and the smallest distance of a float from pi/2 stands in. */
static inline float hairlut_cos(float theta)
{
    const float half_pi_high = 1.57079637f, half_pi_low = -4.37113883e-8f;
    float z = (half_pi_high - fabsf(theta)) + half_pi_low;
    z = z > 4.37113883e-8f ? z : 4.37113883e-8f;
    const float w = z * z;
    return z * (1.0f + w * (-1.0f / 6.0f + w * (1.0f / 120.0f + w * (-1.0f / 5040.0f + w * (1.0f / 362880.0f + w * (-1.0f / 39916800.0f))))));
}

#endif
