#version 430
// SPDX-License-Identifier: BSD-3-Clause
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Inputs { vec4 inputs[]; };
layout(std430, binding = 1) writeonly buffer Outputs { vec4 outputs[]; };
uniform sampler2D hairs;
uniform int first;
uniform int count;
#define HAIRLUT_FETCH(source, i) texelFetch(hairs, ivec2((i) & 1023, (i) >> 10), 0)
//@hairlut
//@record

vec4 packed_sample(hairlut_sample s)
{
    return vec4(s.theta_i, s.phi_i, s.pdf_angle, s.pdf_solid_angle);
}

void main()
{
    int k = int(gl_GlobalInvocationID.x);
    if (k >= count)
        return;
    int n = 4 * k;
    test_result r = test_record(hairlut_model_at(0, first), inputs[n], inputs[n + 1], inputs[n + 2], inputs[n + 3]);
    outputs[5 * k] = packed_sample(r.lobe);
    outputs[5 * k + 1] = packed_sample(r.hair);
    outputs[5 * k + 2] = packed_sample(r.given);
    outputs[5 * k + 3] = vec4(r.pdf_lobe, r.pdf_hair, r.pdf_given, r.inverse_cosine);
    outputs[5 * k + 4] = vec4(r.numbers.u_theta, r.numbers.u_phi, 0.0, 0.0);
}
