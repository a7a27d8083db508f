/* One table file: its header attributes, checked against luts/FORMAT.md, and its texels. */
#ifndef HAIRLUT_EXR_TABLE_H
#define HAIRLUT_EXR_TABLE_H

#include "allocator.h"
#include "exr_file.h"

enum { HAIRLUT_EXR_MODEL_SIZE = 64 };

/* What a file of this name must say about itself. */
typedef struct hairlut_exr_kind {
    const char *table; /* hairlut.table, and the file's name without .exr */
    const char *angle; /* hairlut.angle */
    int has_azimuth;   /* whether hairlut.azimuth is sum or difference; none otherwise */
} hairlut_exr_kind;

typedef struct hairlut_exr_table {
    hairlut_table table;
    void *texels; /* table.texels; release it with the allocator, also after an error */
    hairlut_azimuth azimuth;
    char model[HAIRLUT_EXR_MODEL_SIZE];
} hairlut_exr_table;

/* `source` as in hairlut_exr_open. */
hairlut_result hairlut_exr_read_table(const hairlut_exr_kind *kind, const char *path, const exr_context_initializer_t *source,
                                      const hairlut_allocator *allocator, hairlut_exr_table *out, char *message);

#endif
