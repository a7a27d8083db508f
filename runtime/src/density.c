/* One direction at a time: density and inverse of both lobes. */
#include "lobes.h"

float hairlut_pdf_direct(const hairlut_model *model, float theta_r, float phi_r, float theta_i, float phi_i)
{
    if (!hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i))
        return 0.0f;
    const float phi = hairlut_relative_azimuth(model, phi_r, phi_i);
    const hairlut_query theta_query = hairlut_axis_ask(&model->direct_theta, theta_r, theta_i);
    const hairlut_query phi_query = hairlut_axis_ask(&model->direct_phi, theta_r, phi);
    const hairlut_found theta_found = hairlut_axis_find(&model->direct_theta, theta_query);
    const hairlut_found phi_found = hairlut_axis_find(&model->direct_phi, phi_query);
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
