/* SPDX-License-Identifier: BSD-3-Clause */
#include "hairlut.cuh"

namespace hairlut_gpu {
#include "record.inl"
}

using namespace hairlut_gpu;

__global__ void kernel(const float4 *hairs, int first, const float4 *inputs, test_result *outputs, int k)
{
    outputs[k] = test_record(hairlut_model_at(hairs, first), inputs[3 * k], inputs[3 * k + 1], inputs[3 * k + 2]);
}
