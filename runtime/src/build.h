/* SPDX-License-Identifier: BSD-3-Clause */
/* How descriptors become a model: the parts of hairlut_model_create. */
#ifndef HAIRLUT_BUILD_H
#define HAIRLUT_BUILD_H

#include "internal.h"
#include "message.h"

/* NaN is in no range */
static inline int hairlut_within(float low, float high, float bound_low, float bound_high)
{
    return low >= bound_low && low < high && high <= bound_high;
}

/* A descriptor of `size` bytes, where this library knows `known`. */
static inline hairlut_result hairlut_check_size(const char *type, size_t size, size_t known, char *message)
{
    if (size == known)
        return HAIRLUT_OK;
    return hairlut_fail(size > known ? HAIRLUT_ERROR_VERSION : HAIRLUT_ERROR_ARGUMENT, message,
                        "size of a %s is %zu: expected sizeof(%s), which is %zu in hairlut %d.%d", type, size, type, known,
                        HAIRLUT_VERSION_MAJOR, HAIRLUT_VERSION_MINOR);
}

/* Floats that a table takes in a model: whole cache lines. */
size_t hairlut_table_floats(const hairlut_table *table);

/* Fills an axis, whose arrays go to `memory`, of so many floats; returns the end of what it filled. The table is valid. */
float *hairlut_build_axis(hairlut_axis *axis, const hairlut_table *table, float *memory);

/* Names are for messages: "lobe 1 ('multiple')". desc may be NULL: equal shares, no turns. */
hairlut_result hairlut_validate_mixture(const hairlut_mixture_desc *desc, int lobe_count, char *message);
size_t hairlut_mixture_floats(const hairlut_mixture_desc *desc, int lobe_count);
void hairlut_build_mixture(hairlut_mixture *mixture, const hairlut_mixture_desc *desc, int lobe_count, float *memory);

#endif
