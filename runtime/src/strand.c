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
    float values[HAIRLUT_MAX_PARAMETERS], own[HAIRLUT_MAX_LOBES];
    if (!model->strands || !parameters) {
        hairlut_sample_hair_n(model, n, shares, theta_r, phi_r, offset, u_lobe, u_theta, u_phi, out);
        return;
    }
    const hairlut_one *one = &hairlut_best_kernels()->one;
    for (size_t i = 0; i < n; ++i) {
        const hairlut_sample s =
            one->sample_strand(model, hairlut_gather(parameters, model->strands->parameter_count, n, i, values),
                               hairlut_gather(shares, model->lobe_count, n, i, own), theta_r[i], phi_r[i],
                               offset ? offset[i] : 0.0f, u_lobe[i], u_theta[i], u_phi[i]);
        hairlut_put(out, i, s);
    }
}

void hairlut_pdf_strand_n(const hairlut_model *model, size_t n, const float *parameters, const float *shares,
                          const float *theta_r, const float *phi_r, const float *offset, const float *theta_i,
                          const float *phi_i, float *pdf_angle)
{
    float values[HAIRLUT_MAX_PARAMETERS], own[HAIRLUT_MAX_LOBES];
    if (!model->strands || !parameters) {
        hairlut_pdf_hair_n(model, n, shares, theta_r, phi_r, offset, theta_i, phi_i, pdf_angle);
        return;
    }
    const hairlut_one *one = &hairlut_best_kernels()->one;
    for (size_t i = 0; i < n; ++i)
        pdf_angle[i] = one->pdf_strand(model, hairlut_gather(parameters, model->strands->parameter_count, n, i, values),
                                       hairlut_gather(shares, model->lobe_count, n, i, own), theta_r[i], phi_r[i],
                                       offset ? offset[i] : 0.0f, theta_i[i], phi_i[i]);
}
