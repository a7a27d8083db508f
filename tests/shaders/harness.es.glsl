#version 300 es
// SPDX-License-Identifier: BSD-3-Clause
precision highp float;
precision highp int;
uniform highp sampler2D records; // RGBA32F: four texels a record
uniform highp sampler2D hairs;
uniform int first;
out vec4 lobe;
out vec4 hair;
out vec4 given;
out vec4 densities;
out vec4 numbers;
#define HAIRLUT_FETCH(source, i) texelFetch(hairs, ivec2((i) & 1023, (i) >> 10), 0)
//@hairlut
//@record

vec4 packed_sample(hairlut_sample s)
{
    return vec4(s.theta_i, s.phi_i, s.pdf_angle, s.pdf_solid_angle);
}

vec4 record(int k)
{
    int width = textureSize(records, 0).x;
    return texelFetch(records, ivec2(k % width, k / width), 0);
}

void main()
{
    int k = 4 * gl_VertexID;
    test_result r = test_record(hairlut_model_at(0, first), record(k), record(k + 1), record(k + 2), record(k + 3));
    lobe = packed_sample(r.lobe);
    hair = packed_sample(r.hair);
    given = packed_sample(r.given);
    densities = vec4(r.pdf_lobe, r.pdf_hair, r.pdf_given, r.inverse_cosine);
    numbers = vec4(r.numbers.u_theta, r.numbers.u_phi, 0.0, 0.0);
    gl_Position = vec4(0.0);
    gl_PointSize = 1.0;
}
