/* SPDX-License-Identifier: BSD-3-Clause */
/* Turns in units of 2 pi / 2^32, four at once: 32-bit integers, whose differences modulo 2^32 are the shorter arcs. */
#ifndef HAIRLUT_TURNS_H
#define HAIRLUT_TURNS_H

#include <stdint.h>

#include "quad.h"

#if defined(HAIRLUT_QUAD_SSE2)
typedef __m128i hairlut_turns;

/* clang-format off */
static inline hairlut_turns hairlut_turns_load(const int32_t *p) { return _mm_loadu_si128((const __m128i *)(const void *)p); }
static inline hairlut_turns hairlut_turns_sub(hairlut_turns a, hairlut_turns b) { return _mm_sub_epi32(a, b); }
static inline hairlut_quad hairlut_turns_float(hairlut_turns a) { return _mm_cvtepi32_ps(a); }
/* clang-format on */

#elif defined(HAIRLUT_QUAD_NEON)
typedef int32x4_t hairlut_turns;

/* clang-format off */
static inline hairlut_turns hairlut_turns_load(const int32_t *p) { return vld1q_s32(p); }
static inline hairlut_turns hairlut_turns_sub(hairlut_turns a, hairlut_turns b) { return vsubq_s32(a, b); }
static inline hairlut_quad hairlut_turns_float(hairlut_turns a) { return vcvtq_f32_s32(a); }
/* clang-format on */

#else
typedef struct hairlut_turns {
    int32_t lane[4];
} hairlut_turns;

static inline hairlut_turns hairlut_turns_load(const int32_t *p)
{
    const hairlut_turns a = {{p[0], p[1], p[2], p[3]}};
    return a;
}

static inline hairlut_turns hairlut_turns_sub(hairlut_turns a, hairlut_turns b)
{
    for (int l = 0; l < 4; ++l) {
        const uint32_t difference = (uint32_t)a.lane[l] - (uint32_t)b.lane[l];
        memcpy(&a.lane[l], &difference, sizeof difference); /* no conversion of what an int32_t has not */
    }
    return a;
}

static inline hairlut_quad hairlut_turns_float(hairlut_turns a)
{
    hairlut_quad quad;
    for (int l = 0; l < 4; ++l)
        quad.lane[l] = (float)a.lane[l];
    return quad;
}
#endif

#endif
