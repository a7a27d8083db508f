/* SPDX-License-Identifier: BSD-3-Clause */
/* Azimuths and cosines without libm. */
#ifndef HAIRLUT_ANGLE_H
#define HAIRLUT_ANGLE_H

#include <float.h>
#include <math.h>

#include "quad.h"

static const float hairlut_two_pi = 6.28318548f, hairlut_below_two_pi = 6.28318501f; /* the float next to it */
static const float hairlut_pi = 3.14159274f;
static const float hairlut_inverse_two_pi = 0.159154943f;
/* 2 pi and pi/2 in two parts each; the first part of 2 pi has so few bits that its multiples are exact */
static const float hairlut_two_pi_high = 6.28125f, hairlut_two_pi_low = 1.93530718e-3f;
static const float hairlut_half_pi_high = 1.57079637f, hairlut_half_pi_low = -4.37113883e-8f;

/* sin(z) = z + z^3 (s0 + s1 z^2 + s2 z^4 + s3 z^6): the least largest error for z up to pi/2, 5e-9 before rounding */
static const float hairlut_sine[4] = {-0.166666567f, 0.0083330255f, -0.000198074194f, 2.60190313e-6f};

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

/* Whether phi is in [low, low + 2 pi); not if it is NaN. */
static inline int hairlut_in_turn(float phi, float low)
{
    return phi >= low && phi < low + hairlut_two_pi;
}

/* phi modulo 2 pi, from [low, low + 2 pi). What no float resolves (phi beyond 2^24, infinity, NaN) gives low. The
 * first line is for speed: a renderer's azimuths are mostly in range. */
static inline float hairlut_wrap(float phi, float low)
{
    if (hairlut_in_turn(phi, low))
        return phi;
    const float n = hairlut_floor((phi - low) * hairlut_inverse_two_pi);
    const float r = (phi - n * hairlut_two_pi_high) - n * hairlut_two_pi_low;
    return hairlut_in_turn(r, low) ? r : low;
}

/* The same for |phi| <= 8 pi, with a branch for few: hairlut_wrap corrects what lies beside an end of the range. Turns are rounded
 * down by adding 1.5 * 2^23, from where on floats are integers, less a half; a little more than that, as ties are to go up. */
static const float hairlut_integers = 12582912.0f, hairlut_half_down = -0.4999998f;

static inline float hairlut_wrap_near(float phi, float low)
{
    const float n = ((phi - low) * hairlut_inverse_two_pi + hairlut_half_down + hairlut_integers) - hairlut_integers;
    return hairlut_wrap((phi - n * hairlut_two_pi_high) - n * hairlut_two_pi_low, low);
}

/* cos(theta) for |theta| <= pi/2 as the sine of the angle to the pole: 2.5 ulp up to the pole itself, where theta's
 * rounding would turn it negative and the smallest distance of a float from pi/2 stands in. */
static inline float hairlut_cos(float theta)
{
    const float distance = (hairlut_half_pi_high - fabsf(theta)) + hairlut_half_pi_low;
    const float least = hairlut_constant(-hairlut_half_pi_low), z = distance > least ? distance : least;
    const float w = z * z;
    const float low = hairlut_sine[0] + hairlut_sine[1] * w, high = hairlut_sine[2] + hairlut_sine[3] * w;
    return z + z * w * (low + w * w * high);
}

/* asin(h) = h + h^3 (a0 + a1 h^2 + ... + a4 h^8) for h up to 1/2: the least largest relative error, 5e-9 before rounding */
static const float hairlut_arcsine[5] = {0.166667536f, 0.0749524161f, 0.045477096f, 0.0241476111f, 0.0422185473f};

/* asin(h) for |h| <= 1, to 2.5 ulp; beyond 1/2, asin(h) = pi/2 - 2 asin(sqrt((1-h)/2)). The range is chosen without a branch: an
 * offset is as good as random. */
static inline float hairlut_asin(float h)
{
    const float a = fabsf(h), half = 0.5f * (1.0f - a), square = a * a, z = square < half ? square : half;
    const hairlut_quad range = hairlut_quad_all(0.5f - a); /* negative beyond 1/2 */
    const float r = hairlut_quad_first(hairlut_quad_by_sign(range, hairlut_quad_all(sqrtf(z)), hairlut_quad_all(a)));
    const float p = hairlut_arcsine[3] + z * hairlut_arcsine[4];
    const float q = hairlut_arcsine[0] + z * (hairlut_arcsine[1] + z * (hairlut_arcsine[2] + z * p));
    const float y = r + r * z * q;
    const hairlut_quad beyond = hairlut_quad_all(hairlut_half_pi_high - 2.0f * y);
    const float size = hairlut_quad_first(hairlut_quad_by_sign(range, beyond, hairlut_quad_all(y)));
    return h < 0.0f ? 0.0f - size : size;
}

/* A density per rad^2 in (theta, phi) as one per steradian. */
static inline float hairlut_per_steradian(float pdf_angle, float theta)
{
    return pdf_angle / hairlut_cos(theta);
}

#endif
