/* hairlut for WGSL: sample, pdf and invert as in hairlut.h, from the same texels.
 *
 *     @group(0) @binding(0) var tables: texture_2d<f32>;  // r32float (unfilterable); the three tables, one below another
 *     @group(0) @binding(1) var<uniform> axes: array<vec4f, 9>;   // three vec4f a table, from `hairlut export --to raw`
 *
 *     fn hairlut_fetch(table: i32, column: i32, row: i32) -> f32 {
 *         return textureLoad(tables, vec2i(column, table + row), 0).r;
 *     }
 *     // ... this file ...
 *     let hair = hairlut_model(hairlut_axis_of(axes[0], axes[1], axes[2]),      // direct_theta
 *                              hairlut_axis_of(axes[3], axes[4], axes[5]),      // direct_phi
 *                              hairlut_axis_of(axes[6], axes[7], axes[8]),      // multiple_theta
 *                              hairlut_azimuth_difference);                     // printed: _sum
 *     let s = hairlut_sample_direct(hair, theta_r, phi_r, u_theta, u_phi);
 *
 * hairlut_fetch(table, column, row) is the module's own: it returns the texel of one table, from a texture or a buffer.
 * The integer `table` is passed through from hairlut_axis_of and may mean what the module likes: a first row, a layer, an
 * index. It is never called outside 0 <= column < columns, 0 <= row < height. Never let the texture unit filter: its 8-bit
 * weights move an angle by up to 0.003 rad, and the density would not be the density of what was sampled.
 *
 * Cost: a sample or density fetches eight texels (four in each of two rows) on each axis; density and invert find their
 * cell first, by two fetches for each halving of the row.
 *
 * The rules of hairlut.h hold for every function: no finite input gives NaN or infinity; u and theta_r are clamped; NaN in
 * any argument, or an infinite azimuth, gives density 0 and finite angles inside their ranges. NaN is told by its bits,
 * since WGSL lets an implementation assume that there is none.
 *
 * Keep the axes in uniforms or buffers. As constants they invite a compiler to reorder (1 - u) + e, which costs the upper
 * tail its precision; WGSL has no way to forbid it. */

const hairlut_warp_uniform: i32 = 0;
const hairlut_warp_octaves: i32 = 1;
const hairlut_azimuth_difference: i32 = 0;
const hairlut_azimuth_sum: i32 = 1;

/* One table and the numbers to read it by. */
struct hairlut_axis {
    table: i32,      // passed to hairlut_fetch
    columns: i32,    // >= 4
    height: i32,     // >= 2
    warp: i32,
    row_origin: f32, // theta_r of row 0
    row_scale: f32,  // rows per radian of theta_r
    low: f32,        // the domain, rad
    high: f32,
    e: f32,          // octaves: F(m + e) = f0 + k c, m = min(u, 1-u), c the folded column
    f0: f32,
    k: f32,          // uniform warp: m = k c
    limit: f32,      // of a cell's curvature, relative to its width
    inverse_k: f32,
}

struct hairlut_model {
    direct_theta: hairlut_axis,
    direct_phi: hairlut_axis,
    multiple_theta: hairlut_axis,
    azimuth: i32, // what direct_phi holds: hairlut_azimuth_difference or _sum of phi_i and phi_r
}

struct hairlut_sample {
    theta_i: f32,         // [-pi/2, pi/2]
    phi_i: f32,           // [-pi, pi)
    pdf_angle: f32,       // per rad^2
    pdf_solid_angle: f32, // per sr
}

/* The axis that twelve numbers describe: (table, columns, height, warp), (row_origin, row_scale, low, high),
 * (e, f0, k, limit). */
fn hairlut_axis_of(shape: vec4f, range: vec4f, warp: vec4f) -> hairlut_axis {
    return hairlut_axis(i32(shape.x), i32(shape.y), i32(shape.z), i32(shape.w), range.x, range.y, range.z, range.w,
                        warp.x, warp.y, warp.z, warp.w, 1.0 / warp.z);
}

/* ---- numbers -------------------------------------------------------------------------------------------------- */

const hairlut_two_pi: f32 = 6.28318548;
const hairlut_pi: f32 = 3.14159274;
const hairlut_inverse_two_pi: f32 = 0.159154943; // also the density of a uniform azimuth
const hairlut_huge: f32 = 1e30;                   // stands for infinity; a row position of it stays finite

fn hairlut_is_nan(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u;
}

fn hairlut_is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7fffffffu) < 0x7f800000u;
}

/* x without the values that arithmetic need not honour: NaN becomes `unknown`, infinity a large number. */
fn hairlut_tame(x: f32, unknown: f32) -> f32 {
    if (hairlut_is_nan(x)) {
        return unknown;
    }
    return clamp(x, -hairlut_huge, hairlut_huge);
}

/* phi modulo 2 pi, from [low, low + 2 pi). 2 pi is subtracted in two parts, of which the first multiplies without
 * rounding. What no float resolves gives low. */
fn hairlut_wrap(phi: f32, low: f32) -> f32 {
    if (!hairlut_is_finite(phi)) {
        return low;
    }
    let n = floor((phi - low) * hairlut_inverse_two_pi);
    let r = (phi - n * 6.28125) - n * 1.93530718e-3;
    return select(low, r, r >= low && r < low + hairlut_two_pi);
}

/* cos(theta) for |theta| <= pi/2 as the sine of the distance z from the pole. The last term is what the float pi/2 lacks:
 * added at the end, no compiler can fold it into the first subtraction. */
fn hairlut_cos(theta: f32) -> f32 {
    let z = max(1.57079637 - abs(theta), 0.0);
    let w = z * z;
    let series = 1.0 + w * (-1.0 / 6.0 + w * (1.0 / 120.0 + w * (-1.0 / 5040.0 + w * (1.0 / 362880.0
                     + w * (-1.0 / 39916800.0)))));
    return max(z * series - 4.37113883e-8, 4.37113883e-8);
}

fn hairlut_pdf_to_solid_angle(pdf_angle: f32, theta_i: f32) -> f32 {
    return pdf_angle / hairlut_cos(theta_i);
}

/* ---- one axis: the reading of a table ------------------------------------------------------------------------- */

/* The cells of two neighbouring rows are blended linearly in theta_r. Within a blended cell, with f in [0,1] its fraction,
 * x(f) = x0 + f (d + c (1-f)) and dx/df = d + c (1-2f), where d is the cell's width and c its curvature, taken from the
 * widths of both neighbours. u runs evenly with f, over the cell's width h in u: the density is h / |dx/df|. All is counted
 * from the nearer end of the u axis, where m = min(u, 1-u); seen from the high end, d is negative. */

struct hairlut_rows {
    row: i32, // below theta_r
    t: f32,   // weight of the row above, in [0,1]
}

struct hairlut_cell {
    x0: f32, // in x
    d: f32,
    c: f32,
    m0: f32, // nearer knot and width in u
    h: f32,
}

/* A place on the u axis: m = min(u, 1-u), and its cell, counted from the low or the high end. */
struct hairlut_knot {
    i: i32,
    high: bool,
    m: f32,
}

struct hairlut_draw {
    x: f32,
    pdf: f32,
}

fn hairlut_axis_rows(axis: hairlut_axis, theta_r: f32) -> hairlut_rows {
    let r = clamp((hairlut_tame(theta_r, axis.row_origin) - axis.row_origin) * axis.row_scale, 0.0,
                  f32(axis.height - 1));
    let row = min(i32(r), axis.height - 2);
    return hairlut_rows(row, r - f32(row));
}

fn hairlut_blend(a: f32, b: f32, t: f32) -> f32 {
    return a + t * (b - a);
}

/* The same for the parts of a cell: a width is positive for positive a and b at every t, which it is not by the form above where
 * b is far below a. */
fn hairlut_blend_part(a: f32, b: f32, t: f32) -> f32 {
    return (1.0 - t) * a + t * b;
}

/* The blended texel of knot i. */
fn hairlut_texel(axis: hairlut_axis, rows: hairlut_rows, i: i32) -> f32 {
    let a = hairlut_fetch(axis.table, i, rows.row);
    let b = hairlut_fetch(axis.table, i, rows.row + 1);
    return hairlut_blend(a, b, rows.t);
}

/* The curve F of octaves: near a fourth root, a straight line in each octave of s. */
fn hairlut_curve(s: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(s) >> 2u) + 0x30000000u);
}

/* s of y = F(s) */
fn hairlut_curve_back(y: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(y) - 0x30000000u) << 2u);
}

/* The distance in u of knot n, counted from an end, from that end. */
fn hairlut_axis_tail(axis: hairlut_axis, n: i32) -> f32 {
    let mirrored = axis.columns - 1 - n;
    var m = axis.f0 + axis.k * f32(min(n, mirrored));
    if (axis.warp == hairlut_warp_octaves) {
        m = hairlut_curve_back(m) - axis.e;
    }
    m = select(m, 0.0, n == 0);
    return select(m, 1.0 - m, n > mirrored);
}

/* Texel n of a row, counted from the low or the high end. */
fn hairlut_row_texel(axis: hairlut_axis, row: i32, n: i32, high: bool) -> f32 {
    return hairlut_fetch(axis.table, select(n, axis.columns - 1 - n, high), row);
}

/* dx/du at the knot between two cells, from their widths in x and in u: the density there is that of both, blended in x. */
fn hairlut_knot_slope(d0: f32, d1: f32, h0: f32, h1: f32) -> f32 {
    return (d0 + d1) / (d1 * h0 / d0 + d0 * h1 / d1);
}

/* (nearer end, width, curvature) of cell i of one row. h: the widths in u of the cell before, the cell, and the one behind it,
 * which there always is, as a cell is counted from the nearer end. */
fn hairlut_row_cell(axis: hairlut_axis, row: i32, i: i32, high: bool, h: vec3f) -> vec3f {
    let x0 = hairlut_row_texel(axis, row, i, high);
    let x1 = hairlut_row_texel(axis, row, i + 1, high);
    let d = x1 - x0;
    let before = x0 - hairlut_row_texel(axis, row, max(i - 1, 0), high);
    let after = hairlut_row_texel(axis, row, i + 2, high) - x1;
    var c = d - h.y * after / h.z;
    if (i > 0) {
        c = 0.5 * h.y * (hairlut_knot_slope(before, d, h.x, h.y) - hairlut_knot_slope(d, after, h.y, h.z));
    }
    let bound = axis.limit * abs(d);
    return vec3f(x0, d, clamp(c, -bound, bound));
}

/* Cell i, counted from the low or the high end. Each row's cell is taken before they are blended: neighbouring texels subtract
 * without rounding. */
fn hairlut_axis_cell(axis: hairlut_axis, rows: hairlut_rows, i: i32, high: bool) -> hairlut_cell {
    let m0 = hairlut_axis_tail(axis, i);
    let m1 = hairlut_axis_tail(axis, i + 1);
    let h = vec3f(m0 - hairlut_axis_tail(axis, max(i - 1, 0)), m1 - m0, hairlut_axis_tail(axis, i + 2) - m1);
    let a = hairlut_row_cell(axis, rows.row, i, high, h);
    let b = hairlut_row_cell(axis, rows.row + 1, i, high, h);
    return hairlut_cell(hairlut_blend_part(a.x, b.x, rows.t), hairlut_blend_part(a.y, b.y, rows.t),
                        hairlut_blend_part(a.z, b.z, rows.t), m0, h.y);
}

/* u to cell. The fold at u = 1/2 keeps the relative precision of both tails. */
fn hairlut_axis_knot(axis: hairlut_axis, number: f32) -> hairlut_knot {
    let u = clamp(hairlut_tame(number, 0.0), 0.0, 1.0);
    let m = select(1.0 - u, u, u <= 0.5);
    var y = m;
    if (axis.warp == hairlut_warp_octaves) {
        y = hairlut_curve(m + axis.e);
    }
    let c = y * axis.inverse_k - axis.f0 * axis.inverse_k; // the cell's part of it as C rounds it
    return hairlut_knot(min(i32(max(c, 0.0)), (axis.columns - 1) / 2), u > 0.5, m);
}

/* The cell whose blended texels enclose x. */
fn hairlut_axis_find(axis: hairlut_axis, rows: hairlut_rows, x: f32) -> i32 {
    var i = 0;
    var n = axis.columns - 1;
    while (n > 1) {
        let half_n = n / 2;
        if (hairlut_texel(axis, rows, i + half_n) <= x) {
            i += half_n;
        }
        n -= half_n;
    }
    return i;
}

/* (fraction of a cell at which x lies, |dx/df| there). The root of the quadratic is that slope, written as the slope at the
 * cell's flatter end and the distance from there, which cancels nothing. */
fn hairlut_cell_solve(cell: hairlut_cell, x: f32) -> vec2f {
    let falls = cell.d < 0.0;
    let d = abs(cell.d);
    let c = select(cell.c, -cell.c, falls);
    let along = clamp(select(x - cell.x0, cell.x0 - x, falls), 0.0, d);
    let flat_slope = d - abs(c);
    let away = select(along, d - along, c > 0.0);
    let slope = sqrt(flat_slope * flat_slope + 4.0 * abs(c) * away);
    return vec2f(min(2.0 * along / (d + c + slope), 1.0), slope);
}

fn hairlut_axis_sample(axis: hairlut_axis, theta_r: f32, u: f32) -> hairlut_draw {
    let knot = hairlut_axis_knot(axis, u);
    let cell = hairlut_axis_cell(axis, hairlut_axis_rows(axis, theta_r), knot.i, knot.high);
    let f = (knot.m - cell.m0) / cell.h;
    let x = cell.x0 + f * (cell.d + cell.c * (1.0 - f));
    let slope = abs(cell.d + cell.c * (1.0 - 2.0 * f));
    return hairlut_draw(clamp(x, axis.low, axis.high), cell.h / slope);
}

/* Cell n of a row, counted from the low end, as seen from the nearer end. */
fn hairlut_axis_found(axis: hairlut_axis, rows: hairlut_rows, n: i32) -> hairlut_cell {
    let high = n >= axis.columns / 2;
    return hairlut_axis_cell(axis, rows, select(n, axis.columns - 2 - n, high), high);
}

/* Density per rad of hairlut_axis_sample at x; 0 outside the domain and for NaN. */
fn hairlut_axis_pdf(axis: hairlut_axis, theta_r: f32, x: f32) -> f32 {
    if (hairlut_is_nan(x) || x < axis.low || x > axis.high) {
        return 0.0;
    }
    let rows = hairlut_axis_rows(axis, theta_r);
    let cell = hairlut_axis_found(axis, rows, hairlut_axis_find(axis, rows, x));
    return cell.h / hairlut_cell_solve(cell, x).y;
}

/* The u that hairlut_axis_sample turns into x; outside the domain the nearer end's, 0 for NaN. */
fn hairlut_axis_invert(axis: hairlut_axis, theta_r: f32, number: f32) -> f32 {
    let x = hairlut_tame(number, axis.low);
    let rows = hairlut_axis_rows(axis, theta_r);
    let cell = hairlut_axis_found(axis, rows, hairlut_axis_find(axis, rows, x));
    let m = clamp(cell.m0 + cell.h * hairlut_cell_solve(cell, x).x, 0.0, 1.0);
    return select(m, 1.0 - m, cell.d < 0.0);
}

/* ---- the two lobes -------------------------------------------------------------------------------------------- */

/* NaN anywhere, or an infinite azimuth: the density is 0. */
fn hairlut_known(theta_r: f32, phi_r: f32, a: f32, b: f32) -> bool {
    return !hairlut_is_nan(theta_r) && hairlut_is_finite(phi_r) && !hairlut_is_nan(a) && !hairlut_is_nan(b);
}

/* The azimuth that the table direct_phi holds, in [0, 2 pi). */
fn hairlut_relative_azimuth(model: hairlut_model, phi_r: f32, phi_i: f32) -> f32 {
    let r = hairlut_wrap(phi_r, -hairlut_pi);
    let i = hairlut_wrap(phi_i, -hairlut_pi);
    return hairlut_wrap(select(i - r, i + r, model.azimuth == hairlut_azimuth_sum), 0.0);
}

/* phi_i in [-pi, pi) from the azimuth in the table. */
fn hairlut_incident_azimuth(model: hairlut_model, phi_r: f32, phi: f32) -> f32 {
    let r = hairlut_wrap(phi_r, -hairlut_pi);
    return hairlut_wrap(select(phi + r, phi - r, model.azimuth == hairlut_azimuth_sum), -hairlut_pi);
}

fn hairlut_finish(theta_i: f32, phi_i: f32, pdf: f32) -> hairlut_sample {
    return hairlut_sample(theta_i, phi_i, pdf, hairlut_pdf_to_solid_angle(pdf, theta_i));
}

/* Draws an incident direction for the viewer direction (theta_r, phi_r) from two numbers in [0,1). */
fn hairlut_sample_direct(model: hairlut_model, theta_r: f32, phi_r: f32, u_theta: f32, u_phi: f32) -> hairlut_sample {
    let theta = hairlut_axis_sample(model.direct_theta, theta_r, u_theta);
    let phi = hairlut_axis_sample(model.direct_phi, theta_r, u_phi);
    let pdf = select(0.0, theta.pdf * phi.pdf, hairlut_known(theta_r, phi_r, u_theta, u_phi));
    return hairlut_finish(theta.x, hairlut_incident_azimuth(model, phi_r, phi.x), pdf);
}

fn hairlut_sample_multiple(model: hairlut_model, theta_r: f32, phi_r: f32, u_theta: f32, u_phi: f32) -> hairlut_sample {
    let theta = hairlut_axis_sample(model.multiple_theta, theta_r, u_theta);
    let u = clamp(hairlut_tame(u_phi, 0.0), 0.0, 1.0);
    let phi = hairlut_two_pi * u - hairlut_pi;
    let pdf = select(0.0, theta.pdf * hairlut_inverse_two_pi, hairlut_known(theta_r, phi_r, u_theta, u_phi));
    return hairlut_finish(theta.x, select(-hairlut_pi, phi, phi < hairlut_pi), pdf);
}

/* Density, per rad^2, with which the function above draws (theta_i, phi_i). phi_i may be any finite azimuth. */
fn hairlut_pdf_direct(model: hairlut_model, theta_r: f32, phi_r: f32, theta_i: f32, phi_i: f32) -> f32 {
    if (!hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i)) {
        return 0.0;
    }
    let phi = hairlut_relative_azimuth(model, phi_r, phi_i);
    return hairlut_axis_pdf(model.direct_theta, theta_r, theta_i) * hairlut_axis_pdf(model.direct_phi, theta_r, phi);
}

fn hairlut_pdf_multiple(model: hairlut_model, theta_r: f32, phi_r: f32, theta_i: f32, phi_i: f32) -> f32 {
    if (!hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i)) {
        return 0.0;
    }
    return hairlut_axis_pdf(model.multiple_theta, theta_r, theta_i) * hairlut_inverse_two_pi;
}

/* The numbers (u_theta, u_phi) from which the sampling function draws (theta_i, phi_i). Directions outside the domain give
 * the nearer end's u; NaN gives 0. */
fn hairlut_invert_direct(model: hairlut_model, theta_r: f32, phi_r: f32, theta_i: f32, phi_i: f32) -> vec2f {
    let phi = select(hairlut_relative_azimuth(model, phi_r, phi_i), 0.0, hairlut_is_nan(phi_i));
    return vec2f(hairlut_axis_invert(model.direct_theta, theta_r, theta_i),
                 hairlut_axis_invert(model.direct_phi, theta_r, phi));
}

fn hairlut_invert_multiple(model: hairlut_model, theta_r: f32, phi_r: f32, theta_i: f32, phi_i: f32) -> vec2f {
    return vec2f(hairlut_axis_invert(model.multiple_theta, theta_r, theta_i),
                 (hairlut_wrap(phi_i, -hairlut_pi) + hairlut_pi) * hairlut_inverse_two_pi);
}

/* ---- both lobes at once --------------------------------------------------------------------------------------- */

fn hairlut_pdf_mixture(model: hairlut_model, direct_weight: f32, theta_r: f32, phi_r: f32, theta_i: f32,
                       phi_i: f32) -> f32 {
    if (hairlut_is_nan(direct_weight)) {
        return 0.0;
    }
    let w = clamp(hairlut_tame(direct_weight, 0.0), 0.0, 1.0);
    return w * hairlut_pdf_direct(model, theta_r, phi_r, theta_i, phi_i)
           + (1.0 - w) * hairlut_pdf_multiple(model, theta_r, phi_r, theta_i, phi_i);
}

/* With probability direct_weight, clamped to [0,1], draws from the direct lobe (u_lobe < direct_weight), else from the
 * multiple lobe. The densities returned are the mixture's: direct_weight * direct + (1 - direct_weight) * multiple. */
fn hairlut_sample_mixture(model: hairlut_model, direct_weight: f32, theta_r: f32, phi_r: f32, u_lobe: f32, u_theta: f32,
                          u_phi: f32) -> hairlut_sample {
    let w = clamp(hairlut_tame(direct_weight, 0.0), 0.0, 1.0);
    var s: hairlut_sample;
    var direct: f32;
    var multiple: f32;
    if (!hairlut_is_nan(u_lobe) && u_lobe < w) {
        s = hairlut_sample_direct(model, theta_r, phi_r, u_theta, u_phi);
        direct = s.pdf_angle;
        multiple = hairlut_pdf_multiple(model, theta_r, phi_r, s.theta_i, s.phi_i);
    } else {
        s = hairlut_sample_multiple(model, theta_r, phi_r, u_theta, u_phi);
        multiple = s.pdf_angle;
        direct = hairlut_pdf_direct(model, theta_r, phi_r, s.theta_i, s.phi_i);
    }
    let known = !hairlut_is_nan(direct_weight) && !hairlut_is_nan(u_lobe)
                && hairlut_known(theta_r, phi_r, u_theta, u_phi);
    return hairlut_finish(s.theta_i, s.phi_i, select(0.0, w * direct + (1.0 - w) * multiple, known));
}
