#version 300 es
// SPDX-License-Identifier: BSD-3-Clause
precision highp float;
precision highp int;
uniform highp sampler2D hairs; // the stream of one model, 1024 texels wide
uniform vec3 viewer;           // theta_r, phi_r, offset
uniform int lobe;              // -1: the whole hair
#define HAIRLUT_FETCH(source, i) texelFetch(hairs, ivec2((i) & 1023, (i) >> 10), 0)
//@hairlut

uniform float parameters[hairlut_max_parameters];

hairlut_model hair()
{
    hairlut_model model = hairlut_model_at(0, 0);
    for (int p = 0; p < hairlut_max_parameters; ++p)
        model.parameters.value[p] = parameters[p];
    return model;
}

/* numbers: u_theta, u_phi, u_lobe */
hairlut_sample draw(vec3 numbers)
{
    if (lobe < 0)
        return hairlut_sample_hair(hair(), viewer.x, viewer.y, viewer.z, numbers.z, numbers.x, numbers.y);
    return hairlut_sample_lobe(hair(), lobe, viewer.x, viewer.y, numbers.x, numbers.y);
}

float density(float theta_i, float phi_i)
{
    if (lobe < 0)
        return hairlut_pdf_hair(hair(), viewer.x, viewer.y, viewer.z, theta_i, phi_i);
    return hairlut_pdf_lobe(hair(), lobe, viewer.x, viewer.y, theta_i, phi_i);
}
