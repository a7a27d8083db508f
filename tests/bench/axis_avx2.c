/* One axis in the instruction set of simd_avx2.h. */
#include "simd_avx2.h"

#include "axis_batch.h"
#include "axis_floor.h"

const axis_kernels axis_avx2 = {"avx2", axis_sample, axis_pdf, floor_index, floor_angles};
