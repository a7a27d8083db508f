#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D tables; // the three tables of the model, one below another
uniform vec4 axes[9];
uniform int azimuth;
uniform vec2 viewer;  // theta_r, phi_r
uniform int lobe;     // 0 direct, 1 multiple, 2 mixture
uniform float weight; // of the direct lobe in the mixture
#define HAIRLUT_FETCH(table, column, row) texelFetch(tables, ivec2(column, (table) + (row)), 0).r
//@hairlut

hairlut_model hair()
{
    return hairlut_model(hairlut_axis_of(axes[0], axes[1], axes[2]), hairlut_axis_of(axes[3], axes[4], axes[5]),
                         hairlut_axis_of(axes[6], axes[7], axes[8]), azimuth);
}

/* numbers: u_theta, u_phi, u_lobe */
hairlut_sample draw(vec3 numbers)
{
    if (lobe == 0)
        return hairlut_sample_direct(hair(), viewer.x, viewer.y, numbers.x, numbers.y);
    if (lobe == 1)
        return hairlut_sample_multiple(hair(), viewer.x, viewer.y, numbers.x, numbers.y);
    return hairlut_sample_mixture(hair(), weight, viewer.x, viewer.y, numbers.z, numbers.x, numbers.y);
}

float density(float theta_i, float phi_i)
{
    if (lobe == 0)
        return hairlut_pdf_direct(hair(), viewer.x, viewer.y, theta_i, phi_i);
    if (lobe == 1)
        return hairlut_pdf_multiple(hair(), viewer.x, viewer.y, theta_i, phi_i);
    return hairlut_pdf_mixture(hair(), weight, viewer.x, viewer.y, theta_i, phi_i);
}
