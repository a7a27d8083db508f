/* What a model is made of. Private to the library and to the generated file of compiled-in tables. */
#ifndef HAIRLUT_INTERNAL_H
#define HAIRLUT_INTERNAL_H

#include <float.h>

#include "hairlut.h"

enum {
    HAIRLUT_PIVOTS = 16,
    HAIRLUT_ROW_EXTRA = 2 + HAIRLUT_PIVOTS /* floats of a stored row that are not texels */
};

/* A table ready for sampling. Row j starts at rows[j*(columns + HAIRLUT_ROW_EXTRA)] and holds: one texel before the
 * first, the texels, one after the last, so that the four texels around any cell are adjacent (luts/FORMAT.md,
 * "Padding"); then the pivots of the search for a cell: pivot k is texel (k+1)*pivot_step, or HAIRLUT_NO_PIVOT where
 * that is beyond the last cell. */
typedef struct hairlut_axis {
    const float *rows;
    int columns;
    int height;
    int pivot_step; /* cells between two pivots: (columns - 1) / HAIRLUT_PIVOTS, rounded up */
    int warp;       /* hairlut_warp */
    float row_origin; /* theta_r of row 0 */
    float row_scale;  /* rows per radian of theta_r */
    float row_last;   /* height - 1 */
    float low;        /* the domain */
    float high;
    float e; /* quartic warp: y = (m + e)^(1/4) = f0 + k c, m = min(u, 1-u), c the folded column */
    float f0;
    float k; /* uniform warp: m = k c */
    float inverse_k;
    float middle; /* the largest folded column: (columns - 1) / 2 */
    float limit;  /* of a cell's curvature, relative to its width */
} hairlut_axis;

#define HAIRLUT_NO_PIVOT FLT_MAX

/* The one initialiser of an axis, also of the compiled-in ones: generated code does not depend on the fields. */
#define HAIRLUT_AXIS(rows_, columns_, height_, row_origin_, row_scale_, low_, high_, warp_, e_, f0_, k_, limit_)      \
    {                                                                                                                 \
        rows_, columns_, height_, ((columns_) - 2 + HAIRLUT_PIVOTS) / HAIRLUT_PIVOTS, warp_, row_origin_, row_scale_, \
            (float)((height_) - 1), low_, high_, e_, f0_, k_, 1.0f / (k_), 0.5f * (float)((columns_) - 1), limit_     \
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
