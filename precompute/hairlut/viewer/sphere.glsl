// SPDX-License-Identifier: BSD-3-Clause
in vec2 place;
uniform mat3 turn;    // world to view
uniform float radius; // of the sphere, in half the canvas
uniform float pixel;  // in units of the sphere's radius
uniform float top;    // density per steradian at the bright end of the colours
uniform vec3 colours[6];
out vec4 colour;

vec3 coloured(float t)
{
    float x = clamp(t, 0.0, 1.0) * 5.0;
    int i = min(int(x), 4);
    return mix(colours[i], colours[i + 1], x - float(i));
}

/* 1 on the lines of constant angle, 30 degrees apart; width in radians */
float line(float angle, float width)
{
    float step = hairlut_pi / 6.0;
    float off = abs(fract(angle / step + 0.5) - 0.5) * step;
    return 1.0 - smoothstep(0.6 * width, 1.4 * width, off);
}

void main()
{
    vec2 p = place / radius;
    float r = length(p);
    vec3 world = vec3(p, sqrt(max(1.0 - r * r, 0.0))) * turn;
    float across = length(world.xz);
    float theta_i = atan(world.y, across);
    float phi_i = atan(-world.z, world.x);
    float q = hairlut_pdf_to_solid_angle(density(theta_i, phi_i), theta_i);
    float t = 1.0 + log(max(q / top, 1e-9)) / log(10.0) / 4.0;
    float facing = sqrt(max(1.0 - r * r, 0.0));
    vec3 surface = coloured(t) * (0.72 + 0.28 * facing);
    float width = pixel / max(facing, 0.15);
    float grid = max(line(theta_i, width), across > 0.13 ? line(phi_i, width / max(across, 0.05)) : 0.0);
    surface = mix(surface, vec3(1.0), 0.13 * grid * facing);
    float edge = 1.0 - smoothstep(1.0 - 1.5 * pixel, 1.0, r);
    float halo = exp(-14.0 * max(r - 1.0, 0.0)) * 0.10;
    colour = vec4(mix(vec3(0.063, 0.075, 0.094) + halo * vec3(0.5, 0.6, 0.9), surface, edge), 1.0);
}
