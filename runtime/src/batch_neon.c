/* The kernels in AArch64 Advanced SIMD, which every such processor has. */
#include "batch.h"

#ifdef HAIRLUT_BATCH_NEON
#include "simd_neon.h"

#include "batch_kernel.h"

const hairlut_batch hairlut_batch_neon = {"neon", sample_direct, sample_multiple, pdf_direct, pdf_multiple};
#endif
