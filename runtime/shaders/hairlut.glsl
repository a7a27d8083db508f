/* hairlut for GLSL 4.30 and GLSL ES 3.00: sample, pdf and invert as in hairlut.h, from the same texels.
 *
 *     #version 430                                        // or: #version 300 es
 *     uniform highp sampler2D tables;                     // R32F, filter NEAREST; the three tables, one below another
 *     #define HAIRLUT_FETCH(table, column, row) texelFetch(tables, ivec2(column, (table) + (row)), 0).r
 *     // ... this file, pasted or included ...
 *     uniform vec4 axes[9];                               // three vec4 a table, from `hairlut export --to raw`
 *
 *     hairlut_model hair = hairlut_model(hairlut_axis_of(axes[0], axes[1], axes[2]),     // direct_theta
 *                                        hairlut_axis_of(axes[3], axes[4], axes[5]),     // direct_phi
 *                                        hairlut_axis_of(axes[6], axes[7], axes[8]),     // multiple_theta
 *                                        HAIRLUT_AZIMUTH_DIFFERENCE);                    // printed: _SUM
 *     hairlut_sample s = hairlut_sample_direct(hair, theta_r, phi_r, u_theta, u_phi);
 *
 * HAIRLUT_FETCH(table, column, row) is the includer's: it returns the texel of one table, from a texture or a buffer. The
 * integer `table` is passed through from hairlut_axis_of and may mean what the includer likes: a first row, a layer, an
 * index. It is never called outside 0 <= column < columns, 0 <= row < height. Never let the texture unit filter: its 8-bit
 * weights move an angle by up to 0.003 rad, and the density would not be the density of what was sampled.
 *
 * Cost: a sample or density fetches eight texels (four in each of two rows) on each axis; density and invert find their
 * cell first, by two fetches for each halving of the row.
 *
 * The rules of hairlut.h hold for every function: no finite input gives NaN or infinity; u and theta_r are clamped; NaN in
 * any argument, or an infinite azimuth, gives density 0 and finite angles inside their ranges. NaN is told by its bits,
 * since a shader compiler may assume that x == x.
 *
 * Keep the axes in uniforms or buffers. As compile-time constants they invite a compiler to reorder (1 - u) + e, which
 * costs the upper tail its precision where `precise` (GLSL 4.00) is missing. */
#ifndef HAIRLUT_GLSL
#define HAIRLUT_GLSL

#ifdef GL_ES
precision highp float;
precision highp int;
#define HAIRLUT_PRECISE
#else
#define HAIRLUT_PRECISE precise
#endif

#define HAIRLUT_WARP_UNIFORM 0
#define HAIRLUT_WARP_OCTAVES 1
#define HAIRLUT_AZIMUTH_DIFFERENCE 0
#define HAIRLUT_AZIMUTH_SUM 1

/* One table and the numbers to read it by. */
struct hairlut_axis {
    int table;        // passed to HAIRLUT_FETCH
    int columns;      // >= 4
    int height;       // >= 2
    int warp;
    float row_origin; // theta_r of row 0
    float row_scale;  // rows per radian of theta_r
    float low;        // the domain, rad
    float high;
    float e;          // octaves: F(m + e) = f0 + k c, m = min(u, 1-u), c the folded column
    float f0;
    float k;          // uniform warp: m = k c
    float limit;      // of a cell's curvature, relative to its width
    float inverse_k;
};

struct hairlut_model {
    hairlut_axis direct_theta;
    hairlut_axis direct_phi;
    hairlut_axis multiple_theta;
    int azimuth; // what direct_phi holds: HAIRLUT_AZIMUTH_DIFFERENCE or _SUM of phi_i and phi_r
};

struct hairlut_sample {
    float theta_i;         // [-pi/2, pi/2]
    float phi_i;           // [-pi, pi)
    float pdf_angle;       // per rad^2
    float pdf_solid_angle; // per sr
};

/* The axis that twelve numbers describe: (table, columns, height, warp), (row_origin, row_scale, low, high),
 * (e, f0, k, limit). */
hairlut_axis hairlut_axis_of(vec4 shape, vec4 range, vec4 warp)
{
    return hairlut_axis(int(shape.x), int(shape.y), int(shape.z), int(shape.w), range.x, range.y, range.z, range.w,
                        warp.x, warp.y, warp.z, warp.w, 1.0 / warp.z);
}

/* ---- numbers -------------------------------------------------------------------------------------------------- */

const float hairlut_two_pi = 6.28318548;
const float hairlut_pi = 3.14159274;
const float hairlut_inverse_two_pi = 0.159154943; // also the density of a uniform azimuth
const float hairlut_huge = 1e30;                   // stands for infinity; a row position of it stays finite

bool hairlut_is_nan(float x)
{
    return (floatBitsToUint(x) & 0x7fffffffu) > 0x7f800000u;
}

bool hairlut_is_finite(float x)
{
    return (floatBitsToUint(x) & 0x7fffffffu) < 0x7f800000u;
}

/* x without the values that arithmetic need not honour: NaN becomes `unknown`, infinity a large number. */
float hairlut_tame(float x, float unknown)
{
    return hairlut_is_nan(x) ? unknown : clamp(x, -hairlut_huge, hairlut_huge);
}

/* phi modulo 2 pi, from [low, low + 2 pi). 2 pi is subtracted in two parts, of which the first multiplies without
 * rounding. What no float resolves gives low. */
float hairlut_wrap(float phi, float low)
{
    if (!hairlut_is_finite(phi))
        return low;
    float n = floor((phi - low) * hairlut_inverse_two_pi);
    HAIRLUT_PRECISE float r = (phi - n * 6.28125) - n * 1.93530718e-3;
    return r >= low && r < low + hairlut_two_pi ? r : low;
}

/* cos(theta) for |theta| <= pi/2 as the sine of the distance z from the pole. The last term is what the float pi/2 lacks:
 * added at the end, no compiler can fold it into the first subtraction. */
float hairlut_cos(float theta)
{
    float z = max(1.57079637 - abs(theta), 0.0);
    float w = z * z;
    float series = 1.0 + w * (-1.0 / 6.0 + w * (1.0 / 120.0 + w * (-1.0 / 5040.0 + w * (1.0 / 362880.0
                       + w * (-1.0 / 39916800.0)))));
    return max(z * series - 4.37113883e-8, 4.37113883e-8);
}

float hairlut_pdf_to_solid_angle(float pdf_angle, float theta_i)
{
    return pdf_angle / hairlut_cos(theta_i);
}

/* ---- one axis: the reading of a table ------------------------------------------------------------------------- */

/* The cells of two neighbouring rows are blended linearly in theta_r. Within a blended cell, with f in [0,1] its fraction,
 * x(f) = x0 + f (d + c (1-f)) and dx/df = d + c (1-2f), where d is the cell's width and c its curvature, taken from the
 * widths of both neighbours. u runs evenly with f, over the cell's width h in u: the density is h / |dx/df|. All is counted
 * from the nearer end of the u axis, where m = min(u, 1-u); seen from the high end, d is negative. */

struct hairlut_rows {
    int row;  // below theta_r
    float t;  // weight of the row above, in [0,1]
};

struct hairlut_cell {
    float x0, d, c; // in x
    float m0, h;    // nearer knot and width in u
};

/* A place on the u axis: m = min(u, 1-u), and its cell, counted from the low or the high end. */
struct hairlut_knot {
    int i;
    bool high;
    float m;
};

struct hairlut_draw {
    float x;
    float pdf;
};

hairlut_rows hairlut_axis_rows(hairlut_axis axis, float theta_r)
{
    float r = clamp((hairlut_tame(theta_r, axis.row_origin) - axis.row_origin) * axis.row_scale, 0.0,
                    float(axis.height - 1));
    int row = min(int(r), axis.height - 2);
    return hairlut_rows(row, r - float(row));
}

float hairlut_blend(float a, float b, float t)
{
    HAIRLUT_PRECISE float x = a + t * (b - a);
    return x;
}

/* The same for the parts of a cell: a width is positive for positive a and b at every t, which it is not by the form above where
 * b is far below a. */
float hairlut_blend_part(float a, float b, float t)
{
    HAIRLUT_PRECISE float x = (1.0 - t) * a + t * b;
    return x;
}

/* The blended texel of knot i. */
float hairlut_texel(hairlut_axis axis, hairlut_rows rows, int i)
{
    float a = HAIRLUT_FETCH(axis.table, i, rows.row);
    float b = HAIRLUT_FETCH(axis.table, i, rows.row + 1);
    return hairlut_blend(a, b, rows.t);
}

/* The curve F of octaves: near a fourth root, a straight line in each octave of s. */
float hairlut_curve(float s)
{
    return uintBitsToFloat((floatBitsToUint(s) >> 2) + 0x30000000u);
}

/* s of y = F(s) */
float hairlut_curve_back(float y)
{
    return uintBitsToFloat((floatBitsToUint(y) - 0x30000000u) << 2);
}

/* The distance in u of knot n, counted from an end, from that end. */
float hairlut_axis_tail(hairlut_axis axis, int n)
{
    int mirrored = axis.columns - 1 - n;
    HAIRLUT_PRECISE float y = axis.f0 + axis.k * float(min(n, mirrored));
    HAIRLUT_PRECISE float m = axis.warp == HAIRLUT_WARP_OCTAVES ? hairlut_curve_back(y) - axis.e : y;
    m = n == 0 ? 0.0 : m;
    return n > mirrored ? 1.0 - m : m;
}

/* Texel n of a row, counted from the low or the high end. */
float hairlut_row_texel(hairlut_axis axis, int row, int n, bool high)
{
    return HAIRLUT_FETCH(axis.table, high ? axis.columns - 1 - n : n, row);
}

/* dx/du at the knot between two cells, from their widths in x and in u: the density there is that of both, blended in x. */
float hairlut_knot_slope(float d0, float d1, float h0, float h1)
{
    return (d0 + d1) / (d1 * h0 / d0 + d0 * h1 / d1);
}

/* (nearer end, width, curvature) of cell i of one row. h: the widths in u of the cell before, the cell, and the one behind it,
 * which there always is, as a cell is counted from the nearer end. */
vec3 hairlut_row_cell(hairlut_axis axis, int row, int i, bool high, vec3 h)
{
    float x0 = hairlut_row_texel(axis, row, i, high);
    float x1 = hairlut_row_texel(axis, row, i + 1, high);
    float d = x1 - x0;
    float before = x0 - hairlut_row_texel(axis, row, max(i - 1, 0), high);
    float after = hairlut_row_texel(axis, row, i + 2, high) - x1;
    float c;
    if (i == 0)
        c = d - h.y * after / h.z;
    else
        c = 0.5 * h.y * (hairlut_knot_slope(before, d, h.x, h.y) - hairlut_knot_slope(d, after, h.y, h.z));
    float bound = axis.limit * abs(d);
    return vec3(x0, d, clamp(c, -bound, bound));
}

/* Cell i, counted from the low or the high end. Each row's cell is taken before they are blended: neighbouring texels subtract
 * without rounding. */
hairlut_cell hairlut_axis_cell(hairlut_axis axis, hairlut_rows rows, int i, bool high)
{
    float m0 = hairlut_axis_tail(axis, i);
    float m1 = hairlut_axis_tail(axis, i + 1);
    vec3 h = vec3(m0 - hairlut_axis_tail(axis, max(i - 1, 0)), m1 - m0, hairlut_axis_tail(axis, i + 2) - m1);
    vec3 a = hairlut_row_cell(axis, rows.row, i, high, h);
    vec3 b = hairlut_row_cell(axis, rows.row + 1, i, high, h);
    return hairlut_cell(hairlut_blend_part(a.x, b.x, rows.t), hairlut_blend_part(a.y, b.y, rows.t),
                        hairlut_blend_part(a.z, b.z, rows.t), m0, h.y);
}

/* u to cell. The fold at u = 1/2 keeps the relative precision of both tails. */
hairlut_knot hairlut_axis_knot(hairlut_axis axis, float number)
{
    float u = clamp(hairlut_tame(number, 0.0), 0.0, 1.0);
    HAIRLUT_PRECISE float m = u <= 0.5 ? u : 1.0 - u;
    HAIRLUT_PRECISE float sum = m + axis.e;
    float y = axis.warp == HAIRLUT_WARP_OCTAVES ? hairlut_curve(sum) : m;
    HAIRLUT_PRECISE float c = y * axis.inverse_k - axis.f0 * axis.inverse_k; // rounded as in C, for the same cell beside a knot
    return hairlut_knot(min(int(max(c, 0.0)), (axis.columns - 1) / 2), u > 0.5, m);
}

/* The cell whose blended texels enclose x. */
int hairlut_axis_find(hairlut_axis axis, hairlut_rows rows, float x)
{
    int i = 0;
    for (int n = axis.columns - 1; n > 1;) {
        int half_n = n / 2;
        i += hairlut_texel(axis, rows, i + half_n) <= x ? half_n : 0;
        n -= half_n;
    }
    return i;
}

/* (fraction of a cell at which x lies, |dx/df| there). The root of the quadratic is that slope, written as the slope at the
 * cell's flatter end and the distance from there, which cancels nothing. */
vec2 hairlut_cell_solve(hairlut_cell cell, float x)
{
    bool falls = cell.d < 0.0;
    float d = abs(cell.d);
    float c = falls ? -cell.c : cell.c;
    float along = clamp(falls ? cell.x0 - x : x - cell.x0, 0.0, d);
    float flat_slope = d - abs(c);
    float away = c > 0.0 ? d - along : along;
    float slope = sqrt(flat_slope * flat_slope + 4.0 * abs(c) * away);
    return vec2(min(2.0 * along / (d + c + slope), 1.0), slope);
}

hairlut_draw hairlut_axis_sample(hairlut_axis axis, float theta_r, float u)
{
    hairlut_knot knot = hairlut_axis_knot(axis, u);
    hairlut_cell cell = hairlut_axis_cell(axis, hairlut_axis_rows(axis, theta_r), knot.i, knot.high);
    float f = (knot.m - cell.m0) / cell.h;
    float x = cell.x0 + f * (cell.d + cell.c * (1.0 - f));
    float slope = abs(cell.d + cell.c * (1.0 - 2.0 * f));
    return hairlut_draw(clamp(x, axis.low, axis.high), cell.h / slope);
}

/* Cell n of a row, counted from the low end, as seen from the nearer end. */
hairlut_cell hairlut_axis_found(hairlut_axis axis, hairlut_rows rows, int n)
{
    bool high = n >= axis.columns / 2;
    return hairlut_axis_cell(axis, rows, high ? axis.columns - 2 - n : n, high);
}

/* Density per rad of hairlut_axis_sample at x; 0 outside the domain and for NaN. */
float hairlut_axis_pdf(hairlut_axis axis, float theta_r, float x)
{
    if (hairlut_is_nan(x) || x < axis.low || x > axis.high)
        return 0.0;
    hairlut_rows rows = hairlut_axis_rows(axis, theta_r);
    hairlut_cell cell = hairlut_axis_found(axis, rows, hairlut_axis_find(axis, rows, x));
    return cell.h / hairlut_cell_solve(cell, x).y;
}

/* The u that hairlut_axis_sample turns into x; outside the domain the nearer end's, 0 for NaN. */
float hairlut_axis_invert(hairlut_axis axis, float theta_r, float number)
{
    float x = hairlut_tame(number, axis.low);
    hairlut_rows rows = hairlut_axis_rows(axis, theta_r);
    hairlut_cell cell = hairlut_axis_found(axis, rows, hairlut_axis_find(axis, rows, x));
    float m = clamp(cell.m0 + cell.h * hairlut_cell_solve(cell, x).x, 0.0, 1.0);
    return cell.d < 0.0 ? 1.0 - m : m;
}

/* ---- the two lobes -------------------------------------------------------------------------------------------- */

/* NaN anywhere, or an infinite azimuth: the density is 0. */
bool hairlut_known(float theta_r, float phi_r, float a, float b)
{
    return !hairlut_is_nan(theta_r) && hairlut_is_finite(phi_r) && !hairlut_is_nan(a) && !hairlut_is_nan(b);
}

/* The azimuth that the table direct_phi holds, in [0, 2 pi). */
float hairlut_relative_azimuth(hairlut_model model, float phi_r, float phi_i)
{
    float r = hairlut_wrap(phi_r, -hairlut_pi);
    float i = hairlut_wrap(phi_i, -hairlut_pi);
    return hairlut_wrap(model.azimuth == HAIRLUT_AZIMUTH_SUM ? i + r : i - r, 0.0);
}

/* phi_i in [-pi, pi) from the azimuth in the table. */
float hairlut_incident_azimuth(hairlut_model model, float phi_r, float phi)
{
    float r = hairlut_wrap(phi_r, -hairlut_pi);
    return hairlut_wrap(model.azimuth == HAIRLUT_AZIMUTH_SUM ? phi - r : phi + r, -hairlut_pi);
}

hairlut_sample hairlut_finish(float theta_i, float phi_i, float pdf)
{
    return hairlut_sample(theta_i, phi_i, pdf, hairlut_pdf_to_solid_angle(pdf, theta_i));
}

/* Draws an incident direction for the viewer direction (theta_r, phi_r) from two numbers in [0,1). */
hairlut_sample hairlut_sample_direct(hairlut_model model, float theta_r, float phi_r, float u_theta, float u_phi)
{
    hairlut_draw theta = hairlut_axis_sample(model.direct_theta, theta_r, u_theta);
    hairlut_draw phi = hairlut_axis_sample(model.direct_phi, theta_r, u_phi);
    float pdf = hairlut_known(theta_r, phi_r, u_theta, u_phi) ? theta.pdf * phi.pdf : 0.0;
    return hairlut_finish(theta.x, hairlut_incident_azimuth(model, phi_r, phi.x), pdf);
}

hairlut_sample hairlut_sample_multiple(hairlut_model model, float theta_r, float phi_r, float u_theta, float u_phi)
{
    hairlut_draw theta = hairlut_axis_sample(model.multiple_theta, theta_r, u_theta);
    float u = clamp(hairlut_tame(u_phi, 0.0), 0.0, 1.0);
    float phi = hairlut_two_pi * u - hairlut_pi;
    float pdf = hairlut_known(theta_r, phi_r, u_theta, u_phi) ? theta.pdf * hairlut_inverse_two_pi : 0.0;
    return hairlut_finish(theta.x, phi < hairlut_pi ? phi : -hairlut_pi, pdf);
}

/* Density, per rad^2, with which the function above draws (theta_i, phi_i). phi_i may be any finite azimuth. */
float hairlut_pdf_direct(hairlut_model model, float theta_r, float phi_r, float theta_i, float phi_i)
{
    if (!hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i))
        return 0.0;
    float phi = hairlut_relative_azimuth(model, phi_r, phi_i);
    return hairlut_axis_pdf(model.direct_theta, theta_r, theta_i) * hairlut_axis_pdf(model.direct_phi, theta_r, phi);
}

float hairlut_pdf_multiple(hairlut_model model, float theta_r, float phi_r, float theta_i, float phi_i)
{
    if (!hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i))
        return 0.0;
    return hairlut_axis_pdf(model.multiple_theta, theta_r, theta_i) * hairlut_inverse_two_pi;
}

/* The numbers (u_theta, u_phi) from which the sampling function draws (theta_i, phi_i). Directions outside the domain give
 * the nearer end's u; NaN gives 0. */
vec2 hairlut_invert_direct(hairlut_model model, float theta_r, float phi_r, float theta_i, float phi_i)
{
    float phi = hairlut_is_nan(phi_i) ? 0.0 : hairlut_relative_azimuth(model, phi_r, phi_i);
    return vec2(hairlut_axis_invert(model.direct_theta, theta_r, theta_i),
                hairlut_axis_invert(model.direct_phi, theta_r, phi));
}

vec2 hairlut_invert_multiple(hairlut_model model, float theta_r, float phi_r, float theta_i, float phi_i)
{
    return vec2(hairlut_axis_invert(model.multiple_theta, theta_r, theta_i),
                (hairlut_wrap(phi_i, -hairlut_pi) + hairlut_pi) * hairlut_inverse_two_pi);
}

/* ---- both lobes at once --------------------------------------------------------------------------------------- */

float hairlut_pdf_mixture(hairlut_model model, float direct_weight, float theta_r, float phi_r, float theta_i, float phi_i)
{
    if (hairlut_is_nan(direct_weight))
        return 0.0;
    float w = clamp(hairlut_tame(direct_weight, 0.0), 0.0, 1.0);
    return w * hairlut_pdf_direct(model, theta_r, phi_r, theta_i, phi_i)
           + (1.0 - w) * hairlut_pdf_multiple(model, theta_r, phi_r, theta_i, phi_i);
}

/* With probability direct_weight, clamped to [0,1], draws from the direct lobe (u_lobe < direct_weight), else from the
 * multiple lobe. The densities returned are the mixture's: direct_weight * direct + (1 - direct_weight) * multiple. */
hairlut_sample hairlut_sample_mixture(hairlut_model model, float direct_weight, float theta_r, float phi_r, float u_lobe,
                                      float u_theta, float u_phi)
{
    float w = clamp(hairlut_tame(direct_weight, 0.0), 0.0, 1.0);
    hairlut_sample s;
    float direct, multiple;
    if (!hairlut_is_nan(u_lobe) && u_lobe < w) {
        s = hairlut_sample_direct(model, theta_r, phi_r, u_theta, u_phi);
        direct = s.pdf_angle;
        multiple = hairlut_pdf_multiple(model, theta_r, phi_r, s.theta_i, s.phi_i);
    } else {
        s = hairlut_sample_multiple(model, theta_r, phi_r, u_theta, u_phi);
        multiple = s.pdf_angle;
        direct = hairlut_pdf_direct(model, theta_r, phi_r, s.theta_i, s.phi_i);
    }
    bool known = !hairlut_is_nan(direct_weight) && !hairlut_is_nan(u_lobe) && hairlut_known(theta_r, phi_r, u_theta, u_phi);
    return hairlut_finish(s.theta_i, s.phi_i, known ? w * direct + (1.0 - w) * multiple : 0.0);
}

#endif
