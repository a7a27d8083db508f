/* SPDX-License-Identifier: BSD-3-Clause */
/* hairlut for CUDA (OptiX included) and C++17. Made by source/assemble.py; change source/body.inl.
 *
 *     #include "hairlut.cuh"
 *     using namespace hairlut_gpu;
 *     const float4 *hairs;                                // on the device: the file(s) of `hairlut export --to raw`
 *     hairlut_model hair = hairlut_model_at(hairs, 0);    // 0: the model's first texel
 *     hairlut_sample s = hairlut_sample_hair(hair, theta_r, phi_r, offset, u_lobe, u_theta, u_phi);
 *     float q = hairlut_pdf_hair(hair, theta_r, phi_r, offset, theta_i, phi_i);
 *
 * In C++ the texels are hairlut_float4. A program for the processor alone draws faster by hairlut.h: the C++ form is for code that is
 * shared with a GPU. Both may be included in one file. README.md has the rest: fetches, limits. */
#ifndef HAIRLUT_CUH
#define HAIRLUT_CUH

#include <math.h>
#include <string.h>

#ifdef __CUDACC__
#define HAIRLUT_FN __host__ __device__ inline
#elif defined(__GNUC__)
#define HAIRLUT_FN inline __attribute__((always_inline)) /* as on a GPU: structures are passed by value */
#else
#define HAIRLUT_FN inline
#endif
#ifndef HAIRLUT_LOBE_LIMIT
#define HAIRLUT_LOBE_LIMIT 16
#endif
#ifndef HAIRLUT_PARAMETER_LIMIT
#define HAIRLUT_PARAMETER_LIMIT 8
#endif
#ifndef HAIRLUT_FETCH /* with HAIRLUT_SOURCE: what hairlut_model_at takes, and how texel i is read of it */
#define HAIRLUT_SOURCE const hairlut_float4 *
#define HAIRLUT_FETCH(source, i) ((source)[i])
#endif
#ifndef HAIRLUT_HEADER
#define HAIRLUT_HEADER(source, i) HAIRLUT_FETCH(source, i)
#endif
#define HAIRLUT_CONST constexpr
#define HAIRLUT_PRECISE

namespace hairlut_gpu {

#ifdef __CUDACC__
using hairlut_float4 = float4;
#else
struct hairlut_float4 {
    float x, y, z, w;
};
#endif

constexpr int hairlut_max_lobes = HAIRLUT_LOBE_LIMIT;
constexpr int hairlut_max_parameters = HAIRLUT_PARAMETER_LIMIT;
constexpr int hairlut_parameter_slots = HAIRLUT_PARAMETER_LIMIT > 0 ? HAIRLUT_PARAMETER_LIMIT : 1;

HAIRLUT_FN float abs(float x)
{
    return fabsf(x);
}

HAIRLUT_FN float floor(float x)
{
    return floorf(x);
}

HAIRLUT_FN float sqrt(float x)
{
    return sqrtf(x);
}

HAIRLUT_FN float min(float x, float y)
{
    return x < y ? x : y;
}

HAIRLUT_FN float max(float x, float y)
{
    return x > y ? x : y;
}

HAIRLUT_FN float clamp(float x, float low, float high)
{
    return min(max(x, low), high);
}

HAIRLUT_FN int min(int x, int y)
{
    return x < y ? x : y;
}

HAIRLUT_FN int max(int x, int y)
{
    return x > y ? x : y;
}

HAIRLUT_FN int clamp(int x, int low, int high)
{
    return min(max(x, low), high);
}

HAIRLUT_FN unsigned hairlut_bits(float x)
{
    unsigned bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

HAIRLUT_FN float hairlut_from_bits(unsigned bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}
