/* Sixteen lanes of AVX-512 for batch_kernel.h, which says what each operation must do. What sorts the loads of single samples
 * is AVX2's: there, eight lanes are as fast. */
#ifndef HAIRLUT_SIMD_AVX512_H
#define HAIRLUT_SIMD_AVX512_H

#include <immintrin.h>

#include "internal.h"

typedef __m512 real;
typedef __m512i whole;
typedef __mmask16 mask;
enum { LANES = 16 };

static inline real load(const float *p) { return _mm512_loadu_ps(p); }
static inline void store(float *p, real a) { _mm512_storeu_ps(p, a); }
static inline real all(float a) { return _mm512_set1_ps(a); }
static inline real add(real a, real b) { return _mm512_add_ps(a, b); }
static inline real sub(real a, real b) { return _mm512_sub_ps(a, b); }
static inline real mul(real a, real b) { return _mm512_mul_ps(a, b); }
static inline real over(real a, real b) { return _mm512_div_ps(a, b); }
static inline real root(real a) { return _mm512_sqrt_ps(a); }
static inline real smaller(real a, real b) { return _mm512_min_ps(a, b); }
static inline real larger(real a, real b) { return _mm512_max_ps(a, b); }
static inline real magnitude(real a) { return _mm512_andnot_ps(_mm512_set1_ps(-0.0f), a); }
static inline mask greater(real a, real b) { return _mm512_cmp_ps_mask(a, b, _CMP_GT_OQ); }
static inline mask at_least(real a, real b) { return _mm512_cmp_ps_mask(a, b, _CMP_GE_OQ); }
static inline mask numbers(real a, real b) { return _mm512_cmp_ps_mask(a, b, _CMP_ORD_Q); }
static inline mask both(mask a, mask b) { return (mask)(a & b); }
static inline int every(mask m) { return m == 0xffff; }
static inline real choose(mask m, real a, real b) { return _mm512_mask_blend_ps(m, b, a); }

static inline whole iload(const int *p) { return _mm512_loadu_si512(p); }
static inline void istore(int *p, whole a) { _mm512_storeu_si512(p, a); }
static inline whole iall(int a) { return _mm512_set1_epi32(a); }
static inline whole iadd(whole a, whole b) { return _mm512_add_epi32(a, b); }
static inline whole isub(whole a, whole b) { return _mm512_sub_epi32(a, b); }
static inline whole ismaller(whole a, whole b) { return _mm512_min_epi32(a, b); }
static inline whole imul(whole a, whole b) { return _mm512_madd_epi16(a, b); }
static inline mask igreater(whole a, whole b) { return _mm512_cmpgt_epi32_mask(a, b); }
static inline whole iwhere(mask m, whole a) { return _mm512_maskz_mov_epi32(m, a); }
static inline whole truncated(real a) { return _mm512_cvttps_epi32(a); }
static inline real shifted(real a) { return _mm512_castsi512_ps(_mm512_srli_epi32(_mm512_castps_si512(a), 2)); }
static inline real converted(whole a) { return _mm512_cvtepi32_ps(a); }

/* Four lanes of each x[k] at a time: rows of four floats, transposed within parts of 128 bits. */
static inline void gather4(const float *p, const int *at, real x[4])
{
    real r[4];
    for (int k = 0; k < 4; ++k) {
        r[k] = _mm512_castps128_ps512(_mm_loadu_ps(p + at[k]));
        r[k] = _mm512_insertf32x4(r[k], _mm_loadu_ps(p + at[k + 4]), 1);
        r[k] = _mm512_insertf32x4(r[k], _mm_loadu_ps(p + at[k + 8]), 2);
        r[k] = _mm512_insertf32x4(r[k], _mm_loadu_ps(p + at[k + 12]), 3);
    }
    const __m512d a = _mm512_castps_pd(_mm512_unpacklo_ps(r[0], r[1])), b = _mm512_castps_pd(_mm512_unpackhi_ps(r[0], r[1]));
    const __m512d c = _mm512_castps_pd(_mm512_unpacklo_ps(r[2], r[3])), d = _mm512_castps_pd(_mm512_unpackhi_ps(r[2], r[3]));
    x[0] = _mm512_castpd_ps(_mm512_unpacklo_pd(a, c));
    x[1] = _mm512_castpd_ps(_mm512_unpackhi_pd(a, c));
    x[2] = _mm512_castpd_ps(_mm512_unpacklo_pd(b, d));
    x[3] = _mm512_castpd_ps(_mm512_unpackhi_pd(b, d));
}

#define HAIRLUT_CELLS_BY_AVX2
#define HAIRLUT_COUNT(group, above, t, x, n) count16(group, above, t, x)
static inline int count16(const float *group, const float *above, float t, float x)
{
    const real from = load(group), blend = add(from, mul(all(t), sub(load(above), from)));
    return _mm_popcnt_u32(_mm512_cmp_ps_mask(blend, all(x), _CMP_LE_OQ));
}

#endif
