/* The mixture of both lobes for many directions, put together from the _n functions of each lobe. */
#include "batch.h"
#include "lobes.h"

enum { BLOCK = 128 };

/* Whether the direct lobe is drawn from; writes its clamped weight. */
static int draws_direct(float direct_weight, float u_lobe, float *w)
{
    *w = hairlut_clamp(direct_weight, 0.0f, 1.0f);
    return u_lobe < *w;
}

static void sample_block(const hairlut_model *model, size_t n, const float *direct_weight, const float *theta_r,
                         const float *phi_r, const float *u_lobe, const float *u_theta, const float *u_phi,
                         hairlut_samples out)
{
    float theta[2][BLOCK], phi[2][BLOCK], drawn[2][BLOCK], asked[2][BLOCK];
    const hairlut_samples direct = {theta[0], phi[0], drawn[0], NULL}, multiple = {theta[1], phi[1], drawn[1], NULL};
    hairlut_sample_direct_n(model, n, theta_r, phi_r, u_theta, u_phi, direct);
    hairlut_sample_multiple_n(model, n, theta_r, phi_r, u_theta, u_phi, multiple);
    for (size_t k = 0; k < n; ++k) {
        float w;
        if (draws_direct(direct_weight[k], u_lobe[k], &w)) {
            theta[1][k] = theta[0][k];
            phi[1][k] = phi[0][k];
        }
    }
    hairlut_pdf_direct_n(model, n, theta_r, phi_r, theta[1], phi[1], asked[0]);
    hairlut_pdf_multiple_n(model, n, theta_r, phi_r, theta[1], phi[1], asked[1]);
    for (size_t k = 0; k < n; ++k) {
        float w;
        const int is_direct = draws_direct(direct_weight[k], u_lobe[k], &w);
        const int known = direct_weight[k] == direct_weight[k] && u_lobe[k] == u_lobe[k]
                          && hairlut_known(theta_r[k], phi_r[k], u_theta[k], u_phi[k]);
        const float mixed = hairlut_mix(w, is_direct ? drawn[0][k] : asked[0][k], is_direct ? asked[1][k] : drawn[1][k]);
        const float pdf = known ? mixed : 0.0f;
        out.theta_i[k] = theta[1][k];
        out.phi_i[k] = phi[1][k];
        if (out.pdf_angle)
            out.pdf_angle[k] = pdf;
        if (out.pdf_solid_angle)
            out.pdf_solid_angle[k] = pdf / hairlut_cos(theta[1][k]);
    }
}

void hairlut_sample_mixture_n(const hairlut_model *model, size_t n, const float *direct_weight, const float *theta_r,
                              const float *phi_r, const float *u_lobe, const float *u_theta, const float *u_phi,
                              hairlut_samples out)
{
    for (size_t s = 0; s < n; s += BLOCK)
        sample_block(model, n - s < BLOCK ? n - s : BLOCK, direct_weight + s, theta_r + s, phi_r + s, u_lobe + s,
                     u_theta + s, u_phi + s, hairlut_samples_from(out, s));
}

void hairlut_pdf_mixture_n(const hairlut_model *model, size_t n, const float *direct_weight, const float *theta_r,
                           const float *phi_r, const float *theta_i, const float *phi_i, float *pdf_angle)
{
    for (size_t s = 0; s < n; s += BLOCK) {
        const size_t m = n - s < BLOCK ? n - s : BLOCK;
        float direct[BLOCK], multiple[BLOCK];
        hairlut_pdf_direct_n(model, m, theta_r + s, phi_r + s, theta_i + s, phi_i + s, direct);
        hairlut_pdf_multiple_n(model, m, theta_r + s, phi_r + s, theta_i + s, phi_i + s, multiple);
        for (size_t k = 0; k < m; ++k) {
            const float mixed = hairlut_mix(hairlut_clamp(direct_weight[s + k], 0.0f, 1.0f), direct[k], multiple[k]);
            pdf_angle[s + k] = direct_weight[s + k] == direct_weight[s + k] ? mixed : 0.0f;
        }
    }
}
