/* SPDX-License-Identifier: BSD-3-Clause */
/* Samples of a block sorted by the lobes that they draw, and back, a vector at a time: the lanes that draw a lobe are brought to the
 * front of a vector, which is stored behind those of the vectors before. */
#ifndef HAIRLUT_BATCH_SORT_H
#define HAIRLUT_BATCH_SORT_H

#include "batch_axis.h"

enum { VECTORS = BLOCK / LANES };

/* Lobe k's range of sorted samples is first[k] .. first[k+1]-1. Those of vector v are the lanes whose bits are set, and stand from
 * at[k][v] on. Of arrays of lobes, as many are set as the model has. */
typedef struct sorting {
    size_t first[HAIRLUT_MAX_LOBES + 1];
    int at[HAIRLUT_MAX_LOBES][VECTORS];
    unsigned short lanes[HAIRLUT_MAX_LOBES][VECTORS];
} sorting;

static inline void sort_by_lobe(int lobe_count, size_t n, const int *chosen, sorting *sorted)
{
    int count = 0;
    for (int k = 0; k < lobe_count; ++k) {
        sorted->first[k] = (size_t)count;
        for (size_t v = 0; v < n / LANES; ++v) {
            const int lanes = lanes_of(iequal(iload(chosen + v * LANES), iall(k)));
            sorted->lanes[k][v] = (unsigned short)lanes;
            sorted->at[k][v] = count;
            count += how_many(lanes);
        }
    }
    sorted->first[lobe_count] = (size_t)count;
}

static inline int draws_any(const sorting *sorted, int k)
{
    return sorted->first[k] < sorted->first[k + 1];
}

/* `count` arrays, which is to be a constant. What a vector writes beyond its lobe's range, the next lobe writes again; a vector
 * beyond the end is 0. */
HAIRLUT_INLINE void sort_arrays(const sorting *sorted, int lobe_count, size_t n, int count, const float *const *from,
                                float *const *to)
{
    for (int k = 0; k < lobe_count; ++k)
        for (size_t v = 0; draws_any(sorted, k) && v < n / LANES; ++v) {
            const permutation to_front = to_the_front(sorted->lanes[k][v]);
            for (int a = 0; a < count; ++a)
                store(to[a] + sorted->at[k][v], permuted(load(from[a] + v * LANES), to_front));
        }
    for (int a = 0; a < count; ++a)
        store(to[a] + n, all(0.0f));
}

static inline void sort_array(const sorting *sorted, int lobe_count, size_t n, const float *from, float *to)
{
    sort_arrays(sorted, lobe_count, n, 1, &from, &to);
}

static inline void sort_in_place(const sorting *sorted, int lobe_count, size_t n, float *values)
{
    float kept[BLOCK];
    for (size_t s = 0; s < n; s += LANES)
        store(kept + s, load(values + s));
    sort_array(sorted, lobe_count, n, kept, values);
}

/* Vector v of `count` arrays as it was before they were sorted; `count` is to be a constant. */
HAIRLUT_INLINE void unsorted(const sorting *sorted, int lobe_count, const int *chosen, size_t v, int count,
                             const float *const *from, real *to)
{
    for (int a = 0; a < count; ++a)
        to[a] = all(0.0f);
    for (int k = 0; k < lobe_count; ++k) {
        if (!draws_any(sorted, k))
            continue;
        const mask here = iequal(iload(chosen + v * LANES), iall(k));
        const permutation from_front = from_the_front(sorted->lanes[k][v]);
        for (int a = 0; a < count; ++a)
            to[a] = choose(here, permuted(load(from[a] + sorted->at[k][v]), from_front), to[a]);
    }
}

#endif
