/* SPDX-License-Identifier: BSD-3-Clause */
/* A model over parameters, and a strand: a set of values of them.
 *
 * The model itself is that of the standard values. Tables and mixtures that depend on parameters are stored for each node of their
 * axes besides, and a strand reads the blend of the 2^d nodes around its values, the corners. */
#ifndef HAIRLUT_STRAND_H
#define HAIRLUT_STRAND_H

#include "internal.h"

enum {
    HAIRLUT_MOST_GRIDS = HAIRLUT_MOST_TABLES + 2, /* one for each table, for the mixture, and the one without axes */
    HAIRLUT_MOST_SCALES = HAIRLUT_MAX_AXES * (HAIRLUT_MOST_TABLES + 1),
    HAIRLUT_CORNERS = 1 << HAIRLUT_MAX_AXES,
    HAIRLUT_FLAT_COLUMNS = 4 * HAIRLUT_SMALL_GROUP +
        1 /* of tables whose rows are searched as a whole: a bit of 32 is left */
};

/* The nodes of one axis; tables with the same ones share them. */
typedef struct hairlut_scale {
    int parameter;
    hairlut_nodes nodes;
} hairlut_scale;

/* The axes of a table or of the mixture, the fastest first: each one's scale, and how many nodes of the grid lie from one of its nodes
 * to the next. Of the 2^axis_count corners of a cell of nodes, number c is at the upper node of axis a where bit a
 * of c is set. */
typedef struct hairlut_node_grid {
    int axis_count;
    const hairlut_scale *scale[HAIRLUT_MAX_AXES];
    int stride[HAIRLUT_MAX_AXES];
} hairlut_node_grid;

/* The cell of nodes around a strand, on each grid: the node of its first corner, and the corners' weights, which sum to 1. */
typedef struct hairlut_corners {
    float weight[HAIRLUT_CORNERS];
    int node;
} hairlut_corners;

/* How the copies for the nodes of a grid are spaced in memory: from one node to the next, and from the first corner to each. */
typedef struct hairlut_spacing {
    int grid;
    int count; /* corners */
    ptrdiff_t pitch;
    ptrdiff_t corner[HAIRLUT_CORNERS];
} hairlut_spacing;

/* What a strand reads of a table: where its first node's arrays begin, and how they are laid out (hairlut_axis). That of node p is
 * p * pitch floats from there; without axes the pitch is 0. A cache line has what each call reads. */
typedef struct hairlut_strand_table {
    const float *rows, *cells; /* cells: hairlut_axis.ends[0] */
    const hairlut_link *links;
    ptrdiff_t pitch, second; /* second: floats from the first corner to the second */
    float low, high;
    int stride, grid;         /* grid: that of theta_r's rows */
    unsigned char groups;     /* of a row that is searched as a whole; else 0 */
    unsigned char small;      /* HAIRLUT_IS_SMALL */
    unsigned char alike;      /* hairlut_axis.alike: no row changes to the one above */
    unsigned char uniform;    /* of a table of theta_i: whether the lobe's azimuth is uniform */
    const hairlut_axis *axis; /* at the standard values */
    hairlut_spacing nodes;
} hairlut_strand_table;

typedef struct hairlut_strands {
    int parameter_count, scale_count, grid_count;
    float least[HAIRLUT_MAX_PARAMETERS], most[HAIRLUT_MAX_PARAMETERS], standard[HAIRLUT_MAX_PARAMETERS];
    char names[HAIRLUT_MAX_PARAMETERS][HAIRLUT_NAME_SIZE];
    hairlut_scale scales[HAIRLUT_MOST_SCALES];
    hairlut_node_grid grids[HAIRLUT_MOST_GRIDS]; /* number 0 has no axes */
    float sign[HAIRLUT_MAX_LOBES];               /* those of the lobes; of other ones, 0 */
    hairlut_strand_table theta[HAIRLUT_MAX_LOBES], phi[HAIRLUT_MAX_LOBES];
    /* Of the mixture, in fours: that of node p stands as the model's does, (p + 1) * pitch behind it; without axes the pitch is 0, and
     * the only node is the model's itself. */
    hairlut_spacing mixture;
    int whole; /* whether the rows of all tables are searched as a whole */
    int pairs; /* whether no table has more than one axis: two corners do, of which one without axes has the weight 0 */
} hairlut_strands;

#endif
