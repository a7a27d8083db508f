// SPDX-License-Identifier: BSD-3-Clause
in vec3 numbers;
out vec4 drawn; // theta_i, phi_i, pdf_angle, pdf_solid_angle

void main()
{
    hairlut_sample s = draw(numbers);
    drawn = vec4(s.theta_i, s.phi_i, s.pdf_angle, s.pdf_solid_angle);
}
