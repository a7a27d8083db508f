#version 300 es
// SPDX-License-Identifier: BSD-3-Clause
in vec4 drawn;
uniform mat3 turn;
uniform float radius;
uniform float size;
out float facing;

void main()
{
    float across = cos(drawn.x);
    vec3 view = turn * vec3(across * cos(drawn.y), sin(drawn.x), -across * sin(drawn.y));
    facing = view.z;
    gl_Position = vec4(view.xy * radius, view.z > 0.0 ? 0.0 : 2.0, 1.0); // the far half is cut away
    gl_PointSize = size;
}
