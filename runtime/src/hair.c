/* SPDX-License-Identifier: BSD-3-Clause */
/* The whole hair, one direction at a time. */
#include "batch.h"

hairlut_sample hairlut_sample_hair(const hairlut_model *model, const float *shares, float theta_r, float phi_r, float offset,
                                   float u_lobe, float u_theta, float u_phi)
{
    return hairlut_best_kernels()->one.sample_hair(model, shares, theta_r, phi_r, offset, u_lobe, u_theta, u_phi);
}

float hairlut_pdf_hair(const hairlut_model *model, const float *shares, float theta_r, float phi_r, float offset,
                       float theta_i, float phi_i)
{
    return hairlut_best_kernels()->one.pdf_hair(model, shares, theta_r, phi_r, offset, theta_i, phi_i);
}
