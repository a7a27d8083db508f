/* SPDX-License-Identifier: BSD-3-Clause */
/* Sixteen lanes of AVX-512 (F, DQ, BW, VL) for batch_kernel.h, which says what each operation must do. */
#ifndef HAIRLUT_SIMD_AVX512_H
#define HAIRLUT_SIMD_AVX512_H

#include "simd_eight.h"

typedef __m512 real;
typedef __m512i whole;
typedef __mmask16 mask;
enum { LANES = 16 };

/* clang-format off */
HAIRLUT_INLINE real load(const float *p) { return _mm512_loadu_ps(p); }
HAIRLUT_INLINE void store(float *p, real a) { _mm512_storeu_ps(p, a); }
HAIRLUT_INLINE real all(float a) { return _mm512_set1_ps(a); }
HAIRLUT_INLINE real add(real a, real b) { return _mm512_add_ps(a, b); }
HAIRLUT_INLINE real sub(real a, real b) { return _mm512_sub_ps(a, b); }
HAIRLUT_INLINE real mul(real a, real b) { return _mm512_mul_ps(a, b); }
HAIRLUT_INLINE real over(real a, real b) { return _mm512_div_ps(a, b); }
HAIRLUT_INLINE real root(real a) { return _mm512_sqrt_ps(a); }
HAIRLUT_INLINE real smaller(real a, real b) { return _mm512_min_ps(a, b); }
HAIRLUT_INLINE real larger(real a, real b) { return _mm512_max_ps(a, b); }
HAIRLUT_INLINE real magnitude(real a) { return _mm512_abs_ps(a); }
HAIRLUT_INLINE mask greater(real a, real b) { return _mm512_cmp_ps_mask(a, b, _CMP_GT_OQ); }
HAIRLUT_INLINE mask at_least(real a, real b) { return _mm512_cmp_ps_mask(a, b, _CMP_GE_OQ); }
HAIRLUT_INLINE mask numbers(real a, real b) { return _mm512_cmp_ps_mask(a, b, _CMP_ORD_Q); }
HAIRLUT_INLINE mask both(mask a, mask b) { return (mask)(a & b); }
HAIRLUT_INLINE int every(mask m) { return m == 0xffff; }
HAIRLUT_INLINE real choose(mask m, real a, real b) { return _mm512_mask_blend_ps(m, b, a); }
HAIRLUT_INLINE real flipped(real a, real s) { return _mm512_xor_ps(a, _mm512_and_ps(s, _mm512_set1_ps(-0.0f))); }
HAIRLUT_INLINE real by_sign(real a, real negative, real positive) { return choose(_mm512_movepi32_mask(_mm512_castps_si512(a)), negative, positive); }
HAIRLUT_INLINE whole iload(const int *p) { return _mm512_loadu_si512(p); }
HAIRLUT_INLINE void istore(int *p, whole a) { _mm512_storeu_si512(p, a); }
HAIRLUT_INLINE whole iall(int a) { return _mm512_set1_epi32(a); }
HAIRLUT_INLINE whole iadd(whole a, whole b) { return _mm512_add_epi32(a, b); }
HAIRLUT_INLINE whole isub(whole a, whole b) { return _mm512_sub_epi32(a, b); }
HAIRLUT_INLINE whole ismaller(whole a, whole b) { return _mm512_min_epi32(a, b); }
HAIRLUT_INLINE whole imul(whole a, whole b) { return _mm512_madd_epi16(a, b); }
HAIRLUT_INLINE whole iproduct(whole a, whole b) { return _mm512_mullo_epi32(a, b); }
HAIRLUT_INLINE mask iequal(whole a, whole b) { return _mm512_cmpeq_epi32_mask(a, b); }
HAIRLUT_INLINE mask igreater(whole a, whole b) { return _mm512_cmpgt_epi32_mask(a, b); }
HAIRLUT_INLINE whole iwhere(mask m, whole a) { return _mm512_maskz_mov_epi32(m, a); }
HAIRLUT_INLINE whole truncated(real a) { return _mm512_cvttps_epi32(a); }
HAIRLUT_INLINE real shifted(real a) { return _mm512_castsi512_ps(_mm512_srli_epi32(_mm512_castps_si512(a), 2)); }
HAIRLUT_INLINE whole as_whole(real a) { return _mm512_castps_si512(a); }
HAIRLUT_INLINE real converted(whole a) { return _mm512_cvtepi32_ps(a); }
/* clang-format on */

/* A vector of two halves */
HAIRLUT_INLINE real of_halves(__m256 low, __m256 high)
{
    return _mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
}

HAIRLUT_INLINE whole iof_halves(__m256i low, __m256i high)
{
    return _mm512_inserti32x8(_mm512_castsi256_si512(low), high, 1);
}

HAIRLUT_INLINE real four_quads(const float *p, const int *at)
{
    return of_halves(two_quads(p, at), two_quads(p, at + 8));
}

HAIRLUT_INLINE void gather4(const float *p, const int *at, real x[4])
{
    const real r0 = four_quads(p, at), r1 = four_quads(p, at + 1), r2 = four_quads(p, at + 2), r3 = four_quads(p, at + 3);
    const __m512d a = _mm512_castps_pd(_mm512_unpacklo_ps(r0, r1)), b = _mm512_castps_pd(_mm512_unpackhi_ps(r0, r1));
    const __m512d c = _mm512_castps_pd(_mm512_unpacklo_ps(r2, r3)), d = _mm512_castps_pd(_mm512_unpackhi_ps(r2, r3));
    x[0] = _mm512_castpd_ps(_mm512_unpacklo_pd(a, c));
    x[1] = _mm512_castpd_ps(_mm512_unpackhi_pd(a, c));
    x[2] = _mm512_castpd_ps(_mm512_unpacklo_pd(b, d));
    x[3] = _mm512_castpd_ps(_mm512_unpackhi_pd(b, d));
}

HAIRLUT_INLINE void gather_links(const hairlut_link *links, const int *at, whole *offset, real *h)
{
    __m256i low_offset, high_offset;
    __m256 low_h, high_h;
    gather_eight_links(links, at, &low_offset, &low_h);
    gather_eight_links(links, at + 8, &high_offset, &high_h);
    *offset = iof_halves(low_offset, high_offset);
    *h = of_halves(low_h, high_h);
}

#define HAIRLUT_COUNTS count_sixteen_groups
HAIRLUT_INLINE whole count_sixteen_groups(const float *groups, const float *above, const int *at, const float *t,
                                          const float *x, int n, int alike)
{
    return iof_halves(count_eight_groups(groups, above, at, t, x, n, alike),
                      count_eight_groups(groups, above, at + 8, t + 8, x + 8, n, alike));
}

typedef __m512i permutation;

HAIRLUT_INLINE permutation in_order(void)
{
    return _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

/* clang-format off */
HAIRLUT_INLINE int how_many(int lanes) { return _mm_popcnt_u32((unsigned)lanes); }
HAIRLUT_INLINE int lanes_of(mask m) { return m; }
HAIRLUT_INLINE permutation to_the_front(int lanes) { return _mm512_maskz_compress_epi32((mask)lanes, in_order()); }
HAIRLUT_INLINE permutation from_the_front(int lanes) { return _mm512_maskz_expand_epi32((mask)lanes, in_order()); }
HAIRLUT_INLINE real permuted(real a, permutation p) { return _mm512_permutexvar_ps(p, a); }
/* clang-format on */

HAIRLUT_INLINE real lookup(const float *table, int vectors, whole i)
{
    real found = permuted(load(table), i);
    for (int v = 1; v < vectors; ++v)
        found = choose(igreater(i, iall(v * LANES - 1)), permuted(load(table + v * LANES), i), found);
    return found;
}

#endif
