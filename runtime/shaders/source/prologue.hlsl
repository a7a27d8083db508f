/* SPDX-License-Identifier: BSD-3-Clause */
/* hairlut for HLSL, shader model 5.0 and newer. Made by source/assemble.py; change source/body.inl.
 *
 *     StructuredBuffer<float4> hairs : register(t0);      // the file(s) of `hairlut export --to raw`
 *     #define HAIRLUT_FETCH(source, i) hairs[i]
 *     #include "hairlut.hlsl"
 *     hairlut_model hair = hairlut_model_at(0, 0);        // 0: passed to HAIRLUT_FETCH; 0: the model's first texel
 *     hairlut_sample s = hairlut_sample_hair(hair, theta_r, phi_r, offset, u_lobe, u_theta, u_phi);
 *     float q = hairlut_pdf_hair(hair, theta_r, phi_r, offset, theta_i, phi_i);
 *
 * README.md has the rest: bindings, fetches, limits. */
#ifndef HAIRLUT_HLSL
#define HAIRLUT_HLSL

#ifndef HAIRLUT_LOBE_LIMIT
#define HAIRLUT_LOBE_LIMIT 16
#endif
#ifndef HAIRLUT_PARAMETER_LIMIT
#define HAIRLUT_PARAMETER_LIMIT 8
#endif
#ifndef HAIRLUT_HEADER
#define HAIRLUT_HEADER(source, i) HAIRLUT_FETCH(source, i)
#endif
#define HAIRLUT_PRECISE precise
#define HAIRLUT_SOURCE int
#define HAIRLUT_FN
#define HAIRLUT_CONST static const
#define hairlut_float4 float4
#define hairlut_bits asuint
#define hairlut_from_bits asfloat

HAIRLUT_CONST int hairlut_max_lobes = HAIRLUT_LOBE_LIMIT;
HAIRLUT_CONST int hairlut_max_parameters = HAIRLUT_PARAMETER_LIMIT;
HAIRLUT_CONST int hairlut_parameter_slots = HAIRLUT_PARAMETER_LIMIT > 0 ? HAIRLUT_PARAMETER_LIMIT : 1;
