/* One axis in the instruction set of simd_neon.h. */
#include "simd_neon.h"

#include "axis_batch.h"
#include "axis_floor.h"

const axis_kernels axis_neon = {"neon", axis_sample, axis_pdf, floor_index, floor_angles};
