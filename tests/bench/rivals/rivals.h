/* SPDX-License-Identifier: BSD-3-Clause
 * What a renderer would use instead of tables: whole calls over arrays. A rival that is timed "one" at a time, or "native",
 * makes one call of a function that is not inlined for each sample, as a renderer does; one timed over "arrays" leaves the loop to
 * the compiler. All take angles and return angles, as hairlut does. */
#ifndef RIVALS_H
#define RIVALS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* n numbers in each array. The models that have no offsets do not read `offset`. */
typedef struct rival_arrays {
    size_t n;
    const float *theta_r, *phi_r, *offset; /* the viewer direction; where the fibre is hit */
    const float *u_lobe, *u_theta, *u_phi; /* random numbers in [0, 1) */
    const float *theta_light, *phi_light;  /* a direction that another strategy drew */
    float *theta_i, *phi_i;                /* the sample */
    float *pdf_angle, *pdf_solid_angle;    /* its densities, per rad^2 and per steradian */
    float *pdf_light;                      /* density of (theta_light, phi_light), per rad^2 */
} rival_arrays;

typedef void rival_call(const rival_arrays *);

/* The calls that a rival offers; NULL for the others. */
typedef struct rival {
    const char *model; /* whose lobes: "fitted" or "brown" */
    const char *name;
    const char *how; /* "one", "native", or "arrays" with the width of vectors that the compiler prefers */
    rival_call *sample_direct, *pdf_direct, *sample_multiple, *pdf_multiple;
    rival_call *sample_hair, *pdf_hair; /* the mixture of all lobes */
    rival_call *vertex;                 /* sample_hair and pdf_hair of the light's direction, in one loop */
    rival_call *
        hit; /* sample_hair and the sum of pdf_hair of four lights' directions, i's and the next, what they share computed once */
} rival;

/* The rivals of this build that this processor runs; NULL past the last. */
const rival *rival_at(int index);

#ifdef __cplusplus
}
#endif

#endif
