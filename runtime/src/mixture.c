/* SPDX-License-Identifier: BSD-3-Clause */
/* Mixtures from memory: what one must fulfil, and the copy of it that is read. */
#include <math.h>

#include "angle.h"
#include "build.h"

enum { MAX_NODES = 4096, MAX_GRID = 1 << 18 }; /* kernels count the floats of a grid in floats, exact up to 2^24 */

static const float largest_turn = 25.1327419f; /* the float next to 8 pi, above it */

static hairlut_result validate_nodes(const char *axis, const float *nodes, int count, float low, float high, char *message)
{
    if (count < 1 || count > MAX_NODES)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "mixture: %s_count is %d: expected 1 to %d", axis, count,
                            (int)MAX_NODES);
    if (!nodes && count > 1)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "mixture: %s is NULL: expected %d numbers", axis, count);
    for (int k = 0; nodes && k < count; ++k)
        if (!(nodes[k] >= low && nodes[k] <= high && (k == 0 || nodes[k] > nodes[k - 1])))
            return hairlut_fail(HAIRLUT_ERROR_TABLE, message,
                                "mixture: %s node %d is %.9g: expected increasing numbers from %g to %g", axis, k,
                                (double)nodes[k], (double)low, (double)high);
    return HAIRLUT_OK;
}

/* Lobe k's number at node (j, o) */
static size_t place(const hairlut_mixture_desc *desc, int k, int j, int o)
{
    return ((size_t)k * (size_t)desc->theta_r_count + (size_t)j) * (size_t)desc->offset_count + (size_t)o;
}

static hairlut_result validate_node(const hairlut_mixture_desc *desc, int lobe_count, int j, int o, char *message)
{
    int shares = 0;
    for (int k = 0; k < lobe_count; ++k) {
        const float share = desc->share ? desc->share[place(desc, k, j, o)] : 1.0f;
        const float turn = desc->turn ? desc->turn[place(desc, k, j, o)] : 0.0f;
        if (!(share >= 0.0f && hairlut_is_finite(share)))
            return hairlut_fail(HAIRLUT_ERROR_TABLE, message,
                                "mixture: share of lobe %d at theta_r node %d, offset node %d is %.9g: expected a finite "
                                "number, not below 0",
                                k, j, o, (double)share);
        if (!(fabsf(turn) <= largest_turn))
            return hairlut_fail(
                HAIRLUT_ERROR_TABLE, message,
                "mixture: turn of lobe %d at theta_r node %d, offset node %d is %.9g: expected -8 pi to 8 pi", k, j, o,
                (double)turn);
        shares += share > 0.0f;
    }
    if (shares == 0)
        return hairlut_fail(HAIRLUT_ERROR_TABLE, message,
                            "mixture: the shares at theta_r node %d, offset node %d are all 0: expected one above 0", j, o);
    return HAIRLUT_OK;
}

hairlut_result hairlut_validate_mixture(const hairlut_mixture_desc *desc, int lobe_count, char *message)
{
    if (!desc)
        return HAIRLUT_OK;
    hairlut_result result = hairlut_check_size("hairlut_mixture_desc", desc->size, sizeof *desc, message);
    if (result == HAIRLUT_OK && desc->mirrored != 0 && desc->mirrored != 1)
        result = hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "mixture: mirrored is %d: expected 0 or 1", desc->mirrored);
    if (result == HAIRLUT_OK)
        result = validate_nodes("theta_r", desc->theta_r, desc->theta_r_count, -hairlut_two_pi, hairlut_two_pi, message);
    if (result == HAIRLUT_OK)
        result = validate_nodes("offset", desc->offset, desc->offset_count, desc->mirrored ? 0.0f : -1.0f, 1.0f, message);
    if (result == HAIRLUT_OK && desc->theta_r_count * desc->offset_count > MAX_GRID)
        result = hairlut_fail(HAIRLUT_ERROR_TABLE, message, "mixture: %d x %d nodes: expected at most %d in all",
                              desc->theta_r_count, desc->offset_count, (int)MAX_GRID);
    for (int j = 0; result == HAIRLUT_OK && j < desc->theta_r_count; ++j)
        for (int o = 0; result == HAIRLUT_OK && o < desc->offset_count; ++o)
            result = validate_node(desc, lobe_count, j, o, message);
    return result;
}

size_t hairlut_mixture_floats(const hairlut_mixture_desc *desc, int lobe_count)
{
    const size_t rows = desc ? (size_t)desc->theta_r_count : 1, columns = desc ? (size_t)desc->offset_count : 1;
    return HAIRLUT_CORNER * rows * columns * (size_t)lobe_count + 2 * rows + 2 * columns;
}

/* wrap to [-pi, pi), in double: the arc from one turn to another is the shorter one also where floats are too coarse to decide */
static double shorter_arc(double turn)
{
    static const double pi = 3.14159265358979323846;
    return turn - 2.0 * pi * floor((turn + pi) / (2.0 * pi));
}

static void store_corner(float *stored, const hairlut_mixture_desc *desc, int lobe_count, int k, int j, int o)
{
    const int above = j + 1 < desc->theta_r_count ? j + 1 : j;
    double sum = 0.0;
    for (int l = 0; l < lobe_count; ++l)
        sum += desc->share ? (double)desc->share[place(desc, l, j, o)] : 1.0;
    const double turn = desc->turn ? (double)desc->turn[place(desc, k, j, o)] : 0.0;
    const double next = desc->turn ? (double)desc->turn[place(desc, k, above, o)] : 0.0;
    stored[0] = (float)((desc->share ? (double)desc->share[place(desc, k, j, o)] : 1.0) / sum);
    stored[1] = hairlut_wrap((float)shorter_arc(turn), -hairlut_pi);
    stored[2] = (float)shorter_arc(next - turn);
}

/* The weights of a node: hairlut_mixture_at's where there is no other node. */
static void store_weights(float *node, int lobe_count)
{
    float sum = 0.0f;
    for (int k = 0; k < lobe_count; ++k)
        sum += node[HAIRLUT_CORNER * k];
    for (int k = 0; k < lobe_count; ++k)
        node[HAIRLUT_CORNER * k + 3] = node[HAIRLUT_CORNER * k] * (1.0f / sum);
}

static void store_nodes(float *stored, const float *nodes, int count, int is_offset)
{
    for (int k = 0; k < count; ++k) {
        const float node = nodes ? nodes[k] : 0.0f;
        stored[2 * k] = is_offset ? hairlut_asin(node) : node;
        stored[2 * k + 1] = 0.0f;
        if (k > 0)
            stored[2 * k - 1] = 1.0f / (stored[2 * k] - stored[2 * k - 2]);
    }
}

void hairlut_build_mixture(hairlut_mixture *mixture, const hairlut_mixture_desc *desc, int lobe_count, float *memory)
{
    const hairlut_mixture_desc plain = {sizeof plain, 1, 1, NULL, NULL, NULL, NULL, 0};
    const hairlut_mixture_desc *d = desc ? desc : &plain;
    float *corner = memory,
          *theta_r = memory + hairlut_mixture_floats(d, lobe_count) - 2 * (d->theta_r_count + d->offset_count);
    float *arc = theta_r + 2 * d->theta_r_count;
    mixture->corners = corner;
    mixture->theta_r = theta_r;
    mixture->arc = arc;
    mixture->rows = d->theta_r_count;
    mixture->columns = d->offset_count;
    mixture->mirrored = d->mirrored;
    mixture->turned = 0;
    store_nodes(theta_r, d->theta_r, d->theta_r_count, 0);
    store_nodes(arc, d->offset, d->offset_count, 1);
    for (int j = 0; j < d->theta_r_count; ++j)
        for (int o = 0; o < d->offset_count; ++o, corner += HAIRLUT_CORNER * lobe_count) {
            for (int k = 0; k < lobe_count; ++k) {
                store_corner(corner + HAIRLUT_CORNER * k, d, lobe_count, k, j, o);
                mixture->turned |= corner[HAIRLUT_CORNER * k + 1] != 0.0f;
            }
            store_weights(corner, lobe_count);
        }
}
