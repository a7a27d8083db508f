/* Stands in for the compiler's immintrin.h: SIMDe computes every instruction in plain C, so that the AVX-512 kernels run
 * on processors without it. Slow; for test_batch.py. */
#ifndef EMULATED_IMMINTRIN_H
#define EMULATED_IMMINTRIN_H

#define SIMDE_NO_NATIVE
#define SIMDE_ENABLE_NATIVE_ALIASES
#include <simde/x86/avx2.h>
#include <simde/x86/avx512.h>

typedef simde__mmask16 __mmask16;

#ifndef _mm_popcnt_u32
#define _mm_popcnt_u32(a) __builtin_popcount(a)
#endif

/* What SIMDe 0.7 lacks, from what it has for half a vector */
typedef union emulated_halves {
    simde__m512i integers;
    simde__m512 floats;
    simde__m256i integer[2];
    simde__m256 real[2];
} emulated_halves;

#ifndef _mm512_cvttps_epi32
static inline simde__m512i emulated_cvttps_epi32(simde__m512 a)
{
    const emulated_halves from = {.floats = a};
    const emulated_halves to = {.integer = {simde_mm256_cvttps_epi32(from.real[0]), simde_mm256_cvttps_epi32(from.real[1])}};
    return to.integers;
}
#define _mm512_cvttps_epi32 emulated_cvttps_epi32
#endif

#ifndef _mm512_cvtepi32_ps
static inline simde__m512 emulated_cvtepi32_ps(simde__m512i a)
{
    const emulated_halves from = {.integers = a};
    const emulated_halves to = {.real = {simde_mm256_cvtepi32_ps(from.integer[0]), simde_mm256_cvtepi32_ps(from.integer[1])}};
    return to.floats;
}
#define _mm512_cvtepi32_ps emulated_cvtepi32_ps
#endif

static inline simde__m512i emulated_madd_epi16(simde__m512i a, simde__m512i b)
{
    const emulated_halves p = {.integers = a}, q = {.integers = b};
    const emulated_halves sum = {
        .integer = {simde_mm256_madd_epi16(p.integer[0], q.integer[0]), simde_mm256_madd_epi16(p.integer[1], q.integer[1])}};
    return sum.integers;
}
#undef _mm512_madd_epi16 /* SIMDe 0.7 takes a mask as well */
#define _mm512_madd_epi16 emulated_madd_epi16

#endif
