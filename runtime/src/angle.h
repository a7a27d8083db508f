/* Azimuths and cosines without libm. */
#ifndef HAIRLUT_ANGLE_H
#define HAIRLUT_ANGLE_H

#include <float.h>
#include <math.h>

static const float hairlut_two_pi = 6.28318548f;
static const float hairlut_pi = 3.14159274f;
static const float hairlut_inverse_two_pi = 0.159154943f;

static inline int hairlut_is_finite(float x)
{
    return fabsf(x) <= FLT_MAX;
}

/* The largest integer not above x. From 2^23 on every float is one. NaN gives NaN. */
static inline float hairlut_floor(float x)
{
    const float n = fabsf(x) < 8388608.0f ? (float)(int)x : x;
    return n - (float)(n > x);
}

/* phi modulo 2 pi, from [low, low + 2 pi). 2 pi is subtracted in two parts, of which the first multiplies without
 * rounding. What no float resolves (phi beyond 2^24, infinity, NaN) gives low. */
static inline float hairlut_wrap(float phi, float low)
{
    const float n = hairlut_floor((phi - low) * hairlut_inverse_two_pi);
    const float r = (phi - n * 6.28125f) - n * 1.93530718e-3f;
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
