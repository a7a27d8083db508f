/* SPDX-License-Identifier: BSD-3-Clause */
/* Four lanes of AArch64 Advanced SIMD for batch_kernel.h, which says what each operation must do. */
#ifndef HAIRLUT_SIMD_NEON_H
#define HAIRLUT_SIMD_NEON_H

#include <arm_neon.h>

#include "internal.h"
#include "quad.h"

typedef float32x4_t real;
typedef int32x4_t whole;
typedef uint32x4_t mask;
enum { LANES = 4 };

/* clang-format off */
HAIRLUT_INLINE real load(const float *p) { return vld1q_f32(p); }
HAIRLUT_INLINE void store(float *p, real a) { vst1q_f32(p, a); }
HAIRLUT_INLINE real all(float a) { return vdupq_n_f32(a); }
HAIRLUT_INLINE real add(real a, real b) { return vaddq_f32(a, b); }
HAIRLUT_INLINE real sub(real a, real b) { return vsubq_f32(a, b); }
HAIRLUT_INLINE real mul(real a, real b) { return vmulq_f32(a, b); }
HAIRLUT_INLINE real over(real a, real b) { return vdivq_f32(a, b); }
HAIRLUT_INLINE real root(real a) { return vsqrtq_f32(a); }
HAIRLUT_INLINE real magnitude(real a) { return vabsq_f32(a); }
HAIRLUT_INLINE mask greater(real a, real b) { return vcgtq_f32(a, b); }
HAIRLUT_INLINE mask at_least(real a, real b) { return vcgeq_f32(a, b); }
HAIRLUT_INLINE mask both(mask a, mask b) { return vandq_u32(a, b); }
HAIRLUT_INLINE int every(mask m) { return vminvq_u32(m) != 0; }
HAIRLUT_INLINE mask numbers(real a, real b) { return both(vceqq_f32(a, a), vceqq_f32(b, b)); }
HAIRLUT_INLINE real choose(mask m, real a, real b) { return vbslq_f32(m, a, b); }
/* clang-format on */
HAIRLUT_INLINE real flipped(real a, real s)
{
    const uint32x4_t sign = vandq_u32(vreinterpretq_u32_f32(s), vdupq_n_u32(0x80000000u));
    return vreinterpretq_f32_u32(veorq_u32(vreinterpretq_u32_f32(a), sign));
}
HAIRLUT_INLINE real by_sign(real a, real negative, real positive)
{
    return choose(vreinterpretq_u32_s32(vshrq_n_s32(vreinterpretq_s32_f32(a), 31)), negative, positive);
}
/* clang-format off */
HAIRLUT_INLINE real smaller(real a, real b) { return choose(greater(b, a), a, b); }
HAIRLUT_INLINE real larger(real a, real b) { return choose(greater(a, b), a, b); }

HAIRLUT_INLINE whole iload(const int *p) { return vld1q_s32(p); }
HAIRLUT_INLINE void istore(int *p, whole a) { vst1q_s32(p, a); }
HAIRLUT_INLINE whole iall(int a) { return vdupq_n_s32(a); }
HAIRLUT_INLINE whole iadd(whole a, whole b) { return vaddq_s32(a, b); }
HAIRLUT_INLINE whole isub(whole a, whole b) { return vsubq_s32(a, b); }
HAIRLUT_INLINE whole ismaller(whole a, whole b) { return vminq_s32(a, b); }
HAIRLUT_INLINE whole imul(whole a, whole b) { return vmulq_s32(a, b); }
HAIRLUT_INLINE whole iproduct(whole a, whole b) { return vmulq_s32(a, b); }
HAIRLUT_INLINE mask iequal(whole a, whole b) { return vceqq_s32(a, b); }
HAIRLUT_INLINE mask igreater(whole a, whole b) { return vcgtq_s32(a, b); }
HAIRLUT_INLINE whole iwhere(mask m, whole a) { return vandq_s32(vreinterpretq_s32_u32(m), a); }
HAIRLUT_INLINE whole truncated(real a) { return vcvtq_s32_f32(a); }
HAIRLUT_INLINE real shifted(real a) { return vreinterpretq_f32_u32(vshrq_n_u32(vreinterpretq_u32_f32(a), 2)); }
HAIRLUT_INLINE whole as_whole(real a) { return vreinterpretq_s32_f32(a); }
HAIRLUT_INLINE real converted(whole a) { return vcvtq_f32_s32(a); }
/* clang-format on */

HAIRLUT_INLINE void gather4(const float *p, const int *at, real x[4])
{
    const float32x4x2_t a = vtrnq_f32(load(p + at[0]), load(p + at[1]));
    const float32x4x2_t b = vtrnq_f32(load(p + at[2]), load(p + at[3]));
    x[0] = vcombine_f32(vget_low_f32(a.val[0]), vget_low_f32(b.val[0]));
    x[1] = vcombine_f32(vget_low_f32(a.val[1]), vget_low_f32(b.val[1]));
    x[2] = vcombine_f32(vget_high_f32(a.val[0]), vget_high_f32(b.val[0]));
    x[3] = vcombine_f32(vget_high_f32(a.val[1]), vget_high_f32(b.val[1]));
}

HAIRLUT_INLINE float32x2_t one_link(const hairlut_link *links, int at)
{
    return vreinterpret_f32_u32(vld1_u32(&links[at].offset)); /* and h, which follows */
}

HAIRLUT_INLINE void gather_links(const hairlut_link *links, const int *at, whole *offset, real *h)
{
    const float32x4_t a = vcombine_f32(one_link(links, at[0]), one_link(links, at[1]));
    const float32x4_t b = vcombine_f32(one_link(links, at[2]), one_link(links, at[3]));
    const float32x4x2_t both_parts = vuzpq_f32(a, b);
    *offset = vreinterpretq_s32_f32(both_parts.val[0]);
    *h = both_parts.val[1];
}

/* The bytes of lanes a, b, c and d, in this order. Of a set of lanes, bit l for lane l, to the front and from there. */
#define HAIRLUT_BYTES(l) 4 * l, 4 * l + 1, 4 * l + 2, 4 * l + 3
#define HAIRLUT_FOUR(a, b, c, d) {HAIRLUT_BYTES(a), HAIRLUT_BYTES(b), HAIRLUT_BYTES(c), HAIRLUT_BYTES(d)}
static const uint8_t hairlut_to_front[16][16] = {
    HAIRLUT_FOUR(0, 0, 0, 0), HAIRLUT_FOUR(0, 0, 0, 0), HAIRLUT_FOUR(1, 0, 0, 0), HAIRLUT_FOUR(0, 1, 0, 0),
    HAIRLUT_FOUR(2, 0, 0, 0), HAIRLUT_FOUR(0, 2, 0, 0), HAIRLUT_FOUR(1, 2, 0, 0), HAIRLUT_FOUR(0, 1, 2, 0),
    HAIRLUT_FOUR(3, 0, 0, 0), HAIRLUT_FOUR(0, 3, 0, 0), HAIRLUT_FOUR(1, 3, 0, 0), HAIRLUT_FOUR(0, 1, 3, 0),
    HAIRLUT_FOUR(2, 3, 0, 0), HAIRLUT_FOUR(0, 2, 3, 0), HAIRLUT_FOUR(1, 2, 3, 0), HAIRLUT_FOUR(0, 1, 2, 3)};
static const uint8_t hairlut_from_front[16][16] = {
    HAIRLUT_FOUR(0, 0, 0, 0), HAIRLUT_FOUR(0, 1, 1, 1), HAIRLUT_FOUR(0, 0, 1, 1), HAIRLUT_FOUR(0, 1, 2, 2),
    HAIRLUT_FOUR(0, 0, 0, 1), HAIRLUT_FOUR(0, 1, 1, 2), HAIRLUT_FOUR(0, 0, 1, 2), HAIRLUT_FOUR(0, 1, 2, 3),
    HAIRLUT_FOUR(0, 0, 0, 0), HAIRLUT_FOUR(0, 1, 1, 1), HAIRLUT_FOUR(0, 0, 1, 1), HAIRLUT_FOUR(0, 1, 2, 2),
    HAIRLUT_FOUR(0, 0, 0, 1), HAIRLUT_FOUR(0, 1, 1, 2), HAIRLUT_FOUR(0, 0, 1, 2), HAIRLUT_FOUR(0, 1, 2, 3)};

typedef uint8x16_t permutation;

HAIRLUT_INLINE int lanes_of(mask m)
{
    static const uint32_t bits[4] = {1, 2, 4, 8};
    return (int)vaddvq_u32(vandq_u32(m, vld1q_u32(bits)));
}

/* clang-format off */
HAIRLUT_INLINE int how_many(int lanes) { return hairlut_bits[lanes]; }
HAIRLUT_INLINE permutation to_the_front(int lanes) { return vld1q_u8(hairlut_to_front[lanes]); }
HAIRLUT_INLINE permutation from_the_front(int lanes) { return vld1q_u8(hairlut_from_front[lanes]); }
/* clang-format on */
HAIRLUT_INLINE real permuted(real a, permutation p)
{
    return vreinterpretq_f32_u8(vqtbl1q_u8(vreinterpretq_u8_f32(a), p));
}

HAIRLUT_INLINE real lookup(const float *table, int vectors, whole i)
{
    const float found[4] = {table[vgetq_lane_s32(i, 0)], table[vgetq_lane_s32(i, 1)], table[vgetq_lane_s32(i, 2)],
                            table[vgetq_lane_s32(i, 3)]};
    (void)vectors;
    return load(found);
}

#endif
