/* The _n functions: the widest kernels that the processor and the operating system run. */
#include "batch.h"
#include "cpu.h"

const hairlut_batch *hairlut_batch_level(int level)
{
    if (level == 0)
        return &hairlut_batch_portable;
#ifdef HAIRLUT_BATCH_X86
    if (level == 1 && hairlut_this_cpu() >= HAIRLUT_CPU_AVX2)
        return &hairlut_batch_avx2;
    if (level == 2 && hairlut_this_cpu() >= HAIRLUT_CPU_AVX512)
        return &hairlut_batch_avx512;
#endif
#ifdef HAIRLUT_BATCH_NEON
    if (level == 1)
        return &hairlut_batch_neon;
#endif
    return NULL;
}

const hairlut_batch *hairlut_batch_widest(void)
{
    const hairlut_batch *batch = hairlut_batch_level(0);
    for (int level = 1; hairlut_batch_level(level); ++level)
        batch = hairlut_batch_level(level);
    return batch;
}

void hairlut_sample_direct_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                             const float *u_theta, const float *u_phi, hairlut_samples out)
{
    hairlut_batch_widest()->sample_direct(model, n, theta_r, phi_r, u_theta, u_phi, out);
}

void hairlut_sample_multiple_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                               const float *u_theta, const float *u_phi, hairlut_samples out)
{
    hairlut_batch_widest()->sample_multiple(model, n, theta_r, phi_r, u_theta, u_phi, out);
}

void hairlut_pdf_direct_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                          const float *theta_i, const float *phi_i, float *pdf_angle)
{
    hairlut_batch_widest()->pdf_direct(model, n, theta_r, phi_r, theta_i, phi_i, pdf_angle);
}

void hairlut_pdf_multiple_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                            const float *theta_i, const float *phi_i, float *pdf_angle)
{
    hairlut_batch_widest()->pdf_multiple(model, n, theta_r, phi_r, theta_i, phi_i, pdf_angle);
}
