#version 430
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Inputs { vec4 inputs[]; };
layout(std430, binding = 1) writeonly buffer Outputs { vec4 outputs[]; };
uniform sampler2D tables;
uniform vec4 axes[9];
uniform int azimuth;
uniform int count;
#define HAIRLUT_FETCH(table, column, row) texelFetch(tables, ivec2(column, (table) + (row)), 0).r
//@hairlut

vec4 packed_sample(hairlut_sample s)
{
    return vec4(s.theta_i, s.phi_i, s.pdf_angle, s.pdf_solid_angle);
}

void main()
{
    int k = int(gl_GlobalInvocationID.x);
    if (k >= count)
        return;
    hairlut_model hair = hairlut_model(hairlut_axis_of(axes[0], axes[1], axes[2]), hairlut_axis_of(axes[3], axes[4], axes[5]),
                                       hairlut_axis_of(axes[6], axes[7], axes[8]), azimuth);
    vec4 a = inputs[2 * k];
    vec4 b = inputs[2 * k + 1];
    outputs[5 * k] = packed_sample(hairlut_sample_direct(hair, a.x, a.y, a.z, a.w));
    outputs[5 * k + 1] = packed_sample(hairlut_sample_multiple(hair, a.x, a.y, a.z, a.w));
    outputs[5 * k + 2] = packed_sample(hairlut_sample_mixture(hair, b.y, a.x, a.y, b.x, a.z, a.w));
    outputs[5 * k + 3] = vec4(hairlut_pdf_direct(hair, a.x, a.y, b.z, b.w), hairlut_pdf_multiple(hair, a.x, a.y, b.z, b.w),
                              hairlut_pdf_mixture(hair, b.y, a.x, a.y, b.z, b.w), hairlut_pdf_to_solid_angle(1.0, b.z));
    outputs[5 * k + 4] = vec4(hairlut_invert_direct(hair, a.x, a.y, b.z, b.w), hairlut_invert_multiple(hair, a.x, a.y, b.z, b.w));
}
