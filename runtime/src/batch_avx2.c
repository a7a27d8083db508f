/* The kernels in AVX2. Compiled with -mavx2 -mbmi2. */
#include "batch.h"

#ifdef HAIRLUT_BATCH_X86
#include "simd_avx2.h"

#include "batch_kernel.h"

void hairlut_fetch_avx2(const hairlut_axis *axis, size_t n, draws *q)
{
    fetch(axis, n, q);
}

void hairlut_search_small_avx2(const hairlut_axis *axis, size_t n, queries *q)
{
    search_small(axis, n, q);
}

void hairlut_read_cells_avx2(const hairlut_axis *axis, size_t n, queries *q)
{
    read_cells(axis, n, q);
}

const hairlut_batch hairlut_batch_avx2 = {"avx2", sample_direct, sample_multiple, pdf_direct, pdf_multiple};
#endif
