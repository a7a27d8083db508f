/* SPDX-License-Identifier: BSD-3-Clause */
/* What runtime/shaders/hairlut.cuh uses of CUDA, for a compiler without the toolkit. */
#define __host__ __attribute__((host))
#define __device__ __attribute__((device))
#define __global__ __attribute__((global))
#define __CUDACC__ 1

struct float4 {
    float x, y, z, w;
};

extern "C" {
__device__ float fabsf(float);
__device__ float floorf(float);
__device__ float sqrtf(float);
__device__ void *memcpy(void *, const void *, __SIZE_TYPE__);
}
