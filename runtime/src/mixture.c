/* SPDX-License-Identifier: BSD-3-Clause */
/* Mixtures from memory: what one must fulfil, and the copy of it that is read. */
#include <math.h>
#include <string.h>

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

/* Lobe k's number at node (j, o), at a node of the parameters */
static size_t place(const hairlut_mixture_desc *desc, int k, size_t node, int j, int o)
{
    const size_t row = ((size_t)k * hairlut_node_count(desc->axes, desc->axis_count) + node) * (size_t)desc->theta_r_count;
    return (row + (size_t)j) * (size_t)desc->offset_count + (size_t)o;
}

/* Where a number stands, in a message. */
typedef struct node_name {
    char text[96];
} node_name;

static node_name name_node(const hairlut_mixture_desc *desc, size_t node, int j, int o)
{
    node_name name;
    if (desc->axis_count > 0)
        snprintf(name.text, sizeof name.text, "node %zu of the axes, theta_r node %d, offset node %d", node, j, o);
    else
        snprintf(name.text, sizeof name.text, "theta_r node %d, offset node %d", j, o);
    return name;
}

static hairlut_result validate_node(const hairlut_mixture_desc *desc, int lobe_count, size_t node, int j, int o,
                                    char *message)
{
    int shares = 0;
    for (int k = 0; k < lobe_count; ++k) {
        const float share = desc->share ? desc->share[place(desc, k, node, j, o)] : 1.0f;
        const float turn = desc->turn ? desc->turn[place(desc, k, node, j, o)] : 0.0f;
        if (!(share >= 0.0f && hairlut_is_finite(share)))
            return hairlut_fail(HAIRLUT_ERROR_TABLE, message,
                                "mixture: share of lobe %d at %s is %.9g: expected a finite number, not below 0", k,
                                name_node(desc, node, j, o).text, (double)share);
        if (!(fabsf(turn) <= largest_turn))
            return hairlut_fail(HAIRLUT_ERROR_TABLE, message,
                                "mixture: turn of lobe %d at %s is %.9g: expected -8 pi to 8 pi", k,
                                name_node(desc, node, j, o).text, (double)turn);
        shares += share > 0.0f;
    }
    if (shares == 0)
        return hairlut_fail(HAIRLUT_ERROR_TABLE, message, "mixture: the shares at %s are all 0: expected one above 0",
                            name_node(desc, node, j, o).text);
    return HAIRLUT_OK;
}

static hairlut_result validate_extent(const hairlut_mixture_desc *desc, char *message)
{
    char detail[HAIRLUT_MESSAGE_SIZE];
    hairlut_result result = HAIRLUT_OK;
    if (desc->mirrored != 0 && desc->mirrored != 1)
        result = hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "mixture: mirrored is %d: expected 0 or 1", desc->mirrored);
    if (result == HAIRLUT_OK)
        result = validate_nodes("theta_r", desc->theta_r, desc->theta_r_count, -hairlut_two_pi, hairlut_two_pi, message);
    if (result == HAIRLUT_OK)
        result = validate_nodes("offset", desc->offset, desc->offset_count, desc->mirrored ? 0.0f : -1.0f, 1.0f, message);
    if (result == HAIRLUT_OK && desc->theta_r_count * desc->offset_count > MAX_GRID)
        result = hairlut_fail(HAIRLUT_ERROR_TABLE, message, "mixture: %d x %d nodes: expected at most %d in all",
                              desc->theta_r_count, desc->offset_count, (int)MAX_GRID);
    if (result != HAIRLUT_OK)
        return result;
    result = hairlut_validate_axes(desc->axes, desc->axis_count, detail);
    if (result != HAIRLUT_OK)
        return hairlut_fail(result, message, "mixture: %.480s", detail);
    const size_t nodes = hairlut_node_count(desc->axes, desc->axis_count);
    if (nodes > (size_t)(MAX_GRID / (desc->theta_r_count * desc->offset_count)))
        return hairlut_fail(HAIRLUT_ERROR_TABLE, message,
                            "mixture: %zu nodes of the axes x %d x %d: expected at most %d in all", nodes,
                            desc->theta_r_count, desc->offset_count, (int)MAX_GRID);
    return HAIRLUT_OK;
}

hairlut_result hairlut_validate_mixture(const hairlut_mixture_desc *desc, int lobe_count, char *message)
{
    hairlut_result result = validate_extent(desc, message);
    const size_t nodes = result == HAIRLUT_OK ? hairlut_node_count(desc->axes, desc->axis_count) : 0;
    for (size_t node = 0; node < nodes; ++node)
        for (int j = 0; result == HAIRLUT_OK && j < desc->theta_r_count; ++j)
            for (int o = 0; result == HAIRLUT_OK && o < desc->offset_count; ++o)
                result = validate_node(desc, lobe_count, node, j, o, message);
    return result;
}

/* The arc by which a turn, in rad, differs from 0: [-pi, pi). In double: the arc from one turn to another is the shorter one also where
 * floats are too coarse to decide. */
static double shorter_arc(double turn)
{
    static const double pi = 3.14159265358979323846;
    return turn - 2.0 * pi * floor((turn + pi) / (2.0 * pi));
}

static double share_at(const hairlut_mixture_desc *desc, int lobe_count, int k, size_t node, int j, int o)
{
    double sum = 0.0;
    if (!desc->share)
        return 1.0 / lobe_count;
    for (int l = 0; l < lobe_count; ++l)
        sum += (double)desc->share[place(desc, l, node, j, o)];
    return (double)desc->share[place(desc, k, node, j, o)] / sum;
}

static double turn_at(const hairlut_mixture_desc *desc, int k, size_t node, int j, int o)
{
    return desc->turn ? (double)desc->turn[place(desc, k, node, j, o)] : 0.0;
}

/* Blends over the corners of a node of the parameters. */
static double blended_share(const hairlut_mixture_desc *desc, int lobe_count, const hairlut_spacing *nodes,
                            const hairlut_corners *corners, int k, int j, int o)
{
    double sum = 0.0;
    for (int c = 0; c < nodes->count; ++c)
        sum += (double)corners->weight[c] * share_at(desc, lobe_count, k, (size_t)(corners->node + nodes->corner[c]), j, o);
    return sum;
}

static double blended_turn(const hairlut_mixture_desc *desc, const hairlut_spacing *nodes, const hairlut_corners *corners,
                           int k, int j, int o)
{
    const double low = turn_at(desc, k, (size_t)corners->node, j, o);
    double turn = low;
    for (int c = 1; c < nodes->count; ++c) {
        const double other = turn_at(desc, k, (size_t)(corners->node + nodes->corner[c]), j, o);
        turn += (double)corners->weight[c] * shorter_arc(other - low);
    }
    return turn;
}

/* A turn in units of 2 pi / 2^32, modulo 2^32 */
static int32_t fixed_turn(double turn)
{
    static const double unit = 683565275.57643158979; /* 2^32 / (2 pi) */
    const double fixed = floor(shorter_arc(turn) * unit + 0.5);
    return fixed >= 2147483648.0 ? INT32_MIN : (int32_t)fixed;
}

static int fours_of(int lobe_count)
{
    return (lobe_count + 3) / 4;
}

/* The fours of a node of theta_r and the offset, at a place between the nodes of the parameters. Returns whether a turn is not 0. */
static int store_fours(hairlut_four *four, const hairlut_mixture_desc *desc, int lobe_count, const hairlut_spacing *nodes,
                       const hairlut_corners *corners, int j, int o)
{
    int turned = 0;
    memset(four, 0, (size_t)fours_of(lobe_count) * sizeof *four);
    for (int k = 0; k < lobe_count; ++k) {
        four[k / 4].share[k % 4] = (float)blended_share(desc, lobe_count, nodes, corners, k, j, o);
        four[k / 4].turn[k % 4] = fixed_turn(blended_turn(desc, nodes, corners, k, j, o));
        turned |= four[k / 4].turn[k % 4] != 0;
    }
    return turned;
}

/* The whole grid. Returns its end. */
static hairlut_four *store_grid(hairlut_four *four, const hairlut_mixture_desc *desc, int lobe_count,
                                const hairlut_spacing *nodes, const hairlut_corners *corners, int *turned)
{
    for (int j = 0; j < desc->theta_r_count; ++j)
        for (int o = 0; o < desc->offset_count; ++o, four += fours_of(lobe_count))
            *turned |= store_fours(four, desc, lobe_count, nodes, corners, j, o);
    return four;
}

static size_t grid_fours(const hairlut_mixture_desc *desc, int lobe_count)
{
    return (size_t)desc->theta_r_count * (size_t)desc->offset_count * (size_t)fours_of(lobe_count);
}

static size_t grids_of(const hairlut_mixture_desc *desc)
{
    return desc->axis_count > 0 ? 1 + hairlut_node_count(desc->axes, desc->axis_count) : 1;
}

ptrdiff_t hairlut_mixture_pitch(const hairlut_mixture_desc *desc, int lobe_count)
{
    return desc->axis_count > 0 ? (ptrdiff_t)grid_fours(desc, lobe_count) : 0;
}

size_t hairlut_mixture_floats(const hairlut_mixture_desc *desc, int lobe_count)
{
    return grids_of(desc) * grid_fours(desc, lobe_count) * sizeof(hairlut_four) / sizeof(float) +
           hairlut_nodes_floats(desc->theta_r_count) + hairlut_nodes_floats(desc->offset_count);
}

static int same_turns(const hairlut_four *a, const hairlut_four *b, size_t count)
{
    size_t k = 0;
    while (k < count && memcmp(a[k].turn, b[k].turn, sizeof a->turn) == 0)
        ++k;
    return k == count;
}

/* The grid of the standard values, then those of the nodes of the parameters. Returns the end of the last. */
static hairlut_four *build_grids(hairlut_mixture *mixture, const hairlut_mixture_desc *desc, int lobe_count,
                                 const hairlut_spacing *nodes, const hairlut_corners *standard, hairlut_four *first)
{
    static const hairlut_spacing alone = {0, 1, 0, {0}};
    const size_t fours = grid_fours(desc, lobe_count);
    hairlut_corners node = hairlut_only_corner();
    hairlut_four *next = store_grid(first, desc, lobe_count, nodes, standard, &mixture->turned);
    for (size_t p = 1; p < grids_of(desc); ++p) {
        node.node = (int)p - 1;
        next = store_grid(next, desc, lobe_count, &alone, &node, &mixture->turned);
        mixture->turns_vary |= !same_turns(first + fours, next - fours, fours);
    }
    return next;
}

void hairlut_build_mixture(hairlut_mixture *mixture, const hairlut_mixture_desc *d, int lobe_count,
                           const hairlut_spacing *nodes, const hairlut_corners *corners, float *memory)
{
    static const float zero[1];
    float arcs[MAX_NODES] = {0.0f};
    mixture->fours = (hairlut_four *)memory;
    mixture->four_count = fours_of(lobe_count);
    mixture->beside = d->offset_count > 1 ? mixture->four_count : 0;
    mixture->above = d->theta_r_count > 1 ? mixture->four_count * d->offset_count : 0;
    mixture->mirrored = d->mirrored;
    mixture->turned = mixture->turns_vary = 0;
    mixture->constant = d->theta_r_count == 1 && d->offset_count == 1 && !d->mirrored;
    memory = (float *)build_grids(mixture, d, lobe_count, nodes, corners, (hairlut_four *)memory);
    for (int k = 0; d->offset && k < d->offset_count; ++k)
        arcs[k] = hairlut_asin(d->offset[k]);
    memory = hairlut_build_nodes(&mixture->theta_r, d->theta_r ? d->theta_r : zero, d->theta_r_count, memory);
    hairlut_build_nodes(&mixture->arc, arcs, d->offset_count, memory);
}
