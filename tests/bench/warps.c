/* SPDX-License-Identifier: BSD-3-Clause */
/* The warps of the study (tests/report/study.py) in single precision; compiled once for each set of flags. */
#include "warps.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "rivals/giles.h"

#ifdef RIVAL_ARRAYS_WIDTH
#define TABLE bench_warps_vector
#define ONE static inline
#else
#define TABLE bench_warps_scalar
#define ONE __attribute__((noinline)) static
#endif

static const float E = 0x1p-18f;

ONE float uniform(float u)
{
    return u;
}

ONE float one_sided_power(float u)
{
    return sqrtf(sqrtf(u));
}

ONE float two_sided_power(float u)
{
    return sqrtf(sqrtf(u + E)) - sqrtf(sqrtf(1.0f - u + E));
}

ONE float logit(float u)
{
    return logf((u + E) / (1.0f - u + E));
}

ONE float probit(float u)
{
    return giles((2.0f * u - 1.0f) / (1.0f + 2.0f * E));
}

static inline uint32_t bits_of_tail(float u)
{
    const float m = fminf(u, 1.0f - u) + E;
    uint32_t bits;
    memcpy(&bits, &m, sizeof bits);
    return bits;
}

/* The bits of a float are its logarithm, linear in every octave. */
ONE float logarithm(float u)
{
    return (float)(int32_t)bits_of_tail(u);
}

ONE float quartic(float u)
{
    return sqrtf(sqrtf(fminf(u, 1.0f - u) + E));
}

/* Shifted by two they are a float near the fourth root. */
ONE float octaves(float u)
{
    const uint32_t bits = bits_of_tail(u) >> 2;
    float s;
    memcpy(&s, &bits, sizeof s);
    return s;
}

#define OVER_ARRAYS(warp)                                                      \
    static void warp##_n(size_t n, const float *restrict u, float *restrict s) \
    {                                                                          \
        for (size_t i = 0; i < n; ++i)                                         \
            s[i] = warp(u[i]);                                                 \
    }

OVER_ARRAYS(uniform)
OVER_ARRAYS(one_sided_power)
OVER_ARRAYS(two_sided_power)
OVER_ARRAYS(logit)
OVER_ARRAYS(probit)
OVER_ARRAYS(logarithm)
OVER_ARRAYS(quartic)
OVER_ARRAYS(octaves)

const bench_warp TABLE[BENCH_WARPS] = {
    {"uniform", uniform_n},
    {"one-sided-power", one_sided_power_n},
    {"two-sided-power", two_sided_power_n},
    {"logit", logit_n},
    {"probit", probit_n},
    {"logarithm", logarithm_n},
    {"quartic", quartic_n},
    {"octaves", octaves_n},
};
