/* SPDX-License-Identifier: BSD-3-Clause */
/* Strands of models over parameters: strand_one.h, for the processor at hand. Without parameters they are the whole hair. */
#include "batch.h"
#include "internal.h"
#include "strand.h"

hairlut_sample hairlut_sample_strand(const hairlut_model *model, const float *parameters, const float *shares, float theta_r,
                                     float phi_r, float offset, float u_lobe, float u_theta, float u_phi)
{
    const hairlut_one *one = &hairlut_best_kernels()->one;
    if (!model->strands || !parameters)
        return one->sample_hair(model, shares, theta_r, phi_r, offset, u_lobe, u_theta, u_phi);
    return one->sample_strand(model, parameters, shares, theta_r, phi_r, offset, u_lobe, u_theta, u_phi);
}

float hairlut_pdf_strand(const hairlut_model *model, const float *parameters, const float *shares, float theta_r,
                         float phi_r, float offset, float theta_i, float phi_i)
{
    const hairlut_one *one = &hairlut_best_kernels()->one;
    if (!model->strands || !parameters)
        return one->pdf_hair(model, shares, theta_r, phi_r, offset, theta_i, phi_i);
    return one->pdf_strand(model, parameters, shares, theta_r, phi_r, offset, theta_i, phi_i);
}

/* ---- arrays --------------------------------------------------------------------------------------------------- */

void hairlut_sample_strand_n(const hairlut_model *model, size_t n, const float *parameters, const float *shares,
                             const float *theta_r, const float *phi_r, const float *offset, const float *u_lobe,
                             const float *u_theta, const float *u_phi, hairlut_samples out)
{
    const hairlut_batch *batch = hairlut_batch_widest();
    if (!model->strands || !parameters)
        batch->sample_hair(model, n, shares, theta_r, phi_r, offset, u_lobe, u_theta, u_phi, out);
    else
        batch->sample_strand(model, n, parameters, shares, theta_r, phi_r, offset, u_lobe, u_theta, u_phi, out);
}

void hairlut_pdf_strand_n(const hairlut_model *model, size_t n, const float *parameters, const float *shares,
                          const float *theta_r, const float *phi_r, const float *offset, const float *theta_i,
                          const float *phi_i, float *pdf_angle)
{
    const hairlut_batch *batch = hairlut_batch_widest();
    if (!model->strands || !parameters)
        batch->pdf_hair(model, n, shares, theta_r, phi_r, offset, theta_i, phi_i, pdf_angle);
    else
        batch->pdf_strand(model, n, parameters, shares, theta_r, phi_r, offset, theta_i, phi_i, pdf_angle);
}
