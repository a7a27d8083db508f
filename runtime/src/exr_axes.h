/* SPDX-License-Identifier: BSD-3-Clause */
/* Parameters of the hair in the headers of files: what mixture.exr says of them, and the nodes over which a file depends on
 * them. */
#ifndef HAIRLUT_EXR_AXES_H
#define HAIRLUT_EXR_AXES_H

#include "exr_file.h"

enum { HAIRLUT_EXR_MOST_NODES = 64 /* of an axis */ };

/* The parameters of a model. The list points into the names: not to be copied. */
typedef struct hairlut_exr_parameters {
    int count;
    char names[HAIRLUT_MAX_PARAMETERS][HAIRLUT_NAME_SIZE];
    hairlut_parameter list[HAIRLUT_MAX_PARAMETERS];
} hairlut_exr_parameters;

/* The axes of a file. They point into the nodes: not to be copied. */
typedef struct hairlut_exr_axes {
    int count;
    int blocks; /* of rows: the product of the axes' nodes, 1 without axes */
    hairlut_parameter_nodes list[HAIRLUT_MAX_AXES];
    float nodes[HAIRLUT_MAX_AXES][HAIRLUT_EXR_MOST_NODES];
} hairlut_exr_axes;

/* Of mixture.exr: all parameters, and the axes of those on which it depends. */
hairlut_result hairlut_exr_read_mixture_axes(const hairlut_exr_file *file, hairlut_exr_parameters *parameters,
                                             hairlut_exr_axes *axes);

/* Of a table of a model with these parameters. */
hairlut_result hairlut_exr_read_table_axes(const hairlut_exr_file *file, const hairlut_exr_parameters *parameters,
                                           hairlut_exr_axes *axes);

/* *height is the number of theta_r's rows in one block, from `least` to HAIRLUT_EXR_LARGEST_SIDE. */
hairlut_result hairlut_exr_split_rows(const hairlut_exr_file *file, const hairlut_exr_axes *axes, int least, int *height);

#endif
