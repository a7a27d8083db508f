/* The one step of the search for a cell that must be fast: counting, among neighbouring blended texels, those that are at
 * most x. A count has no branch that depends on x. The three forms give the same number. */
#ifndef HAIRLUT_COUNT_H
#define HAIRLUT_COUNT_H

#if defined(HAIRLUT_PORTABLE_COUNT)
#elif defined(__SSE2__) || defined(_M_X64)
#define HAIRLUT_COUNT_SSE2
#include <emmintrin.h>
#elif defined(__aarch64__) || defined(_M_ARM64)
#define HAIRLUT_COUNT_NEON
#include <arm_neon.h>
#endif

static inline float hairlut_blend(float a, float b, float t)
{
    return a + t * (b - a);
}

/* How many of the n blended texels from a on, blended with those at a + stride, are at most x. Up to three floats beyond
 * the n are read. */
#if defined(HAIRLUT_COUNT_SSE2)
static inline int hairlut_count(const float *a, int stride, float t, float x, int n)
{
    __m128i sum = _mm_setzero_si128();
    for (int k = 0; k < n; k += 4) {
        const __m128 low = _mm_loadu_ps(a + k), high = _mm_loadu_ps(a + stride + k);
        const __m128 blend = _mm_add_ps(low, _mm_mul_ps(_mm_set1_ps(t), _mm_sub_ps(high, low)));
        const __m128i inside = _mm_cmplt_epi32(_mm_set_epi32(3, 2, 1, 0), _mm_set1_epi32(n - k));
        sum = _mm_sub_epi32(sum, _mm_and_si128(inside, _mm_castps_si128(_mm_cmple_ps(blend, _mm_set1_ps(x)))));
    }
    sum = _mm_add_epi32(sum, _mm_shuffle_epi32(sum, _MM_SHUFFLE(1, 0, 3, 2)));
    sum = _mm_add_epi32(sum, _mm_shuffle_epi32(sum, _MM_SHUFFLE(2, 3, 0, 1)));
    return _mm_cvtsi128_si32(sum);
}
#elif defined(HAIRLUT_COUNT_NEON)
static inline int hairlut_count(const float *a, int stride, float t, float x, int n)
{
    static const int index[4] = {0, 1, 2, 3};
    uint32x4_t sum = vdupq_n_u32(0);
    for (int k = 0; k < n; k += 4) {
        const float32x4_t low = vld1q_f32(a + k), high = vld1q_f32(a + stride + k);
        const float32x4_t blend = vaddq_f32(low, vmulq_f32(vdupq_n_f32(t), vsubq_f32(high, low)));
        const uint32x4_t inside = vcltq_s32(vld1q_s32(index), vdupq_n_s32(n - k));
        sum = vsubq_u32(sum, vandq_u32(inside, vcleq_f32(blend, vdupq_n_f32(x))));
    }
    return (int)vaddvq_u32(sum);
}
#else
static inline int hairlut_count(const float *a, int stride, float t, float x, int n)
{
    int sum = 0;
    for (int k = 0; k < n; ++k)
        sum += hairlut_blend(a[k], a[stride + k], t) <= x;
    return sum;
}
#endif

#endif
