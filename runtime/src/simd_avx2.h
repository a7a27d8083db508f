/* Eight lanes of AVX2 for batch_kernel.h, which says what each operation must do. */
#ifndef HAIRLUT_SIMD_AVX2_H
#define HAIRLUT_SIMD_AVX2_H

#include "simd_256.h"

typedef __m256 mask;

static inline mask greater(real a, real b) { return _mm256_cmp_ps(a, b, _CMP_GT_OQ); }
static inline mask at_least(real a, real b) { return _mm256_cmp_ps(a, b, _CMP_GE_OQ); }
static inline mask numbers(real a, real b) { return _mm256_cmp_ps(a, b, _CMP_ORD_Q); }
static inline mask both(mask a, mask b) { return _mm256_and_ps(a, b); }
static inline int every(mask m) { return _mm256_movemask_ps(m) == 0xff; }
static inline real choose(mask m, real a, real b) { return _mm256_blendv_ps(b, a, m); }
static inline whole ichoose(mask m, whole a, whole b)
{
    return _mm256_castps_si256(_mm256_blendv_ps(_mm256_castsi256_ps(b), _mm256_castsi256_ps(a), m));
}

static inline whole iwhere(mask m, whole a) { return _mm256_and_si256(_mm256_castps_si256(m), a); }

#define HAIRLUT_COUNT count_at_most
static inline unsigned below(const float *low, const float *high, float t, float x)
{
    const real from = load(low), blend = add(from, mul(all(t), sub(load(high), from)));
    return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(blend, all(x), _CMP_LE_OQ));
}

static inline int count_at_most(const float *low, const float *high, float t, float x, int n)
{
    return _mm_popcnt_u32(below(low, high, t, x)) + (n > 8 ? _mm_popcnt_u32(below(low + 8, high + 8, t, x)) : 0);
}

#endif
