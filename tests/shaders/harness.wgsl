// SPDX-License-Identifier: BSD-3-Clause
@group(0) @binding(0) var<storage, read> hairs: array<vec4f>;
@group(0) @binding(1) var<uniform> place: vec4i; // (first texel, count, 0, 0)
@group(0) @binding(2) var<storage, read> inputs: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> outputs: array<vec4f>;

fn hairlut_fetch(source: i32, i: i32) -> vec4f {
    return hairs[i];
}

fn hairlut_header(source: i32, i: i32) -> vec4f {
    return hairs[i];
}
//@hairlut
//@record

fn packed_sample(s: hairlut_sample) -> vec4f {
    return vec4f(s.theta_i, s.phi_i, s.pdf_angle, s.pdf_solid_angle);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let k = i32(id.x);
    if (k >= place.y) {
        return;
    }
    let n = 4 * k;
    let r = test_record(hairlut_model_at(0, place.x), inputs[n], inputs[n + 1], inputs[n + 2], inputs[n + 3]);
    outputs[5 * k] = packed_sample(r.lobe);
    outputs[5 * k + 1] = packed_sample(r.hair);
    outputs[5 * k + 2] = packed_sample(r.given);
    outputs[5 * k + 3] = vec4f(r.pdf_lobe, r.pdf_hair, r.pdf_given, r.inverse_cosine);
    outputs[5 * k + 4] = vec4f(r.numbers.u_theta, r.numbers.u_phi, 0.0, 0.0);
}
