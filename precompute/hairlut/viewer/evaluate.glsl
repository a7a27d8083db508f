in vec2 direction; // theta_i, phi_i
out vec4 inverted; // u_theta and u_phi of the direct lobe, then of the multiple one
out float evaluated;

void main()
{
    inverted = vec4(hairlut_invert_direct(hair(), viewer.x, viewer.y, direction.x, direction.y),
                    hairlut_invert_multiple(hair(), viewer.x, viewer.y, direction.x, direction.y));
    evaluated = density(direction.x, direction.y);
}
