/* What must hold of every model that was accepted, whatever it was made of. */
#ifndef CHECK_H
#define CHECK_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "hairlut.h"

#define REQUIRE(condition)                                                                                            \
    do {                                                                                                              \
        if (!(condition)) {                                                                                           \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);                                           \
            abort();                                                                                                  \
        }                                                                                                             \
    } while (0)

/* What a draw is made from. shares: NULL, or a number a lobe. */
typedef struct draw_inputs {
    const float *shares;
    float theta_r, phi_r, offset, u_lobe, u_theta, u_phi;
} draw_inputs;

static inline void check_sample(hairlut_sample s, int has_density)
{
    REQUIRE(fabsf(s.theta_i) <= 1.57079637f);
    REQUIRE(s.phi_i >= -3.14159274f && s.phi_i < 3.14159274f);
    REQUIRE(isfinite(s.pdf_angle) && isfinite(s.pdf_solid_angle) && s.pdf_angle >= 0.0f && s.pdf_solid_angle >= 0.0f);
    REQUIRE((s.pdf_angle > 0.0f) == has_density);
}

static inline int is_known(const draw_inputs *in)
{
    return in->theta_r == in->theta_r && isfinite(in->phi_r) && in->u_theta == in->u_theta && in->u_phi == in->u_phi;
}

static inline void check_lobe(const hairlut_model *model, int lobe, const draw_inputs *in)
{
    float u[2];
    const int exists = lobe >= 0 && lobe < hairlut_lobe_count(model);
    const hairlut_sample s = hairlut_sample_lobe(model, lobe, in->theta_r, in->phi_r, in->u_theta, in->u_phi);
    const float pdf = hairlut_pdf_lobe(model, lobe, in->theta_r, in->phi_r, s.theta_i, s.phi_i);
    check_sample(s, exists && is_known(in));
    REQUIRE(isfinite(pdf) && (pdf > 0.0f) == (s.pdf_angle > 0.0f || (exists && in->theta_r == in->theta_r && isfinite(in->phi_r))));
    hairlut_invert_lobe(model, lobe, in->theta_r, in->phi_r, s.theta_i, s.phi_i, u);
    REQUIRE(u[0] >= 0.0f && u[0] <= 1.0f && u[1] >= 0.0f && u[1] <= 1.0f);
}

/* Whether shares give a density: finite, and one above 0. */
static inline int are_shares(const hairlut_model *model, const float *shares)
{
    int some = !shares;
    for (int k = 0; shares && k < hairlut_lobe_count(model); ++k) {
        if (!isfinite(shares[k]))
            return 0;
        some |= shares[k] > 0.0f;
    }
    return some;
}

static inline void check_hair(const hairlut_model *model, const draw_inputs *in)
{
    const hairlut_sample s = hairlut_sample_hair(model, in->shares, in->theta_r, in->phi_r, in->offset, in->u_lobe, in->u_theta, in->u_phi);
    const float pdf = hairlut_pdf_hair(model, in->shares, in->theta_r, in->phi_r, in->offset, s.theta_i, s.phi_i);
    const int shares = are_shares(model, in->shares) && in->offset == in->offset;
    check_sample(s, shares && is_known(in) && in->u_lobe == in->u_lobe);
    REQUIRE(isfinite(pdf) && pdf >= 0.0f);
    if (!shares || in->theta_r != in->theta_r || !isfinite(in->phi_r))
        REQUIRE(pdf == 0.0f);
}

static inline void check_inputs(const hairlut_model *model, const draw_inputs *in)
{
    for (int lobe = -1; lobe <= hairlut_lobe_count(model); ++lobe)
        check_lobe(model, lobe, in);
    check_hair(model, in);
}

static inline void check_model(const hairlut_model *model)
{
    static const float theta_r[] = {-10.0f, -1.57079637f, -0.7f, 0.0f, 0.3f, 1.57079637f, INFINITY, NAN};
    static const float u[] = {0.0f, 2.3e-10f, 5.9604645e-8f, 0.25f, 0.5f, 0.75f, 0.99999994f, 1.0f, 2.0f, NAN};
    static const float offset[] = {-2.0f, -1.0f, -0.3f, -0.0f, 0.0f, 0.7f, 1.0f, INFINITY, NAN};
    enum { ANGLES = sizeof theta_r / sizeof *theta_r, NUMBERS = sizeof u / sizeof *u, OFFSETS = sizeof offset / sizeof *offset };
    static const float shares[][2] = {{0.0f, 1.0f}, {1e-45f, 3e38f}, {-1.0f, 0.0f}, {NAN, 1.0f}, {INFINITY, 1.0f}};
    enum { SHARES = sizeof shares / sizeof *shares };
    float given[HAIRLUT_MAX_LOBES];
    for (int i = 0; i < ANGLES; ++i)
        for (int j = 0; j < NUMBERS; ++j) {
            for (int k = 0; k < HAIRLUT_MAX_LOBES; ++k)
                given[k] = shares[(i + j) % SHARES][(k + j) % 2];
            const draw_inputs own = {NULL, theta_r[i], 1e3f * theta_r[i], offset[(i * j) % OFFSETS], u[(2 * j + i) % NUMBERS], u[j],
                                     u[(j + i) % NUMBERS]};
            draw_inputs callers = own;
            callers.shares = given;
            check_inputs(model, &own);
            check_hair(model, &callers);
        }
}

#endif
