/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernels in AArch64 Advanced SIMD, which every such processor has. */
#include "batch.h"

#ifdef HAIRLUT_BATCH_NEON
#include "simd_neon.h"

#include "batch_kernel.h"
#include "strand_one.h"

const hairlut_batch hairlut_batch_neon = {
    "neon",        {sample_lobe_one, pdf_lobe_one, sample_hair_one, pdf_hair_one, sample_strand_one, pdf_strand_one},
    sample_lobe,   pdf_lobe,
    sample_hair,   pdf_hair,
    sample_strand, pdf_strand};
#endif
