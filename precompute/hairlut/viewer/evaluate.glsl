// SPDX-License-Identifier: BSD-3-Clause
in vec2 direction; // theta_i, phi_i
uniform int part;  // the lobe to invert: as it stands, or, in the whole hair, mirrored and turned
out vec3 evaluated; // u_theta, u_phi, density

void main()
{
    hairlut_mixture mixture = hairlut_mixture_at(hair(), viewer.x, viewer.z);
    bool placed = lobe < 0 && hairlut_lobe_at(hair(), part).phi.azimuth != hairlut_uniform;
    float side = placed ? mixture.side : 1.0;
    float turn = placed ? mixture.turn[part] : 0.0;
    hairlut_numbers u = hairlut_invert_lobe(hair(), part, viewer.x, side * viewer.y, direction.x, side * direction.y - turn);
    evaluated = vec3(u.u_theta, u.u_phi, density(direction.x, direction.y));
}
