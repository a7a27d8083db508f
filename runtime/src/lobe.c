/* SPDX-License-Identifier: BSD-3-Clause */
/* One lobe by itself, one direction at a time. */
#include "lobe.h"

#include "batch.h"

static const hairlut_lobe *lobe_of(const hairlut_model *model, int lobe)
{
    return lobe >= 0 && lobe < model->lobe_count ? &model->lobes[lobe] : NULL;
}

hairlut_sample hairlut_sample_lobe(const hairlut_model *model, int lobe, float theta_r, float phi_r, float u_theta,
                                   float u_phi)
{
    if (!lobe_of(model, lobe))
        return hairlut_finish(0.0f, 0.0f, 0.0f);
    return hairlut_best_kernels()->one.sample_lobe(model, lobe, theta_r, phi_r, u_theta, u_phi);
}

float hairlut_pdf_lobe(const hairlut_model *model, int lobe, float theta_r, float phi_r, float theta_i, float phi_i)
{
    if (!lobe_of(model, lobe))
        return 0.0f;
    return hairlut_best_kernels()->one.pdf_lobe(model, lobe, theta_r, phi_r, theta_i, phi_i);
}

void hairlut_invert_lobe(const hairlut_model *model, int lobe, float theta_r, float phi_r, float theta_i, float phi_i,
                         float u[2])
{
    const hairlut_lobe *l = lobe_of(model, lobe);
    u[0] = u[1] = 0.0f;
    if (!l)
        return;
    const float r = hairlut_wrap(phi_r, -hairlut_pi), i = hairlut_wrap(phi_i, -hairlut_pi);
    u[0] = hairlut_axis_invert(&l->theta, theta_r, theta_i);
    if (l->uniform)
        u[1] = (i + hairlut_pi) * hairlut_inverse_two_pi;
    else
        u[1] = hairlut_axis_invert(&l->phi, theta_r, phi_i == phi_i ? hairlut_table_azimuth(l, r, i, 0.0f, 1.0f) : 0.0f);
}

hairlut_sample hairlut_sample_direct(const hairlut_model *model, float theta_r, float phi_r, float u_theta, float u_phi)
{
    return hairlut_sample_lobe(model, model->direct, theta_r, phi_r, u_theta, u_phi);
}

hairlut_sample hairlut_sample_multiple(const hairlut_model *model, float theta_r, float phi_r, float u_theta, float u_phi)
{
    return hairlut_sample_lobe(model, model->multiple, theta_r, phi_r, u_theta, u_phi);
}

float hairlut_pdf_direct(const hairlut_model *model, float theta_r, float phi_r, float theta_i, float phi_i)
{
    return hairlut_pdf_lobe(model, model->direct, theta_r, phi_r, theta_i, phi_i);
}

float hairlut_pdf_multiple(const hairlut_model *model, float theta_r, float phi_r, float theta_i, float phi_i)
{
    return hairlut_pdf_lobe(model, model->multiple, theta_r, phi_r, theta_i, phi_i);
}

float hairlut_pdf_to_solid_angle(float pdf_angle, float theta_i)
{
    return hairlut_per_steradian(pdf_angle, theta_i);
}
