/* SPDX-License-Identifier: BSD-3-Clause */
/* Eight lanes of AVX2 for batch_kernel.h, which says what each operation must do. */
#ifndef HAIRLUT_SIMD_AVX2_H
#define HAIRLUT_SIMD_AVX2_H

#include "quad.h"
#include "simd_eight.h"

typedef __m256 real;
typedef __m256i whole;
typedef __m256 mask;
enum { LANES = 8 };

/* clang-format off */
HAIRLUT_INLINE real load(const float *p) { return _mm256_loadu_ps(p); }
HAIRLUT_INLINE void store(float *p, real a) { _mm256_storeu_ps(p, a); }
HAIRLUT_INLINE real all(float a) { return _mm256_set1_ps(a); }
HAIRLUT_INLINE real add(real a, real b) { return _mm256_add_ps(a, b); }
HAIRLUT_INLINE real sub(real a, real b) { return _mm256_sub_ps(a, b); }
HAIRLUT_INLINE real mul(real a, real b) { return _mm256_mul_ps(a, b); }
HAIRLUT_INLINE real over(real a, real b) { return _mm256_div_ps(a, b); }
HAIRLUT_INLINE real root(real a) { return _mm256_sqrt_ps(a); }
HAIRLUT_INLINE real smaller(real a, real b) { return _mm256_min_ps(a, b); }
HAIRLUT_INLINE real larger(real a, real b) { return _mm256_max_ps(a, b); }
HAIRLUT_INLINE real magnitude(real a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a); }
HAIRLUT_INLINE mask greater(real a, real b) { return _mm256_cmp_ps(a, b, _CMP_GT_OQ); }
HAIRLUT_INLINE mask at_least(real a, real b) { return _mm256_cmp_ps(a, b, _CMP_GE_OQ); }
HAIRLUT_INLINE mask numbers(real a, real b) { return _mm256_cmp_ps(a, b, _CMP_ORD_Q); }
HAIRLUT_INLINE mask both(mask a, mask b) { return _mm256_and_ps(a, b); }
HAIRLUT_INLINE int every(mask m) { return _mm256_movemask_ps(m) == 0xff; }
HAIRLUT_INLINE real choose(mask m, real a, real b) { return _mm256_blendv_ps(b, a, m); }
HAIRLUT_INLINE real flipped(real a, real s) { return _mm256_xor_ps(a, _mm256_and_ps(s, _mm256_set1_ps(-0.0f))); }
HAIRLUT_INLINE real by_sign(real a, real negative, real positive) { return _mm256_blendv_ps(positive, negative, a); }

HAIRLUT_INLINE whole iload(const int *p) { return _mm256_loadu_si256((const __m256i *)p); }
HAIRLUT_INLINE void istore(int *p, whole a) { _mm256_storeu_si256((__m256i *)p, a); }
HAIRLUT_INLINE whole iall(int a) { return _mm256_set1_epi32(a); }
HAIRLUT_INLINE whole iadd(whole a, whole b) { return _mm256_add_epi32(a, b); }
HAIRLUT_INLINE whole isub(whole a, whole b) { return _mm256_sub_epi32(a, b); }
HAIRLUT_INLINE whole ismaller(whole a, whole b) { return _mm256_min_epi32(a, b); }
HAIRLUT_INLINE whole imul(whole a, whole b) { return _mm256_madd_epi16(a, b); }
HAIRLUT_INLINE whole iproduct(whole a, whole b) { return _mm256_mullo_epi32(a, b); }
HAIRLUT_INLINE mask iequal(whole a, whole b) { return _mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b)); }
HAIRLUT_INLINE mask igreater(whole a, whole b) { return _mm256_castsi256_ps(_mm256_cmpgt_epi32(a, b)); }
HAIRLUT_INLINE whole iwhere(mask m, whole a) { return _mm256_and_si256(_mm256_castps_si256(m), a); }
HAIRLUT_INLINE whole truncated(real a) { return _mm256_cvttps_epi32(a); }
HAIRLUT_INLINE real shifted(real a) { return _mm256_castsi256_ps(_mm256_srli_epi32(_mm256_castps_si256(a), 2)); }
HAIRLUT_INLINE whole as_whole(real a) { return _mm256_castps_si256(a); }
HAIRLUT_INLINE real converted(whole a) { return _mm256_cvtepi32_ps(a); }
/* clang-format on */

HAIRLUT_INLINE void gather4(const float *p, const int *at, real x[4])
{
    gather_eight(p, at, x);
}

HAIRLUT_INLINE void gather_links(const hairlut_link *links, const int *at, whole *offset, real *h)
{
    gather_eight_links(links, at, offset, h);
}

#define HAIRLUT_COUNTS count_eight_groups

/* Permutations of eight lanes, four bits a lane, for each set of lanes, bit l of m for lane l. To the front: from the last lane on,
 * each one of the set moves those behind it up. From the front: each moves those behind it on by one. */
#define HAIRLUT_BIT(m, l) ((unsigned)(m) >> (l) & 1u)
#define HAIRLUT_PUSH(m, l, rest) ((rest) * (1 + 15 * HAIRLUT_BIT(m, l)) + (l) * HAIRLUT_BIT(m, l))
#define HAIRLUT_PUSH_TWO(m, l, rest) HAIRLUT_PUSH(m, l, HAIRLUT_PUSH(m, (l) + 1, rest))
#define HAIRLUT_PUSH_FOUR(m, l, rest) HAIRLUT_PUSH_TWO(m, l, HAIRLUT_PUSH_TWO(m, (l) + 2, rest))
#define HAIRLUT_TO_FRONT(m) HAIRLUT_PUSH_FOUR(m, 0, HAIRLUT_PUSH_FOUR(m, 4, 0u))
#define HAIRLUT_BEHIND(m, l) (HAIRLUT_BIT(m, l) * (0x11111110u << 4 * (l)))
#define HAIRLUT_BEHIND_FOUR(m, l) \
    (HAIRLUT_BEHIND(m, l) + HAIRLUT_BEHIND(m, (l) + 1) + HAIRLUT_BEHIND(m, (l) + 2) + HAIRLUT_BEHIND(m, (l) + 3))
#define HAIRLUT_FROM_FRONT(m) (HAIRLUT_BEHIND_FOUR(m, 0) + HAIRLUT_BEHIND_FOUR(m, 4))
#define HAIRLUT_SETS_4(f, m) f(m), f(m + 1), f(m + 2), f(m + 3)
#define HAIRLUT_SETS_16(f, m) \
    HAIRLUT_SETS_4(f, m), HAIRLUT_SETS_4(f, m + 4), HAIRLUT_SETS_4(f, m + 8), HAIRLUT_SETS_4(f, m + 12)
#define HAIRLUT_SETS_64(f, m) \
    HAIRLUT_SETS_16(f, m), HAIRLUT_SETS_16(f, m + 16), HAIRLUT_SETS_16(f, m + 32), HAIRLUT_SETS_16(f, m + 48)
#define HAIRLUT_SETS(f) HAIRLUT_SETS_64(f, 0), HAIRLUT_SETS_64(f, 64), HAIRLUT_SETS_64(f, 128), HAIRLUT_SETS_64(f, 192)
static const unsigned hairlut_to_front[256] = {HAIRLUT_SETS(HAIRLUT_TO_FRONT)},
                      hairlut_from_front[256] = {HAIRLUT_SETS(HAIRLUT_FROM_FRONT)};

typedef __m256i permutation;

HAIRLUT_INLINE permutation unpacked(unsigned lanes)
{
    return _mm256_srlv_epi32(_mm256_set1_epi32((int)lanes), _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28));
}

/* clang-format off */
HAIRLUT_INLINE int how_many(int lanes) { return hairlut_bits[lanes]; }
HAIRLUT_INLINE int lanes_of(mask m) { return _mm256_movemask_ps(m); }
HAIRLUT_INLINE permutation to_the_front(int lanes) { return unpacked(hairlut_to_front[lanes]); }
HAIRLUT_INLINE permutation from_the_front(int lanes) { return unpacked(hairlut_from_front[lanes]); }
HAIRLUT_INLINE real permuted(real a, permutation p) { return _mm256_permutevar8x32_ps(a, p); }
/* clang-format on */

HAIRLUT_INLINE real lookup(const float *table, int vectors, whole i)
{
    real found = permuted(load(table), i);
    for (int v = 1; v < vectors; ++v)
        found = choose(igreater(i, iall(v * LANES - 1)), permuted(load(table + v * LANES), i), found);
    return found;
}

#endif
