/* SPDX-License-Identifier: BSD-3-Clause */
#include "hairlut.cuh"

namespace hairlut_gpu {
#include "record.inl"
}

using namespace hairlut_gpu;

__global__ void kernel(const float4 *hairs, int first, const float4 *inputs, test_result *outputs, int k)
{
    const float4 *in = inputs + 4 * k;
    outputs[k] = test_record(hairlut_model_at(hairs, first), in[0], in[1], in[2], in[3]);
}
