/* SPDX-License-Identifier: BSD-3-Clause */
/* What these cells cost at least, one direction at a time: calls on luts/fitted written for its three tables alone, with AVX2. */
#ifndef BENCH_FLOOR_H
#define BENCH_FLOOR_H

#include "hairlut.h"

#ifdef __cplusplus
extern "C" {
#endif

/* hairlut_sample_hair, hairlut_pdf_hair and hairlut_pdf_direct of `fitted`, the same bits, for numbers that are not NaN */
typedef struct bench_floor {
    hairlut_sample (*sample)(float theta_r, float phi_r, float u_lobe, float u_theta, float u_phi);
    float (*pdf)(float theta_r, float phi_r, float theta_i, float phi_i);
    float (*pdf_direct)(float theta_r, float phi_r, float theta_i, float phi_i);
} bench_floor;

/* NULL where the processor has no AVX2, or the model is not of the kind that it is written for. */
const bench_floor *bench_floor_of(const hairlut_model *model);

#ifdef __cplusplus
}
#endif

#endif
