#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D records; // RGBA32F: two texels a record
uniform highp sampler2D tables;
uniform vec4 axes[9];
uniform int azimuth;
out vec4 direct;
out vec4 multiple;
out vec4 mixture;
out vec4 densities;
out vec4 numbers;
#define HAIRLUT_FETCH(table, column, row) texelFetch(tables, ivec2(column, (table) + (row)), 0).r
//@hairlut

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
    hairlut_model hair = hairlut_model(hairlut_axis_of(axes[0], axes[1], axes[2]), hairlut_axis_of(axes[3], axes[4], axes[5]),
                                       hairlut_axis_of(axes[6], axes[7], axes[8]), azimuth);
    vec4 a = record(2 * gl_VertexID);
    vec4 b = record(2 * gl_VertexID + 1);
    direct = packed_sample(hairlut_sample_direct(hair, a.x, a.y, a.z, a.w));
    multiple = packed_sample(hairlut_sample_multiple(hair, a.x, a.y, a.z, a.w));
    mixture = packed_sample(hairlut_sample_mixture(hair, b.y, a.x, a.y, b.x, a.z, a.w));
    densities = vec4(hairlut_pdf_direct(hair, a.x, a.y, b.z, b.w), hairlut_pdf_multiple(hair, a.x, a.y, b.z, b.w),
                     hairlut_pdf_mixture(hair, b.y, a.x, a.y, b.z, b.w), hairlut_pdf_to_solid_angle(1.0, b.z));
    numbers = vec4(hairlut_invert_direct(hair, a.x, a.y, b.z, b.w), hairlut_invert_multiple(hair, a.x, a.y, b.z, b.w));
    gl_Position = vec4(0.0);
    gl_PointSize = 1.0;
}
