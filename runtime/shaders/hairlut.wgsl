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

const hairlut_uniform: i32 = 0; // azimuths: see hairlut_axis
const hairlut_difference: i32 = 1;
const hairlut_sum: i32 = 2;

/* What differs from strand to strand, such as a roughness: a value for each of the model's named parameters, in the order of
 * hair.json. Values are clamped to the parameter's range; with NaN the density is 0. */
struct hairlut_parameters {
    value: array<f32, hairlut_parameter_slots>,
}

/* One hair in the stream of texels that `hairlut export --to raw` writes. */
struct hairlut_model {
    source: i32,                    // passed to hairlut_fetch and hairlut_header
    first: i32,                     // the texel at which the model begins
    lobes: i32,
    values: i32,                    // the first texel of the mixture's shares and turns
    stride: i32,                    // texels of shares and turns for a gap between nodes: two for each of the stream's lobes
    mirrored: bool,                 // nodes of the offset are >= 0, and -h mirrors h
    ranges: i32,                    // the first parameter's texel
    parameter_count: i32,           // 0 to 8
    parameters: hairlut_parameters, // every function reads the model at these: the standard values, or your own
}

/* The lobes' shares and turns at one theta_r, offset and set of parameters. Shares are in any unit: replace them by your own where a shader knows
 * better. A negative one counts as 0; with one that is infinite or NaN the density is 0. */
struct hairlut_mixture {
    share: array<f32, hairlut_max_lobes>,
    turn: array<f32, hairlut_max_lobes>, // rad
    side: f32,                           // -1: azimuths are mirrored
    known: bool,                         // none of the three was NaN
}

struct hairlut_sample {
    theta_i: f32,         // rad, [-pi/2, pi/2]
    phi_i: f32,           // rad, [-pi, pi)
    pdf_angle: f32,       // per rad^2
    pdf_solid_angle: f32, // per sr
}

/* The two numbers from which a lobe's direction is drawn, in [0,1]. */
struct hairlut_numbers {
    u_theta: f32,
    u_phi: f32,
}

/* Where a strand lies among the nodes of the parameters that a table, or the mixture, depends on. Its texels are those of the 2^d
 * nodes around it, each weighted by the product of t, where it is the upper node of an axis, or of 1 - t. */
struct hairlut_corners {
    count: i32,  // 2^d; 1 without parameters
    first: i32,  // texels from those of the first node to those of the lowest corner
    weight: f32, // of the lowest corner
    t: vec4f,    // in [0,1], along each axis; 0 where there is none
    step: vec4f, // texels from a node to the next one, likewise
}

struct hairlut_corner {
    at: i32, // texels from those of the first node
    weight: f32,
}

/* One table and the numbers to read it by. */
struct hairlut_axis {
    source: i32,
    first: i32,      // the table's first texel
    columns: i32,    // knots of a row
    height: i32,     // rows
    tree: i32,       // texels of a row's search tree
    row_origin: f32, // theta_r of row 0
    row_scale: f32,  // rows per radian of theta_r
    low: f32,        // the domain, rad
    high: f32,
    e: f32,          // knots are evenly spaced in F(m + e), m = min(u, 1-u); 0: in m itself
    scale: f32,      // column = F(m + e) * scale - origin
    origin: f32,
    azimuth: i32,    // what a lobe's second table holds: nothing (the azimuth is uniform), phi_i - phi_r or phi_i + phi_r
    corners: hairlut_corners,
}

struct hairlut_lobe {
    theta: hairlut_axis,
    phi: hairlut_axis,
}

/* ---- numbers -------------------------------------------------------------------------------------------------- */

const hairlut_two_pi: f32 = 6.28318548f;
const hairlut_pi: f32 = 3.14159274f;
const hairlut_inverse_two_pi: f32 = 0.159154943f; // also the density of a uniform azimuth
const hairlut_huge: f32 = 1e30f;                  // stands for infinity; what is computed from it stays finite

fn hairlut_is_nan(x: f32) -> bool {
    return (hairlut_bits(x) & 0x7fffffffu) > 0x7f800000u;
}

fn hairlut_is_finite(x: f32) -> bool {
    return (hairlut_bits(x) & 0x7fffffffu) < 0x7f800000u;
}

/* x without the values that arithmetic need not honour: NaN becomes `unknown`, infinity a large number. */
fn hairlut_bounded(x: f32, unknown: f32) -> f32 {
    let number = clamp(x, -hairlut_huge, hairlut_huge);
    return select(number, unknown, hairlut_is_nan(x));
}

/* phi modulo 2 pi, from [low, low + 2 pi). 2 pi is subtracted in two parts, of which the first multiplies without
 * rounding. What no float resolves gives low. */
fn hairlut_wrap(phi: f32, low: f32) -> f32 {
    if (!hairlut_is_finite(phi)) {
        return low;
    }
    let n = floor((phi - low) * hairlut_inverse_two_pi);
    let r = (phi - n * 6.28125f) - n * 1.93530718e-3f;
    return select(low, r, r >= low && r < low + hairlut_two_pi);
}

/* cos(theta) for |theta| <= pi/2 as the sine of the distance z from the pole, by the polynomial of the C library. The last term is
 * what the float pi/2 lacks: added at the end, no compiler can fold it into the first subtraction. */
fn hairlut_cos(theta: f32) -> f32 {
    let z = max(1.57079637f - abs(theta), 0.0f);
    let w = z * z;
    let series = -0.166666567f + w * (0.0083330255f + w * (-0.000198074194f + w * 2.60190313e-6f));
    return max(z + z * w * series - 4.37113883e-8f, 4.37113883e-8f);
}

/* asin(h) for |h| <= 1, by the polynomial of the C library: r + r^3 Q(r^2) for r up to 1/2, and beyond pi/2 - 2 asin(r) with
 * r = sqrt((1 - |h|) / 2). */
fn hairlut_asin(h: f32) -> f32 {
    let a = abs(h);
    let z = select(a * a, 0.5f * (1.0f - a), a > 0.5f);
    let r = select(a, sqrt(z), a > 0.5f);
    let series = 0.166667536f + z * (0.0749524161f + z * (0.045477096f + z * (0.0241476111f + z * 0.0422185473f)));
    let y = r + r * z * series;
    let angle = select(y, 1.57079637f - 2.0f * y, a > 0.5f);
    return select(angle, -angle, h < 0.0f);
}

fn hairlut_pdf_to_solid_angle(pdf_angle: f32, theta_i: f32) -> f32 {
    return pdf_angle / hairlut_cos(theta_i);
}

/* Both weights are positive: what is blended from positive numbers is positive, at every t. */
fn hairlut_blend(a: f32, b: f32, t: f32) -> f32 {
    let x = (1.0f - t) * a + t * b;
    return x;
}

/* ---- the stream ----------------------------------------------------------------------------------------------- */

/* The model whose first texel is `first`, with the standard values of its parameters. */
fn hairlut_model_at(source: i32, first: i32) -> hairlut_model {
    let head = hairlut_header(source, first);
    var model: hairlut_model;
    model.source = source;
    model.first = first;
    model.stride = 2 * i32(abs(head.x));
    model.lobes = min(model.stride / 2, hairlut_max_lobes);
    model.mirrored = head.y > 0.5f;
    model.values = first + i32(head.z);
    model.ranges = first + 3 + 3 * model.stride;
    model.parameter_count = 0;
    if (head.x < 0.0f) {
        let offsets = hairlut_header(source, first + 2);
        model.parameter_count = i32(offsets.w);
        model.lobes = select(0, model.lobes, hairlut_max_parameters > 0);
    }
    for (var p = 0; p < hairlut_max_parameters; p++) {
        model.parameters.value[p] = 0.0f;
        if (p < model.parameter_count) {
            let range = hairlut_header(source, model.ranges + p);
            model.parameters.value[p] = range.z;
        }
    }
    return model;
}

fn hairlut_zeros() -> vec4f {
    var zeros: vec4f;
    zeros.x = 0.0f;
    zeros.y = 0.0f;
    zeros.z = 0.0f;
    zeros.w = 0.0f;
    return zeros;
}

/* v, with x in place of component a. */
fn hairlut_replaced(v: vec4f, a: i32, x: f32) -> vec4f {
    var changed: vec4f;
    changed.x = select(v.x, x, a == 0);
    changed.y = select(v.y, x, a == 1);
    changed.z = select(v.z, x, a == 2);
    changed.w = select(v.w, x, a == 3);
    return changed;
}

fn hairlut_scaled(weight: f32, v: vec4f) -> vec4f {
    var product: vec4f;
    product.x = weight * v.x;
    product.y = weight * v.y;
    product.z = weight * v.z;
    product.w = weight * v.w;
    return product;
}

/* sum + weight v */
fn hairlut_added(sum: vec4f, weight: f32, v: vec4f) -> vec4f {
    var total: vec4f;
    total.x = sum.x + weight * v.x;
    total.y = sum.y + weight * v.y;
    total.z = sum.z + weight * v.z;
    total.w = sum.w + weight * v.w;
    return total;
}

fn hairlut_one_corner() -> hairlut_corners {
    var corners: hairlut_corners;
    corners.count = 1;
    corners.first = 0;
    corners.weight = 1.0f;
    corners.t = hairlut_zeros();
    corners.step = hairlut_zeros();
    return corners;
}

/* Corner c of a set: bit a of c is 1 where it is the upper node of axis a. */
fn hairlut_corner_of(corners: hairlut_corners, c: i32) -> hairlut_corner {
    let x = select(1.0f - corners.t.x, corners.t.x, (c & 1) != 0);
    let y = select(1.0f - corners.t.y, corners.t.y, (c & 2) != 0);
    let z = select(1.0f - corners.t.z, corners.t.z, (c & 4) != 0);
    let w = select(1.0f - corners.t.w, corners.t.w, (c & 8) != 0);
    var steps = select(0.0f, corners.step.x, (c & 1) != 0);
    steps += select(0.0f, corners.step.y, (c & 2) != 0);
    steps += select(0.0f, corners.step.z, (c & 4) != 0);
    steps += select(0.0f, corners.step.w, (c & 8) != 0);
    var corner: hairlut_corner;
    corner.at = corners.first + i32(steps);
    corner.weight = x * y * z * w;
    return corner;
}

/* How many keys of a tree, blended over the corners, are at most x. A texel has two keys of a row and the same two of the row
 * above, and three texels below it; all leaves are at one depth. */
fn hairlut_search(source: i32, corners: hairlut_corners, first: i32, tree: i32, t: f32, x: f32) -> i32 {
    var node = 0;
    while (node < tree) {
        var keys = hairlut_scaled(corners.weight, hairlut_fetch(source, first + corners.first + node));
        for (var c = 1; c < corners.count; c++) {
            let corner = hairlut_corner_of(corners, c);
            if (corner.weight > 0.0f) {
                keys = hairlut_added(keys, corner.weight, hairlut_fetch(source, first + corner.at + node));
            }
        }
        var branch = select(0, 1, hairlut_blend(keys.x, keys.z, t) <= x);
        branch += select(0, 1, hairlut_blend(keys.y, keys.w, t) <= x);
        node = 3 * node + 1 + branch;
    }
    return node - tree;
}

/* A place between two nodes: the gap, and how far along it, in [0,1]. */
struct hairlut_place {
    gap: i32,
    gaps: i32,
    t: f32,
}

/* Where x lies among the nodes that header texel `at` describes: (first texel, number of nodes, texels of the search tree).
 * There is a texel (node, 1 / gap) for each gap, then the tree of the inner nodes. A single node has one gap, of no width. */
fn hairlut_place_of(model: hairlut_model, at: i32, x: f32) -> hairlut_place {
    let nodes = hairlut_header(model.source, at);
    let first = model.first + i32(nodes.x);
    var place: hairlut_place;
    place.gaps = max(i32(nodes.y) - 1, 1);
    place.gap = hairlut_search(model.source, hairlut_one_corner(), first + place.gaps, i32(nodes.z), 0.0f, x);
    let node = hairlut_fetch(model.source, first + place.gap);
    place.t = clamp((x - node.x) * node.y, 0.0f, 1.0f);
    return place;
}

/* The value of parameter p, with NaN the least. Beyond HAIRLUT_PARAMETER_LIMIT it is the standard one. */
fn hairlut_parameter(model: hairlut_model, p: i32) -> f32 {
    if (p < hairlut_max_parameters) {
        return hairlut_bounded(model.parameters.value[p], -hairlut_huge);
    }
    let range = hairlut_header(model.source, model.ranges + p);
    return range.z;
}

fn hairlut_parameters_known(model: hairlut_model) -> bool {
    var known = true;
    for (var p = 0; p < min(model.parameter_count, hairlut_max_parameters); p++) {
        known = known && !hairlut_is_nan(model.parameters.value[p]);
    }
    return known;
}

/* The corners around the model's parameters: of the mixture (0), of lobe k's theta table (1 + 2k), or of its azimuth's (2 + 2k).
 * Behind the ranges there is a texel (number of axes, place of the first one, texels of a node) for each of these. An axis is a texel
 * of its nodes as above, with the number of its parameter; nodes that differ along the last axis alone follow each other. */
fn hairlut_corners_of(model: hairlut_model, owner: i32) -> hairlut_corners {
    var corners = hairlut_one_corner();
    if (hairlut_max_parameters == 0 || model.parameter_count == 0) {
        return corners;
    }
    let depends = hairlut_header(model.source, model.ranges + model.parameter_count + owner);
    for (var a = 0; a < i32(depends.x); a++) {
        let at = model.first + i32(depends.y) + a;
        let axis = hairlut_header(model.source, at);
        let place = hairlut_place_of(model, at, hairlut_parameter(model, i32(axis.w)));
        corners.count *= 2;
        corners.first = corners.first * i32(axis.y) + place.gap;
        corners.t = hairlut_replaced(corners.t, a, place.t);
        corners.step = hairlut_replaced(hairlut_scaled(axis.y, corners.step), a, 1.0f);
    }
    corners.first *= i32(depends.z);
    corners.step = hairlut_scaled(depends.z, corners.step);
    corners.weight = (1.0f - corners.t.x) * (1.0f - corners.t.y) * (1.0f - corners.t.z) * (1.0f - corners.t.w);
    return corners;
}

/* A table whose three texels of numbers begin at `at`. */
fn hairlut_axis_at(model: hairlut_model, at: i32, corners: hairlut_corners) -> hairlut_axis {
    let shape = hairlut_header(model.source, at);
    let range = hairlut_header(model.source, at + 1);
    let warp = hairlut_header(model.source, at + 2);
    var axis: hairlut_axis;
    axis.source = model.source;
    axis.first = model.first + i32(shape.x);
    axis.columns = i32(shape.y);
    axis.height = i32(shape.z);
    axis.tree = i32(shape.w);
    axis.row_origin = range.x;
    axis.row_scale = range.y;
    axis.low = range.z;
    axis.high = range.w;
    axis.e = warp.x;
    axis.scale = warp.y;
    axis.origin = warp.z;
    axis.azimuth = i32(warp.w);
    axis.corners = corners;
    return axis;
}

fn hairlut_lobe_at(model: hairlut_model, k: i32) -> hairlut_lobe {
    let at = model.first + 3 + 6 * k;
    var lobe: hairlut_lobe;
    lobe.theta = hairlut_axis_at(model, at, hairlut_corners_of(model, 1 + 2 * k));
    lobe.phi = hairlut_axis_at(model, at + 3, hairlut_corners_of(model, 2 + 2 * k));
    return lobe;
}

/* ---- one axis: the reading of a table ------------------------------------------------------------------------- */

/* A cell is a monotone rational quadratic (Gregory and Delbourgo 1982). Between two knots, h apart in u and w in x, with the
 * slopes e0 and e1 at the knots in units of the cell's own, e = (h/w) dx/du, the fraction f of h, and g = 1 - f,
 *
 *     G = f^2 + g^2 + (e0 + e1) f g,   x = x0 + w (f^2 + e0 f g) / G,
 *     N = e1 f^2 + 2 f g + e0 g^2,     density = du/dx = (h/w) G^2 / N,
 *
 * and back from X = (x - x0) / w, with Z = 1 - X, B = e0 Z - e1 X and R = sqrt(B^2 + 4 X Z), without cancellation:
 *
 *     f : g = 2 X : R + B where B >= 0, else R - B : 2 Z,   density = (h/w) G / R.
 *
 * x0, w, h dx/du at both knots are what texels hold; those of two neighbouring rows are blended linearly in theta_r. All is
 * counted from the nearer end of the u axis, where m = min(u, 1-u); seen from the high end, w is negative. */

struct hairlut_rows {
    row: i32, // below theta_r
    t: f32,   // weight of the row above, in [0,1]
}

struct hairlut_cell {
    x0: f32, // the nearer knot, rad
    w: f32,
    e0: f32,
    e1: f32,
    m0: f32, // the nearer knot's m
    inverse_h: f32,
    h: f32,
}

/* A place on the u axis: m, and its cell, counted from the low or the high end. */
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
    let angle = hairlut_bounded(theta_r, axis.row_origin);
    let r = clamp((angle - axis.row_origin) * axis.row_scale, 0.0f, f32(axis.height - 1));
    var rows: hairlut_rows;
    rows.row = min(i32(r), axis.height - 2);
    rows.t = r - f32(rows.row);
    return rows;
}

/* The curve F of octaves: near a fourth root, a straight line in each octave of s. */
fn hairlut_curve(s: f32) -> f32 {
    return hairlut_from_bits((hairlut_bits(s) >> 2u) + 0x30000000u);
}

/* u to cell. The fold at u = 1/2 keeps the relative precision of both tails. */
fn hairlut_axis_knot(axis: hairlut_axis, number: f32) -> hairlut_knot {
    let u = clamp(hairlut_bounded(number, 0.0f), 0.0f, 1.0f);
    var knot: hairlut_knot;
    knot.high = u > 0.5f;
    let folded = 1.0f - u;
    knot.m = min(u, folded);
    let sum = knot.m + axis.e;
    let y = select(knot.m, hairlut_curve(sum), axis.e > 0.0f);
    let column = y * axis.scale - axis.origin; // rounded as in C, for the same cell beside a knot
    knot.i = clamp(i32(column), 0, axis.columns / 2 - 1);
    return knot;
}

/* Cell i, counted from the low or the high end. */
fn hairlut_axis_cell(axis: hairlut_axis, rows: hairlut_rows, i: i32, high: bool) -> hairlut_cell {
    let half_count = axis.columns / 2;
    let column = select(i, half_count + i, high);
    let at = axis.first + half_count + column * axis.height + rows.row;
    let lowest = at + axis.corners.first;
    var below = hairlut_scaled(axis.corners.weight, hairlut_fetch(axis.source, lowest));
    var above = hairlut_scaled(axis.corners.weight, hairlut_fetch(axis.source, lowest + 1));
    for (var c = 1; c < axis.corners.count; c++) {
        let corner = hairlut_corner_of(axis.corners, c);
        if (corner.weight > 0.0f) {
            below = hairlut_added(below, corner.weight, hairlut_fetch(axis.source, at + corner.at));
            above = hairlut_added(above, corner.weight, hairlut_fetch(axis.source, at + corner.at + 1));
        }
    }
    let knot = hairlut_fetch(axis.source, axis.first + i);
    var cell: hairlut_cell;
    cell.x0 = hairlut_blend(below.x, above.x, rows.t);
    cell.w = hairlut_blend(below.y, above.y, rows.t);
    cell.e0 = hairlut_blend(below.z, above.z, rows.t) / cell.w;
    cell.e1 = hairlut_blend(below.w, above.w, rows.t) / cell.w;
    cell.m0 = knot.x;
    cell.inverse_h = knot.y;
    cell.h = knot.z;
    return cell;
}

/* The cell whose blended texels enclose x. */
fn hairlut_axis_cell_around(axis: hairlut_axis, rows: hairlut_rows, x: f32) -> hairlut_cell {
    let half_count = axis.columns / 2;
    let trees = axis.first + half_count + 2 * half_count * axis.height;
    let n = hairlut_search(axis.source, axis.corners, trees + rows.row * axis.tree, axis.tree, rows.t, x);
    let high = n >= half_count;
    let i = select(n, axis.columns - 2 - n, high);
    return hairlut_axis_cell(axis, rows, i, high);
}

fn hairlut_cell_g(cell: hairlut_cell, f: f32, g: f32) -> f32 {
    return f * f + g * g + (cell.e0 + cell.e1) * (f * g);
}

fn hairlut_axis_sample(axis: hairlut_axis, theta_r: f32, u: f32) -> hairlut_draw {
    let knot = hairlut_axis_knot(axis, u);
    let cell = hairlut_axis_cell(axis, hairlut_axis_rows(axis, theta_r), knot.i, knot.high);
    let f = clamp((knot.m - cell.m0) * cell.inverse_h, 0.0f, 1.0f);
    let g = 1.0f - f;
    let G = hairlut_cell_g(cell, f, g);
    let N = cell.e1 * (f * f) + 2.0f * (f * g) + cell.e0 * (g * g);
    var draw: hairlut_draw;
    draw.x = clamp(cell.x0 + cell.w * ((f * f + cell.e0 * (f * g)) / G), axis.low, axis.high);
    draw.pdf = cell.h / abs(cell.w) * (G * G / N);
    return draw;
}

/* Where x lies in a cell: f, g, and R of above. */
struct hairlut_root {
    f: f32,
    g: f32,
    r: f32,
}

fn hairlut_cell_solve(cell: hairlut_cell, x: f32) -> hairlut_root {
    let X = clamp((x - cell.x0) / cell.w, 0.0f, 1.0f);
    let Z = 1.0f - X;
    let B = cell.e0 * Z - cell.e1 * X;
    let R = sqrt(B * B + 4.0f * (X * Z));
    let a = select(R - B, 2.0f * X, B >= 0.0f);
    let b = select(2.0f * Z, R + B, B >= 0.0f);
    var root: hairlut_root;
    root.f = a / (a + b);
    root.g = b / (a + b);
    root.r = R;
    return root;
}

/* Density per rad of hairlut_axis_sample at x; 0 outside the domain and for NaN. */
fn hairlut_axis_pdf(axis: hairlut_axis, theta_r: f32, x: f32) -> f32 {
    if (hairlut_is_nan(x) || x < axis.low || x > axis.high) {
        return 0.0f;
    }
    let cell = hairlut_axis_cell_around(axis, hairlut_axis_rows(axis, theta_r), x);
    let root = hairlut_cell_solve(cell, x);
    return cell.h / abs(cell.w) * (hairlut_cell_g(cell, root.f, root.g) / root.r);
}

/* The u that hairlut_axis_sample turns into x; outside the domain the nearer end's, 0 for NaN. */
fn hairlut_axis_invert(axis: hairlut_axis, theta_r: f32, number: f32) -> f32 {
    let x = clamp(hairlut_bounded(number, axis.low), axis.low, axis.high);
    let cell = hairlut_axis_cell_around(axis, hairlut_axis_rows(axis, theta_r), x);
    let m = clamp(cell.m0 + cell.h * hairlut_cell_solve(cell, x).f, 0.0f, 1.0f);
    return select(m, 1.0f - m, cell.w < 0.0f);
}

/* ---- one lobe ------------------------------------------------------------------------------------------------- */

/* NaN anywhere, or an infinite azimuth: the density is 0. */
fn hairlut_known(theta_r: f32, phi_r: f32, a: f32, b: f32) -> bool {
    return !hairlut_is_nan(theta_r) && hairlut_is_finite(phi_r) && !hairlut_is_nan(a) && !hairlut_is_nan(b);
}

/* The azimuth that a table holds before mirror and turn, in [-2 pi, 2 pi]: phi_i - phi_r or phi_i + phi_r. */
fn hairlut_relative_azimuth(phi: hairlut_axis, phi_r: f32, phi_i: f32) -> f32 {
    let r = hairlut_wrap(phi_r, -hairlut_pi);
    let i = hairlut_wrap(phi_i, -hairlut_pi);
    return select(i - r, i + r, phi.azimuth == hairlut_sum);
}

/* phi_i in [-pi, pi) from such an azimuth. */
fn hairlut_incident_azimuth(phi: hairlut_axis, phi_r: f32, relative: f32) -> f32 {
    let r = hairlut_wrap(phi_r, -hairlut_pi);
    let phi_i = select(relative + r, relative - r, phi.azimuth == hairlut_sum);
    return hairlut_wrap(phi_i, -hairlut_pi);
}

fn hairlut_finish(theta_i: f32, phi_i: f32, pdf: f32) -> hairlut_sample {
    var s: hairlut_sample;
    s.theta_i = theta_i;
    s.phi_i = phi_i;
    s.pdf_angle = pdf;
    s.pdf_solid_angle = hairlut_pdf_to_solid_angle(pdf, theta_i);
    return s;
}

/* A lobe's draw, mirrored by side = -1 and turned around the fibre. A uniform azimuth ignores both. */
fn hairlut_lobe_sample(lobe: hairlut_lobe, side: f32, turn: f32, theta_r: f32, phi_r: f32, u_theta: f32,
                       u_phi: f32) -> hairlut_sample {
    let theta = hairlut_axis_sample(lobe.theta, theta_r, u_theta);
    var phi_i = hairlut_two_pi * clamp(hairlut_bounded(u_phi, 0.0f), 0.0f, 1.0f) - hairlut_pi;
    var pdf = hairlut_inverse_two_pi;
    if (lobe.phi.azimuth == hairlut_uniform) {
        phi_i = select(-hairlut_pi, phi_i, phi_i < hairlut_pi);
    } else {
        let phi = hairlut_axis_sample(lobe.phi, theta_r, u_phi);
        phi_i = hairlut_incident_azimuth(lobe.phi, phi_r, side * (phi.x + turn));
        pdf = phi.pdf;
    }
    let known = select(0.0f, theta.pdf * pdf, hairlut_known(theta_r, phi_r, u_theta, u_phi));
    return hairlut_finish(theta.x, phi_i, known);
}

fn hairlut_lobe_pdf(lobe: hairlut_lobe, side: f32, turn: f32, theta_r: f32, phi_r: f32, theta_i: f32, phi_i: f32) -> f32 {
    if (!hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i)) {
        return 0.0f;
    }
    let pdf = hairlut_axis_pdf(lobe.theta, theta_r, theta_i);
    if (lobe.phi.azimuth == hairlut_uniform) {
        return pdf * hairlut_inverse_two_pi;
    }
    let phi = hairlut_wrap(side * hairlut_relative_azimuth(lobe.phi, phi_r, phi_i) - turn, 0.0f);
    return pdf * hairlut_axis_pdf(lobe.phi, theta_r, phi);
}

fn hairlut_has_lobe(model: hairlut_model, lobe: i32) -> bool {
    return lobe >= 0 && lobe < model.lobes;
}

/* Draws an incident direction from one lobe, without a turn, for the viewer direction (theta_r, phi_r) and two numbers in
 * [0,1). A lobe that the model does not have: density 0, angles 0. */
fn hairlut_sample_lobe(model: hairlut_model, lobe: i32, theta_r: f32, phi_r: f32, u_theta: f32, u_phi: f32) -> hairlut_sample {
    if (!hairlut_has_lobe(model, lobe)) {
        return hairlut_finish(0.0f, 0.0f, 0.0f);
    }
    let s = hairlut_lobe_sample(hairlut_lobe_at(model, lobe), 1.0f, 0.0f, theta_r, phi_r, u_theta, u_phi);
    let known = select(0.0f, s.pdf_angle, hairlut_parameters_known(model));
    return hairlut_finish(s.theta_i, s.phi_i, known);
}

/* Density, per rad^2, with which the function above draws (theta_i, phi_i). phi_i may be any finite azimuth. */
fn hairlut_pdf_lobe(model: hairlut_model, lobe: i32, theta_r: f32, phi_r: f32, theta_i: f32, phi_i: f32) -> f32 {
    if (!hairlut_has_lobe(model, lobe) || !hairlut_parameters_known(model)) {
        return 0.0f;
    }
    return hairlut_lobe_pdf(hairlut_lobe_at(model, lobe), 1.0f, 0.0f, theta_r, phi_r, theta_i, phi_i);
}

/* The numbers from which hairlut_sample_lobe draws (theta_i, phi_i). Directions outside the domain give the nearer end's u;
 * NaN, or a lobe that the model does not have, gives 0. */
fn hairlut_invert_lobe(model: hairlut_model, lobe: i32, theta_r: f32, phi_r: f32, theta_i: f32,
                       phi_i: f32) -> hairlut_numbers {
    var numbers: hairlut_numbers;
    numbers.u_theta = 0.0f;
    numbers.u_phi = 0.0f;
    if (!hairlut_has_lobe(model, lobe)) {
        return numbers;
    }
    let axes = hairlut_lobe_at(model, lobe);
    numbers.u_theta = hairlut_axis_invert(axes.theta, theta_r, theta_i);
    if (axes.phi.azimuth == hairlut_uniform) {
        numbers.u_phi = (hairlut_wrap(phi_i, -hairlut_pi) + hairlut_pi) * hairlut_inverse_two_pi;
        return numbers;
    }
    let relative = select(hairlut_relative_azimuth(axes.phi, phi_r, phi_i), 0.0f, hairlut_is_nan(phi_i));
    numbers.u_phi = hairlut_axis_invert(axes.phi, theta_r, hairlut_wrap(relative, 0.0f));
    return numbers;
}

/* ---- the mixture ---------------------------------------------------------------------------------------------- */

/* One lobe at the four nodes around theta_r and the offset. */
struct hairlut_pair {
    share: vec4f, // low offset: row below theta_r, row above; high offset: the same
    turn: vec4f,  // low offset: row below theta_r, arc to the row above; high offset: the same
}

/* The texels (share, turn) at `at`, blended over the corners: each of the four turns along the shorter arcs from the lowest corner's. */
fn hairlut_pair_at(model: hairlut_model, corners: hairlut_corners, at: i32) -> hairlut_pair {
    let lowest = hairlut_fetch(model.source, at + corners.first + 1);
    var arcs = hairlut_zeros();
    var pair: hairlut_pair;
    pair.share = hairlut_scaled(corners.weight, hairlut_fetch(model.source, at + corners.first));
    for (var c = 1; c < corners.count; c++) {
        let corner = hairlut_corner_of(corners, c);
        if (corner.weight > 0.0f) {
            pair.share = hairlut_added(pair.share, corner.weight, hairlut_fetch(model.source, at + corner.at));
            let turn = hairlut_fetch(model.source, at + corner.at + 1);
            var arc: vec4f;
            arc.x = hairlut_wrap(turn.x - lowest.x, -hairlut_pi);
            arc.y = hairlut_wrap((turn.x - lowest.x) + (turn.y - lowest.y), -hairlut_pi);
            arc.z = hairlut_wrap(turn.z - lowest.z, -hairlut_pi);
            arc.w = hairlut_wrap((turn.z - lowest.z) + (turn.w - lowest.w), -hairlut_pi);
            arcs = hairlut_added(arcs, corner.weight, arc);
        }
    }
    pair.turn = lowest;
    if (corners.count > 1) {
        pair.turn.x = lowest.x + arcs.x;
        pair.turn.y = hairlut_wrap(lowest.y + (arcs.y - arcs.x), -hairlut_pi);
        pair.turn.z = lowest.z + arcs.z;
        pair.turn.w = hairlut_wrap(lowest.w + (arcs.w - arcs.z), -hairlut_pi);
    }
    return pair;
}

/* Shares and turns at theta_r and the offset h in [-1,1] at which the fibre is hit: linear in theta_r and in asin(h). A turn goes
 * along the shorter arc, in theta_r first. */
fn hairlut_mixture_at(model: hairlut_model, theta_r: f32, offset: f32) -> hairlut_mixture {
    let h = clamp(hairlut_bounded(offset, -1.0f), -1.0f, 1.0f);
    let side = select(1.0f, -1.0f, model.mirrored && h < 0.0f);
    let row = hairlut_place_of(model, model.first + 1, hairlut_bounded(theta_r, -hairlut_huge));
    let column = hairlut_place_of(model, model.first + 2, hairlut_asin(side * h));
    let values = model.values + model.stride * (row.gap * column.gaps + column.gap);
    let corners = hairlut_corners_of(model, 0);
    var mixture: hairlut_mixture;
    mixture.side = side;
    mixture.known = !hairlut_is_nan(theta_r) && !hairlut_is_nan(offset) && hairlut_parameters_known(model);
    for (var k = 0; k < model.lobes; k++) {
        let pair = hairlut_pair_at(model, corners, values + 2 * k);
        let share_low = hairlut_blend(pair.share.x, pair.share.y, row.t);
        let share_high = hairlut_blend(pair.share.z, pair.share.w, row.t);
        let turn_low = pair.turn.x + row.t * pair.turn.y;
        let turn_high = pair.turn.z + row.t * pair.turn.w;
        mixture.share[k] = hairlut_blend(share_low, share_high, column.t);
        mixture.turn[k] = turn_low + column.t * hairlut_wrap(turn_high - turn_low, -hairlut_pi);
    }
    return mixture;
}

/* A share, 0 in place of a negative one, and so far from the largest float that a sum is finite and its reciprocal is not 0. */
fn hairlut_share(mixture: hairlut_mixture, k: i32) -> f32 {
    return clamp(mixture.share[k], 0.0f, 1e36f);
}

/* The sum of the shares; 0 where one is infinite or NaN. */
fn hairlut_total_share(model: hairlut_model, mixture: hairlut_mixture) -> f32 {
    var total = 0.0f;
    var known = true;
    for (var k = 0; k < model.lobes; k++) {
        known = known && hairlut_is_finite(mixture.share[k]);
        total += hairlut_share(mixture, k);
    }
    return select(0.0f, total, known);
}

/* The density of the mixture at (theta_i, phi_i); total is the sum of its shares. Lobe `drawn`, if there is one, has the
 * density that is given. */
fn hairlut_mixture_pdf(model: hairlut_model, mixture: hairlut_mixture, total: f32, theta_r: f32, phi_r: f32, theta_i: f32,
                       phi_i: f32, drawn: i32, given: f32) -> f32 {
    var sum = 0.0f;
    for (var k = 0; k < model.lobes; k++) {
        let weight = hairlut_share(mixture, k) / total;
        if (weight > 0.0f) {
            var pdf = given;
            if (k != drawn) {
                pdf = hairlut_lobe_pdf(hairlut_lobe_at(model, k), mixture.side, mixture.turn[k], theta_r, phi_r, theta_i, phi_i);
            }
            sum += weight * pdf;
        }
    }
    return sum;
}

/* ---- the whole hair ------------------------------------------------------------------------------------------- */

/* Draws an incident direction for the viewer direction (theta_r, phi_r) from three numbers in [0,1): u_lobe chooses the lobe.
 * The densities are those of the whole mixture. */
fn hairlut_sample_hair_at(model: hairlut_model, mixture: hairlut_mixture, theta_r: f32, phi_r: f32, u_lobe: f32, u_theta: f32,
                          u_phi: f32) -> hairlut_sample {
    let total = hairlut_total_share(model, mixture);
    let wanted = clamp(hairlut_bounded(u_lobe, 0.0f), 0.0f, 1.0f) * total;
    var drawn = 0;
    var turn = mixture.turn[0];
    var below = 0.0f;
    for (var k = 0; k < model.lobes; k++) {
        let share = hairlut_share(mixture, k);
        if (share > 0.0f && below <= wanted) {
            drawn = k;
            turn = mixture.turn[k];
        }
        below += share;
    }
    let s = hairlut_lobe_sample(hairlut_lobe_at(model, drawn), mixture.side, turn, theta_r, phi_r, u_theta, u_phi);
    let known = mixture.known && !hairlut_is_nan(u_lobe) && hairlut_known(theta_r, phi_r, u_theta, u_phi);
    if (!known || !(total > 0.0f)) {
        return hairlut_finish(s.theta_i, s.phi_i, 0.0f);
    }
    let pdf = hairlut_mixture_pdf(model, mixture, total, theta_r, phi_r, s.theta_i, s.phi_i, drawn, s.pdf_angle);
    return hairlut_finish(s.theta_i, s.phi_i, pdf);
}

/* Density, per rad^2, with which the function above draws (theta_i, phi_i). phi_i may be any finite azimuth. */
fn hairlut_pdf_hair_at(model: hairlut_model, mixture: hairlut_mixture, theta_r: f32, phi_r: f32, theta_i: f32,
                       phi_i: f32) -> f32 {
    let total = hairlut_total_share(model, mixture);
    if (!mixture.known || !(total > 0.0f)) {
        return 0.0f;
    }
    return hairlut_mixture_pdf(model, mixture, total, theta_r, phi_r, theta_i, phi_i, -1, 0.0f);
}

/* The same with the model's own shares. Where a shader calls both, take the mixture once and call the two above. */
fn hairlut_sample_hair(model: hairlut_model, theta_r: f32, phi_r: f32, offset: f32, u_lobe: f32, u_theta: f32,
                       u_phi: f32) -> hairlut_sample {
    return hairlut_sample_hair_at(model, hairlut_mixture_at(model, theta_r, offset), theta_r, phi_r, u_lobe, u_theta, u_phi);
}

fn hairlut_pdf_hair(model: hairlut_model, theta_r: f32, phi_r: f32, offset: f32, theta_i: f32, phi_i: f32) -> f32 {
    return hairlut_pdf_hair_at(model, hairlut_mixture_at(model, theta_r, offset), theta_r, phi_r, theta_i, phi_i);
}

/* The same for a strand with these parameters. Where a shader calls both, or takes the mixture once, set model.parameters. */
fn hairlut_strand(model: hairlut_model, parameters: hairlut_parameters) -> hairlut_model {
    var strand = model;
    strand.parameters = parameters;
    return strand;
}

fn hairlut_sample_strand(model: hairlut_model, parameters: hairlut_parameters, theta_r: f32, phi_r: f32, offset: f32,
                         u_lobe: f32, u_theta: f32, u_phi: f32) -> hairlut_sample {
    return hairlut_sample_hair(hairlut_strand(model, parameters), theta_r, phi_r, offset, u_lobe, u_theta, u_phi);
}

fn hairlut_pdf_strand(model: hairlut_model, parameters: hairlut_parameters, theta_r: f32, phi_r: f32, offset: f32,
                      theta_i: f32, phi_i: f32) -> f32 {
    return hairlut_pdf_hair(hairlut_strand(model, parameters), theta_r, phi_r, offset, theta_i, phi_i);
}
