/* The kernels behind the _n functions. Private: tests and benchmarks reach it through the static library. */
#ifndef HAIRLUT_BATCH_H
#define HAIRLUT_BATCH_H

#include "hairlut.h"
#include "platform.h"

#if defined(HAIRLUT_X86)
#define HAIRLUT_BATCH_X86 1
#elif defined(HAIRLUT_ARM64)
#define HAIRLUT_BATCH_NEON 1
#endif

/* One set of kernels; each member is a function of hairlut.h. */
typedef struct hairlut_batch {
    const char *name;
    void (*sample_direct)(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                          const float *u_theta, const float *u_phi, hairlut_samples out);
    void (*sample_multiple)(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                            const float *u_theta, const float *u_phi, hairlut_samples out);
    void (*pdf_direct)(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                       const float *theta_i, const float *phi_i, float *pdf_angle);
    void (*pdf_multiple)(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                         const float *theta_i, const float *phi_i, float *pdf_angle);
} hairlut_batch;

/* Samples from s on */
static inline hairlut_samples hairlut_samples_from(hairlut_samples out, size_t s)
{
    const hairlut_samples rest = {out.theta_i + s, out.phi_i + s, out.pdf_angle ? out.pdf_angle + s : NULL,
                                  out.pdf_solid_angle ? out.pdf_solid_angle + s : NULL};
    return rest;
}

extern const hairlut_batch hairlut_batch_portable;
#ifdef HAIRLUT_BATCH_X86
extern const hairlut_batch hairlut_batch_avx2;
extern const hairlut_batch hairlut_batch_avx512;
#endif
#ifdef HAIRLUT_BATCH_NEON
extern const hairlut_batch hairlut_batch_neon;
#endif

/* The sets that this processor runs, narrowest first: index 0 is the portable one. NULL from the number of sets on. */
const hairlut_batch *hairlut_batch_level(int level);

/* The last of them: what the _n functions call. */
const hairlut_batch *hairlut_batch_widest(void);

#endif
