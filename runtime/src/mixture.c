/* Both lobes at once, with one density. */
#include "lobes.h"

float hairlut_pdf_mixture(const hairlut_model *model, float direct_weight, float theta_r, float phi_r, float theta_i,
                          float phi_i)
{
    const float w = hairlut_clamp(direct_weight, 0.0f, 1.0f);
    const float mixed = hairlut_mix(w, hairlut_pdf_direct(model, theta_r, phi_r, theta_i, phi_i),
                                    hairlut_pdf_multiple(model, theta_r, phi_r, theta_i, phi_i));
    return direct_weight == direct_weight ? mixed : 0.0f;
}

hairlut_sample hairlut_sample_mixture(const hairlut_model *model, float direct_weight, float theta_r, float phi_r,
                                      float u_lobe, float u_theta, float u_phi)
{
    const float w = hairlut_clamp(direct_weight, 0.0f, 1.0f);
    hairlut_sample s;
    float direct, multiple;
    if (u_lobe < w) {
        s = hairlut_sample_direct(model, theta_r, phi_r, u_theta, u_phi);
        direct = s.pdf_angle;
        multiple = hairlut_pdf_multiple(model, theta_r, phi_r, s.theta_i, s.phi_i);
    } else {
        s = hairlut_sample_multiple(model, theta_r, phi_r, u_theta, u_phi);
        multiple = s.pdf_angle;
        direct = hairlut_pdf_direct(model, theta_r, phi_r, s.theta_i, s.phi_i);
    }
    const int known = direct_weight == direct_weight && u_lobe == u_lobe && hairlut_known(theta_r, phi_r, u_theta, u_phi);
    return hairlut_finish(s.theta_i, s.phi_i, known ? hairlut_mix(w, direct, multiple) : 0.0f);
}
