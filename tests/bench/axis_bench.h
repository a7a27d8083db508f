/* One axis of a model over arrays of n: what the public functions do twice, so that it compares with a rival that samples
 * one lobe in one angle. */
#ifndef AXIS_BENCH_H
#define AXIS_BENCH_H

#include "internal.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct axis_kernels {
    const char *name;
    void (*sample)(const hairlut_axis *axis, size_t n, const float *theta_r, const float *u, float *x, float *pdf);
    void (*pdf)(const hairlut_axis *axis, size_t n, const float *theta_r, const float *x, float *pdf);
    /* the floor: corners of given cells, and of the cells of theta_r and u; NULL where there is none */
    void (*floor_index)(const float *cells, size_t n, const int *index, float *corners);
    void (*floor_angles)(const hairlut_axis *axis, const float *cells, size_t n, const float *theta_r, const float *u,
                         float *corners);
} axis_kernels;

extern const axis_kernels axis_scalar;
#if defined(__x86_64__) || defined(__i386__)
extern const axis_kernels axis_avx2;
extern const axis_kernels axis_avx512;
#elif defined(__aarch64__)
extern const axis_kernels axis_neon;
#endif

#ifdef __cplusplus
}
#endif

#endif
