/* Eight lanes of AVX-512 for batch_kernel.h, which says what each operation must do. Eight and not sixteen: most of the work
 * is loading and sorting cells, for which vectors of 256 bits have three ports and those of 512 bits two. */
#ifndef HAIRLUT_SIMD_AVX512_H
#define HAIRLUT_SIMD_AVX512_H

#include "internal.h"
#include "simd_256.h"

typedef __mmask8 mask;

static inline mask greater(real a, real b) { return _mm256_cmp_ps_mask(a, b, _CMP_GT_OQ); }
static inline mask at_least(real a, real b) { return _mm256_cmp_ps_mask(a, b, _CMP_GE_OQ); }
static inline mask numbers(real a, real b) { return _mm256_cmp_ps_mask(a, b, _CMP_ORD_Q); }
static inline mask both(mask a, mask b) { return (mask)(a & b); }
static inline int every(mask m) { return m == 0xff; }
static inline real choose(mask m, real a, real b) { return _mm256_mask_blend_ps(m, b, a); }
static inline mask igreater(whole a, whole b) { return _mm256_cmpgt_epi32_mask(a, b); }
static inline whole iwhere(mask m, whole a) { return _mm256_maskz_mov_epi32(m, a); }

#define HAIRLUT_COUNT count_at_most
static inline unsigned below8(const float *group, const float *changes, float t, float x)
{
    const real blend = add(load(group), mul(all(t), load(changes)));
    return _mm256_cmp_ps_mask(blend, all(x), _CMP_LE_OQ);
}

static inline unsigned below16(const float *group, const float *above, float t, float x)
{
    const __m512 from = _mm512_loadu_ps(group), change = _mm512_sub_ps(_mm512_loadu_ps(above), from);
    const __m512 blend = _mm512_add_ps(from, _mm512_mul_ps(_mm512_set1_ps(t), change));
    return _mm512_cmp_ps_mask(blend, _mm512_set1_ps(x), _CMP_LE_OQ);
}

HAIRLUT_INLINE int count_at_most(const float *group, const float *above, float t, float x, int n)
{
    return _mm_popcnt_u32(n == HAIRLUT_SMALL_GROUP ? below8(group, above, t, x) : below16(group, above, t, x));
}

#endif
