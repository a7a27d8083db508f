/* SPDX-License-Identifier: BSD-3-Clause */
/* Lays out nodes as internal.h describes them, and a model's parameters as strand.h does. */
#include <string.h>

#include "build.h"
#include "corners.h"

static const hairlut_parameter_nodes *axis_at(const hairlut_parameter_nodes *axes, int a)
{
    return (const hairlut_parameter_nodes *)((const char *)axes + (size_t)a * axes->size);
}

/* ---- nodes ---------------------------------------------------------------------------------------------------- */

static int eights_of(int count)
{
    return count > 2 ? (count - 2 + 7) / 8 : 0;
}

size_t hairlut_nodes_floats(int count)
{
    return 8 * (size_t)eights_of(count) + 2 * (size_t)count;
}

float *hairlut_build_nodes(hairlut_nodes *nodes, const float *values, int count, float *memory)
{
    const int inner = 8 * eights_of(count);
    float *pairs = memory + inner;
    nodes->inner = memory;
    nodes->pairs = pairs;
    nodes->count = count;
    nodes->eights = eights_of(count);
    nodes->last = values[count - 1];
    for (int k = 0; k < inner; ++k)
        memory[k] = k + 2 < count ? values[k + 1] : HAIRLUT_NO_TEXEL;
    for (int k = 0; k < count; ++k) {
        pairs[2 * k] = values[k];
        pairs[2 * k + 1] = k + 1 < count ? 1.0f / (values[k + 1] - values[k]) : 0.0f;
    }
    return pairs + 2 * count;
}

static size_t axes_floats(const hairlut_parameter_nodes *axes, int axis_count)
{
    size_t floats = 0;
    for (int a = 0; a < axis_count; ++a)
        floats += hairlut_nodes_floats(axis_at(axes, a)->count);
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
    if (scale->parameter != axis->parameter || scale->nodes.count != axis->count)
        return 0;
    for (int k = 0; k < axis->count; ++k)
        if (scale->nodes.pairs[2 * k] != axis->values[k])
            return 0;
    return 1;
}

static const hairlut_scale *add_scale(hairlut_strands *strands, const hairlut_parameter_nodes *axis, float **memory)
{
    int s = 0;
    while (s < strands->scale_count && !is_scale(&strands->scales[s], axis))
        ++s;
    if (s == strands->scale_count) {
        strands->scales[s].parameter = axis->parameter;
        *memory = hairlut_build_nodes(&strands->scales[s].nodes, axis->values, axis->count, *memory);
        ++strands->scale_count;
    }
    return &strands->scales[s];
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
    corners.weight[0] = 1.0f;
    return corners;
}

hairlut_corners hairlut_standard_corners(const hairlut_strands *strands, int grid)
{
    hairlut_corners corners;
    hairlut_corners_of(&strands->grids[grid], strands->standard, &corners);
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

/* ---- tables --------------------------------------------------------------------------------------------------- */

static void build_strand_table(const hairlut_axis *axis, hairlut_strand_table *table)
{
    const ptrdiff_t pitch = table->nodes.pitch;
    table->rows = axis->rows + pitch;
    table->cells = axis->ends[0] + pitch;
    table->links = axis->links;
    table->pitch = pitch;
    table->second = table->nodes.corner[1];
    table->low = axis->low;
    table->high = axis->high;
    table->stride = axis->stride;
    table->small = HAIRLUT_IS_SMALL(axis->columns);
    table->groups = (unsigned char)(axis->columns <= HAIRLUT_FLAT_COLUMNS ? (axis->columns - 2 + 7) / 8 : 0);
    table->grid = axis->grid;
    table->alike = axis->alike != 0;
    table->axis = axis;
}

void hairlut_build_strand_tables(hairlut_strands *strands, const hairlut_lobe *lobes, int lobe_count)
{
    strands->whole = 1;
    for (int k = 0; k < lobe_count; ++k) {
        strands->sign[k] = lobes[k].sign;
        build_strand_table(&lobes[k].theta, &strands->theta[k]);
        strands->theta[k].uniform = lobes[k].uniform != 0;
        strands->whole &= strands->theta[k].groups > 0;
        if (lobes[k].uniform)
            continue;
        build_strand_table(&lobes[k].phi, &strands->phi[k]);
        strands->whole &= strands->phi[k].groups > 0;
    }
}
