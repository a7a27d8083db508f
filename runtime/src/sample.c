/* One direction at a time: samples of both lobes. */
#include "lobes.h"

/* theta_i as it was drawn: its cosine does not wait until it is moved into the domain. */
HAIRLUT_INLINE hairlut_sample finish(const hairlut_axis *axis, float theta_i, float phi_i, float pdf)
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
    const float phi = hairlut_two_pi * hairlut_clamp(u_phi, hairlut_constant(0.0f), hairlut_constant(1.0f)) - hairlut_pi;
    const float pdf = hairlut_known(theta_r, phi_r, u_theta, u_phi) ? hairlut_inverse_two_pi / theta.slope : 0.0f;
    return finish(&model->multiple_theta, theta.x, phi < hairlut_pi ? phi : -hairlut_pi, pdf);
}
