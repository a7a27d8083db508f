/* SPDX-License-Identifier: BSD-3-Clause */
/* The _n functions where no vector instructions are known: the one-direction forms in a loop. */
#include "batch.h"
#include "internal.h"
#include "viewer_one.h"

static void sample_lobe(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                        const float *u_theta, const float *u_phi, hairlut_samples out)
{
    for (size_t i = 0; i < n; ++i)
        hairlut_put(out, i, sample_lobe_one(model, lobe, theta_r[i], phi_r[i], u_theta[i], u_phi[i]));
}

static void pdf_lobe(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                     const float *theta_i, const float *phi_i, float *pdf_angle)
{
    for (size_t i = 0; i < n; ++i)
        pdf_angle[i] = pdf_lobe_one(model, lobe, theta_r[i], phi_r[i], theta_i[i], phi_i[i]);
}

static void sample_hair(const hairlut_model *model, size_t n, const float *shares, const float *theta_r, const float *phi_r,
                        const float *offset, const float *u_lobe, const float *u_theta, const float *u_phi,
                        hairlut_samples out)
{
    float own[HAIRLUT_MAX_LOBES];
    for (size_t i = 0; i < n; ++i)
        hairlut_put(out, i,
                    sample_hair_one(model, hairlut_gather(shares, model->lobe_count, n, i, own), theta_r[i], phi_r[i],
                                    offset ? offset[i] : 0.0f, u_lobe[i], u_theta[i], u_phi[i]));
}

static void pdf_hair(const hairlut_model *model, size_t n, const float *shares, const float *theta_r, const float *phi_r,
                     const float *offset, const float *theta_i, const float *phi_i, float *pdf_angle)
{
    float own[HAIRLUT_MAX_LOBES];
    for (size_t i = 0; i < n; ++i)
        pdf_angle[i] = pdf_hair_one(model, hairlut_gather(shares, model->lobe_count, n, i, own), theta_r[i], phi_r[i],
                                    offset ? offset[i] : 0.0f, theta_i[i], phi_i[i]);
}

static void sample_strand(const hairlut_model *model, size_t n, const float *parameters, const float *shares,
                          const float *theta_r, const float *phi_r, const float *offset, const float *u_lobe,
                          const float *u_theta, const float *u_phi, hairlut_samples out)
{
    float values[HAIRLUT_MAX_PARAMETERS], own[HAIRLUT_MAX_LOBES];
    for (size_t i = 0; i < n; ++i)
        hairlut_put(out, i,
                    sample_strand_one(model, hairlut_gather(parameters, model->strands->parameter_count, n, i, values),
                                      hairlut_gather(shares, model->lobe_count, n, i, own), theta_r[i], phi_r[i],
                                      offset ? offset[i] : 0.0f, u_lobe[i], u_theta[i], u_phi[i]));
}

static void pdf_strand(const hairlut_model *model, size_t n, const float *parameters, const float *shares,
                       const float *theta_r, const float *phi_r, const float *offset, const float *theta_i,
                       const float *phi_i, float *pdf_angle)
{
    float values[HAIRLUT_MAX_PARAMETERS], own[HAIRLUT_MAX_LOBES];
    for (size_t i = 0; i < n; ++i)
        pdf_angle[i] = pdf_strand_one(model, hairlut_gather(parameters, model->strands->parameter_count, n, i, values),
                                      hairlut_gather(shares, model->lobe_count, n, i, own), theta_r[i], phi_r[i],
                                      offset ? offset[i] : 0.0f, theta_i[i], phi_i[i]);
}

const hairlut_batch hairlut_batch_portable = {"portable",  HAIRLUT_ONE, sample_lobe,   pdf_lobe,
                                              sample_hair, pdf_hair,    sample_strand, pdf_strand};
