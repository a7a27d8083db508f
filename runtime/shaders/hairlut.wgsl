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
const hairlut_warp_quartic: i32 = 1;
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
    e: f32,          // quartic warp: (m + e)^(1/4) = f0 + k c, m = min(u, 1-u), c the folded column
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
 * widths of both neighbours. The density is du/dx. */

struct hairlut_rows {
    row: i32, // below theta_r
    t: f32,   // weight of the row above, in [0,1]
}

struct hairlut_cell {
    x0: f32,
    d: f32,
    c: f32,
}

/* A place on the u axis: cell, counted from the low or the high end, fraction of it, counted likewise, and du/dcolumn there. */
struct hairlut_knot {
    i: i32,
    high: bool,
    f: f32,
    du: f32,
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

/* (nearer end, width, curvature) of a cell of one row, n columns from the low end. The curvature comes from the widths of both
 * neighbours, at an end of the row from the one that there is. Seen from the high end the width is negative. */
fn hairlut_row_cell(axis: hairlut_axis, row: i32, n: i32, high: bool) -> vec3f {
    let last = axis.columns - 1;
    let x0 = hairlut_fetch(axis.table, n, row);
    let x1 = hairlut_fetch(axis.table, n + 1, row);
    let d = x1 - x0;
    let inner = n > 0 && n < last - 1;
    let before = select(d, x0 - hairlut_fetch(axis.table, max(n - 1, 0), row), n > 0);
    let after = select(d, hairlut_fetch(axis.table, min(n + 2, last), row) - x1, n < last - 1);
    let bound = axis.limit * d;
    let c = clamp(select(1.0, 0.25, inner) * (before - after), -bound, bound);
    return select(vec3f(x0, d, c), vec3f(x1, -d, c), high);
}

/* Cell i, counted from the low or the high end. Each row's cell is taken before they are blended: neighbouring texels subtract
 * without rounding. */
fn hairlut_axis_cell(axis: hairlut_axis, rows: hairlut_rows, i: i32, high: bool) -> hairlut_cell {
    let n = select(i, axis.columns - 2 - i, high);
    let a = hairlut_row_cell(axis, rows.row, n, high);
    let b = hairlut_row_cell(axis, rows.row + 1, n, high);
    return hairlut_cell(hairlut_blend_part(a.x, b.x, rows.t), hairlut_blend_part(a.y, b.y, rows.t),
                        hairlut_blend_part(a.z, b.z, rows.t));
}

/* u to column. The fold at u = 1/2 keeps the relative precision of both tails. */
fn hairlut_axis_knot(axis: hairlut_axis, number: f32) -> hairlut_knot {
    let u = clamp(hairlut_tame(number, 0.0), 0.0, 1.0);
    let m = select(1.0 - u, u, u <= 0.5);
    var c = m * axis.inverse_k;
    var du = axis.k;
    if (axis.warp == hairlut_warp_quartic) {
        let y = sqrt(sqrt(m + axis.e));
        c = (y - axis.f0) * axis.inverse_k;
        du = 4.0 * axis.k * (y * (y * y));
    }
    c = clamp(c, 0.0, 0.5 * f32(axis.columns - 1));
    let i = i32(c);
    return hairlut_knot(i, u > 0.5, c - f32(i), du);
}

/* (column, its mirror image) of a place in cell i, counted from one end. */
fn hairlut_columns(axis: hairlut_axis, i: i32, f: f32) -> vec2f {
    let column = f32(i) + f;
    return vec2f(column, f32(axis.columns - 1) - column);
}

/* du/dcolumn at a place given by cell and fraction. The middle cell of an even number of columns is seen from the low end; beyond
 * its middle the high end is nearer. */
fn hairlut_axis_du(axis: hairlut_axis, i: i32, f: f32) -> f32 {
    if (axis.warp != hairlut_warp_quartic) {
        return axis.k;
    }
    let columns = hairlut_columns(axis, i, f);
    let y = axis.f0 + axis.k * min(columns.x, columns.y);
    return 4.0 * axis.k * (y * (y * y));
}

/* Column to u. */
fn hairlut_axis_u(axis: hairlut_axis, i: i32, high: bool, f: f32) -> f32 {
    let columns = hairlut_columns(axis, i, f);
    var m = axis.k * min(columns.x, columns.y);
    if (axis.warp == hairlut_warp_quartic) {
        let y = axis.f0 + m;
        m *= (y + axis.f0) * (y * y + axis.f0 * axis.f0); // y^4 - f0^4 without its cancellation
    }
    m = clamp(m, 0.0, 0.5);
    return select(m, 1.0 - m, high || columns.y < columns.x);
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
    let x = cell.x0 + knot.f * (cell.d + cell.c * (1.0 - knot.f));
    let slope = abs(cell.d + cell.c * (1.0 - 2.0 * knot.f));
    return hairlut_draw(clamp(x, axis.low, axis.high), knot.du / slope);
}

/* Density per rad of hairlut_axis_sample at x; 0 outside the domain and for NaN. */
fn hairlut_axis_pdf(axis: hairlut_axis, theta_r: f32, x: f32) -> f32 {
    if (hairlut_is_nan(x) || x < axis.low || x > axis.high) {
        return 0.0;
    }
    let rows = hairlut_axis_rows(axis, theta_r);
    let n = hairlut_axis_find(axis, rows, x);
    let high = n >= axis.columns / 2;
    let i = select(n, axis.columns - 2 - n, high);
    let place = hairlut_cell_solve(hairlut_axis_cell(axis, rows, i, high), x);
    return hairlut_axis_du(axis, i, place.x) / place.y;
}

/* The u that hairlut_axis_sample turns into x; outside the domain the nearer end's, 0 for NaN. */
fn hairlut_axis_invert(axis: hairlut_axis, theta_r: f32, number: f32) -> f32 {
    let x = hairlut_tame(number, axis.low);
    let rows = hairlut_axis_rows(axis, theta_r);
    let n = hairlut_axis_find(axis, rows, x);
    let high = n >= axis.columns / 2;
    let i = select(n, axis.columns - 2 - n, high);
    let place = hairlut_cell_solve(hairlut_axis_cell(axis, rows, i, high), x);
    return hairlut_axis_u(axis, i, high, place.x);
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
