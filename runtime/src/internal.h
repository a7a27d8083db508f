/* What a model is made of. Private to the library and to the generated file of compiled-in tables. */
#ifndef HAIRLUT_INTERNAL_H
#define HAIRLUT_INTERNAL_H

#include <float.h>

#include "hairlut.h"

/* A stored row: the pivots of the search for a cell; one texel before the first, the texels, one after the last, so that
 * the four texels around any cell are adjacent (luts/FORMAT.md, "Padding"); what fills it up to whole cache lines. Pivot
 * k is texel (k+1)*step, or HAIRLUT_NO_TEXEL where that is beyond the last cell. A line follows the last row, because
 * kernels read whole vectors. */
enum { HAIRLUT_PIVOTS = 16, HAIRLUT_LINE = 16 /* floats of a cache line */ };
#define HAIRLUT_NO_TEXEL FLT_MAX
#define HAIRLUT_STRIDE(columns) (((columns) + 2 + HAIRLUT_PIVOTS + HAIRLUT_LINE - 1) / HAIRLUT_LINE * HAIRLUT_LINE)
#define HAIRLUT_STORED(columns, height) (HAIRLUT_STRIDE(columns) * (height) + HAIRLUT_LINE)
#define HAIRLUT_STEP(columns) (((columns) - 2 + HAIRLUT_PIVOTS) / HAIRLUT_PIVOTS)

#if defined(__GNUC__)
#define HAIRLUT_LINE_ALIGNED __attribute__((aligned(64)))
#elif defined(_MSC_VER)
#define HAIRLUT_LINE_ALIGNED __declspec(align(64))
#else
#define HAIRLUT_LINE_ALIGNED
#endif

/* A table ready for sampling. */
typedef struct hairlut_axis {
    const float *rows; /* the texel before the first of row 0; best if the row's pivots are aligned to a cache line */
    int columns;
    int height;
    int stride; /* floats from one row to the next */
    int step;   /* cells between two pivots */
    int warp;   /* hairlut_warp */
    float row_origin; /* theta_r of row 0 */
    float row_scale;  /* rows per radian of theta_r */
    float row_last;   /* height - 1 */
    float low;        /* the domain */
    float high;
    float e; /* quartic warp: y = (m + e)^(1/4) = f0 + k c, m = min(u, 1-u), c the folded column, dm/dc = du y^3 */
    float f0; /* sqrtf(sqrtf(e)), rounded as when a sample is drawn */
    float k; /* uniform warp: m = k c, dm/dc = du */
    float inverse_k;
    float du;
    float limit;  /* of a cell's curvature, relative to its width */
} hairlut_axis;

/* The one initialiser of an axis, also of the compiled-in ones: generated code does not depend on the fields. `stored`
 * are the rows with their pivots, HAIRLUT_STORED(columns, height) floats. */
#define HAIRLUT_AXIS(stored, columns_, height_, row_origin_, row_scale_, low_, high_, warp_, e_, f0_, k_, limit_)      \
    {                                                                                                                 \
        (stored) + HAIRLUT_PIVOTS, columns_, height_, HAIRLUT_STRIDE(columns_), HAIRLUT_STEP(columns_), warp_,        \
            row_origin_, row_scale_,                                                                                  \
            (float)((height_) - 1), low_, high_, e_, f0_, k_, 1.0f / (k_),                                            \
            (warp_) == HAIRLUT_WARP_QUARTIC ? 4.0f * (k_) : (k_), limit_                                              \
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
