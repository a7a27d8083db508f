/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef RIVALS_GILES_H
#define RIVALS_GILES_H

#include <math.h>

/* The inverse of erf in single precision, with the published coefficients of M. Giles, "Approximating the erfinv function"
 * (GPU Computing Gems, 2011): one polynomial for the middle, one for the tails. */
static inline float giles_middle(float w)
{
    const float a = w - 2.5f;
    float p = 2.81022636e-08f;
    p = 3.43273939e-07f + p * a;
    p = -3.5233877e-06f + p * a;
    p = -4.39150654e-06f + p * a;
    p = 0.00021858087f + p * a;
    p = -0.00125372503f + p * a;
    p = -0.00417768164f + p * a;
    p = 0.246640727f + p * a;
    return 1.50140941f + p * a;
}

static inline float giles_tail(float root)
{
    const float b = root - 3.0f;
    float p = -0.000200214257f;
    p = 0.000100950558f + p * b;
    p = 0.00134934322f + p * b;
    p = -0.00367342844f + p * b;
    p = 0.00573950773f + p * b;
    p = -0.0076224613f + p * b;
    p = 0.00943887047f + p * b;
    p = 1.00167406f + p * b;
    return 2.83297682f + p * b;
}

#ifdef RIVAL_ARRAYS_WIDTH
static inline float giles(float x) /* both, and a choice: a loop over arrays has no branches */
{
    const float w = -logf((1.0f - x) * (1.0f + x));
    const float p = giles_middle(w), q = giles_tail(sqrtf(w > 5.0f ? w : 5.0f));
    return (w < 5.0f ? p : q) * x;
}
#else
static inline float giles(float x)
{
    const float w = -logf((1.0f - x) * (1.0f + x));
    return (w < 5.0f ? giles_middle(w) : giles_tail(sqrtf(w))) * x;
}
#endif

#endif
