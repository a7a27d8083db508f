/* SPDX-License-Identifier: BSD-3-Clause */
/* hairlut for CUDA (OptiX included) and C++17. Made by source/assemble.py; change source/body.inl.
 *
 *     #include "hairlut.cuh"
 *     using namespace hairlut_gpu;
 *     const float4 *hairs;                                // on the device: the file(s) of `hairlut export --to raw`
 *     hairlut_model hair = hairlut_model_at(hairs, 0);    // 0: the model's first texel
 *     hairlut_sample s = hairlut_sample_hair(hair, theta_r, phi_r, offset, u_lobe, u_theta, u_phi);
 *     float q = hairlut_pdf_hair(hair, theta_r, phi_r, offset, theta_i, phi_i);
 *
 * In C++ the texels are hairlut_float4. A program for the processor alone draws faster by hairlut.h: the C++ form is for code that is
 * shared with a GPU. Both may be included in one file. README.md has the rest: fetches, limits. */
#ifndef HAIRLUT_CUH
#define HAIRLUT_CUH

#include <math.h>
#include <string.h>

#ifdef __CUDACC__
#define HAIRLUT_FN __host__ __device__ inline
#elif defined(__GNUC__)
#define HAIRLUT_FN inline __attribute__((always_inline)) /* as on a GPU: structures are passed by value */
#else
#define HAIRLUT_FN inline
#endif
#ifndef HAIRLUT_LOBE_LIMIT
#define HAIRLUT_LOBE_LIMIT 16
#endif
#ifndef HAIRLUT_PARAMETER_LIMIT
#define HAIRLUT_PARAMETER_LIMIT 8
#endif
#ifndef HAIRLUT_FETCH /* with HAIRLUT_SOURCE: what hairlut_model_at takes, and how texel i is read of it */
#define HAIRLUT_SOURCE const hairlut_float4 *
#define HAIRLUT_FETCH(source, i) ((source)[i])
#endif
#ifndef HAIRLUT_HEADER
#define HAIRLUT_HEADER(source, i) HAIRLUT_FETCH(source, i)
#endif
#define HAIRLUT_CONST constexpr
#define HAIRLUT_PRECISE

namespace hairlut_gpu {

#ifdef __CUDACC__
using hairlut_float4 = float4;
#else
struct hairlut_float4 {
    float x, y, z, w;
};
#endif

constexpr int hairlut_max_lobes = HAIRLUT_LOBE_LIMIT;
constexpr int hairlut_max_parameters = HAIRLUT_PARAMETER_LIMIT;
constexpr int hairlut_parameter_slots = HAIRLUT_PARAMETER_LIMIT > 0 ? HAIRLUT_PARAMETER_LIMIT : 1;

HAIRLUT_FN float abs(float x)
{
    return fabsf(x);
}

HAIRLUT_FN float floor(float x)
{
    return floorf(x);
}

HAIRLUT_FN float sqrt(float x)
{
    return sqrtf(x);
}

HAIRLUT_FN float min(float x, float y)
{
    return x < y ? x : y;
}

HAIRLUT_FN float max(float x, float y)
{
    return x > y ? x : y;
}

HAIRLUT_FN float clamp(float x, float low, float high)
{
    return min(max(x, low), high);
}

HAIRLUT_FN int min(int x, int y)
{
    return x < y ? x : y;
}

HAIRLUT_FN int max(int x, int y)
{
    return x > y ? x : y;
}

HAIRLUT_FN int clamp(int x, int low, int high)
{
    return min(max(x, low), high);
}

HAIRLUT_FN unsigned hairlut_bits(float x)
{
    unsigned bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

HAIRLUT_FN float hairlut_from_bits(unsigned bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

HAIRLUT_CONST int hairlut_uniform = 0; // azimuths: see hairlut_axis
HAIRLUT_CONST int hairlut_difference = 1;
HAIRLUT_CONST int hairlut_sum = 2;

/* What differs from strand to strand, such as a roughness: a value for each of the model's named parameters, in the order of
 * hair.json. Values are clamped to the parameter's range; with NaN the density is 0. */
struct hairlut_parameters {
    float value[hairlut_parameter_slots];
};

/* One hair in the stream of texels that `hairlut export --to raw` writes. */
struct hairlut_model {
    HAIRLUT_SOURCE source;         // passed to HAIRLUT_FETCH and HAIRLUT_HEADER
    int first;                     // the texel at which the model begins
    int lobes;
    int values;                    // the first texel of the mixture's shares and turns
    int stride;                    // texels of shares and turns for a gap between nodes: two for each of the stream's lobes
    bool mirrored;                 // nodes of the offset are >= 0, and -h mirrors h
    int ranges;                    // the first parameter's texel
    int parameter_count;           // 0 to 8
    hairlut_parameters parameters; // every function reads the model at these: the standard values, or your own
};

/* The lobes' shares and turns at one theta_r, offset and set of parameters. Shares are in any unit: replace them by your own where a shader knows
 * better. A negative one counts as 0; with one that is infinite or NaN the density is 0. */
struct hairlut_mixture {
    float share[hairlut_max_lobes];
    float turn[hairlut_max_lobes]; // rad
    float side;                    // -1: azimuths are mirrored
    bool known;                    // none of the three was NaN
};

struct hairlut_sample {
    float theta_i;         // rad, [-pi/2, pi/2]
    float phi_i;           // rad, [-pi, pi)
    float pdf_angle;       // per rad^2
    float pdf_solid_angle; // per sr
};

/* The two numbers from which a lobe's direction is drawn, in [0,1]. */
struct hairlut_numbers {
    float u_theta;
    float u_phi;
};

/* Where a strand lies among the nodes of the parameters that a table, or the mixture, depends on. Its texels are those of the 2^d
 * nodes around it, each weighted by the product of t, where it is the upper node of an axis, or of 1 - t. */
struct hairlut_corners {
    int count;           // 2^d; 1 without parameters
    int first;           // texels from those of the first node to those of the lowest corner
    float weight;        // of the lowest corner
    hairlut_float4 t;    // in [0,1], along each axis; 0 where there is none
    hairlut_float4 step; // texels from a node to the next one, likewise
};

struct hairlut_corner {
    int at; // texels from those of the first node
    float weight;
};

/* One table and the numbers to read it by. */
struct hairlut_axis {
    HAIRLUT_SOURCE source;
    int first;        // the table's first texel
    int columns;      // knots of a row
    int height;       // rows
    int tree;         // texels of a row's search tree
    float row_origin; // theta_r of row 0
    float row_scale;  // rows per radian of theta_r
    float low;        // the domain, rad
    float high;
    float e;          // knots are evenly spaced in F(m + e), m = min(u, 1-u); 0: in m itself
    float scale;      // column = F(m + e) * scale - origin
    float origin;
    int azimuth;      // what a lobe's second table holds: nothing (the azimuth is uniform), phi_i - phi_r or phi_i + phi_r
    hairlut_corners corners;
};

struct hairlut_lobe {
    hairlut_axis theta;
    hairlut_axis phi;
};

/* ---- numbers -------------------------------------------------------------------------------------------------- */

HAIRLUT_CONST float hairlut_two_pi = 6.28318548f;
HAIRLUT_CONST float hairlut_pi = 3.14159274f;
HAIRLUT_CONST float hairlut_inverse_two_pi = 0.159154943f; // also the density of a uniform azimuth
HAIRLUT_CONST float hairlut_huge = 1e30f;                  // stands for infinity; what is computed from it stays finite

HAIRLUT_FN bool hairlut_is_nan(float x)
{
    return (hairlut_bits(x) & 0x7fffffffu) > 0x7f800000u;
}

HAIRLUT_FN bool hairlut_is_finite(float x)
{
    return (hairlut_bits(x) & 0x7fffffffu) < 0x7f800000u;
}

/* x without the values that arithmetic need not honour: NaN becomes `unknown`, infinity a large number. */
HAIRLUT_FN float hairlut_bounded(float x, float unknown)
{
    float number = clamp(x, -hairlut_huge, hairlut_huge);
    return hairlut_is_nan(x) ? unknown : number;
}

/* phi modulo 2 pi, from [low, low + 2 pi). 2 pi is subtracted in two parts, of which the first multiplies without
 * rounding. What no float resolves gives low. */
HAIRLUT_FN float hairlut_wrap(float phi, float low)
{
    if (!hairlut_is_finite(phi)) {
        return low;
    }
    float n = floor((phi - low) * hairlut_inverse_two_pi);
    HAIRLUT_PRECISE float r = (phi - n * 6.28125f) - n * 1.93530718e-3f;
    return r >= low && r < low + hairlut_two_pi ? r : low;
}

/* cos(theta) for |theta| <= pi/2 as the sine of the distance z from the pole, by the polynomial of the C library. The last term is
 * what the float pi/2 lacks: added at the end, no compiler can fold it into the first subtraction. */
HAIRLUT_FN float hairlut_cos(float theta)
{
    float z = max(1.57079637f - abs(theta), 0.0f);
    float w = z * z;
    float series = -0.166666567f + w * (0.0083330255f + w * (-0.000198074194f + w * 2.60190313e-6f));
    return max(z + z * w * series - 4.37113883e-8f, 4.37113883e-8f);
}

/* asin(h) for |h| <= 1, by the polynomial of the C library: r + r^3 Q(r^2) for r up to 1/2, and beyond pi/2 - 2 asin(r) with
 * r = sqrt((1 - |h|) / 2). */
HAIRLUT_FN float hairlut_asin(float h)
{
    float a = abs(h);
    float z = a > 0.5f ? 0.5f * (1.0f - a) : a * a;
    float r = a > 0.5f ? sqrt(z) : a;
    float series = 0.166667536f + z * (0.0749524161f + z * (0.045477096f + z * (0.0241476111f + z * 0.0422185473f)));
    float y = r + r * z * series;
    float angle = a > 0.5f ? 1.57079637f - 2.0f * y : y;
    return h < 0.0f ? -angle : angle;
}

HAIRLUT_FN float hairlut_pdf_to_solid_angle(float pdf_angle, float theta_i)
{
    return pdf_angle / hairlut_cos(theta_i);
}

/* Both weights are positive: what is blended from positive numbers is positive, at every t. */
HAIRLUT_FN float hairlut_blend(float a, float b, float t)
{
    HAIRLUT_PRECISE float x = (1.0f - t) * a + t * b;
    return x;
}

/* ---- the stream ----------------------------------------------------------------------------------------------- */

/* The model whose first texel is `first`, with the standard values of its parameters. */
HAIRLUT_FN hairlut_model hairlut_model_at(HAIRLUT_SOURCE source, int first)
{
    hairlut_float4 head = HAIRLUT_HEADER(source, first);
    hairlut_model model;
    model.source = source;
    model.first = first;
    model.stride = 2 * int(abs(head.x));
    model.lobes = min(model.stride / 2, hairlut_max_lobes);
    model.mirrored = head.y > 0.5f;
    model.values = first + int(head.z);
    model.ranges = first + 3 + 3 * model.stride;
    model.parameter_count = 0;
    if (head.x < 0.0f) {
        hairlut_float4 offsets = HAIRLUT_HEADER(source, first + 2);
        model.parameter_count = int(offsets.w);
        model.lobes = hairlut_max_parameters > 0 ? model.lobes : 0;
    }
    for (int p = 0; p < hairlut_max_parameters; ++p) {
        model.parameters.value[p] = 0.0f;
        if (p < model.parameter_count) {
            hairlut_float4 range = HAIRLUT_HEADER(source, model.ranges + p);
            model.parameters.value[p] = range.z;
        }
    }
    return model;
}

HAIRLUT_FN hairlut_float4 hairlut_zeros()
{
    hairlut_float4 zeros;
    zeros.x = 0.0f;
    zeros.y = 0.0f;
    zeros.z = 0.0f;
    zeros.w = 0.0f;
    return zeros;
}

/* v, with x in place of component a. */
HAIRLUT_FN hairlut_float4 hairlut_replaced(hairlut_float4 v, int a, float x)
{
    hairlut_float4 changed;
    changed.x = a == 0 ? x : v.x;
    changed.y = a == 1 ? x : v.y;
    changed.z = a == 2 ? x : v.z;
    changed.w = a == 3 ? x : v.w;
    return changed;
}

HAIRLUT_FN hairlut_float4 hairlut_scaled(float weight, hairlut_float4 v)
{
    hairlut_float4 product;
    product.x = weight * v.x;
    product.y = weight * v.y;
    product.z = weight * v.z;
    product.w = weight * v.w;
    return product;
}

/* sum + weight v */
HAIRLUT_FN hairlut_float4 hairlut_added(hairlut_float4 sum, float weight, hairlut_float4 v)
{
    hairlut_float4 total;
    total.x = sum.x + weight * v.x;
    total.y = sum.y + weight * v.y;
    total.z = sum.z + weight * v.z;
    total.w = sum.w + weight * v.w;
    return total;
}

HAIRLUT_FN hairlut_corners hairlut_one_corner()
{
    hairlut_corners corners;
    corners.count = 1;
    corners.first = 0;
    corners.weight = 1.0f;
    corners.t = hairlut_zeros();
    corners.step = hairlut_zeros();
    return corners;
}

/* Corner c of a set: bit a of c is 1 where it is the upper node of axis a. */
HAIRLUT_FN hairlut_corner hairlut_corner_of(hairlut_corners corners, int c)
{
    float x = (c & 1) != 0 ? corners.t.x : 1.0f - corners.t.x;
    float y = (c & 2) != 0 ? corners.t.y : 1.0f - corners.t.y;
    float z = (c & 4) != 0 ? corners.t.z : 1.0f - corners.t.z;
    float w = (c & 8) != 0 ? corners.t.w : 1.0f - corners.t.w;
    float steps = (c & 1) != 0 ? corners.step.x : 0.0f;
    steps += (c & 2) != 0 ? corners.step.y : 0.0f;
    steps += (c & 4) != 0 ? corners.step.z : 0.0f;
    steps += (c & 8) != 0 ? corners.step.w : 0.0f;
    hairlut_corner corner;
    corner.at = corners.first + int(steps);
    corner.weight = x * y * z * w;
    return corner;
}

/* How many keys of a tree, blended over the corners, are at most x. A texel has two keys of a row and the same two of the row
 * above, and three texels below it; all leaves are at one depth. */
HAIRLUT_FN int hairlut_search(HAIRLUT_SOURCE source, hairlut_corners corners, int first, int tree, float t, float x)
{
    int node = 0;
    while (node < tree) {
        hairlut_float4 keys = hairlut_scaled(corners.weight, HAIRLUT_FETCH(source, first + corners.first + node));
        for (int c = 1; c < corners.count; ++c) {
            hairlut_corner corner = hairlut_corner_of(corners, c);
            if (corner.weight > 0.0f) {
                keys = hairlut_added(keys, corner.weight, HAIRLUT_FETCH(source, first + corner.at + node));
            }
        }
        int branch = hairlut_blend(keys.x, keys.z, t) <= x ? 1 : 0;
        branch += hairlut_blend(keys.y, keys.w, t) <= x ? 1 : 0;
        node = 3 * node + 1 + branch;
    }
    return node - tree;
}

/* A place between two nodes: the gap, and how far along it, in [0,1]. */
struct hairlut_place {
    int gap;
    int gaps;
    float t;
};

/* Where x lies among the nodes that header texel `at` describes: (first texel, number of nodes, texels of the search tree).
 * There is a texel (node, 1 / gap) for each gap, then the tree of the inner nodes. A single node has one gap, of no width. */
HAIRLUT_FN hairlut_place hairlut_place_of(hairlut_model model, int at, float x)
{
    hairlut_float4 nodes = HAIRLUT_HEADER(model.source, at);
    int first = model.first + int(nodes.x);
    hairlut_place place;
    place.gaps = max(int(nodes.y) - 1, 1);
    place.gap = hairlut_search(model.source, hairlut_one_corner(), first + place.gaps, int(nodes.z), 0.0f, x);
    hairlut_float4 node = HAIRLUT_FETCH(model.source, first + place.gap);
    place.t = clamp((x - node.x) * node.y, 0.0f, 1.0f);
    return place;
}

/* The value of parameter p, with NaN the least. Beyond HAIRLUT_PARAMETER_LIMIT it is the standard one. */
HAIRLUT_FN float hairlut_parameter(hairlut_model model, int p)
{
    if (p < hairlut_max_parameters) {
        return hairlut_bounded(model.parameters.value[p], -hairlut_huge);
    }
    hairlut_float4 range = HAIRLUT_HEADER(model.source, model.ranges + p);
    return range.z;
}

HAIRLUT_FN bool hairlut_parameters_known(hairlut_model model)
{
    bool known = true;
    for (int p = 0; p < min(model.parameter_count, hairlut_max_parameters); ++p) {
        known = known && !hairlut_is_nan(model.parameters.value[p]);
    }
    return known;
}

/* The corners around the model's parameters: of the mixture (0), of lobe k's theta table (1 + 2k), or of its azimuth's (2 + 2k).
 * Behind the ranges there is a texel (number of axes, place of the first one, texels of a node) for each of these. An axis is a texel
 * of its nodes as above, with the number of its parameter; nodes that differ along the last axis alone follow each other. */
HAIRLUT_FN hairlut_corners hairlut_corners_of(hairlut_model model, int owner)
{
    hairlut_corners corners = hairlut_one_corner();
    if (hairlut_max_parameters == 0 || model.parameter_count == 0) {
        return corners;
    }
    hairlut_float4 depends = HAIRLUT_HEADER(model.source, model.ranges + model.parameter_count + owner);
    for (int a = 0; a < int(depends.x); ++a) {
        int at = model.first + int(depends.y) + a;
        hairlut_float4 axis = HAIRLUT_HEADER(model.source, at);
        hairlut_place place = hairlut_place_of(model, at, hairlut_parameter(model, int(axis.w)));
        corners.count *= 2;
        corners.first = corners.first * int(axis.y) + place.gap;
        corners.t = hairlut_replaced(corners.t, a, place.t);
        corners.step = hairlut_replaced(hairlut_scaled(axis.y, corners.step), a, 1.0f);
    }
    corners.first *= int(depends.z);
    corners.step = hairlut_scaled(depends.z, corners.step);
    corners.weight = (1.0f - corners.t.x) * (1.0f - corners.t.y) * (1.0f - corners.t.z) * (1.0f - corners.t.w);
    return corners;
}

/* A table whose three texels of numbers begin at `at`. */
HAIRLUT_FN hairlut_axis hairlut_axis_at(hairlut_model model, int at, hairlut_corners corners)
{
    hairlut_float4 shape = HAIRLUT_HEADER(model.source, at);
    hairlut_float4 range = HAIRLUT_HEADER(model.source, at + 1);
    hairlut_float4 warp = HAIRLUT_HEADER(model.source, at + 2);
    hairlut_axis axis;
    axis.source = model.source;
    axis.first = model.first + int(shape.x);
    axis.columns = int(shape.y);
    axis.height = int(shape.z);
    axis.tree = int(shape.w);
    axis.row_origin = range.x;
    axis.row_scale = range.y;
    axis.low = range.z;
    axis.high = range.w;
    axis.e = warp.x;
    axis.scale = warp.y;
    axis.origin = warp.z;
    axis.azimuth = int(warp.w);
    axis.corners = corners;
    return axis;
}

HAIRLUT_FN hairlut_lobe hairlut_lobe_at(hairlut_model model, int k)
{
    int at = model.first + 3 + 6 * k;
    hairlut_lobe lobe;
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
    int row; // below theta_r
    float t; // weight of the row above, in [0,1]
};

struct hairlut_cell {
    float x0; // the nearer knot, rad
    float w;
    float e0;
    float e1;
    float m0; // the nearer knot's m
    float inverse_h;
    float h;
};

/* A place on the u axis: m, and its cell, counted from the low or the high end. */
struct hairlut_knot {
    int i;
    bool high;
    float m;
};

struct hairlut_draw {
    float x;
    float pdf;
};

HAIRLUT_FN hairlut_rows hairlut_axis_rows(hairlut_axis axis, float theta_r)
{
    float angle = hairlut_bounded(theta_r, axis.row_origin);
    float r = clamp((angle - axis.row_origin) * axis.row_scale, 0.0f, float(axis.height - 1));
    hairlut_rows rows;
    rows.row = min(int(r), axis.height - 2);
    rows.t = r - float(rows.row);
    return rows;
}

/* The curve F of octaves: near a fourth root, a straight line in each octave of s. */
HAIRLUT_FN float hairlut_curve(float s)
{
    return hairlut_from_bits((hairlut_bits(s) >> 2u) + 0x30000000u);
}

/* u to cell. The fold at u = 1/2 keeps the relative precision of both tails. */
HAIRLUT_FN hairlut_knot hairlut_axis_knot(hairlut_axis axis, float number)
{
    float u = clamp(hairlut_bounded(number, 0.0f), 0.0f, 1.0f);
    hairlut_knot knot;
    knot.high = u > 0.5f;
    HAIRLUT_PRECISE float folded = 1.0f - u;
    knot.m = min(u, folded);
    HAIRLUT_PRECISE float sum = knot.m + axis.e;
    float y = axis.e > 0.0f ? hairlut_curve(sum) : knot.m;
    HAIRLUT_PRECISE float column = y * axis.scale - axis.origin; // rounded as in C, for the same cell beside a knot
    knot.i = clamp(int(column), 0, axis.columns / 2 - 1);
    return knot;
}

/* Cell i, counted from the low or the high end. */
HAIRLUT_FN hairlut_cell hairlut_axis_cell(hairlut_axis axis, hairlut_rows rows, int i, bool high)
{
    int half_count = axis.columns / 2;
    int column = high ? half_count + i : i;
    int at = axis.first + half_count + column * axis.height + rows.row;
    int lowest = at + axis.corners.first;
    hairlut_float4 below = hairlut_scaled(axis.corners.weight, HAIRLUT_FETCH(axis.source, lowest));
    hairlut_float4 above = hairlut_scaled(axis.corners.weight, HAIRLUT_FETCH(axis.source, lowest + 1));
    for (int c = 1; c < axis.corners.count; ++c) {
        hairlut_corner corner = hairlut_corner_of(axis.corners, c);
        if (corner.weight > 0.0f) {
            below = hairlut_added(below, corner.weight, HAIRLUT_FETCH(axis.source, at + corner.at));
            above = hairlut_added(above, corner.weight, HAIRLUT_FETCH(axis.source, at + corner.at + 1));
        }
    }
    hairlut_float4 knot = HAIRLUT_FETCH(axis.source, axis.first + i);
    hairlut_cell cell;
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
HAIRLUT_FN hairlut_cell hairlut_axis_cell_around(hairlut_axis axis, hairlut_rows rows, float x)
{
    int half_count = axis.columns / 2;
    int trees = axis.first + half_count + 2 * half_count * axis.height;
    int n = hairlut_search(axis.source, axis.corners, trees + rows.row * axis.tree, axis.tree, rows.t, x);
    bool high = n >= half_count;
    int i = high ? axis.columns - 2 - n : n;
    return hairlut_axis_cell(axis, rows, i, high);
}

HAIRLUT_FN float hairlut_cell_g(hairlut_cell cell, float f, float g)
{
    return f * f + g * g + (cell.e0 + cell.e1) * (f * g);
}

HAIRLUT_FN hairlut_draw hairlut_axis_sample(hairlut_axis axis, float theta_r, float u)
{
    hairlut_knot knot = hairlut_axis_knot(axis, u);
    hairlut_cell cell = hairlut_axis_cell(axis, hairlut_axis_rows(axis, theta_r), knot.i, knot.high);
    float f = clamp((knot.m - cell.m0) * cell.inverse_h, 0.0f, 1.0f);
    float g = 1.0f - f;
    float G = hairlut_cell_g(cell, f, g);
    float N = cell.e1 * (f * f) + 2.0f * (f * g) + cell.e0 * (g * g);
    hairlut_draw draw;
    draw.x = clamp(cell.x0 + cell.w * ((f * f + cell.e0 * (f * g)) / G), axis.low, axis.high);
    draw.pdf = cell.h / abs(cell.w) * (G * G / N);
    return draw;
}

/* Where x lies in a cell: f, g, and R of above. */
struct hairlut_root {
    float f;
    float g;
    float r;
};

HAIRLUT_FN hairlut_root hairlut_cell_solve(hairlut_cell cell, float x)
{
    float X = clamp((x - cell.x0) / cell.w, 0.0f, 1.0f);
    float Z = 1.0f - X;
    float B = cell.e0 * Z - cell.e1 * X;
    float R = sqrt(B * B + 4.0f * (X * Z));
    float a = B >= 0.0f ? 2.0f * X : R - B;
    float b = B >= 0.0f ? R + B : 2.0f * Z;
    hairlut_root root;
    root.f = a / (a + b);
    root.g = b / (a + b);
    root.r = R;
    return root;
}

/* Density per rad of hairlut_axis_sample at x; 0 outside the domain and for NaN. */
HAIRLUT_FN float hairlut_axis_pdf(hairlut_axis axis, float theta_r, float x)
{
    if (hairlut_is_nan(x) || x < axis.low || x > axis.high) {
        return 0.0f;
    }
    hairlut_cell cell = hairlut_axis_cell_around(axis, hairlut_axis_rows(axis, theta_r), x);
    hairlut_root root = hairlut_cell_solve(cell, x);
    return cell.h / abs(cell.w) * (hairlut_cell_g(cell, root.f, root.g) / root.r);
}

/* The u that hairlut_axis_sample turns into x; outside the domain the nearer end's, 0 for NaN. */
HAIRLUT_FN float hairlut_axis_invert(hairlut_axis axis, float theta_r, float number)
{
    float x = clamp(hairlut_bounded(number, axis.low), axis.low, axis.high);
    hairlut_cell cell = hairlut_axis_cell_around(axis, hairlut_axis_rows(axis, theta_r), x);
    float m = clamp(cell.m0 + cell.h * hairlut_cell_solve(cell, x).f, 0.0f, 1.0f);
    return cell.w < 0.0f ? 1.0f - m : m;
}

/* ---- one lobe ------------------------------------------------------------------------------------------------- */

/* NaN anywhere, or an infinite azimuth: the density is 0. */
HAIRLUT_FN bool hairlut_known(float theta_r, float phi_r, float a, float b)
{
    return !hairlut_is_nan(theta_r) && hairlut_is_finite(phi_r) && !hairlut_is_nan(a) && !hairlut_is_nan(b);
}

/* The azimuth that a table holds before mirror and turn, in [-2 pi, 2 pi]: phi_i - phi_r or phi_i + phi_r. */
HAIRLUT_FN float hairlut_relative_azimuth(hairlut_axis phi, float phi_r, float phi_i)
{
    float r = hairlut_wrap(phi_r, -hairlut_pi);
    float i = hairlut_wrap(phi_i, -hairlut_pi);
    return phi.azimuth == hairlut_sum ? i + r : i - r;
}

/* phi_i in [-pi, pi) from such an azimuth. */
HAIRLUT_FN float hairlut_incident_azimuth(hairlut_axis phi, float phi_r, float relative)
{
    float r = hairlut_wrap(phi_r, -hairlut_pi);
    float phi_i = phi.azimuth == hairlut_sum ? relative - r : relative + r;
    return hairlut_wrap(phi_i, -hairlut_pi);
}

HAIRLUT_FN hairlut_sample hairlut_finish(float theta_i, float phi_i, float pdf)
{
    hairlut_sample s;
    s.theta_i = theta_i;
    s.phi_i = phi_i;
    s.pdf_angle = pdf;
    s.pdf_solid_angle = hairlut_pdf_to_solid_angle(pdf, theta_i);
    return s;
}

/* A lobe's draw, mirrored by side = -1 and turned around the fibre. A uniform azimuth ignores both. */
HAIRLUT_FN hairlut_sample hairlut_lobe_sample(hairlut_lobe lobe, float side, float turn, float theta_r, float phi_r,
                                              float u_theta, float u_phi)
{
    hairlut_draw theta = hairlut_axis_sample(lobe.theta, theta_r, u_theta);
    float phi_i = hairlut_two_pi * clamp(hairlut_bounded(u_phi, 0.0f), 0.0f, 1.0f) - hairlut_pi;
    float pdf = hairlut_inverse_two_pi;
    if (lobe.phi.azimuth == hairlut_uniform) {
        phi_i = phi_i < hairlut_pi ? phi_i : -hairlut_pi;
    } else {
        hairlut_draw phi = hairlut_axis_sample(lobe.phi, theta_r, u_phi);
        phi_i = hairlut_incident_azimuth(lobe.phi, phi_r, side * (phi.x + turn));
        pdf = phi.pdf;
    }
    float known = hairlut_known(theta_r, phi_r, u_theta, u_phi) ? theta.pdf * pdf : 0.0f;
    return hairlut_finish(theta.x, phi_i, known);
}

HAIRLUT_FN float hairlut_lobe_pdf(hairlut_lobe lobe, float side, float turn, float theta_r, float phi_r, float theta_i,
                                  float phi_i)
{
    if (!hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i)) {
        return 0.0f;
    }
    float pdf = hairlut_axis_pdf(lobe.theta, theta_r, theta_i);
    if (lobe.phi.azimuth == hairlut_uniform) {
        return pdf * hairlut_inverse_two_pi;
    }
    float phi = hairlut_wrap(side * hairlut_relative_azimuth(lobe.phi, phi_r, phi_i) - turn, 0.0f);
    return pdf * hairlut_axis_pdf(lobe.phi, theta_r, phi);
}

HAIRLUT_FN bool hairlut_has_lobe(hairlut_model model, int lobe)
{
    return lobe >= 0 && lobe < model.lobes;
}

/* Draws an incident direction from one lobe, without a turn, for the viewer direction (theta_r, phi_r) and two numbers in
 * [0,1). A lobe that the model does not have: density 0, angles 0. */
HAIRLUT_FN hairlut_sample hairlut_sample_lobe(hairlut_model model, int lobe, float theta_r, float phi_r, float u_theta,
                                              float u_phi)
{
    if (!hairlut_has_lobe(model, lobe)) {
        return hairlut_finish(0.0f, 0.0f, 0.0f);
    }
    hairlut_sample s = hairlut_lobe_sample(hairlut_lobe_at(model, lobe), 1.0f, 0.0f, theta_r, phi_r, u_theta, u_phi);
    float known = hairlut_parameters_known(model) ? s.pdf_angle : 0.0f;
    return hairlut_finish(s.theta_i, s.phi_i, known);
}

/* Density, per rad^2, with which the function above draws (theta_i, phi_i). phi_i may be any finite azimuth. */
HAIRLUT_FN float hairlut_pdf_lobe(hairlut_model model, int lobe, float theta_r, float phi_r, float theta_i, float phi_i)
{
    if (!hairlut_has_lobe(model, lobe) || !hairlut_parameters_known(model)) {
        return 0.0f;
    }
    return hairlut_lobe_pdf(hairlut_lobe_at(model, lobe), 1.0f, 0.0f, theta_r, phi_r, theta_i, phi_i);
}

/* The numbers from which hairlut_sample_lobe draws (theta_i, phi_i). Directions outside the domain give the nearer end's u;
 * NaN, or a lobe that the model does not have, gives 0. */
HAIRLUT_FN hairlut_numbers hairlut_invert_lobe(hairlut_model model, int lobe, float theta_r, float phi_r, float theta_i,
                                               float phi_i)
{
    hairlut_numbers numbers;
    numbers.u_theta = 0.0f;
    numbers.u_phi = 0.0f;
    if (!hairlut_has_lobe(model, lobe)) {
        return numbers;
    }
    hairlut_lobe axes = hairlut_lobe_at(model, lobe);
    numbers.u_theta = hairlut_axis_invert(axes.theta, theta_r, theta_i);
    if (axes.phi.azimuth == hairlut_uniform) {
        numbers.u_phi = (hairlut_wrap(phi_i, -hairlut_pi) + hairlut_pi) * hairlut_inverse_two_pi;
        return numbers;
    }
    float relative = hairlut_is_nan(phi_i) ? 0.0f : hairlut_relative_azimuth(axes.phi, phi_r, phi_i);
    numbers.u_phi = hairlut_axis_invert(axes.phi, theta_r, hairlut_wrap(relative, 0.0f));
    return numbers;
}

/* ---- the mixture ---------------------------------------------------------------------------------------------- */

/* One lobe at the four nodes around theta_r and the offset. */
struct hairlut_pair {
    hairlut_float4 share; // low offset: row below theta_r, row above; high offset: the same
    hairlut_float4 turn;  // low offset: row below theta_r, arc to the row above; high offset: the same
};

/* The texels (share, turn) at `at`, blended over the corners: each of the four turns along the shorter arcs from the lowest corner's. */
HAIRLUT_FN hairlut_pair hairlut_pair_at(hairlut_model model, hairlut_corners corners, int at)
{
    hairlut_float4 lowest = HAIRLUT_FETCH(model.source, at + corners.first + 1);
    hairlut_float4 arcs = hairlut_zeros();
    hairlut_pair pair;
    pair.share = hairlut_scaled(corners.weight, HAIRLUT_FETCH(model.source, at + corners.first));
    for (int c = 1; c < corners.count; ++c) {
        hairlut_corner corner = hairlut_corner_of(corners, c);
        if (corner.weight > 0.0f) {
            pair.share = hairlut_added(pair.share, corner.weight, HAIRLUT_FETCH(model.source, at + corner.at));
            hairlut_float4 turn = HAIRLUT_FETCH(model.source, at + corner.at + 1);
            hairlut_float4 arc;
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
HAIRLUT_FN hairlut_mixture hairlut_mixture_at(hairlut_model model, float theta_r, float offset)
{
    float h = clamp(hairlut_bounded(offset, -1.0f), -1.0f, 1.0f);
    float side = model.mirrored && h < 0.0f ? -1.0f : 1.0f;
    hairlut_place row = hairlut_place_of(model, model.first + 1, hairlut_bounded(theta_r, -hairlut_huge));
    hairlut_place column = hairlut_place_of(model, model.first + 2, hairlut_asin(side * h));
    int values = model.values + model.stride * (row.gap * column.gaps + column.gap);
    hairlut_corners corners = hairlut_corners_of(model, 0);
    hairlut_mixture mixture;
    mixture.side = side;
    mixture.known = !hairlut_is_nan(theta_r) && !hairlut_is_nan(offset) && hairlut_parameters_known(model);
    for (int k = 0; k < model.lobes; ++k) {
        hairlut_pair pair = hairlut_pair_at(model, corners, values + 2 * k);
        float share_low = hairlut_blend(pair.share.x, pair.share.y, row.t);
        float share_high = hairlut_blend(pair.share.z, pair.share.w, row.t);
        float turn_low = pair.turn.x + row.t * pair.turn.y;
        float turn_high = pair.turn.z + row.t * pair.turn.w;
        mixture.share[k] = hairlut_blend(share_low, share_high, column.t);
        mixture.turn[k] = turn_low + column.t * hairlut_wrap(turn_high - turn_low, -hairlut_pi);
    }
    return mixture;
}

/* A share, 0 in place of a negative one, and so far from the largest float that a sum is finite and its reciprocal is not 0. */
HAIRLUT_FN float hairlut_share(hairlut_mixture mixture, int k)
{
    return clamp(mixture.share[k], 0.0f, 1e36f);
}

/* The sum of the shares; 0 where one is infinite or NaN. */
HAIRLUT_FN float hairlut_total_share(hairlut_model model, hairlut_mixture mixture)
{
    float total = 0.0f;
    bool known = true;
    for (int k = 0; k < model.lobes; ++k) {
        known = known && hairlut_is_finite(mixture.share[k]);
        total += hairlut_share(mixture, k);
    }
    return known ? total : 0.0f;
}

/* The density of the mixture at (theta_i, phi_i); total is the sum of its shares. Lobe `drawn`, if there is one, has the
 * density that is given. */
HAIRLUT_FN float hairlut_mixture_pdf(hairlut_model model, hairlut_mixture mixture, float total, float theta_r, float phi_r,
                                     float theta_i, float phi_i, int drawn, float given)
{
    float sum = 0.0f;
    for (int k = 0; k < model.lobes; ++k) {
        float weight = hairlut_share(mixture, k) / total;
        if (weight > 0.0f) {
            float pdf = given;
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
HAIRLUT_FN hairlut_sample hairlut_sample_hair_at(hairlut_model model, hairlut_mixture mixture, float theta_r, float phi_r,
                                                 float u_lobe, float u_theta, float u_phi)
{
    float total = hairlut_total_share(model, mixture);
    float wanted = clamp(hairlut_bounded(u_lobe, 0.0f), 0.0f, 1.0f) * total;
    int drawn = 0;
    float turn = mixture.turn[0];
    float below = 0.0f;
    for (int k = 0; k < model.lobes; ++k) {
        float share = hairlut_share(mixture, k);
        if (share > 0.0f && below <= wanted) {
            drawn = k;
            turn = mixture.turn[k];
        }
        below += share;
    }
    hairlut_sample s = hairlut_lobe_sample(hairlut_lobe_at(model, drawn), mixture.side, turn, theta_r, phi_r, u_theta, u_phi);
    bool known = mixture.known && !hairlut_is_nan(u_lobe) && hairlut_known(theta_r, phi_r, u_theta, u_phi);
    if (!known || !(total > 0.0f)) {
        return hairlut_finish(s.theta_i, s.phi_i, 0.0f);
    }
    float pdf = hairlut_mixture_pdf(model, mixture, total, theta_r, phi_r, s.theta_i, s.phi_i, drawn, s.pdf_angle);
    return hairlut_finish(s.theta_i, s.phi_i, pdf);
}

/* Density, per rad^2, with which the function above draws (theta_i, phi_i). phi_i may be any finite azimuth. */
HAIRLUT_FN float hairlut_pdf_hair_at(hairlut_model model, hairlut_mixture mixture, float theta_r, float phi_r, float theta_i,
                                     float phi_i)
{
    float total = hairlut_total_share(model, mixture);
    if (!mixture.known || !(total > 0.0f)) {
        return 0.0f;
    }
    return hairlut_mixture_pdf(model, mixture, total, theta_r, phi_r, theta_i, phi_i, -1, 0.0f);
}

/* The same with the model's own shares. Where a shader calls both, take the mixture once and call the two above. */
HAIRLUT_FN hairlut_sample hairlut_sample_hair(hairlut_model model, float theta_r, float phi_r, float offset, float u_lobe,
                                              float u_theta, float u_phi)
{
    return hairlut_sample_hair_at(model, hairlut_mixture_at(model, theta_r, offset), theta_r, phi_r, u_lobe, u_theta, u_phi);
}

HAIRLUT_FN float hairlut_pdf_hair(hairlut_model model, float theta_r, float phi_r, float offset, float theta_i, float phi_i)
{
    return hairlut_pdf_hair_at(model, hairlut_mixture_at(model, theta_r, offset), theta_r, phi_r, theta_i, phi_i);
}

/* The same for a strand with these parameters. Where a shader calls both, or takes the mixture once, set model.parameters. */
HAIRLUT_FN hairlut_model hairlut_strand(hairlut_model model, hairlut_parameters parameters)
{
    hairlut_model strand = model;
    strand.parameters = parameters;
    return strand;
}

HAIRLUT_FN hairlut_sample hairlut_sample_strand(hairlut_model model, hairlut_parameters parameters, float theta_r, float phi_r,
                                                float offset, float u_lobe, float u_theta, float u_phi)
{
    return hairlut_sample_hair(hairlut_strand(model, parameters), theta_r, phi_r, offset, u_lobe, u_theta, u_phi);
}

HAIRLUT_FN float hairlut_pdf_strand(hairlut_model model, hairlut_parameters parameters, float theta_r, float phi_r, float offset,
                                    float theta_i, float phi_i)
{
    return hairlut_pdf_hair(hairlut_strand(model, parameters), theta_r, phi_r, offset, theta_i, phi_i);
}

} // namespace hairlut_gpu

#endif
