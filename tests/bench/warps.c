/* The warps of the study (precompute/hairlut/study.py) in single precision; compiled once for each set of flags. */
#include "warps.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "rivals/lobe.h"

#ifdef WARPS_VECTOR
#define TABLE bench_warps_vector
#define ONE static inline
#else
#define TABLE bench_warps_scalar
#define ONE __attribute__((noinline)) static
#endif

static const float E = 0x1p-18f;

typedef struct place {
    float s, slope;
} place;

ONE place uniform(float u)
{
    const place p = {u, 1.0f};
    return p;
}

ONE place one_sided_power(float u)
{
    const float y = sqrtf(sqrtf(u));
    const place p = {y, 0.25f / (y * y * y)};
    return p;
}

ONE place two_sided_power(float u)
{
    const float y = sqrtf(sqrtf(u + E)), z = sqrtf(sqrtf(1.0f - u + E));
    const place p = {y - z, 0.25f / (y * y * y) + 0.25f / (z * z * z)};
    return p;
}

ONE place logit(float u)
{
    const float a = u + E, b = 1.0f - u + E;
    const place p = {logf(a / b), 1.0f / a + 1.0f / b};
    return p;
}

ONE place probit(float u)
{
    const float x = (2.0f * u - 1.0f) / (1.0f + 2.0f * E);
    const float z = rival_erfinv(x);
    const place p = {z, expf(z * z)};
    return p;
}

/* The bits of a float are its logarithm, linear in every octave. */
ONE place octaves(float u)
{
    const float m = fminf(u, 1.0f - u) + E;
    uint32_t bits;
    memcpy(&bits, &m, sizeof bits);
    const uint32_t octave = 0x7f000000u - (bits & 0x7f800000u);
    place p = {(float)(int32_t)bits * 0x1p-23f, 0.0f};
    memcpy(&p.slope, &octave, sizeof octave);
    return p;
}

ONE place quartic(float u)
{
    const float y = sqrtf(sqrtf(fminf(u, 1.0f - u) + E));
    const place p = {y, y * y * y}; /* du/ds: the density multiplies by it */
    return p;
}

#define OVER_ARRAYS(warp)                                                                                             \
    static void warp##_n(size_t n, const float *restrict u, float *restrict s, float *restrict slope)                 \
    {                                                                                                                 \
        for (size_t i = 0; i < n; ++i) {                                                                              \
            const place p = warp(u[i]);                                                                               \
            s[i] = p.s;                                                                                               \
            slope[i] = p.slope;                                                                                       \
        }                                                                                                             \
    }

OVER_ARRAYS(uniform)
OVER_ARRAYS(one_sided_power)
OVER_ARRAYS(two_sided_power)
OVER_ARRAYS(logit)
OVER_ARRAYS(probit)
OVER_ARRAYS(octaves)
OVER_ARRAYS(quartic)

const bench_warp TABLE[BENCH_WARPS] = {
    {"uniform", uniform_n},   {"one-sided-power", one_sided_power_n}, {"two-sided-power", two_sided_power_n},
    {"logit", logit_n},       {"probit", probit_n},                   {"octaves", octaves_n},
    {"quartic", quartic_n},
};
