/* The _n functions where no vector instructions are known: the one-direction forms in a loop. */
#include "batch.h"

typedef hairlut_sample (*sampler)(const hairlut_model *, float, float, float, float);
typedef float (*density)(const hairlut_model *, float, float, float, float);

static void sample_all(sampler draw, const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                       const float *u_theta, const float *u_phi, hairlut_samples out)
{
    for (size_t i = 0; i < n; ++i) {
        const hairlut_sample s = draw(model, theta_r[i], phi_r[i], u_theta[i], u_phi[i]);
        out.theta_i[i] = s.theta_i;
        out.phi_i[i] = s.phi_i;
        if (out.pdf_angle)
            out.pdf_angle[i] = s.pdf_angle;
        if (out.pdf_solid_angle)
            out.pdf_solid_angle[i] = s.pdf_solid_angle;
    }
}

static void pdf_all(density pdf, const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                    const float *theta_i, const float *phi_i, float *pdf_angle)
{
    for (size_t i = 0; i < n; ++i)
        pdf_angle[i] = pdf(model, theta_r[i], phi_r[i], theta_i[i], phi_i[i]);
}

static void sample_direct(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                          const float *u_theta, const float *u_phi, hairlut_samples out)
{
    sample_all(hairlut_sample_direct, model, n, theta_r, phi_r, u_theta, u_phi, out);
}

static void sample_multiple(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                            const float *u_theta, const float *u_phi, hairlut_samples out)
{
    sample_all(hairlut_sample_multiple, model, n, theta_r, phi_r, u_theta, u_phi, out);
}

static void pdf_direct(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                       const float *theta_i, const float *phi_i, float *pdf_angle)
{
    pdf_all(hairlut_pdf_direct, model, n, theta_r, phi_r, theta_i, phi_i, pdf_angle);
}

static void pdf_multiple(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                         const float *theta_i, const float *phi_i, float *pdf_angle)
{
    pdf_all(hairlut_pdf_multiple, model, n, theta_r, phi_r, theta_i, phi_i, pdf_angle);
}

const hairlut_batch hairlut_batch_portable = {"portable", sample_direct, sample_multiple, pdf_direct, pdf_multiple};
