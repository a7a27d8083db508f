/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernels in AVX2. Compiled with -mavx2 -mbmi2 -mpopcnt. */
#include "batch.h"

#ifdef HAIRLUT_BATCH_X86
#include "simd_avx2.h"

#include "batch_kernel.h"
#include "viewer_one.h"

const hairlut_batch hairlut_batch_avx2 = {"avx2",      HAIRLUT_ONE, sample_lobe,   pdf_lobe,
                                          sample_hair, pdf_hair,    sample_strand, pdf_strand};
#endif
