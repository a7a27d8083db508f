/* SPDX-License-Identifier: BSD-3-Clause */
/* A model over parameters: what those of a strand choose from, and the choice.
 *
 * The model itself is that of the standard values. What depends on parameters is stored at the nodes of its axes besides, and
 * a strand reads the blend of the 2^d nodes around it, the corners. */
#ifndef HAIRLUT_STRAND_H
#define HAIRLUT_STRAND_H

#include <stdint.h>

#include "internal.h"
#include "quad.h"

enum {
    HAIRLUT_MOST_TABLES = 2 * HAIRLUT_MAX_LOBES,
    HAIRLUT_MOST_GRIDS = HAIRLUT_MOST_TABLES + 2, /* one for each table, for the mixture, and the one without axes */
    HAIRLUT_MOST_SCALES = HAIRLUT_MAX_AXES * (HAIRLUT_MOST_TABLES + 1),
    HAIRLUT_CORNERS = 1 << HAIRLUT_MAX_AXES
};

/* The nodes of one axis; tables with the same ones share them. */
typedef struct hairlut_scale {
    int parameter;
    int count;
    int quads;          /* of the inner nodes, which infinity fills up */
    const float *inner; /* all but the first and the last, by which a value is searched */
    const float *nodes; /* for each, its value and 1 / (the next one's - its own); 0 at the last */
} hairlut_scale;

/* The axes of a table or of the mixture, by the numbers of their scales, the slowest first. */
typedef struct hairlut_node_grid {
    int axis_count;
    int scale[HAIRLUT_MAX_AXES];
} hairlut_node_grid;

/* The nodes around a strand, and their weights, which sum to 1. */
typedef struct hairlut_corners {
    int count;
    int node[HAIRLUT_CORNERS];
    float weight[HAIRLUT_CORNERS];
} hairlut_corners;

/* A table over parameters. The table of node p stands as the lobe's hairlut_axis does, (p + 1) * pitch floats behind it;
 * without axes the pitch is 0, and the only node is that axis itself. */
typedef struct hairlut_varied {
    ptrdiff_t pitch;
    int grid;
} hairlut_varied;

/* Shares and turns of four lobes at a node, side by side. A turn is in units of 2 pi / 2^32: the difference of two, modulo
 * 2^32, is the shorter arc. */
typedef struct hairlut_four {
    float share[4];
    int32_t turn[4];
} hairlut_four;

typedef struct hairlut_strands {
    int parameter_count, scale_count, grid_count;
    float least[HAIRLUT_MAX_PARAMETERS], most[HAIRLUT_MAX_PARAMETERS], standard[HAIRLUT_MAX_PARAMETERS];
    char names[HAIRLUT_MAX_PARAMETERS][HAIRLUT_NAME_SIZE];
    hairlut_scale scales[HAIRLUT_MOST_SCALES];
    hairlut_node_grid grids[HAIRLUT_MOST_GRIDS]; /* number 0 is that without axes */
    hairlut_varied theta[HAIRLUT_MAX_LOBES], phi[HAIRLUT_MAX_LOBES];
    /* Of the mixture: fours ((node * rows + j) * columns + o) * four_count and so on are those of theta_r node j, offset o */
    const hairlut_four *fours;
    int four_count; /* lobes / 4, rounded up */
    int mixture_grid;
} hairlut_strands;

#endif
