/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernels in AVX2. Compiled with -mavx2 -mbmi2. */
#include "batch.h"

#ifdef HAIRLUT_BATCH_X86
#include "simd_avx2.h"

#include "batch_kernel.h"

void hairlut_fetch_draws_avx2(const hairlut_axis *axis, size_t n, draws *q)
{
    fetch_draws(axis, n, q);
}

void hairlut_search_small_avx2(const hairlut_axis *axis, size_t n, searches *q)
{
    search_small(axis, n, q);
}

void hairlut_fetch_searches_avx2(const hairlut_axis *axis, size_t n, searches *q)
{
    fetch_searches(axis, n, q);
}

const hairlut_batch hairlut_batch_avx2 = {"avx2", sample_lobe, pdf_lobe, sample_hair, pdf_hair};
#endif
