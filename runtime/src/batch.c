/* SPDX-License-Identifier: BSD-3-Clause */
/* The _n functions: the widest kernels that the processor and the operating system run. */
#include "batch.h"
#include "cpu.h"
#include "internal.h"

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

void hairlut_sample_hair_n(const hairlut_model *model, size_t n, const float *shares, const float *theta_r,
                           const float *phi_r, const float *offset, const float *u_lobe, const float *u_theta,
                           const float *u_phi, hairlut_samples out)
{
    hairlut_batch_widest()->sample_hair(model, n, shares, theta_r, phi_r, offset, u_lobe, u_theta, u_phi, out);
}

void hairlut_pdf_hair_n(const hairlut_model *model, size_t n, const float *shares, const float *theta_r, const float *phi_r,
                        const float *offset, const float *theta_i, const float *phi_i, float *pdf_angle)
{
    hairlut_batch_widest()->pdf_hair(model, n, shares, theta_r, phi_r, offset, theta_i, phi_i, pdf_angle);
}

/* The kernels take lobes that there are; of another, densities and angles are 0. */
static int has_lobe(const hairlut_model *model, int lobe)
{
    return lobe >= 0 && lobe < model->lobe_count;
}

void hairlut_sample_lobe_n(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                           const float *u_theta, const float *u_phi, hairlut_samples out)
{
    static const hairlut_sample none;
    if (has_lobe(model, lobe))
        hairlut_batch_widest()->sample_lobe(model, lobe, n, theta_r, phi_r, u_theta, u_phi, out);
    else
        for (size_t i = 0; i < n; ++i)
            hairlut_put(out, i, none);
}

void hairlut_pdf_lobe_n(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                        const float *theta_i, const float *phi_i, float *pdf_angle)
{
    if (has_lobe(model, lobe))
        hairlut_batch_widest()->pdf_lobe(model, lobe, n, theta_r, phi_r, theta_i, phi_i, pdf_angle);
    else
        for (size_t i = 0; i < n; ++i)
            pdf_angle[i] = 0.0f;
}

void hairlut_sample_direct_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                             const float *u_theta, const float *u_phi, hairlut_samples out)
{
    hairlut_sample_lobe_n(model, model->direct, n, theta_r, phi_r, u_theta, u_phi, out);
}

void hairlut_sample_multiple_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                               const float *u_theta, const float *u_phi, hairlut_samples out)
{
    hairlut_sample_lobe_n(model, model->multiple, n, theta_r, phi_r, u_theta, u_phi, out);
}

void hairlut_pdf_direct_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                          const float *theta_i, const float *phi_i, float *pdf_angle)
{
    hairlut_pdf_lobe_n(model, model->direct, n, theta_r, phi_r, theta_i, phi_i, pdf_angle);
}

void hairlut_pdf_multiple_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                            const float *theta_i, const float *phi_i, float *pdf_angle)
{
    hairlut_pdf_lobe_n(model, model->multiple, n, theta_r, phi_r, theta_i, phi_i, pdf_angle);
}
