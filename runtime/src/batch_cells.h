/* The cells of a block of samples or directions: searched for, read and blended. What batch_kernel.h computes with. */
#ifndef HAIRLUT_BATCH_CELLS_H
#define HAIRLUT_BATCH_CELLS_H

#include "axis.h"
#include "batch.h"

enum { BLOCK = 256 }; /* samples a pass */

/* Before a loop over single samples: less of it is counting. clang does so by itself. */
#if defined(__GNUC__) && !defined(__clang__)
#define HAIRLUT_UNROLLED _Pragma("GCC unroll 4")
#else
#define HAIRLUT_UNROLLED
#endif

#ifndef HAIRLUT_COUNT
#define HAIRLUT_COUNT hairlut_count
#endif

/* The samples of a block on an axis. What a pass no longer needs makes room for what it finds: all of it is to stay in the
 * first-level cache, beside the table. */
typedef struct draws {
    int at[BLOCK];   /* the offset of the cell */
    float t[BLOCK];  /* the weight of the row above; from fetch on: the blended cell's c */
    float m[BLOCK];  /* of hairlut_knot; from fetch on: the distance d from the cell's knot */
    float x0[BLOCK]; /* of the blended cell; from store_samples on: the angle as it was drawn */
    float a[BLOCK];  /* of the blended cell; from store_samples on: the density */
} draws;

/* The directions of a block on an axis; here, too, what is found takes the place of what is no longer needed. */
typedef struct queries {
    int j[BLOCK];    /* the row */
    int cell[BLOCK]; /* as far as it is found, counted from the low end */
    int at[BLOCK];   /* where to read on: an offset among the rows, then among the cells */
    float t[BLOCK];  /* the weight of the row above; from read_cells on: the blended cell's c */
    float x[BLOCK];  /* the angle; from read_cells on: less the blended cell's x0 */
    float a[BLOCK];  /* of the blended cell */
} queries;

/* The offset of cell i, counted from an end, of row j. */
static inline whole cell_offset(const hairlut_axis *axis, whole j, whole i, mask high)
{
    const whole cell = imul(i, iall(axis->pitch));
    const whole half = iwhere(high, iall((int)(axis->ends[1] - axis->ends[0])));
    return iadd(iadd(cell, half), imul(j, iall(HAIRLUT_CELL)));
}

/* hairlut_count, of n samples in groups of `size`, which is to be a constant; `groups` are those of row 0 */
HAIRLUT_INLINE void count(const hairlut_axis *axis, const float *groups, size_t n, const queries *q, int size, int *counts)
{
    const float *above = groups + (size == HAIRLUT_SMALL_GROUP ? HAIRLUT_SMALL_GROUP : axis->stride);
#ifdef HAIRLUT_COUNTS
    for (size_t s = 0; s < n; s += LANES)
        istore(counts + s, HAIRLUT_COUNTS(groups, above, q->at + s, q->t + s, q->x + s, size));
#else
    HAIRLUT_UNROLLED
    for (size_t k = 0; k < n; ++k)
        counts[k] = HAIRLUT_COUNT(groups + q->at[k], above + q->at[k], q->t[k], q->x[k], size);
#endif
}

/* hairlut_axis_ask with groups of `size`: the first cell of the block, and the offset of its first group */
HAIRLUT_INLINE void find_blocks(const hairlut_axis *axis, size_t n, queries *q, int size)
{
    const int step = axis->step, floats = HAIRLUT_LINE / size * step; /* of a block */
    count(axis, axis->rows, n, q, size, q->cell);
    for (size_t s = 0; s < n; s += LANES) {
        const whole block = iload(q->cell + s);
        istore(q->cell + s, imul(block, iall(step)));
        istore(q->at + s, iadd(iload(q->at + s), imul(block, iall(floats))));
    }
}

/* hairlut_halve */
static inline void halve_blocks(const hairlut_axis *axis, size_t n, queries *q)
{
    const float *groups = axis->rows + HAIRLUT_LINE;
    for (size_t k = 0; axis->step > HAIRLUT_GROUP && k < n; ++k) {
        const int halved = hairlut_halve(groups + q->at[k], axis->stride, q->t[k], q->x[k], axis->step);
        q->cell[k] += halved;
        q->at[k] += halved;
    }
}

/* hairlut_axis_found, but for the cell itself */
static inline void turn_to_nearer_end(const hairlut_axis *axis, whole found, queries *q, size_t s)
{
    const whole mirrored = isub(iall(axis->columns - 2), found);
    istore(q->at + s, cell_offset(axis, iload(q->j + s), ismaller(found, mirrored), igreater(found, mirrored)));
}

/* hairlut_axis_find from the count on, and where to read the cell. */
HAIRLUT_INLINE void find_in_groups(const hairlut_axis *axis, size_t n, queries *q, int size)
{
    int counts[BLOCK];
    count(axis, axis->rows + HAIRLUT_LINE, n, q, size, counts);
    for (size_t s = 0; s < n; s += LANES)
        turn_to_nearer_end(axis, iadd(iload(q->cell + s), iload(counts + s)), q, s);
}

static inline void search_large(const hairlut_axis *axis, size_t n, queries *q)
{
    find_blocks(axis, n, q, HAIRLUT_GROUP);
    halve_blocks(axis, n, q);
    find_in_groups(axis, n, q, HAIRLUT_GROUP);
}

/* Three passes that sort what they load for single samples gain nothing from more than eight lanes (tests/bench/NOTES.md): the
 * kernels in AVX-512, whose processors all have AVX2, call those in AVX2. */
#ifdef HAIRLUT_BATCH_X86
void hairlut_fetch_avx2(const hairlut_axis *axis, size_t n, draws *q);
void hairlut_search_small_avx2(const hairlut_axis *axis, size_t n, queries *q);
void hairlut_read_cells_avx2(const hairlut_axis *axis, size_t n, queries *q);
#endif

#ifdef HAIRLUT_CELLS_BY_AVX2
#define fetch hairlut_fetch_avx2
#define search_small hairlut_search_small_avx2
#define read_cells hairlut_read_cells_avx2
#else
typedef struct cells {
    real x0, a, c, u0;
} cells;

/* hairlut_axis_cell */
static inline cells load_cells(const hairlut_axis *axis, const int *at, real t)
{
    real p[HAIRLUT_CELL], q[HAIRLUT_CELL];
    gather4(axis->ends[0], at, p);
    gather4(axis->ends[0] + HAIRLUT_CELL, at, q);
    const real s = sub(all(1.0f), t);
    const cells cell = {add(mul(s, p[0]), mul(t, q[0])), add(mul(s, p[1]), mul(t, q[1])), add(mul(s, p[2]), mul(t, q[2])), p[3]};
    return cell;
}

/* Of samples that are placed: the blended cells, and the distances from their knots. */
static inline void fetch(const hairlut_axis *axis, size_t n, draws *q)
{
    for (size_t s = 0; s < n; s += LANES) {
        const cells cell = load_cells(axis, q->at + s, load(q->t + s));
        store(q->t + s, cell.c);
        store(q->m + s, sub(load(q->m + s), cell.u0));
        store(q->x0 + s, cell.x0);
        store(q->a + s, cell.a);
    }
}

static inline void search_small(const hairlut_axis *axis, size_t n, queries *q)
{
    find_blocks(axis, n, q, HAIRLUT_SMALL_GROUP);
    find_in_groups(axis, n, q, HAIRLUT_SMALL_GROUP);
}

/* Of directions that were searched for: the blended cells, and the distances from where those begin. */
static inline void read_cells(const hairlut_axis *axis, size_t n, queries *q)
{
    for (size_t s = 0; s < n; s += LANES) {
        const cells cell = load_cells(axis, q->at + s, load(q->t + s));
        store(q->t + s, cell.c);
        store(q->x + s, sub(load(q->x + s), cell.x0));
        store(q->a + s, cell.a);
    }
}
#endif

/* hairlut_axis_look_up and hairlut_axis_found */
static inline void find_cells(const hairlut_axis *axis, size_t n, queries *q)
{
    if (HAIRLUT_IS_SMALL(axis->columns))
        search_small(axis, n, q);
    else
        search_large(axis, n, q);
    read_cells(axis, n, q);
}

#endif
