/* SPDX-License-Identifier: BSD-3-Clause */
#include <stdio.h>

#include "hairlut.h"

int main(void)
{
    const hairlut_model *hair = hairlut_builtin("brown");
    const float theta_r = 0.3f, phi_r = 1.0f, offset = 0.4f, u_lobe = 0.1f, u_theta = 0.25f, u_phi = 0.75f;
    const hairlut_sample s = hairlut_sample_hair(hair, NULL, theta_r, phi_r, offset, u_lobe, u_theta, u_phi);
    const float pdf = hairlut_pdf_hair(hair, NULL, theta_r, phi_r, offset, s.theta_i, s.phi_i); /* s.pdf_angle again */
    printf("light from theta_i %.4f, phi_i %.4f: %.4f per sr, %.4f per rad^2\n", s.theta_i, s.phi_i, s.pdf_solid_angle, pdf);
    return 0;
}
