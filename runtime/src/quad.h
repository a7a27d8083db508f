/* SPDX-License-Identifier: BSD-3-Clause */
/* Four neighbouring floats at once, and a float's bits, where every processor of an architecture has the instructions:
 * x86-64, AArch64. The form in plain C gives the same numbers. */
#ifndef HAIRLUT_QUAD_H
#define HAIRLUT_QUAD_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(HAIRLUT_PLAIN_QUAD)
#elif defined(__SSE2__) || defined(_M_X64)
#define HAIRLUT_QUAD_SSE2
#include <emmintrin.h>
#elif defined(__aarch64__) || defined(_M_ARM64)
#define HAIRLUT_QUAD_NEON
#include <arm_neon.h>
#endif

/* Hides a constant from the optimiser. With a constant c, gcc compiles x > c ? x : c to a comparison and a jump, three
 * operations; with any other number to one: maxss. */
static inline float hairlut_constant(float c)
{
#if defined(HAIRLUT_QUAD_SSE2) && defined(__GNUC__)
    __asm__("" : "+x"(c));
#endif
    return c;
}

#if defined(HAIRLUT_QUAD_SSE2)
typedef __m128 hairlut_quad;

/* clang-format off */
static inline hairlut_quad hairlut_quad_load(const float *p) { return _mm_loadu_ps(p); }
static inline hairlut_quad hairlut_quad_all(float a) { return _mm_set1_ps(a); }
static inline hairlut_quad hairlut_quad_add(hairlut_quad a, hairlut_quad b) { return _mm_add_ps(a, b); }
static inline hairlut_quad hairlut_quad_sub(hairlut_quad a, hairlut_quad b) { return _mm_sub_ps(a, b); }
static inline hairlut_quad hairlut_quad_mul(hairlut_quad a, hairlut_quad b) { return _mm_mul_ps(a, b); }
/* clang-format on */

/* r >= 0 as its integer part and, in all lanes, its fraction. */
static inline hairlut_quad hairlut_quad_split(float r, int *integer)
{
    const __m128 all = _mm_set1_ps(r);
    const __m128i truncated = _mm_cvttps_epi32(all);
    *integer = _mm_cvtsi128_si32(truncated);
    return _mm_sub_ps(all, _mm_cvtepi32_ps(truncated));
}

/* clang-format off */
static inline hairlut_quad hairlut_quad_div(hairlut_quad a, hairlut_quad b) { return _mm_div_ps(a, b); }
static inline hairlut_quad hairlut_quad_sqrt(hairlut_quad a) { return _mm_sqrt_ps(a); }
static inline hairlut_quad hairlut_quad_max(hairlut_quad a, hairlut_quad b) { return _mm_max_ps(a, b); }
static inline hairlut_quad hairlut_quad_min(hairlut_quad a, hairlut_quad b) { return _mm_min_ps(a, b); }
static inline hairlut_quad hairlut_quad_abs(hairlut_quad a) { return _mm_andnot_ps(_mm_set1_ps(-0.0f), a); }
static inline void hairlut_quad_store(float *p, hairlut_quad a) { _mm_storeu_ps(p, a); }
static inline float hairlut_quad_first(hairlut_quad a) { return _mm_cvtss_f32(a); }
static inline float hairlut_quad_second(hairlut_quad a) { return _mm_cvtss_f32(_mm_shuffle_ps(a, a, 1)); }
static inline float hairlut_quad_last(hairlut_quad a) { return _mm_cvtss_f32(_mm_shuffle_ps(a, a, 3)); }
/* clang-format on */

/* `negative` where a's sign bit is set, else `positive` */
static inline hairlut_quad hairlut_quad_by_sign(hairlut_quad a, hairlut_quad negative, hairlut_quad positive)
{
    const __m128 sign = _mm_castsi128_ps(_mm_srai_epi32(_mm_castps_si128(a), 31));
    return _mm_or_ps(_mm_and_ps(sign, negative), _mm_andnot_ps(sign, positive));
}

/* Lane l of row k becomes lane k of row l. */
static inline void hairlut_quad_transpose(hairlut_quad row[4])
{
    _MM_TRANSPOSE4_PS(row[0], row[1], row[2], row[3]);
}

/* Lane l of a and of b become lanes 0 and 1 of column l; the other two are not used. */
static inline void hairlut_quad_pair(hairlut_quad a, hairlut_quad b, hairlut_quad column[4])
{
    const __m128 low = _mm_unpacklo_ps(a, b), high = _mm_unpackhi_ps(a, b);
    column[0] = low;
    column[1] = _mm_movehl_ps(low, low);
    column[2] = high;
    column[3] = _mm_movehl_ps(high, high);
}

/* x, the other lanes not used: gcc would clear them all the same, through an integer register. */
static inline hairlut_quad hairlut_quad_of(float x)
{
#if defined(__GNUC__) && !defined(__clang__)
    hairlut_quad a;
    __asm__("" : "=x"(a) : "0"(x));
    return a;
#else
    return _mm_set_ss(x);
#endif
}

static inline hairlut_quad hairlut_quad_of_four(float a, float b, float c, float d)
{
    const __m128 low = _mm_unpacklo_ps(hairlut_quad_of(a), hairlut_quad_of(b));
    return _mm_movelh_ps(low, _mm_unpacklo_ps(hairlut_quad_of(c), hairlut_quad_of(d)));
}

/* a and b in lanes 0 and 1; the others are not used */
static inline hairlut_quad hairlut_quad_of_two(float a, float b)
{
    return _mm_unpacklo_ps(hairlut_quad_of(a), hairlut_quad_of(b));
}

/* The float whose bits are those of s > 0 shifted right by two. */
static inline float hairlut_shifted(float s)
{
    return _mm_cvtss_f32(_mm_castsi128_ps(_mm_srli_epi32(_mm_castps_si128(hairlut_quad_of(s)), 2)));
}

typedef __m128i hairlut_tally; /* four counters */

static inline hairlut_tally hairlut_tally_zero(void)
{
    return _mm_setzero_si128();
}

/* Counts the lanes that are at most x. */
static inline hairlut_tally hairlut_tally_at_most(hairlut_tally tally, hairlut_quad a, float x)
{
    return _mm_sub_epi32(tally, _mm_castps_si128(_mm_cmple_ps(a, _mm_set1_ps(x))));
}

static inline int hairlut_tally_sum(hairlut_tally a)
{
    a = _mm_add_epi32(a, _mm_shuffle_epi32(a, _MM_SHUFFLE(1, 0, 3, 2)));
    return _mm_cvtsi128_si32(_mm_add_epi32(a, _mm_shuffle_epi32(a, _MM_SHUFFLE(2, 3, 0, 1))));
}

#elif defined(HAIRLUT_QUAD_NEON)
typedef float32x4_t hairlut_quad;

/* clang-format off */
static inline hairlut_quad hairlut_quad_load(const float *p) { return vld1q_f32(p); }
static inline hairlut_quad hairlut_quad_all(float a) { return vdupq_n_f32(a); }
static inline hairlut_quad hairlut_quad_add(hairlut_quad a, hairlut_quad b) { return vaddq_f32(a, b); }
static inline hairlut_quad hairlut_quad_sub(hairlut_quad a, hairlut_quad b) { return vsubq_f32(a, b); }
static inline hairlut_quad hairlut_quad_mul(hairlut_quad a, hairlut_quad b) { return vmulq_f32(a, b); }
/* clang-format on */

static inline hairlut_quad hairlut_quad_split(float r, int *integer)
{
    *integer = (int)r;
    return vdupq_n_f32(r - (float)*integer);
}

/* clang-format off */
static inline hairlut_quad hairlut_quad_div(hairlut_quad a, hairlut_quad b) { return vdivq_f32(a, b); }
static inline hairlut_quad hairlut_quad_sqrt(hairlut_quad a) { return vsqrtq_f32(a); }
static inline hairlut_quad hairlut_quad_max(hairlut_quad a, hairlut_quad b) { return vbslq_f32(vcgtq_f32(a, b), a, b); }
static inline hairlut_quad hairlut_quad_min(hairlut_quad a, hairlut_quad b) { return vbslq_f32(vcltq_f32(a, b), a, b); }
static inline hairlut_quad hairlut_quad_abs(hairlut_quad a) { return vabsq_f32(a); }
static inline void hairlut_quad_store(float *p, hairlut_quad a) { vst1q_f32(p, a); }
static inline float hairlut_quad_first(hairlut_quad a) { return vgetq_lane_f32(a, 0); }
static inline float hairlut_quad_second(hairlut_quad a) { return vgetq_lane_f32(a, 1); }
static inline float hairlut_quad_last(hairlut_quad a) { return vgetq_lane_f32(a, 3); }
/* clang-format on */

static inline hairlut_quad hairlut_quad_by_sign(hairlut_quad a, hairlut_quad negative, hairlut_quad positive)
{
    return vbslq_f32(vreinterpretq_u32_s32(vshrq_n_s32(vreinterpretq_s32_f32(a), 31)), negative, positive);
}

static inline void hairlut_quad_transpose(hairlut_quad row[4])
{
    const float32x4x2_t a = vtrnq_f32(row[0], row[1]), b = vtrnq_f32(row[2], row[3]);
    row[0] = vcombine_f32(vget_low_f32(a.val[0]), vget_low_f32(b.val[0]));
    row[1] = vcombine_f32(vget_low_f32(a.val[1]), vget_low_f32(b.val[1]));
    row[2] = vcombine_f32(vget_high_f32(a.val[0]), vget_high_f32(b.val[0]));
    row[3] = vcombine_f32(vget_high_f32(a.val[1]), vget_high_f32(b.val[1]));
}

static inline void hairlut_quad_pair(hairlut_quad a, hairlut_quad b, hairlut_quad column[4])
{
    column[0] = a, column[1] = b, column[2] = a, column[3] = b;
    hairlut_quad_transpose(column);
}

static inline hairlut_quad hairlut_quad_of_four(float a, float b, float c, float d)
{
    const float lane[4] = {a, b, c, d};
    return vld1q_f32(lane);
}

static inline hairlut_quad hairlut_quad_of_two(float a, float b)
{
    return hairlut_quad_of_four(a, b, a, b);
}

static inline float hairlut_shifted(float s)
{
    return vget_lane_f32(vreinterpret_f32_u32(vshr_n_u32(vreinterpret_u32_f32(vdup_n_f32(s)), 2)), 0);
}

typedef uint32x4_t hairlut_tally;

static inline hairlut_tally hairlut_tally_zero(void)
{
    return vdupq_n_u32(0);
}

static inline hairlut_tally hairlut_tally_at_most(hairlut_tally tally, hairlut_quad a, float x)
{
    return vsubq_u32(tally, vcleq_f32(a, vdupq_n_f32(x)));
}

static inline int hairlut_tally_sum(hairlut_tally a)
{
    return (int)vaddvq_u32(a);
}

#else
typedef struct hairlut_quad {
    float lane[4];
} hairlut_quad;

static inline hairlut_quad hairlut_quad_load(const float *p)
{
    const hairlut_quad a = {{p[0], p[1], p[2], p[3]}};
    return a;
}

static inline hairlut_quad hairlut_quad_all(float x)
{
    const hairlut_quad a = {{x, x, x, x}};
    return a;
}

static inline hairlut_quad hairlut_quad_add(hairlut_quad a, hairlut_quad b)
{
    for (int l = 0; l < 4; ++l)
        a.lane[l] += b.lane[l];
    return a;
}

static inline hairlut_quad hairlut_quad_sub(hairlut_quad a, hairlut_quad b)
{
    for (int l = 0; l < 4; ++l)
        a.lane[l] -= b.lane[l];
    return a;
}

static inline hairlut_quad hairlut_quad_mul(hairlut_quad a, hairlut_quad b)
{
    for (int l = 0; l < 4; ++l)
        a.lane[l] *= b.lane[l];
    return a;
}

static inline hairlut_quad hairlut_quad_split(float r, int *integer)
{
    *integer = (int)r;
    return hairlut_quad_all(r - (float)*integer);
}

static inline hairlut_quad hairlut_quad_div(hairlut_quad a, hairlut_quad b)
{
    for (int l = 0; l < 4; ++l)
        a.lane[l] /= b.lane[l];
    return a;
}

static inline hairlut_quad hairlut_quad_sqrt(hairlut_quad a)
{
    for (int l = 0; l < 4; ++l)
        a.lane[l] = sqrtf(a.lane[l]);
    return a;
}

static inline hairlut_quad hairlut_quad_max(hairlut_quad a, hairlut_quad b)
{
    for (int l = 0; l < 4; ++l)
        a.lane[l] = a.lane[l] > b.lane[l] ? a.lane[l] : b.lane[l];
    return a;
}

static inline hairlut_quad hairlut_quad_min(hairlut_quad a, hairlut_quad b)
{
    for (int l = 0; l < 4; ++l)
        a.lane[l] = a.lane[l] < b.lane[l] ? a.lane[l] : b.lane[l];
    return a;
}

static inline hairlut_quad hairlut_quad_abs(hairlut_quad a)
{
    for (int l = 0; l < 4; ++l)
        a.lane[l] = fabsf(a.lane[l]);
    return a;
}

/* clang-format off */
static inline void hairlut_quad_store(float *p, hairlut_quad a) { memcpy(p, a.lane, sizeof a.lane); }
static inline float hairlut_quad_first(hairlut_quad a) { return a.lane[0]; }
static inline float hairlut_quad_second(hairlut_quad a) { return a.lane[1]; }
static inline float hairlut_quad_last(hairlut_quad a) { return a.lane[3]; }
/* clang-format on */

static inline hairlut_quad hairlut_quad_by_sign(hairlut_quad a, hairlut_quad negative, hairlut_quad positive)
{
    for (int l = 0; l < 4; ++l)
        a.lane[l] = signbit(a.lane[l]) ? negative.lane[l] : positive.lane[l];
    return a;
}

static inline void hairlut_quad_transpose(hairlut_quad row[4])
{
    for (int k = 0; k < 4; ++k)
        for (int l = 0; l < k; ++l) {
            const float kept = row[k].lane[l];
            row[k].lane[l] = row[l].lane[k];
            row[l].lane[k] = kept;
        }
}

static inline void hairlut_quad_pair(hairlut_quad a, hairlut_quad b, hairlut_quad column[4])
{
    column[0] = a, column[1] = b, column[2] = a, column[3] = b;
    hairlut_quad_transpose(column);
}

static inline hairlut_quad hairlut_quad_of_four(float a, float b, float c, float d)
{
    const hairlut_quad quad = {{a, b, c, d}};
    return quad;
}

static inline hairlut_quad hairlut_quad_of_two(float a, float b)
{
    return hairlut_quad_of_four(a, b, a, b);
}

static inline float hairlut_shifted(float s)
{
    uint32_t bits;
    memcpy(&bits, &s, sizeof bits);
    bits >>= 2;
    memcpy(&s, &bits, sizeof s);
    return s;
}

typedef int hairlut_tally;

static inline hairlut_tally hairlut_tally_zero(void)
{
    return 0;
}

static inline hairlut_tally hairlut_tally_at_most(hairlut_tally tally, hairlut_quad a, float x)
{
    for (int l = 0; l < 4; ++l)
        tally += a.lane[l] <= x;
    return tally;
}

static inline int hairlut_tally_sum(hairlut_tally a)
{
    return a;
}
#endif

#endif
