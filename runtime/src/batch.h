/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernels behind the _n functions. Private: tests and benchmarks reach it through the static library. */
#ifndef HAIRLUT_BATCH_H
#define HAIRLUT_BATCH_H

#include "cpu.h"
#include "hairlut.h"
#include "platform.h"

#if defined(HAIRLUT_X86)
#define HAIRLUT_BATCH_X86 1
#elif defined(HAIRLUT_ARM64)
#define HAIRLUT_BATCH_NEON 1
#endif

struct hairlut_view; /* viewer.h */

/* Those of a set of kernels for one direction. A model has the lobe. */
typedef struct hairlut_one {
    hairlut_sample (*sample_lobe)(const hairlut_model *model, int lobe, float theta_r, float phi_r, float u_theta,
                                  float u_phi);
    float (*pdf_lobe)(const hairlut_model *model, int lobe, float theta_r, float phi_r, float theta_i, float phi_i);
    hairlut_sample (*sample_hair)(const hairlut_model *model, const float *shares, float theta_r, float phi_r, float offset,
                                  float u_lobe, float u_theta, float u_phi);
    float (*pdf_hair)(const hairlut_model *model, const float *shares, float theta_r, float phi_r, float offset,
                      float theta_i, float phi_i);
    /* of a model over parameters, which are not NULL */
    hairlut_sample (*sample_strand)(const hairlut_model *model, const float *parameters, const float *shares, float theta_r,
                                    float phi_r, float offset, float u_lobe, float u_theta, float u_phi);
    float (*pdf_strand)(const hairlut_model *model, const float *parameters, const float *shares, float theta_r, float phi_r,
                        float offset, float theta_i, float phi_i);
    /* of viewers; parameters: NULL, or those of a model that has any */
    void (*view)(struct hairlut_view *view, const hairlut_model *model, const float *parameters, const float *shares,
                 float theta_r, float phi_r, float offset);
    hairlut_sample (*sample_view)(const struct hairlut_view *view, float u_lobe, float u_theta, float u_phi);
    float (*pdf_view)(const struct hairlut_view *view, float theta_i, float phi_i);
} hairlut_one;

/* One set of kernels; each member is a function of hairlut.h. */
typedef struct hairlut_batch {
    const char *name;
    hairlut_one one;
    void (*sample_lobe)(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                        const float *u_theta, const float *u_phi, hairlut_samples out);
    void (*pdf_lobe)(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                     const float *theta_i, const float *phi_i, float *pdf_angle);
    void (*sample_hair)(const hairlut_model *model, size_t n, const float *shares, const float *theta_r, const float *phi_r,
                        const float *offset, const float *u_lobe, const float *u_theta, const float *u_phi,
                        hairlut_samples out);
    void (*pdf_hair)(const hairlut_model *model, size_t n, const float *shares, const float *theta_r, const float *phi_r,
                     const float *offset, const float *theta_i, const float *phi_i, float *pdf_angle);
    /* of a model over parameters, which are not NULL */
    void (*sample_strand)(const hairlut_model *model, size_t n, const float *parameters, const float *shares,
                          const float *theta_r, const float *phi_r, const float *offset, const float *u_lobe,
                          const float *u_theta, const float *u_phi, hairlut_samples out);
    void (*pdf_strand)(const hairlut_model *model, size_t n, const float *parameters, const float *shares,
                       const float *theta_r, const float *phi_r, const float *offset, const float *theta_i,
                       const float *phi_i, float *pdf_angle);
} hairlut_batch;

/* Stores sample i of an array. */
static inline void hairlut_put(hairlut_samples out, size_t i, hairlut_sample s)
{
    out.theta_i[i] = s.theta_i;
    out.phi_i[i] = s.phi_i;
    if (out.pdf_angle)
        out.pdf_angle[i] = s.pdf_angle;
    if (out.pdf_solid_angle)
        out.pdf_solid_angle[i] = s.pdf_solid_angle;
}

/* Sample i's numbers, one of each of `count` arrays of n; NULL for NULL. */
static inline const float *hairlut_gather(const float *values, int count, size_t n, size_t i, float *own)
{
    for (int k = 0; values && k < count; ++k)
        own[k] = values[(size_t)k * n + i];
    return values ? own : NULL;
}

extern const hairlut_batch hairlut_batch_portable;
#ifdef HAIRLUT_BATCH_X86
extern const hairlut_batch hairlut_batch_avx2;
extern const hairlut_batch hairlut_batch_avx512;
#endif
#ifdef HAIRLUT_BATCH_NEON
extern const hairlut_batch hairlut_batch_neon;
#endif

/* The set whose functions for one direction those of hairlut.h call. */
static inline const hairlut_batch *hairlut_best_kernels(void)
{
#if defined(HAIRLUT_BATCH_X86)
    const hairlut_cpu cpu = hairlut_this_cpu();
    return cpu == HAIRLUT_CPU_AVX512 ? &hairlut_batch_avx512
           : cpu == HAIRLUT_CPU_AVX2 ? &hairlut_batch_avx2
                                     : &hairlut_batch_portable;
#elif defined(HAIRLUT_BATCH_NEON)
    return &hairlut_batch_neon;
#else
    return &hairlut_batch_portable;
#endif
}

/* The sets that this processor runs, narrowest first: index 0 is the portable one. NULL from the number of sets on. */
const hairlut_batch *hairlut_batch_level(int level);

/* The last of them: what the _n functions call. */
const hairlut_batch *hairlut_batch_widest(void);

#endif
