/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernels in AVX-512. Compiled with -mavx512f -mavx512bw -mavx512dq -mavx512vl -mbmi2 -mpopcnt. */
#include "batch.h"

#ifdef HAIRLUT_BATCH_X86
#include "simd_avx512.h"

#include "batch_kernel.h"

const hairlut_batch hairlut_batch_avx512 = {"avx512", sample_lobe, pdf_lobe, sample_hair, pdf_hair};
#endif
