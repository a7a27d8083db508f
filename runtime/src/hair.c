/* SPDX-License-Identifier: BSD-3-Clause */
/* The whole hair, one direction at a time. */
#include "hair.h"

/* phi_i of what lobe k drew. */
static float incident_azimuth(const hairlut_model *model, const hairlut_mix *mix, int k, float r, float x)
{
    const hairlut_lobe *lobe = &model->lobes[k];
    if (lobe->uniform)
        return x;
    return hairlut_turned_incident(lobe->azimuth, r, x, model->mixture.turned ? mix->turn[k] : 0.0f, mix->side);
}

/* The azimuth by which lobe k's table is searched; r and i are phi_r and phi_i in [-pi, pi). */
static float lobe_azimuth(const hairlut_model *model, const hairlut_mix *mix, int k, float r, float i)
{
    const hairlut_mixture *m = &model->mixture;
    const float relative = hairlut_relative_azimuth(model->lobes[k].azimuth, r, i);
    return m->turned || m->mirrored ? hairlut_turned_relative(relative, m->turned ? mix->turn[k] : 0.0f, mix->side)
                                    : relative;
}

/* The sum of weight * density. Lobe `drawn`, if there is one, has the density `known`. */
static float mixed(const hairlut_model *model, const hairlut_mix *mix, float theta_r, float r, float theta_i, float i,
                   int drawn, float known)
{
    float contains[HAIRLUT_MAX_LOBES], root[2 * HAIRLUT_MAX_LOBES], bend[2 * HAIRLUT_MAX_LOBES], pdf = 0.0f;
    hairlut_row row = {0, 0.0f};
    hairlut_searches searches;
    searches.count = 0;
    for (int k = 0, grid = -1; k < model->lobe_count; ++k) {
        const hairlut_lobe *lobe = &model->lobes[k];
        if (k == drawn || !(mix->weight[k] > 0.0f))
            continue;
        if (lobe->theta.grid != grid)
            row = hairlut_axis_row(&lobe->theta, theta_r);
        grid = lobe->theta.grid;
        const float phi = lobe->uniform ? 0.0f : lobe_azimuth(model, mix, k, r, i);
        contains[k] = hairlut_lobe_begin_search(lobe, theta_r, row, theta_i, phi, &searches);
    }
    hairlut_end_searches(&searches, root, bend);
    for (int k = 0, a = 0; k < model->lobe_count; ++k) {
        const hairlut_lobe *lobe = &model->lobes[k];
        if (!(mix->weight[k] > 0.0f))
            continue;
        pdf += mix->weight[k] * (k == drawn ? known : hairlut_lobe_density(lobe, contains[k], root + a, bend + a));
        a += k == drawn ? 0 : lobe->uniform ? 1 : 2;
    }
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
    const float r = hairlut_wrap(phi_r, -hairlut_pi), phi_i = incident_azimuth(model, &mix, k, r, drawn.phi);
    const int valid = hairlut_known(theta_r, phi_r, u_theta, u_phi) && !isunordered(offset, u_lobe) && mix.sum > 0.0f;
    return hairlut_finish(theta_i, phi_i, valid ? mixed(model, &mix, theta_r, r, theta_i, phi_i, k, drawn.pdf) : 0.0f);
}

float hairlut_pdf_hair(const hairlut_model *model, const float *shares, float theta_r, float phi_r, float offset,
                       float theta_i, float phi_i)
{
    hairlut_mix mix;
    hairlut_mixture_at(model, shares, 1, theta_r, offset, &mix);
    if (!hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i) || offset != offset || !(mix.sum > 0.0f))
        return 0.0f;
    return mixed(model, &mix, theta_r, hairlut_wrap(phi_r, -hairlut_pi), theta_i, hairlut_wrap(phi_i, -hairlut_pi), -1,
                 0.0f);
}
