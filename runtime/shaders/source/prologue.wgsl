/* SPDX-License-Identifier: BSD-3-Clause */
/* hairlut for WGSL. Made by source/assemble.py; change source/body.inl.
 *
 *     @group(0) @binding(0) var<storage, read> hairs: array<vec4f>;   // the file(s) of `hairlut export --to raw`
 *
 *     fn hairlut_fetch(source: i32, i: i32) -> vec4f {
 *         return hairs[i];
 *     }
 *     fn hairlut_header(source: i32, i: i32) -> vec4f {   // may read the head of a model from a uniform buffer
 *         return hairs[i];
 *     }
 *     // ... this file ...
 *     let hair = hairlut_model_at(0, 0);                  // 0: passed to hairlut_fetch; 0: the model's first texel
 *     let s = hairlut_sample_hair(hair, theta_r, phi_r, offset, u_lobe, u_theta, u_phi);
 *     let q = hairlut_pdf_hair(hair, theta_r, phi_r, offset, theta_i, phi_i);
 *
 * README.md has the rest: bindings, fetches, limits. */

const hairlut_max_lobes: i32 = 16;
const hairlut_max_parameters: i32 = 8;
const hairlut_parameter_slots: i32 = max(hairlut_max_parameters, 1);

fn hairlut_bits(x: f32) -> u32 {
    return bitcast<u32>(x);
}

fn hairlut_from_bits(bits: u32) -> f32 {
    return bitcast<f32>(bits);
}
