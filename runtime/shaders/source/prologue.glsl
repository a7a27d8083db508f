/* SPDX-License-Identifier: BSD-3-Clause */
/* hairlut for GLSL 4.30 and GLSL ES 3.00. Made by source/assemble.py; change source/body.inl.
 *
 *     #version 430                                        // or: #version 300 es
 *     uniform highp sampler2D hairs;                      // RGBA32F, 1024 wide, filter NEAREST: the file(s) of `export --to raw`
 *     #define HAIRLUT_FETCH(source, i) texelFetch(hairs, ivec2((i) & 1023, (i) >> 10), 0)
 *     // ... this file, pasted or included ...
 *     hairlut_model hair = hairlut_model_at(0, 0);        // 0: passed to HAIRLUT_FETCH; 0: the model's first texel
 *     hairlut_sample s = hairlut_sample_hair(hair, theta_r, phi_r, offset, u_lobe, u_theta, u_phi);
 *     float q = hairlut_pdf_hair(hair, theta_r, phi_r, offset, theta_i, phi_i);
 *
 * README.md has the rest: bindings, fetches, limits. */
#ifndef HAIRLUT_GLSL
#define HAIRLUT_GLSL

#ifdef GL_ES
precision highp float;
precision highp int;
#define HAIRLUT_PRECISE
#else
#define HAIRLUT_PRECISE precise
#endif
#ifndef HAIRLUT_LOBE_LIMIT
#define HAIRLUT_LOBE_LIMIT 16
#endif
#ifndef HAIRLUT_PARAMETER_LIMIT
#define HAIRLUT_PARAMETER_LIMIT 8
#endif
#ifndef HAIRLUT_HEADER
#define HAIRLUT_HEADER(source, i) HAIRLUT_FETCH(source, i)
#endif
#define HAIRLUT_SOURCE int
#define HAIRLUT_FN
#define HAIRLUT_CONST const
#define hairlut_float4 vec4
#define hairlut_bits floatBitsToUint
#define hairlut_from_bits uintBitsToFloat

HAIRLUT_CONST int hairlut_max_lobes = HAIRLUT_LOBE_LIMIT;
HAIRLUT_CONST int hairlut_max_parameters = HAIRLUT_PARAMETER_LIMIT;
HAIRLUT_CONST int hairlut_parameter_slots = HAIRLUT_PARAMETER_LIMIT > 0 ? HAIRLUT_PARAMETER_LIMIT : 1;
