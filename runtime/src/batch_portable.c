/* SPDX-License-Identifier: BSD-3-Clause */
/* The _n functions where no vector instructions are known: the one-direction forms in a loop. */
#include "batch.h"
#include "internal.h"

static void put(hairlut_samples out, size_t i, hairlut_sample s)
{
    out.theta_i[i] = s.theta_i;
    out.phi_i[i] = s.phi_i;
    if (out.pdf_angle)
        out.pdf_angle[i] = s.pdf_angle;
    if (out.pdf_solid_angle)
        out.pdf_solid_angle[i] = s.pdf_solid_angle;
}

/* Sample i's shares, one number a lobe; NULL for the model's own. */
static const float *gather(const hairlut_model *model, const float *shares, size_t n, size_t i, float *own)
{
    for (int k = 0; shares && k < model->lobe_count; ++k)
        own[k] = shares[(size_t)k * n + i];
    return shares ? own : NULL;
}

static void sample_lobe(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                        const float *u_theta, const float *u_phi, hairlut_samples out)
{
    for (size_t i = 0; i < n; ++i)
        put(out, i, hairlut_sample_lobe(model, lobe, theta_r[i], phi_r[i], u_theta[i], u_phi[i]));
}

static void pdf_lobe(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                     const float *theta_i, const float *phi_i, float *pdf_angle)
{
    for (size_t i = 0; i < n; ++i)
        pdf_angle[i] = hairlut_pdf_lobe(model, lobe, theta_r[i], phi_r[i], theta_i[i], phi_i[i]);
}

static void sample_hair(const hairlut_model *model, size_t n, const float *shares, const float *theta_r, const float *phi_r,
                        const float *offset, const float *u_lobe, const float *u_theta, const float *u_phi,
                        hairlut_samples out)
{
    float own[HAIRLUT_MAX_LOBES];
    for (size_t i = 0; i < n; ++i)
        put(out, i,
            hairlut_sample_hair(model, gather(model, shares, n, i, own), theta_r[i], phi_r[i], offset ? offset[i] : 0.0f,
                                u_lobe[i], u_theta[i], u_phi[i]));
}

static void pdf_hair(const hairlut_model *model, size_t n, const float *shares, const float *theta_r, const float *phi_r,
                     const float *offset, const float *theta_i, const float *phi_i, float *pdf_angle)
{
    float own[HAIRLUT_MAX_LOBES];
    for (size_t i = 0; i < n; ++i)
        pdf_angle[i] = hairlut_pdf_hair(model, gather(model, shares, n, i, own), theta_r[i], phi_r[i],
                                        offset ? offset[i] : 0.0f, theta_i[i], phi_i[i]);
}

const hairlut_batch hairlut_batch_portable = {"portable", sample_lobe, pdf_lobe, sample_hair, pdf_hair};
