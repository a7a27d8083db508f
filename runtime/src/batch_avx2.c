/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernels in AVX2. Compiled with -mavx2 -mbmi2 -mpopcnt. */
#include "batch.h"

#ifdef HAIRLUT_BATCH_X86
#include "simd_avx2.h"

#include "batch_kernel.h"
#include "strand_one.h"

const hairlut_batch hairlut_batch_avx2 = {
    "avx2",        {sample_lobe_one, pdf_lobe_one, sample_hair_one, pdf_hair_one, sample_strand_one, pdf_strand_one},
    sample_lobe,   pdf_lobe,
    sample_hair,   pdf_hair,
    sample_strand, pdf_strand};
#endif
