/* SPDX-License-Identifier: BSD-3-Clause */
/* Viewers: viewer_one.h, for the processor at hand. */
#include "viewer.h"

#include "batch.h"

static const hairlut_view *view_of(const hairlut_viewer *viewer)
{
    return (const hairlut_view *)(const void *)viewer;
}

void hairlut_viewer_at(hairlut_viewer *viewer, const hairlut_model *model, const float *parameters, const float *shares,
                       float theta_r, float phi_r, float offset)
{
    hairlut_best_kernels()->one.view((hairlut_view *)(void *)viewer, model, model->strands ? parameters : NULL, shares,
                                     theta_r, phi_r, offset);
}

hairlut_sample hairlut_viewer_sample(const hairlut_viewer *viewer, float u_lobe, float u_theta, float u_phi)
{
    return hairlut_best_kernels()->one.sample_view(view_of(viewer), u_lobe, u_theta, u_phi);
}

float hairlut_viewer_pdf(const hairlut_viewer *viewer, float theta_i, float phi_i)
{
    return hairlut_best_kernels()->one.pdf_view(view_of(viewer), theta_i, phi_i);
}
