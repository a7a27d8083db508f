/* SPDX-License-Identifier: BSD-3-Clause */
/* What a model is made of. Private to the library and to the generated file of compiled-in tables. */
#ifndef HAIRLUT_INTERNAL_H
#define HAIRLUT_INTERNAL_H

#include <float.h>
#include <stdint.h>

#include "hairlut.h"
#include "platform.h"

/* A stored table has two parts: rows, in which the cell of an angle is searched, and cells, from which samples and densities
 * are computed. Both repeat the last row, so that theta_r at the end of its range has a row above it.
 *
 * A stored row is groups of texels, which are the ends of parts of it: the number of those up to x is the part in which x lies. The
 * first group is the ends of blocks of `step` cells: its texel k is that of column (k+1)*step. Group g of those that follow is
 * the ends of cells, columns g*size+1 to (g+1)*size, where size is that of a group. HAIRLUT_NO_TEXEL takes the place of the
 * last column, the end of the domain, and of those beyond.
 *
 * A group fills a cache line: 16 texels, or in a small table 8 and their changes to the row above. Those make a search of one
 * row instead of two; in a large table they would crowd more out of the caches than they save. */
enum { HAIRLUT_GROUP = 16, HAIRLUT_SMALL_GROUP = HAIRLUT_GROUP / 2, HAIRLUT_LINE = 16 /* floats of a cache line */ };
#define HAIRLUT_NO_TEXEL FLT_MAX
enum { HAIRLUT_LEAST_WHOLE = 2, HAIRLUT_MOST_WHOLE = 5 /* groups of a row that is searched as a whole (axis.h) */ };
#define HAIRLUT_WHOLE(n, size) (((n) + (size) - 1) / (size) * (size))
/* Small: 9 blocks of 8 have all cells. Else a block is the least power of two, from 16 on, of which 17 blocks have them; a side
 * is at most 4096. */
#define HAIRLUT_SMALL_COLUMNS ((HAIRLUT_SMALL_GROUP + 1) * HAIRLUT_SMALL_GROUP + 1) /* at most */
#define HAIRLUT_IS_SMALL(columns) ((columns) <= HAIRLUT_SMALL_COLUMNS)
#define HAIRLUT_FITS(columns, step) ((columns) - 1 <= (HAIRLUT_GROUP + 1) * (step))
#define HAIRLUT_STEP(columns)                           \
    (HAIRLUT_IS_SMALL(columns)    ? HAIRLUT_SMALL_GROUP \
     : HAIRLUT_FITS(columns, 16)  ? 16                  \
     : HAIRLUT_FITS(columns, 32)  ? 32                  \
     : HAIRLUT_FITS(columns, 64)  ? 64                  \
     : HAIRLUT_FITS(columns, 128) ? 128                 \
                                  : 256)
#define HAIRLUT_GROUP_SIZE(columns) (HAIRLUT_IS_SMALL(columns) ? HAIRLUT_SMALL_GROUP : HAIRLUT_GROUP)
/* Floats of a row for each cell, of a row, and of all rows */
#define HAIRLUT_ROW_FLOATS(columns) (HAIRLUT_LINE / HAIRLUT_GROUP_SIZE(columns))
#define HAIRLUT_STRIDE(columns) \
    (HAIRLUT_LINE + HAIRLUT_ROW_FLOATS(columns) * HAIRLUT_WHOLE((columns) - 1, HAIRLUT_STEP(columns)))
#define HAIRLUT_STORED(columns, height) (HAIRLUT_STRIDE(columns) * ((height) + 1))

/* A cell of one row, seen from the end of the row that is nearer: x0, D0, w, D1, where x0 is the angle at its nearer end, w its
 * width, which blends without cancellation as two angles do not, and D0, D1 are h dx/dm at its ends, with m = min(u, 1-u) and h
 * the width of the cell in m. Counted from the high end w and D are negative. The cells stand in two halves, one from the low
 * end on and one from the high end on, so that a sample, whose place is counted from the nearer end, needs no mirroring; both
 * go one cell beyond u = 1/2. In a half, a cell's rows follow each other: the two that a sample blends are mostly in one cache
 * line. A cell is one load of 16 bytes.
 *
 * What depends on the column alone stands apart, once a table: u0, 1/h, h HAIRLUT_SCALE and 1 / (h HAIRLUT_SCALE), where u0 is
 * m at the nearer end.
 *
 * A slope D beyond HAIRLUT_STEEPEST times the cell's mean slope w, or below its reciprocal, counts as that bound: with cells of
 * 1e-12 rad side by side with others, the product of two axes' densities and of 1/cos at the pole stays a float. */
enum { HAIRLUT_CELL = 4, HAIRLUT_KNOT = 4 /* floats */ };
#define HAIRLUT_STEEPEST 4096.0f
#define HAIRLUT_SCALE 32768.0f
#define HAIRLUT_PITCH(height) (HAIRLUT_CELL * ((height) + 1)) /* floats from one cell of a row to the next */
#define HAIRLUT_HALF(columns) ((columns) / 2 + 1)             /* cells of a row */
#define HAIRLUT_CELLS(columns, height) (2 * HAIRLUT_HALF(columns) * HAIRLUT_PITCH(height))

#if defined(__GNUC__)
#define HAIRLUT_LINE_ALIGNED __attribute__((aligned(64)))
#elif defined(_MSC_VER)
#define HAIRLUT_LINE_ALIGNED __declspec(align(64))
#else
#define HAIRLUT_LINE_ALIGNED
#endif

/* gcc -O2 would call the longer functions and pass what they return through memory: a density takes 1.6 times as long. */
#if defined(__GNUC__)
#define HAIRLUT_INLINE static inline __attribute__((always_inline))
#elif defined(_MSC_VER)
#define HAIRLUT_INLINE static __forceinline
#else
#define HAIRLUT_INLINE static inline
#endif

/* A function that is not inlined: it is long and seldom called. */
#if defined(__GNUC__)
#define HAIRLUT_APART __attribute__((noinline))
#else
#define HAIRLUT_APART
#endif

/* Which way an `if` mostly goes: what seldom happens is laid out of the way. */
#if defined(__GNUC__)
#define HAIRLUT_MOSTLY(condition) __builtin_expect(!!(condition), 1)
#else
#define HAIRLUT_MOSTLY(condition) (condition)
#endif

/* Before a loop over single samples: less of it is counting. clang does so by itself. */
#if defined(__GNUC__) && !defined(__clang__)
#define HAIRLUT_UNROLLED _Pragma("GCC unroll 4")
#else
#define HAIRLUT_UNROLLED
#endif
/* Where a search goes on, for each cell counted from the low end: the offset of the cell's floats in row 0 from ends[0], seen
 * from the nearer end, and its h HAIRLUT_SCALE. */
typedef struct hairlut_link {
    unsigned offset;
    float h;
} hairlut_link;

/* A table ready for sampling. */
typedef struct hairlut_axis {
    const float *rows;    /* row 0; this, the cells and the knots begin at cache lines */
    const float *ends[2]; /* the first cells of row 0, from the low and from the high end on */
    const float *knots;   /* of a half: HAIRLUT_KNOT floats a column */
    const hairlut_link *links;
    int pitch;        /* floats from one cell of a row to the next */
    float row_origin; /* theta_r of row 0 */
    float row_scale;  /* rows per radian of theta_r */
    float row_last;   /* height - 1 */
    int warp;         /* hairlut_warp */
    float e;      /* octaves: the cell of m is the integer part of the folded column y scale - origin, with y the float */
    float scale;  /* whose bits are those of m + e shifted right by two; uniform: y = m */
    float origin; /* y scale at m = 0, rounded as when a sample is drawn, so that no column is below 0 */
    float low;    /* the domain */
    float high;
    int columns;
    int height;
    int stride; /* floats from one row to the next */
    int step;   /* cells of a block */
    int groups; /* of cells, in a row that may be searched as a whole; else 0 */
    int grid;   /* the same number in all axes of a model whose rows are of the same theta_r */
    int alike;  /* whether all rows of a node are the same, as where an azimuth does not depend on theta_r; 0: not known */
} hairlut_axis;

/* The bits of a float shifted right by two are those of F / 2^96, F as in warp.h. */
#define HAIRLUT_SHIFT_SCALE 79228162514264337593543950336.0f /* 2^96 */

/* A lobe ready for sampling. */
typedef struct hairlut_lobe {
    hairlut_axis theta;
    hairlut_axis phi; /* not used where the azimuth is uniform */
    int uniform;      /* whether it is */
    float sign;       /* of phi_r in the azimuth of its table: 1 in phi_i + phi_r, -1 in phi_i - phi_r */
    char name[HAIRLUT_NAME_SIZE];
} hairlut_lobe;

/* A mixture at one theta_r and offset. Of arrays of lobes, as many are set as the model has, rounded up to fours: of lobes that there
 * are not, the shares are 0. */
typedef struct hairlut_mix {
    float share[HAIRLUT_MAX_LOBES];  /* in a unit of their own */
    float weight[HAIRLUT_MAX_LOBES]; /* share / sum */
    float turn[HAIRLUT_MAX_LOBES];   /* from -pi to pi */
    int lobes[HAIRLUT_MAX_LOBES];    /* the numbers of those that have a weight */
    int count;                       /* and how many these are */
    float sum;                       /* of the shares; 0 where no density can be given */
    float side;                      /* -1 where the azimuth is mirrored, else 1 */
} hairlut_mix;

/* The nodes of an axis of a mixture or of a parameter, in one array: first all but the first and the last, by which a value is
 * searched, filled up to eights with HAIRLUT_NO_TEXEL; then for each its value, and 1 / (the next one's - its own), 0 at the last. */
typedef struct hairlut_nodes {
    const float *inner, *pairs;
    int count, eights; /* eights of inner ones */
    float last;
} hairlut_nodes;

/* Shares and turns of four lobes at a node of a mixture, side by side; a model of other than four has as many such as it needs.
 * Shares of a node sum to 1. A turn is in units of 2 pi / 2^32: the difference of two, modulo 2^32, is the shorter arc. */
typedef struct hairlut_four {
    float share[4];
    int32_t turn[4];
} hairlut_four;

/* The grid of a mixture. Those of node (j, o) are four_count fours from j*above + o*beside on; a node that is the only one of its axis
 * is its own neighbour: then the distance is 0. */
typedef struct hairlut_mixture {
    const hairlut_four *fours;
    hairlut_nodes theta_r, arc; /* the second: the asin of the nodes of the offset */
    int four_count;             /* lobes / 4, rounded up */
    int above, beside;          /* fours from a node to the next in theta_r, and in the offset */
    int mirrored;               /* whether -h mirrors h */
    int turned;                 /* whether any turn is not 0 */
    int turns_vary;             /* whether turns depend on parameters */
    int constant;               /* whether the mixture is the same everywhere, namely: */
    hairlut_mix mix;
} hairlut_mixture;

enum { HAIRLUT_MOST_TABLES = 2 * HAIRLUT_MAX_LOBES };

struct hairlut_model {
    int lobe_count;
    int direct; /* the number of the lobe "direct", or -1 */
    int multiple;
    const hairlut_lobe *lobes;
    int grid_count;                                 /* grids of rows */
    const hairlut_axis *grids[HAIRLUT_MOST_TABLES]; /* an axis of each, by its number */
    hairlut_mixture mixture;
    hairlut_allocator allocator; /* what hairlut_free gives the memory back to; zero for compiled-in models */
    const struct hairlut_strands
        *strands; /* strand.h; NULL: no parameters. All else is the model at their standard values */
};

typedef struct hairlut_builtin_entry {
    const char *name;
    hairlut_model model;
} hairlut_builtin_entry;

/* Defined by the generated file (runtime/tools/embed.c). */
extern const hairlut_builtin_entry hairlut_builtin_entries[];
extern const int hairlut_builtin_count;

#endif
