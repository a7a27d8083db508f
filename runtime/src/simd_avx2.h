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
static inline mask igreater(whole a, whole b) { return _mm256_castsi256_ps(_mm256_cmpgt_epi32(a, b)); }
static inline whole iwhere(mask m, whole a) { return _mm256_and_si256(_mm256_castps_si256(m), a); }

/* -1 in the lanes of the eight blended texels that are at most x */
static inline whole at_most(const float *low, const float *high, real t, real x)
{
    const real from = load(low), blend = add(from, mul(t, sub(load(high), from)));
    return _mm256_castps_si256(_mm256_cmp_ps(blend, x, _CMP_LE_OQ));
}

static inline whole tally(const float *low, const float *high, float t, float x, int n)
{
    const whole first = at_most(low, high, all(t), all(x));
    return n > 8 ? iadd(first, at_most(low + 8, high + 8, all(t), all(x))) : first;
}

/* The tallies of samples 0 and 1, as 16-bit integers: those of sample 0 are in the first half of both halves of a vector. */
static inline whole pair(const float *low, const float *high, const int *at, const float *t, const float *x, int n)
{
    return _mm256_packs_epi32(tally(low + at[0], high + at[0], t[0], x[0], n),
                              tally(low + at[1], high + at[1], t[1], x[1], n));
}

/* Eight tallies become bytes, four for each sample in both halves of a vector, whose sum is turned positive. */
#define HAIRLUT_COUNTS counts_at_most
static inline whole counts_at_most(const float *low, const float *high, const int *at, const float *t, const float *x, int n)
{
    const whole a = _mm256_packs_epi16(pair(low, high, at, t, x, n), pair(low, high, at + 2, t + 2, x + 2, n));
    const whole b = _mm256_packs_epi16(pair(low, high, at + 4, t + 4, x + 4, n), pair(low, high, at + 6, t + 6, x + 6, n));
    const whole bytes = _mm256_add_epi8(_mm256_permute2x128_si256(a, b, 0x20), _mm256_permute2x128_si256(a, b, 0x31));
    return _mm256_madd_epi16(_mm256_maddubs_epi16(_mm256_set1_epi8(1), bytes), _mm256_set1_epi16(-1));
}

#endif
