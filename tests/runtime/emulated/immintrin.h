/* Stands in for the compiler's immintrin.h: SIMDe computes every instruction in plain C, so that the AVX-512 kernels run
 * on processors without it. Slow; for test_batch.py. */
#ifndef EMULATED_IMMINTRIN_H
#define EMULATED_IMMINTRIN_H

#define SIMDE_NO_NATIVE
#define SIMDE_ENABLE_NATIVE_ALIASES
#include <simde/x86/avx2.h>
#include <simde/x86/avx512.h>

typedef simde__mmask8 __mmask8;

#ifndef _mm_popcnt_u32
#define _mm_popcnt_u32(a) __builtin_popcount(a)
#endif

#ifndef _mm256_cmpgt_epi32_mask /* SIMDe 0.7 lacks it */
static inline __mmask8 emulated_cmpgt_epi32_mask(simde__m256i a, simde__m256i b)
{
    return (__mmask8)simde_mm256_movemask_ps(simde_mm256_castsi256_ps(simde_mm256_cmpgt_epi32(a, b)));
}
#define _mm256_cmpgt_epi32_mask emulated_cmpgt_epi32_mask
#endif

#endif
