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

static inline void check_direction(const hairlut_model *model, float theta_r, float phi_r, float u_theta, float u_phi)
{
    float u[2];
    const hairlut_sample s = hairlut_sample_direct(model, theta_r, phi_r, u_theta, u_phi);
    const hairlut_sample m = hairlut_sample_mixture(model, 0.3f, theta_r, phi_r, u_phi, u_theta, u_phi);
    const float pdf = hairlut_pdf_direct(model, theta_r, phi_r, s.theta_i, s.phi_i);
    const float mixture = hairlut_pdf_mixture(model, 0.3f, theta_r, phi_r, s.theta_i, s.phi_i);
    REQUIRE(fabsf(s.theta_i) <= 1.57079637f && fabsf(m.theta_i) <= 1.57079637f);
    REQUIRE(s.phi_i >= -3.14159274f && s.phi_i < 3.14159274f);
    REQUIRE(isfinite(s.pdf_angle) && isfinite(s.pdf_solid_angle) && isfinite(m.pdf_solid_angle));
    REQUIRE(isfinite(pdf) && isfinite(mixture) && pdf >= 0.0f && mixture >= 0.0f);
    if (isfinite(theta_r) && isfinite(phi_r) && isfinite(u_theta) && isfinite(u_phi))
        REQUIRE(s.pdf_angle > 0.0f);
    hairlut_invert_direct(model, theta_r, phi_r, s.theta_i, s.phi_i, u);
    REQUIRE(u[0] >= 0.0f && u[0] <= 1.0f && u[1] >= 0.0f && u[1] <= 1.0f);
}

static inline void check_model(const hairlut_model *model)
{
    static const float theta_r[] = {-10.0f, -1.57079637f, -0.7f, 0.0f, 0.3f, 1.57079637f, INFINITY, NAN};
    static const float u[] = {0.0f, 2.3e-10f, 5.9604645e-8f, 0.25f, 0.5f, 0.75f, 0.99999994f, 1.0f, 2.0f, NAN};
    for (size_t i = 0; i < sizeof theta_r / sizeof *theta_r; ++i)
        for (size_t j = 0; j < sizeof u / sizeof *u; ++j)
            check_direction(model, theta_r[i], 1e3f * theta_r[i], u[j], u[(j + i) % (sizeof u / sizeof *u)]);
}

#endif
