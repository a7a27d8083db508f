/* One direction at a time: sample, pdf and invert of both lobes. */
#include "lobes.h"

/* theta_i as it was drawn: its cosine does not wait until it is moved into the domain. */
static hairlut_sample finish(const hairlut_axis *axis, float theta_i, float phi_i, float pdf)
{
    hairlut_sample s = hairlut_finish(theta_i, phi_i, pdf);
    s.theta_i = hairlut_axis_inside(axis, theta_i);
    return s;
}

hairlut_sample hairlut_sample_direct(const hairlut_model *model, float theta_r, float phi_r, float u_theta, float u_phi)
{
    const hairlut_draw theta = hairlut_axis_sample(&model->direct_theta, theta_r, u_theta);
    const hairlut_draw phi = hairlut_axis_sample(&model->direct_phi, theta_r, u_phi);
    const float pdf = hairlut_known(theta_r, phi_r, u_theta, u_phi) ? 1.0f / (theta.slope * phi.slope) : 0.0f;
    return finish(&model->direct_theta, theta.x, hairlut_incident_azimuth(model, phi_r, phi.x), pdf);
}

hairlut_sample hairlut_sample_multiple(const hairlut_model *model, float theta_r, float phi_r, float u_theta, float u_phi)
{
    const hairlut_draw theta = hairlut_axis_sample(&model->multiple_theta, theta_r, u_theta);
    const float phi = hairlut_two_pi * hairlut_clamp(u_phi, 0.0f, 1.0f) - hairlut_pi;
    const float pdf = hairlut_known(theta_r, phi_r, u_theta, u_phi) ? hairlut_inverse_two_pi / theta.slope : 0.0f;
    return finish(&model->multiple_theta, theta.x, phi < hairlut_pi ? phi : -hairlut_pi, pdf);
}

float hairlut_pdf_direct(const hairlut_model *model, float theta_r, float phi_r, float theta_i, float phi_i)
{
    if (!hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i))
        return 0.0f;
    const float phi = hairlut_relative_azimuth(model, phi_r, phi_i);
    /* both searches before both densities: one waits for its loads while the other goes on */
    const hairlut_found theta_found = hairlut_axis_look_up(&model->direct_theta, theta_r, theta_i);
    const hairlut_found phi_found = hairlut_axis_look_up(&model->direct_phi, theta_r, phi);
    const float slope = hairlut_axis_slope(&model->direct_theta, theta_found, theta_i)
                        * hairlut_axis_slope(&model->direct_phi, phi_found, phi);
    return hairlut_axis_holds(&model->direct_theta, theta_i) * hairlut_axis_holds(&model->direct_phi, phi) / slope;
}

float hairlut_pdf_multiple(const hairlut_model *model, float theta_r, float phi_r, float theta_i, float phi_i)
{
    if (!hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i))
        return 0.0f;
    const hairlut_found found = hairlut_axis_look_up(&model->multiple_theta, theta_r, theta_i);
    const float slope = hairlut_axis_slope(&model->multiple_theta, found, theta_i);
    return hairlut_axis_holds(&model->multiple_theta, theta_i) * hairlut_inverse_two_pi / slope;
}

void hairlut_invert_direct(const hairlut_model *model, float theta_r, float phi_r, float theta_i, float phi_i, float u[2])
{
    u[0] = hairlut_axis_invert(&model->direct_theta, theta_r, theta_i);
    const float phi = phi_i == phi_i ? hairlut_relative_azimuth(model, phi_r, phi_i) : 0.0f;
    u[1] = hairlut_axis_invert(&model->direct_phi, theta_r, phi);
}

void hairlut_invert_multiple(const hairlut_model *model, float theta_r, float phi_r, float theta_i, float phi_i,
                             float u[2])
{
    (void)phi_r;
    u[0] = hairlut_axis_invert(&model->multiple_theta, theta_r, theta_i);
    u[1] = (hairlut_wrap(phi_i, -hairlut_pi) + hairlut_pi) * hairlut_inverse_two_pi;
}

float hairlut_pdf_to_solid_angle(float pdf_angle, float theta_i)
{
    return hairlut_per_steradian(pdf_angle, theta_i);
}
