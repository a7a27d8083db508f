/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernels in AArch64 Advanced SIMD, which every such processor has. */
#include "batch.h"

#ifdef HAIRLUT_BATCH_NEON
#include "simd_neon.h"

#include "batch_kernel.h"
#include "viewer_one.h"

const hairlut_batch hairlut_batch_neon = {"neon",      HAIRLUT_ONE, sample_lobe,   pdf_lobe,
                                          sample_hair, pdf_hair,    sample_strand, pdf_strand};
#endif
