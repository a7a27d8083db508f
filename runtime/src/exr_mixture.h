/* SPDX-License-Identifier: BSD-3-Clause */
/* mixture.exr: the names of a model's lobes and their tables, shares and turns. */
#ifndef HAIRLUT_EXR_MIXTURE_H
#define HAIRLUT_EXR_MIXTURE_H

#include "exr_table.h"

/* A table that a lobe names; the name is empty where there is none. */
typedef struct hairlut_exr_reference {
    char table[HAIRLUT_EXR_TABLE_NAME_SIZE];
    uint32_t digest;
} hairlut_exr_reference;

typedef struct hairlut_exr_lobe {
    char name[HAIRLUT_NAME_SIZE];
    hairlut_exr_reference theta, phi;
} hairlut_exr_lobe;

typedef struct hairlut_exr_mixture {
    int lobe_count;
    hairlut_exr_lobe lobes[HAIRLUT_MAX_LOBES];
    hairlut_mixture_desc desc; /* hairlut_model_create checks its shares and turns */
    hairlut_exr_parameters parameters;
    hairlut_exr_axes axes; /* of desc */
    void *memory;          /* of desc's arrays; release it with the allocator, also after an error */
    int missing;           /* the file could not be opened at all */
    char model[HAIRLUT_EXR_MODEL_SIZE];
} hairlut_exr_mixture;

/* `source` as in hairlut_exr_open. */
hairlut_result hairlut_exr_read_mixture(const char *path, const exr_context_initializer_t *source,
                                        const hairlut_allocator *allocator, hairlut_exr_mixture *out, char *message);

#endif
