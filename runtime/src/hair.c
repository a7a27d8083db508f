/* SPDX-License-Identifier: BSD-3-Clause */
/* The whole hair, one direction at a time. */
#include "hair.h"

/* phi_i of what lobe k drew. */
static float incident_azimuth(const hairlut_model *model, const hairlut_mix *mix, int k, float phi_r, float x)
{
    const hairlut_lobe *lobe = &model->lobes[k];
    if (lobe->uniform)
        return x;
    return hairlut_turned_incident(lobe->azimuth, phi_r, x, model->mixture.turned ? mix->turn[k] : 0.0f, mix->side);
}

static float lobe_azimuth(const hairlut_model *model, const hairlut_mix *mix, int k, float phi_r, float phi_i)
{
    const hairlut_lobe *lobe = &model->lobes[k];
    if (lobe->uniform)
        return 0.0f;
    return hairlut_turned_relative(lobe->azimuth, phi_r, phi_i, model->mixture.turned ? mix->turn[k] : 0.0f, mix->side);
}

/* The sum of share / sum * density. Lobe `drawn`, if there is one, has the density `known`. All searches begin before any ends. */
static float mixed(const hairlut_model *model, const hairlut_mix *mix, float theta_r, float phi_r, float theta_i, float phi_i,
                   int drawn, float known)
{
    hairlut_lobe_search searches[HAIRLUT_MAX_LOBES];
    const float unit = 1.0f / mix->sum;
    float pdf = 0.0f;
    for (int k = 0; k < model->lobe_count; ++k)
        if (k != drawn && mix->share[k] > 0.0f)
            searches[k] = hairlut_lobe_begin_search(&model->lobes[k], theta_r, theta_i, lobe_azimuth(model, mix, k, phi_r, phi_i));
    for (int k = 0; k < model->lobe_count; ++k)
        if (mix->share[k] > 0.0f)
            pdf += mix->share[k] * unit * (k == drawn ? known : hairlut_lobe_end_search(&model->lobes[k], &searches[k]));
    return pdf;
}

hairlut_sample hairlut_sample_hair(const hairlut_model *model, const float *shares, float theta_r, float phi_r, float offset,
                                   float u_lobe, float u_theta, float u_phi)
{
    hairlut_mix mix;
    hairlut_mixture_at(model, shares, 1, theta_r, offset, &mix);
    const int k = hairlut_mixture_choose(&mix, model->lobe_count, u_lobe);
    const hairlut_lobe *lobe = &model->lobes[k];
    const hairlut_drawn drawn = hairlut_lobe_draw(lobe, theta_r, u_theta, u_phi);
    const float theta_i = hairlut_axis_inside(&lobe->theta, drawn.theta);
    const float phi_i = incident_azimuth(model, &mix, k, phi_r, drawn.phi);
    const int valid = hairlut_known(theta_r, phi_r, u_theta, u_phi) && !isunordered(offset, u_lobe) && mix.sum > 0.0f;
    return hairlut_finish(theta_i, phi_i, valid ? mixed(model, &mix, theta_r, phi_r, theta_i, phi_i, k, drawn.pdf) : 0.0f);
}

float hairlut_pdf_hair(const hairlut_model *model, const float *shares, float theta_r, float phi_r, float offset, float theta_i,
                       float phi_i)
{
    hairlut_mix mix;
    hairlut_mixture_at(model, shares, 1, theta_r, offset, &mix);
    if (!hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i) || offset != offset || !(mix.sum > 0.0f))
        return 0.0f;
    return mixed(model, &mix, theta_r, phi_r, theta_i, phi_i, -1, 0.0f);
}
