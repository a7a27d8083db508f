/* SPDX-License-Identifier: BSD-3-Clause */
/* One table file: its header attributes, checked against luts/FORMAT.md, and its texels. */
#ifndef HAIRLUT_EXR_TABLE_H
#define HAIRLUT_EXR_TABLE_H

#include "allocator.h"
#include "exr_axes.h"

enum { HAIRLUT_EXR_TABLE_NAME_SIZE = HAIRLUT_NAME_SIZE + 6 /* "_theta" */ };

/* What a file of this name must say about itself. */
typedef struct hairlut_exr_kind {
    const char *table;                        /* hairlut.table, and the file's name without .exr */
    int is_azimuth;                           /* whether its angle is phi; theta_i otherwise */
    int format;                               /* 1: angles alone; 2: angles and slopes, with a digest */
    const char *why;                          /* why this format: for the message */
    const hairlut_exr_parameters *parameters; /* of the model */
} hairlut_exr_kind;

typedef struct hairlut_exr_table {
    hairlut_table table;
    void *texels; /* table.texels; release it with the allocator, also after an error */
    hairlut_azimuth azimuth;
    hairlut_exr_axes axes; /* the table points to them: not to be copied */
    uint32_t digest;       /* of format 2 */
    int missing;           /* the file could not be opened at all */
    char model[HAIRLUT_EXR_MODEL_SIZE];
} hairlut_exr_table;

/* `source` as in hairlut_exr_open. */
hairlut_result hairlut_exr_read_table(const hairlut_exr_kind *kind, const char *path,
                                      const exr_context_initializer_t *source, const hairlut_allocator *allocator,
                                      hairlut_exr_table *out, char *message);

#endif
