/* SPDX-License-Identifier: BSD-3-Clause */
/* The shaders' body as C++ with other limits of lobes and parameters than the usual ones. */
#include <stddef.h>

#include "hairlut.cuh"

using namespace hairlut_gpu;

/* Of n records of 16 floats, as in backends.py, the densities of the sample and of the direction, with the first two parameters of
 * the record, as far as there is room, and without the lobes from `lobes` on. */
extern "C" void evaluate(const float *stream, size_t n, const float *in, int lobes, float *out)
{
    for (size_t k = 0; k < n; ++k, in += 16, out += 2) {
        hairlut_model hair = hairlut_model_at(reinterpret_cast<const hairlut_float4 *>(stream), 0);
        for (int p = 0; p < 2 && p < hairlut_max_parameters; ++p)
            hair.parameters.value[p] = in[10 + p];
        hairlut_mixture mixture = hairlut_mixture_at(hair, in[0], in[2]);
        for (int l = lobes; l < hair.lobes; ++l)
            mixture.share[l] = 0.0f;
        out[0] = hairlut_sample_hair_at(hair, mixture, in[0], in[1], in[5], in[6], in[7]).pdf_angle;
        out[1] = hairlut_pdf_hair_at(hair, mixture, in[0], in[1], in[8], in[9]);
    }
}
