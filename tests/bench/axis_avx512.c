/* One axis in the instruction set of simd_avx512.h. */
#include "simd_avx512.h"

#include "axis_batch.h"

const axis_kernels axis_avx512 = {"avx512", axis_sample, axis_pdf, NULL, NULL};
