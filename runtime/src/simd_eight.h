/* SPDX-License-Identifier: BSD-3-Clause */
/* What both AVX2 and AVX-512 do in vectors of 256 bits: loads for single samples, and most shuffles behind them. */
#ifndef HAIRLUT_SIMD_EIGHT_H
#define HAIRLUT_SIMD_EIGHT_H

#include <immintrin.h>

#include "internal.h"

HAIRLUT_INLINE __m256 two_quads(const float *p, const int *at)
{
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p + at[0])), _mm_loadu_ps(p + at[4]), 1);
}

HAIRLUT_INLINE void gather_eight(const float *p, const int *at, __m256 x[4])
{
    const __m256 r0 = two_quads(p, at), r1 = two_quads(p, at + 1), r2 = two_quads(p, at + 2), r3 = two_quads(p, at + 3);
    const __m256d a = _mm256_castps_pd(_mm256_unpacklo_ps(r0, r1)), b = _mm256_castps_pd(_mm256_unpackhi_ps(r0, r1));
    const __m256d c = _mm256_castps_pd(_mm256_unpacklo_ps(r2, r3)), d = _mm256_castps_pd(_mm256_unpackhi_ps(r2, r3));
    x[0] = _mm256_castpd_ps(_mm256_unpacklo_pd(a, c));
    x[1] = _mm256_castpd_ps(_mm256_unpackhi_pd(a, c));
    x[2] = _mm256_castpd_ps(_mm256_unpacklo_pd(b, d));
    x[3] = _mm256_castpd_ps(_mm256_unpackhi_pd(b, d));
}

HAIRLUT_INLINE __m128 two_links(const hairlut_link *links, const int *at)
{
    const __m128 low = _mm_castpd_ps(_mm_load_sd((const double *)(const void *)(links + at[0])));
    return _mm_loadh_pi(low, (const __m64 *)(const void *)(links + at[1]));
}

HAIRLUT_INLINE void gather_eight_links(const hairlut_link *links, const int *at, __m256i *offset, __m256 *h)
{
    const __m256 a = _mm256_set_m128(two_links(links, at + 4), two_links(links, at));
    const __m256 b = _mm256_set_m128(two_links(links, at + 6), two_links(links, at + 2));
    *offset = _mm256_castps_si256(_mm256_shuffle_ps(a, b, _MM_SHUFFLE(2, 0, 2, 0)));
    *h = _mm256_shuffle_ps(a, b, _MM_SHUFFLE(3, 1, 3, 1));
}

/* -1 in the lanes of the eight blended texels that are at most x */
HAIRLUT_INLINE __m256i at_most(__m256 from, __m256 change, __m256 t, __m256 x)
{
    return _mm256_castps_si256(_mm256_cmp_ps(_mm256_add_ps(from, _mm256_mul_ps(t, change)), x, _CMP_LE_OQ));
}

HAIRLUT_INLINE __m256i tally(const float *group, const float *above, __m256 t, __m256 x, int n, int alike)
{
    const __m256 from = _mm256_loadu_ps(group);
    if (alike)
        return _mm256_castps_si256(_mm256_cmp_ps(from, x, _CMP_LE_OQ));
    const __m256 to = _mm256_loadu_ps(above);
    if (n == HAIRLUT_SMALL_GROUP)
        return at_most(from, to, t, x);
    const __m256 from8 = _mm256_loadu_ps(group + 8), to8 = _mm256_loadu_ps(above + 8);
    return _mm256_add_epi32(at_most(from, _mm256_sub_ps(to, from), t, x), at_most(from8, _mm256_sub_ps(to8, from8), t, x));
}

/* The tallies of samples 0 to 3, as bytes: those of sample k are number k of the four fours in both halves of a vector. Weights are
 * spread by shuffles, angles by loads, which are what a count has most of. */
HAIRLUT_INLINE __m256i four_tallies(const float *groups, const float *above, const int *at, const float *t, const float *x,
                                    int n, int alike)
{
    const __m256 t4 = _mm256_broadcast_ps((const __m128 *)(const void *)t);
    const __m256i k0 = tally(groups + at[0], above + at[0], _mm256_permute_ps(t4, 0x00), _mm256_set1_ps(x[0]), n, alike);
    const __m256i k1 = tally(groups + at[1], above + at[1], _mm256_permute_ps(t4, 0x55), _mm256_set1_ps(x[1]), n, alike);
    const __m256i k2 = tally(groups + at[2], above + at[2], _mm256_permute_ps(t4, 0xaa), _mm256_set1_ps(x[2]), n, alike);
    const __m256i k3 = tally(groups + at[3], above + at[3], _mm256_permute_ps(t4, 0xff), _mm256_set1_ps(x[3]), n, alike);
    return _mm256_packs_epi16(_mm256_packs_epi32(k0, k1), _mm256_packs_epi32(k2, k3));
}

/* Both halves are added, and the sum of each four turned positive. */
HAIRLUT_INLINE __m256i count_eight_groups(const float *groups, const float *above, const int *at, const float *t,
                                          const float *x, int n, int alike)
{
    const __m256i a = four_tallies(groups, above, at, t, x, n, alike),
                  b = four_tallies(groups, above, at + 4, t + 4, x + 4, n, alike);
    const __m256i bytes = _mm256_add_epi8(_mm256_permute2x128_si256(a, b, 0x20), _mm256_permute2x128_si256(a, b, 0x31));
    return _mm256_madd_epi16(_mm256_maddubs_epi16(_mm256_set1_epi8(1), bytes), _mm256_set1_epi16(-1));
}

#endif
