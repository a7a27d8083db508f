/* SPDX-License-Identifier: BSD-3-Clause
 * SLEEF's erf under the names of the vector function ABI: b, c, d and e are SSE, AVX, AVX2 and AVX-512. */
#include <immintrin.h>
#include <sleef.h>

extern "C" {
float rival_sleef_erf(float x)
{
    return Sleef_erff_u10(x);
}
__m128 _ZGVbN4v_rival_sleef_erf(__m128 x)
{
    return Sleef_erff4_u10(x);
}
#ifdef __AVX__
__m256 _ZGVcN8v_rival_sleef_erf(__m256 x)
{
    return Sleef_erff8_u10(x);
}
__m256 _ZGVdN8v_rival_sleef_erf(__m256 x)
{
    return Sleef_erff8_u10(x);
}
#endif
#ifdef __AVX512F__
__m512 _ZGVeN16v_rival_sleef_erf(__m512 x)
{
    return Sleef_erff16_u10(x);
}
#endif
}
