/* SPDX-License-Identifier: BSD-3-Clause */
/* How descriptors become a model: the parts of hairlut_model_create. */
#ifndef HAIRLUT_BUILD_H
#define HAIRLUT_BUILD_H

#include "message.h"
#include "strand.h"

/* NaN is in no range */
static inline int hairlut_within(float low, float high, float bound_low, float bound_high)
{
    return low >= bound_low && low < high && high <= bound_high;
}

/* The largest size of a parameter's value, and the least gap between two nodes: 1 / gap is a float. */
static const float hairlut_largest_value = 1e30f, hairlut_narrowest_gap = 1e-30f;

/* Descriptors as 2.0 had them, for their sizes: without parameters and axes. */
typedef struct hairlut_table_2_0 {
    size_t size;
    const float *texels;
    int width, height;
    float numbers[4];
    hairlut_warp warp;
    float warp_e;
} hairlut_table_2_0;

typedef struct hairlut_mixture_desc_2_0 {
    size_t size;
    int theta_r_count, offset_count;
    const float *arrays[4];
    int mirrored;
} hairlut_mixture_desc_2_0;

typedef struct hairlut_model_desc_2_0 {
    size_t size;
    int lobe_count;
    const hairlut_lobe_desc *lobes;
    const hairlut_mixture_desc *mixture;
} hairlut_model_desc_2_0;

/* A descriptor of `size` bytes, where this library knows `known` bytes, and `earlier` of 2.0. */
static inline hairlut_result hairlut_check_size(const char *type, size_t size, size_t known, size_t earlier, char *message)
{
    if (size == known || size == earlier)
        return HAIRLUT_OK;
    return hairlut_fail(size > known ? HAIRLUT_ERROR_VERSION : HAIRLUT_ERROR_ARGUMENT, message,
                        "size of a %s is %zu: expected sizeof(%s), which is %zu in hairlut %d.%d", type, size, type, known,
                        HAIRLUT_VERSION_MAJOR, HAIRLUT_VERSION_MINOR);
}

/* Descriptors of a known size as this version has them. NULL in place of a mixture: equal shares, no turns. */
hairlut_table hairlut_known_table(const hairlut_table *table);
hairlut_mixture_desc hairlut_known_mixture(const hairlut_mixture_desc *desc);
hairlut_model_desc hairlut_known_model(const hairlut_model_desc *desc);

/* Whether a word can name a lobe or a parameter. */
int hairlut_is_name(const char *name);

/* Axes by themselves: messages begin with "axis". */
hairlut_result hairlut_validate_axes(const hairlut_parameter_nodes *axes, int axis_count, char *message);

/* Axes that are valid by themselves, of a table or mixture called `owner`, and the model's parameters. */
hairlut_result hairlut_match_axes(const char *owner, const hairlut_parameter_nodes *axes, int axis_count,
                                  const hairlut_model_desc *desc, char *message);
hairlut_result hairlut_validate_parameters(const hairlut_model_desc *desc, char *message);

/* The nodes of all axes: the product of their counts; 1 without axes. */
size_t hairlut_node_count(const hairlut_parameter_nodes *axes, int axis_count);

/* Floats that a table takes in a model, for one node of its axes: whole cache lines. */
size_t hairlut_table_floats(const hairlut_table *table);

/* Fills an axis, whose arrays go to `memory`, of so many floats, from the first node's texels. The table is valid. */
void hairlut_build_axis(hairlut_axis *axis, const hairlut_table *table, float *memory);

/* Makes the axis the blend of those at the corners around the standard values. That of node p is stored likewise,
 * (p + 1) * pitch floats behind it. */
void hairlut_blend_axis(const hairlut_axis *axis, float *memory, const hairlut_spacing *nodes,
                        const hairlut_corners *corners);

/* Floats that the nodes of an axis take, and the nodes of such values. Returns the end of what was filled. */
size_t hairlut_nodes_floats(int count);
float *hairlut_build_nodes(hairlut_nodes *nodes, const float *values, int count, float *memory);

/* Lays out what strands read, from descriptors that are valid and of a known size. */
size_t hairlut_strands_floats(const hairlut_model_desc *desc);
float *hairlut_build_parameters(hairlut_strands *strands, const hairlut_model_desc *desc, float *memory);

/* The number of the grid of these axes, new or one that there is. Its scales go to *memory, which moves to their end. */
int hairlut_add_grid(hairlut_strands *strands, const hairlut_parameter_nodes *axes, int axis_count, float **memory);

/* How copies for the nodes of a grid are spaced, from their pitch. */
hairlut_spacing hairlut_space(const hairlut_strands *strands, int number, ptrdiff_t pitch);

/* The corners of a grid without axes, and of one around the standard values. */
hairlut_corners hairlut_only_corner(void);
hairlut_corners hairlut_standard_corners(const hairlut_strands *strands, int grid);

hairlut_result hairlut_validate_mixture(const hairlut_mixture_desc *desc, int lobe_count, char *message);
size_t hairlut_mixture_floats(const hairlut_mixture_desc *desc, int lobe_count);

/* What strands read of the lobes' axes, which are built and numbered; `nodes` of each is set. */
void hairlut_build_strand_tables(hairlut_strands *strands, const hairlut_lobe *lobes, int lobe_count);

/* From one node of the parameters to the next, in fours; 0 where the mixture does not depend on them. */
ptrdiff_t hairlut_mixture_pitch(const hairlut_mixture_desc *desc, int lobe_count);

/* At all nodes of its axes, and, before them, at the standard values: the corners around these. */
void hairlut_build_mixture(hairlut_mixture *mixture, const hairlut_mixture_desc *desc, int lobe_count,
                           const hairlut_spacing *nodes, const hairlut_corners *corners, float *memory);

#endif
