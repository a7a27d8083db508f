/* SPDX-License-Identifier: BSD-3-Clause */
/* What each warp of the study costs by itself: u to the coordinate whose integer part is a cell, over arrays
 * of n. */
#ifndef BENCH_WARPS_H
#define BENCH_WARPS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bench_warp {
    const char *name;
    void (*map)(size_t n, const float *u, float *s);
} bench_warp;

enum { BENCH_WARPS = 8 };
extern const bench_warp bench_warps_scalar[BENCH_WARPS]; /* the library's flags, one call of a function a sample */
extern const bench_warp bench_warps_vector[BENCH_WARPS]; /* the compiler's fastest flags over arrays */

#ifdef __cplusplus
}
#endif

#endif
