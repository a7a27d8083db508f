/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernels in AVX-512. Compiled with -mavx512f -mavx512dq -mavx512bw -mavx512vl -mpopcnt. Functions for one direction have no
 * use for more than eight lanes: from AVX-512 they gain 32 registers and masks. */
#include "batch.h"

#ifdef HAIRLUT_BATCH_X86
#include "simd_avx512.h"

#include "batch_kernel.h"
#include "viewer_one.h"

const hairlut_batch hairlut_batch_avx512 = {.name = "avx512",
                                            .one = HAIRLUT_ONE,
                                            .sample_lobe = sample_lobe,
                                            .pdf_lobe = pdf_lobe,
                                            .sample_hair = sample_hair,
                                            .pdf_hair = pdf_hair,
                                            .sample_strand = sample_strand,
                                            .pdf_strand = pdf_strand};
#endif
