/* What a model is made of. Private to the library and to the generated file of compiled-in tables. */
#ifndef HAIRLUT_INTERNAL_H
#define HAIRLUT_INTERNAL_H

#include "hairlut.h"

/* A table ready for sampling. Rows are padded: rows[j*(columns+2)] .. hold one texel before the first and one after the
 * last, so that the four texels around any cell are adjacent (luts/FORMAT.md, "Padding"). */
typedef struct hairlut_axis {
    const float *rows;
    int columns;
    int height;
    float row_origin; /* theta_r of row 0 */
    float row_scale;  /* rows per radian of theta_r */
    float low;        /* the domain */
    float high;
    int warp;         /* hairlut_warp */
    float e;          /* quartic warp: y = (m + e)^(1/4) = f0 + k c, m = min(u, 1-u), c the folded column */
    float f0;
    float k;          /* uniform warp: m = k c */
    float limit;      /* of a cell's curvature, relative to its width */
} hairlut_axis;

/* One initialiser for compiled-in tables, so that generated code does not depend on the order of the fields. */
#define HAIRLUT_AXIS(rows_, columns_, height_, row_origin_, row_scale_, low_, high_, warp_, e_, f0_, k_, limit_)      \
    {                                                                                                                 \
        rows_, columns_, height_, row_origin_, row_scale_, low_, high_, warp_, e_, f0_, k_, limit_                    \
    }

struct hairlut_model {
    hairlut_axis direct_theta;
    hairlut_axis direct_phi;
    hairlut_axis multiple_theta;
    hairlut_azimuth azimuth;
    hairlut_allocator allocator; /* what hairlut_free gives the memory back to; zero for compiled-in models */
};

typedef struct hairlut_builtin_entry {
    const char *name;
    hairlut_model model;
} hairlut_builtin_entry;

/* Defined by the generated file (hairlut export --to c). */
extern const hairlut_builtin_entry hairlut_builtin_entries[];
extern const int hairlut_builtin_count;

#endif
