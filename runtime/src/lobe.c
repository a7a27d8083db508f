/* SPDX-License-Identifier: BSD-3-Clause */
/* One lobe by itself, one direction at a time. */
#include "lobe.h"

static const hairlut_lobe *lobe_of(const hairlut_model *model, int lobe)
{
    return lobe >= 0 && lobe < model->lobe_count ? &model->lobes[lobe] : NULL;
}

static float relative_azimuth(const hairlut_lobe *lobe, float phi_r, float phi_i)
{
    return hairlut_relative_azimuth(lobe->azimuth, hairlut_wrap(phi_r, -hairlut_pi), hairlut_wrap(phi_i, -hairlut_pi));
}

hairlut_sample hairlut_sample_lobe(const hairlut_model *model, int lobe, float theta_r, float phi_r, float u_theta,
                                   float u_phi)
{
    const hairlut_lobe *l = lobe_of(model, lobe);
    if (!l)
        return hairlut_finish(0.0f, 0.0f, 0.0f);
    const hairlut_drawn drawn = hairlut_lobe_draw(l, theta_r, u_theta, u_phi);
    const float r = hairlut_wrap(phi_r, -hairlut_pi);
    const float turned = hairlut_wrap_down(l->azimuth == HAIRLUT_AZIMUTH_SUM ? drawn.phi - r : drawn.phi + r, -hairlut_pi);
    const float pdf = hairlut_known(theta_r, phi_r, u_theta, u_phi) ? drawn.pdf : 0.0f;
    /* theta_i as it was drawn: its cosine does not wait until it is moved into the domain */
    hairlut_sample s = hairlut_finish(drawn.theta, l->uniform ? drawn.phi : turned, pdf);
    s.theta_i = hairlut_axis_inside(&l->theta, drawn.theta);
    return s;
}

float hairlut_pdf_lobe(const hairlut_model *model, int lobe, float theta_r, float phi_r, float theta_i, float phi_i)
{
    const hairlut_lobe *l = lobe_of(model, lobe);
    if (!l || !hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i))
        return 0.0f;
    const float phi = l->uniform ? 0.0f : relative_azimuth(l, phi_r, phi_i);
    hairlut_searches searches;
    float root[4], bend[4];
    searches.count = 0;
    const float contains =
        hairlut_lobe_begin_search(l, theta_r, hairlut_axis_row(&l->theta, theta_r), theta_i, phi, &searches);
    hairlut_end_searches(&searches, root, bend);
    return hairlut_lobe_density(l, contains, root, bend);
}

void hairlut_invert_lobe(const hairlut_model *model, int lobe, float theta_r, float phi_r, float theta_i, float phi_i,
                         float u[2])
{
    const hairlut_lobe *l = lobe_of(model, lobe);
    u[0] = u[1] = 0.0f;
    if (!l)
        return;
    u[0] = hairlut_axis_invert(&l->theta, theta_r, theta_i);
    if (l->uniform)
        u[1] = (hairlut_wrap(phi_i, -hairlut_pi) + hairlut_pi) * hairlut_inverse_two_pi;
    else
        u[1] = hairlut_axis_invert(&l->phi, theta_r, phi_i == phi_i ? relative_azimuth(l, phi_r, phi_i) : 0.0f);
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
