/* SPDX-License-Identifier: BSD-3-Clause */
/* Eight neighbouring floats at once: one register of AVX2, else two quads. Loads are from any address. */
#ifndef HAIRLUT_OCT_H
#define HAIRLUT_OCT_H

#include "quad.h"

#if defined(HAIRLUT_QUAD_SSE2) && defined(__AVX2__)
#define HAIRLUT_OCT_AVX2
typedef __m256 hairlut_oct;

/* clang-format off */
static inline hairlut_oct hairlut_oct_load(const float *p) { return _mm256_loadu_ps(p); }
static inline hairlut_oct hairlut_oct_all(float a) { return _mm256_set1_ps(a); }
static inline hairlut_oct hairlut_oct_of(hairlut_quad low, hairlut_quad high) { return _mm256_set_m128(high, low); }
static inline hairlut_oct hairlut_oct_add(hairlut_oct a, hairlut_oct b) { return _mm256_add_ps(a, b); }
static inline hairlut_oct hairlut_oct_sub(hairlut_oct a, hairlut_oct b) { return _mm256_sub_ps(a, b); }
static inline hairlut_oct hairlut_oct_mul(hairlut_oct a, hairlut_oct b) { return _mm256_mul_ps(a, b); }
static inline hairlut_quad hairlut_oct_low(hairlut_oct a) { return _mm256_castps256_ps128(a); }
static inline hairlut_quad hairlut_oct_high(hairlut_oct a) { return _mm256_extractf128_ps(a, 1); }
/* clang-format on */

/* A bit for each lane of a that is at most x. */
static inline unsigned hairlut_oct_mask(hairlut_oct a, hairlut_oct x)
{
    return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(a, x, _CMP_LE_OQ));
}

#else
typedef struct hairlut_oct {
    hairlut_quad low, high;
} hairlut_oct;

static inline hairlut_oct hairlut_oct_of(hairlut_quad low, hairlut_quad high)
{
    const hairlut_oct a = {low, high};
    return a;
}

/* clang-format off */
static inline hairlut_oct hairlut_oct_load(const float *p) { return hairlut_oct_of(hairlut_quad_anywhere(p), hairlut_quad_anywhere(p + 4)); }
static inline hairlut_oct hairlut_oct_all(float a) { return hairlut_oct_of(hairlut_quad_all(a), hairlut_quad_all(a)); }
static inline hairlut_oct hairlut_oct_add(hairlut_oct a, hairlut_oct b) { return hairlut_oct_of(hairlut_quad_add(a.low, b.low), hairlut_quad_add(a.high, b.high)); }
static inline hairlut_oct hairlut_oct_sub(hairlut_oct a, hairlut_oct b) { return hairlut_oct_of(hairlut_quad_sub(a.low, b.low), hairlut_quad_sub(a.high, b.high)); }
static inline hairlut_oct hairlut_oct_mul(hairlut_oct a, hairlut_oct b) { return hairlut_oct_of(hairlut_quad_mul(a.low, b.low), hairlut_quad_mul(a.high, b.high)); }
static inline hairlut_quad hairlut_oct_low(hairlut_oct a) { return a.low; }
static inline hairlut_quad hairlut_oct_high(hairlut_oct a) { return a.high; }
static inline unsigned hairlut_oct_mask(hairlut_oct a, hairlut_oct x) { return hairlut_quad_mask(a.low, x.low) | hairlut_quad_mask(a.high, x.high) << 4; }
/* clang-format on */
#endif

/* How many of the bits 0 to 7 are set. */
static inline unsigned hairlut_count_bits(unsigned bits)
{
#if defined(HAIRLUT_QUAD_SSE2) && defined(__POPCNT__)
    return (unsigned)_mm_popcnt_u32(bits);
#else
    return hairlut_bits[bits];
#endif
}

/* How many of a are at most x. */
static inline unsigned hairlut_oct_count(hairlut_oct a, hairlut_oct x)
{
    return hairlut_count_bits(hairlut_oct_mask(a, x));
}

#endif
