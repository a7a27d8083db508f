@group(0) @binding(0) var tables: texture_2d<f32>;
@group(0) @binding(1) var<uniform> axes: array<vec4f, 10>; // the last one: (azimuth, count, 0, 0)
@group(0) @binding(2) var<storage, read> inputs: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> outputs: array<vec4f>;

fn hairlut_fetch(table: i32, column: i32, row: i32) -> f32 {
    return textureLoad(tables, vec2i(column, table + row), 0).r;
}
//@hairlut

fn packed_sample(s: hairlut_sample) -> vec4f {
    return vec4f(s.theta_i, s.phi_i, s.pdf_angle, s.pdf_solid_angle);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let k = id.x;
    if (k >= u32(axes[9].y)) {
        return;
    }
    let hair = hairlut_model(hairlut_axis_of(axes[0], axes[1], axes[2]), hairlut_axis_of(axes[3], axes[4], axes[5]),
                             hairlut_axis_of(axes[6], axes[7], axes[8]), i32(axes[9].x));
    let a = inputs[2 * k];
    let b = inputs[2 * k + 1];
    outputs[5 * k] = packed_sample(hairlut_sample_direct(hair, a.x, a.y, a.z, a.w));
    outputs[5 * k + 1] = packed_sample(hairlut_sample_multiple(hair, a.x, a.y, a.z, a.w));
    outputs[5 * k + 2] = packed_sample(hairlut_sample_mixture(hair, b.y, a.x, a.y, b.x, a.z, a.w));
    outputs[5 * k + 3] = vec4f(hairlut_pdf_direct(hair, a.x, a.y, b.z, b.w), hairlut_pdf_multiple(hair, a.x, a.y, b.z, b.w),
                               hairlut_pdf_mixture(hair, b.y, a.x, a.y, b.z, b.w), hairlut_pdf_to_solid_angle(1.0, b.z));
    outputs[5 * k + 4] = vec4f(hairlut_invert_direct(hair, a.x, a.y, b.z, b.w),
                               hairlut_invert_multiple(hair, a.x, a.y, b.z, b.w));
}
