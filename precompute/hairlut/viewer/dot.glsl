#version 300 es
// SPDX-License-Identifier: BSD-3-Clause
precision highp float;
in float facing;
out vec4 colour;

void main()
{
    float r = length(gl_PointCoord - 0.5) * 2.0;
    colour = vec4(0.70, 0.93, 1.0, (1.0 - smoothstep(0.6, 1.0, r)) * (0.35 + 0.5 * facing));
}
