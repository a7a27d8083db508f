/* Eight lanes of 256 bits: what AVX2 and AVX-512 share of the operations of batch_kernel.h. They differ in truth values. */
#ifndef HAIRLUT_SIMD_256_H
#define HAIRLUT_SIMD_256_H

#include <immintrin.h>

typedef __m256 real;
typedef __m256i whole;
enum { LANES = 8 };

static inline real load(const float *p) { return _mm256_loadu_ps(p); }
static inline void store(float *p, real a) { _mm256_storeu_ps(p, a); }
static inline real all(float a) { return _mm256_set1_ps(a); }
static inline real add(real a, real b) { return _mm256_add_ps(a, b); }
static inline real sub(real a, real b) { return _mm256_sub_ps(a, b); }
static inline real mul(real a, real b) { return _mm256_mul_ps(a, b); }
static inline real over(real a, real b) { return _mm256_div_ps(a, b); }
static inline real root(real a) { return _mm256_sqrt_ps(a); }
static inline real smaller(real a, real b) { return _mm256_min_ps(a, b); }
static inline real larger(real a, real b) { return _mm256_max_ps(a, b); }
static inline real magnitude(real a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a); }

static inline whole iload(const int *p) { return _mm256_loadu_si256((const __m256i *)p); }
static inline void istore(int *p, whole a) { _mm256_storeu_si256((__m256i *)p, a); }
static inline whole iall(int a) { return _mm256_set1_epi32(a); }
static inline whole iadd(whole a, whole b) { return _mm256_add_epi32(a, b); }
static inline whole isub(whole a, whole b) { return _mm256_sub_epi32(a, b); }
static inline whole ismaller(whole a, whole b) { return _mm256_min_epi32(a, b); }
static inline whole imul(whole a, whole b) { return _mm256_madd_epi16(a, b); }
static inline whole truncated(real a) { return _mm256_cvttps_epi32(a); }
static inline real shifted(real a) { return _mm256_castsi256_ps(_mm256_srli_epi32(_mm256_castps_si256(a), 2)); }
static inline real converted(whole a) { return _mm256_cvtepi32_ps(a); }

static inline real quads(const float *p, const int *at)
{
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p + at[0])), _mm_loadu_ps(p + at[4]), 1);
}

static inline void gather4(const float *p, const int *at, real x[4])
{
    const real r0 = quads(p, at), r1 = quads(p, at + 1), r2 = quads(p, at + 2), r3 = quads(p, at + 3);
    const __m256d a = _mm256_castps_pd(_mm256_unpacklo_ps(r0, r1)), b = _mm256_castps_pd(_mm256_unpackhi_ps(r0, r1));
    const __m256d c = _mm256_castps_pd(_mm256_unpacklo_ps(r2, r3)), d = _mm256_castps_pd(_mm256_unpackhi_ps(r2, r3));
    x[0] = _mm256_castpd_ps(_mm256_unpacklo_pd(a, c));
    x[1] = _mm256_castpd_ps(_mm256_unpackhi_pd(a, c));
    x[2] = _mm256_castpd_ps(_mm256_unpacklo_pd(b, d));
    x[3] = _mm256_castpd_ps(_mm256_unpackhi_pd(b, d));
}

#endif
