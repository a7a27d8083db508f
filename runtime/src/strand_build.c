/* SPDX-License-Identifier: BSD-3-Clause */
/* Lays out a model's parameters, nodes and mixtures as strand.h describes them. */
#include <math.h>
#include <string.h>

#include "build.h"
#include "corners.h"

static const hairlut_parameter_nodes *axis_at(const hairlut_parameter_nodes *axes, int a)
{
    return (const hairlut_parameter_nodes *)((const char *)axes + (size_t)a * axes->size);
}

/* ---- scales --------------------------------------------------------------------------------------------------- */

static int quads_of(int count)
{
    return (count - 2 + 3) / 4;
}

static size_t scale_floats(const hairlut_parameter_nodes *axis)
{
    return 4 * (size_t)quads_of(axis->count) + 2 * (size_t)axis->count;
}

static size_t axes_floats(const hairlut_parameter_nodes *axes, int axis_count)
{
    size_t floats = 0;
    for (int a = 0; a < axis_count; ++a)
        floats += scale_floats(axis_at(axes, a));
    return floats;
}

size_t hairlut_strands_floats(const hairlut_model_desc *desc)
{
    size_t floats = axes_floats(desc->mixture->axes, desc->mixture->axis_count);
    for (int k = 0; k < desc->lobe_count; ++k) {
        const hairlut_lobe_desc *lobe =
            (const hairlut_lobe_desc *)((const char *)desc->lobes + (size_t)k * desc->lobes->size);
        const hairlut_table theta = hairlut_known_table(lobe->theta),
                            phi = hairlut_known_table(lobe->phi ? lobe->phi : lobe->theta);
        floats += axes_floats(theta.axes, theta.axis_count) + axes_floats(phi.axes, phi.axis_count);
    }
    return floats;
}

static int is_scale(const hairlut_scale *scale, const hairlut_parameter_nodes *axis)
{
    if (scale->parameter != axis->parameter || scale->count != axis->count)
        return 0;
    for (int k = 0; k < axis->count; ++k)
        if (scale->nodes[2 * k] != axis->values[k])
            return 0;
    return 1;
}

static float *build_scale(hairlut_scale *scale, const hairlut_parameter_nodes *axis, float *memory)
{
    const int inner = 4 * quads_of(axis->count);
    float *nodes = memory + inner;
    scale->parameter = axis->parameter;
    scale->count = axis->count;
    scale->quads = quads_of(axis->count);
    scale->inner = memory;
    scale->nodes = nodes;
    for (int k = 0; k < inner; ++k)
        memory[k] = k + 2 < axis->count ? axis->values[k + 1] : INFINITY;
    for (int k = 0; k < axis->count; ++k) {
        nodes[2 * k] = axis->values[k];
        nodes[2 * k + 1] = k + 1 < axis->count ? 1.0f / (axis->values[k + 1] - axis->values[k]) : 0.0f;
    }
    return nodes + 2 * axis->count;
}

static int add_scale(hairlut_strands *strands, const hairlut_parameter_nodes *axis, float **memory)
{
    int s = 0;
    while (s < strands->scale_count && !is_scale(&strands->scales[s], axis))
        ++s;
    if (s == strands->scale_count) {
        *memory = build_scale(&strands->scales[s], axis, *memory);
        ++strands->scale_count;
    }
    return s;
}

/* ---- grids ---------------------------------------------------------------------------------------------------- */

int hairlut_add_grid(hairlut_strands *strands, const hairlut_parameter_nodes *axes, int axis_count, float **memory)
{
    hairlut_node_grid grid;
    int g = 0;
    memset(&grid, 0, sizeof grid);
    grid.axis_count = axis_count;
    for (int a = 0, stride = 1; a < axis_count; ++a) {
        const hairlut_parameter_nodes *axis = axis_at(axes, axis_count - 1 - a);
        grid.scale[a] = add_scale(strands, axis, memory);
        grid.stride[a] = stride;
        stride *= axis->count;
    }
    while (g < strands->grid_count && memcmp(&strands->grids[g], &grid, sizeof grid) != 0)
        ++g;
    strands->grids[g] = grid;
    strands->grid_count += g == strands->grid_count;
    return g;
}

hairlut_spacing hairlut_space(const hairlut_strands *strands, int number, ptrdiff_t pitch)
{
    const hairlut_node_grid *grid = &strands->grids[number];
    hairlut_spacing spacing;
    memset(&spacing, 0, sizeof spacing);
    spacing.grid = number;
    spacing.count = 1 << grid->axis_count;
    spacing.pitch = pitch;
    for (int c = 0; c < spacing.count; ++c)
        for (int a = 0; a < grid->axis_count; ++a)
            spacing.corner[c] += (c >> a & 1) * grid->stride[a] * pitch;
    return spacing;
}

hairlut_corners hairlut_only_corner(void)
{
    hairlut_corners corners;
    corners.node = 0;
    corners.weight[0] = hairlut_quad_all(1.0f);
    return corners;
}

hairlut_corners hairlut_standard_corners(const hairlut_strands *strands, int grid)
{
    hairlut_node places[HAIRLUT_MOST_SCALES];
    hairlut_corners corners;
    for (int s = 0; s < strands->scale_count; ++s)
        places[s] = hairlut_scale_place(&strands->scales[s], strands->standard[strands->scales[s].parameter]);
    hairlut_corners_of(&strands->grids[grid], places, strands->grids[grid].axis_count, &corners);
    return corners;
}

/* ---- the whole ------------------------------------------------------------------------------------------------ */

float *hairlut_build_parameters(hairlut_strands *strands, const hairlut_model_desc *desc, float *memory)
{
    memset(strands, 0, sizeof *strands);
    strands->parameter_count = desc->parameter_count;
    for (int p = 0; p < desc->parameter_count; ++p) {
        const hairlut_parameter *parameter =
            (const hairlut_parameter *)((const char *)desc->parameters + (size_t)p * desc->parameters->size);
        strands->least[p] = parameter->least;
        strands->most[p] = parameter->most;
        strands->standard[p] = parameter->standard;
        memcpy(strands->names[p], parameter->name, strlen(parameter->name));
    }
    hairlut_add_grid(strands, NULL, 0, &memory); /* number 0 */
    strands->pairs = 1;
    return memory;
}

/* ---- the mixture ---------------------------------------------------------------------------------------------- */

static size_t grid_nodes(const hairlut_mixture_desc *desc)
{
    return hairlut_node_count(desc->axes, desc->axis_count) * (size_t)desc->theta_r_count * (size_t)desc->offset_count;
}

size_t hairlut_fours_floats(const hairlut_mixture_desc *desc, int lobe_count)
{
    return grid_nodes(desc) * (size_t)((lobe_count + 3) / 4) * sizeof(hairlut_four) / sizeof(float);
}

/* A turn in units of 2 pi / 2^32, modulo 2^32. */
static int32_t fixed_turn(double turn)
{
    static const double unit = 683565275.57643158979; /* 2^32 / (2 pi) */
    const double fixed = floor(hairlut_shorter_arc(turn) * unit + 0.5);
    return fixed >= 2147483648.0 ? INT32_MIN : (int32_t)fixed;
}

void hairlut_build_fours(hairlut_strands *strands, const hairlut_mixture_desc *desc, int lobe_count, int grid, float *memory)
{
    hairlut_four *four = (hairlut_four *)memory;
    const size_t nodes = hairlut_node_count(desc->axes, desc->axis_count);
    strands->fours = four;
    strands->four_count = (lobe_count + 3) / 4;
    strands->mixture =
        hairlut_space(strands, grid, (ptrdiff_t)strands->four_count * desc->theta_r_count * desc->offset_count);
    for (size_t node = 0; node < nodes; ++node)
        for (int j = 0; j < desc->theta_r_count; ++j)
            for (int o = 0; o < desc->offset_count; ++o, four += strands->four_count)
                for (int k = 0; k < 4 * strands->four_count; ++k) {
                    const int exists = k < lobe_count;
                    four[k / 4].share[k % 4] = exists ? (float)hairlut_share_at(desc, lobe_count, k, node, j, o) : 0.0f;
                    four[k / 4].turn[k % 4] = exists ? fixed_turn(hairlut_turn_at(desc, k, node, j, o)) : 0;
                    strands->turns_vary |=
                        four[k / 4].turn[k % 4] != four[k / 4 - (ptrdiff_t)node * strands->mixture.pitch].turn[k % 4];
                }
}
