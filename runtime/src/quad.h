/* SPDX-License-Identifier: BSD-3-Clause */
/* Four neighbouring floats at once, and a float's bits, where every processor of an architecture has the instructions:
 * x86-64, AArch64. The form in plain C gives the same numbers. hairlut_quad_load reads from multiples of 16 bytes, hairlut_quad_anywhere from any address. Of lanes:
 * hairlut_quad_where_equal(a, b, x) is x where a == b, else 0; hairlut_quad_swapped, those of each half exchanged;
 * hairlut_quad_list(a, first, list), how many are above 0, whose numbers from first on go to list, which has room for four;
 * hairlut_quad_mask, a bit for each lane of a that is at most x; hairlut_quad_count, how many are, hairlut_quad_count_two, how many of a and b. */
#ifndef HAIRLUT_QUAD_H
#define HAIRLUT_QUAD_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(HAIRLUT_PLAIN_QUAD)
#elif defined(__SSE2__) || defined(_M_X64)
#define HAIRLUT_QUAD_SSE2
#include <immintrin.h>
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

/* How many bits of 0 .. 255 are set: not every x86-64 has an instruction for it. */
#define HAIRLUT_BITS_2(n) n, n + 1, n + 1, n + 2
#define HAIRLUT_BITS_4(n) HAIRLUT_BITS_2(n), HAIRLUT_BITS_2(n + 1), HAIRLUT_BITS_2(n + 1), HAIRLUT_BITS_2(n + 2)
#define HAIRLUT_BITS_6(n) HAIRLUT_BITS_4(n), HAIRLUT_BITS_4(n + 1), HAIRLUT_BITS_4(n + 1), HAIRLUT_BITS_4(n + 2)
static const unsigned char hairlut_bits[256] = {HAIRLUT_BITS_6(0), HAIRLUT_BITS_6(1), HAIRLUT_BITS_6(1), HAIRLUT_BITS_6(2)};

#if defined(HAIRLUT_QUAD_SSE2)
typedef __m128 hairlut_quad;

/* clang-format off */
static inline hairlut_quad hairlut_quad_load(const float *p) { return _mm_load_ps(p); }
static inline hairlut_quad hairlut_quad_anywhere(const float *p) { return _mm_loadu_ps(p); }
static inline void hairlut_quad_store(float *p, hairlut_quad a) { _mm_storeu_ps(p, a); }
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
static inline hairlut_quad hairlut_quad_abs(hairlut_quad a) { return _mm_and_ps(_mm_castsi128_ps(_mm_set1_epi32(0x7fffffff)), a); }
static inline hairlut_quad hairlut_quad_where_equal(hairlut_quad a, hairlut_quad b, hairlut_quad x) { return _mm_and_ps(_mm_cmpeq_ps(a, b), x); }
static inline hairlut_quad hairlut_quad_swapped(hairlut_quad a) { return _mm_shuffle_ps(a, a, _MM_SHUFFLE(2, 3, 0, 1)); }
static inline float hairlut_quad_first(hairlut_quad a) { return _mm_cvtss_f32(a); }
static inline float hairlut_quad_second(hairlut_quad a) { return _mm_cvtss_f32(_mm_shuffle_ps(a, a, 1)); }
static inline float hairlut_quad_third(hairlut_quad a) { return _mm_cvtss_f32(_mm_movehl_ps(a, a)); }
static inline float hairlut_quad_last(hairlut_quad a) { return _mm_cvtss_f32(_mm_shuffle_ps(a, a, 3)); }
/* clang-format on */

/* a, negated where s's sign bit is set */
static inline hairlut_quad hairlut_quad_flipped(hairlut_quad a, hairlut_quad s)
{
    return _mm_xor_ps(a, _mm_and_ps(s, _mm_set1_ps(-0.0f)));
}

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

static inline unsigned hairlut_quad_mask(hairlut_quad a, hairlut_quad x)
{
    return (unsigned)_mm_movemask_ps(_mm_cmple_ps(a, x));
}

static inline unsigned hairlut_quad_count(hairlut_quad a, hairlut_quad x)
{
    return hairlut_bits[hairlut_quad_mask(a, x)];
}

static inline unsigned hairlut_quad_count_two(hairlut_quad a, hairlut_quad b, hairlut_quad x)
{
    const __m128i counted = _mm_packs_epi32(_mm_castps_si128(_mm_cmple_ps(a, x)), _mm_castps_si128(_mm_cmple_ps(b, x)));
#ifdef __POPCNT__
    return (unsigned)_mm_popcnt_u32((unsigned)_mm_movemask_epi8(counted)) / 2;
#else
    return hairlut_bits[_mm_movemask_epi8(_mm_packs_epi16(counted, counted)) & 255];
#endif
}

/* The numbers of the lanes whose bits are set, in order. */
static const int hairlut_lanes[16][4] = {{0}, {0},    {1},    {0, 1},    {2},    {0, 2},    {1, 2},    {0, 1, 2},
                                         {3}, {0, 3}, {1, 3}, {0, 1, 3}, {2, 3}, {0, 2, 3}, {1, 2, 3}, {0, 1, 2, 3}};

static inline int hairlut_quad_list(hairlut_quad a, int first, int *list)
{
    const int bits = _mm_movemask_ps(_mm_cmpgt_ps(a, _mm_setzero_ps()));
    const __m128i numbers = _mm_loadu_si128((const __m128i *)(const void *)hairlut_lanes[bits]);
    _mm_storeu_si128((__m128i *)(void *)list, _mm_add_epi32(numbers, _mm_set1_epi32(first)));
    return hairlut_bits[bits];
}

#elif defined(HAIRLUT_QUAD_NEON)
typedef float32x4_t hairlut_quad;

/* clang-format off */
static inline hairlut_quad hairlut_quad_load(const float *p) { return vld1q_f32(p); }
static inline hairlut_quad hairlut_quad_anywhere(const float *p) { return vld1q_f32(p); }
static inline void hairlut_quad_store(float *p, hairlut_quad a) { vst1q_f32(p, a); }
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
static inline hairlut_quad hairlut_quad_where_equal(hairlut_quad a, hairlut_quad b, hairlut_quad x) { return vbslq_f32(vceqq_f32(a, b), x, vdupq_n_f32(0.0f)); }
static inline hairlut_quad hairlut_quad_swapped(hairlut_quad a) { return vrev64q_f32(a); }
static inline float hairlut_quad_first(hairlut_quad a) { return vgetq_lane_f32(a, 0); }
static inline float hairlut_quad_second(hairlut_quad a) { return vgetq_lane_f32(a, 1); }
static inline float hairlut_quad_third(hairlut_quad a) { return vgetq_lane_f32(a, 2); }
static inline float hairlut_quad_last(hairlut_quad a) { return vgetq_lane_f32(a, 3); }
/* clang-format on */

static inline hairlut_quad hairlut_quad_flipped(hairlut_quad a, hairlut_quad s)
{
    const uint32x4_t sign = vandq_u32(vreinterpretq_u32_f32(s), vdupq_n_u32(0x80000000u));
    return vreinterpretq_f32_u32(veorq_u32(vreinterpretq_u32_f32(a), sign));
}

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

static inline unsigned hairlut_quad_mask(hairlut_quad a, hairlut_quad x)
{
    static const uint32_t bits[4] = {1, 2, 4, 8};
    return vaddvq_u32(vandq_u32(vcleq_f32(a, x), vld1q_u32(bits)));
}

static inline unsigned hairlut_quad_count(hairlut_quad a, hairlut_quad x)
{
    return vaddvq_u32(vshrq_n_u32(vcleq_f32(a, x), 31));
}

static inline unsigned hairlut_quad_count_two(hairlut_quad a, hairlut_quad b, hairlut_quad x)
{
    return vaddvq_u32(vaddq_u32(vshrq_n_u32(vcleq_f32(a, x), 31), vshrq_n_u32(vcleq_f32(b, x), 31)));
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

static inline hairlut_quad hairlut_quad_anywhere(const float *p)
{
    return hairlut_quad_load(p);
}

static inline void hairlut_quad_store(float *p, hairlut_quad a)
{
    memcpy(p, a.lane, sizeof a.lane);
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

static inline hairlut_quad hairlut_quad_where_equal(hairlut_quad a, hairlut_quad b, hairlut_quad x)
{
    for (int l = 0; l < 4; ++l)
        x.lane[l] = a.lane[l] == b.lane[l] ? x.lane[l] : 0.0f;
    return x;
}

static inline hairlut_quad hairlut_quad_swapped(hairlut_quad a)
{
    const hairlut_quad swapped = {{a.lane[1], a.lane[0], a.lane[3], a.lane[2]}};
    return swapped;
}

/* clang-format off */
static inline float hairlut_quad_first(hairlut_quad a) { return a.lane[0]; }
static inline float hairlut_quad_second(hairlut_quad a) { return a.lane[1]; }
static inline float hairlut_quad_third(hairlut_quad a) { return a.lane[2]; }
static inline float hairlut_quad_last(hairlut_quad a) { return a.lane[3]; }
/* clang-format on */

static inline hairlut_quad hairlut_quad_flipped(hairlut_quad a, hairlut_quad s)
{
    for (int l = 0; l < 4; ++l)
        a.lane[l] *= copysignf(1.0f, s.lane[l]);
    return a;
}

static inline hairlut_quad hairlut_quad_by_sign(hairlut_quad a, hairlut_quad negative, hairlut_quad positive)
{
    for (int l = 0; l < 4; ++l) /* signbit ends gcc 12 in an internal error */
        a.lane[l] = copysignf(1.0f, a.lane[l]) < 0.0f ? negative.lane[l] : positive.lane[l];
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

static inline unsigned hairlut_quad_mask(hairlut_quad a, hairlut_quad x)
{
    unsigned bits = 0;
    for (int l = 0; l < 4; ++l)
        bits |= (unsigned)(a.lane[l] <= x.lane[l]) << l;
    return bits;
}

static inline unsigned hairlut_quad_count(hairlut_quad a, hairlut_quad x)
{
    unsigned count = 0;
    for (int l = 0; l < 4; ++l)
        count += a.lane[l] <= x.lane[l];
    return count;
}

static inline unsigned hairlut_quad_count_two(hairlut_quad a, hairlut_quad b, hairlut_quad x)
{
    return hairlut_quad_count(a, x) + hairlut_quad_count(b, x);
}
#endif

#ifndef HAIRLUT_QUAD_EIGHT
/* p[k] + t p[k + 8] of four numbers */
static inline hairlut_quad hairlut_quad_along(const float *p, hairlut_quad t)
{
    return hairlut_quad_add(hairlut_quad_load(p), hairlut_quad_mul(t, hairlut_quad_load(p + 8)));
}

static inline unsigned hairlut_count_eight(const float *p, hairlut_quad t, hairlut_quad x)
{
    return hairlut_quad_count_two(hairlut_quad_along(p, t), hairlut_quad_along(p + 4, t), x);
}
#endif

#if !defined(HAIRLUT_QUAD_SSE2)
static inline int hairlut_quad_list(hairlut_quad a, int first, int *list)
{
    float lane[4];
    int count = 0;
    hairlut_quad_store(lane, a);
    for (int l = 0; l < 4; ++l) {
        list[count] = first + l;
        count += lane[l] > 0.0f;
        if (count == 4) /* full */
            break;
    }
    return count;
}
#endif

#endif
