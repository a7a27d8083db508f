/* SPDX-License-Identifier: BSD-3-Clause */
/* What must be true of every model that was accepted, whatever it was made of. */
#ifndef CHECK_H
#define CHECK_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hairlut.h"

#define REQUIRE(condition)                                                  \
    do {                                                                    \
        if (!(condition)) {                                                 \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition); \
            abort();                                                        \
        }                                                                   \
    } while (0)

static inline void check_sample(hairlut_sample s)
{
    REQUIRE(fabsf(s.theta_i) <= 1.57079637f);
    REQUIRE(s.phi_i >= -3.14159274f && s.phi_i < 3.14159274f);
    REQUIRE(isfinite(s.pdf_angle) && isfinite(s.pdf_solid_angle) && s.pdf_angle >= 0.0f);
}

/* The viewer, an offset, and the numbers that a sample is drawn with. */
typedef struct query {
    float theta_r, phi_r, offset, u_lobe, u_theta, u_phi;
} query;

static inline int is_finite_query(const query *q)
{
    return isfinite(q->theta_r) && isfinite(q->phi_r) && isfinite(q->offset) && isfinite(q->u_lobe) &&
           isfinite(q->u_theta) && isfinite(q->u_phi);
}

/* One lobe; any number of a lobe. */
static inline void check_lobe(const hairlut_model *model, int lobe, const query *q)
{
    const int exists = lobe >= 0 && lobe < hairlut_lobe_count(model);
    const hairlut_sample s = hairlut_sample_lobe(model, lobe, q->theta_r, q->phi_r, q->u_theta, q->u_phi);
    const float pdf = hairlut_pdf_lobe(model, lobe, q->theta_r, q->phi_r, s.theta_i, s.phi_i);
    float u[2];
    check_sample(s);
    REQUIRE(isfinite(pdf) && pdf >= 0.0f && (exists || (pdf == 0.0f && s.pdf_angle == 0.0f)));
    REQUIRE(!exists || !is_finite_query(q) || s.pdf_angle > 0.0f);
    hairlut_invert_lobe(model, lobe, q->theta_r, q->phi_r, s.theta_i, s.phi_i, u);
    REQUIRE(u[0] >= 0.0f && u[0] <= 1.0f && u[1] >= 0.0f && u[1] <= 1.0f);
}

/* Each parameter at the same part of its range; beyond it for parts below 0 and above 1. */
static inline void strand_at(const hairlut_model *model, float place, float strand[HAIRLUT_MAX_PARAMETERS])
{
    for (int p = 0; p < hairlut_parameter_count(model); ++p) {
        float least, most, standard;
        REQUIRE(hairlut_parameter_range(model, p, &least, &most, &standard));
        REQUIRE(least <= standard && standard <= most);
        strand[p] = least + place * (most - least);
    }
}

/* Nine times the same strand, a vector and some more: the same bits. Nothing can be read behind the arrays unnoticed. */
static inline void check_strand_arrays(const hairlut_model *model, const query *q, const float *strand, hairlut_sample s,
                                       float pdf)
{
    enum { N = 9 };
    const int count = hairlut_parameter_count(model);
    float values[HAIRLUT_MAX_PARAMETERS * N], *parameters = values + (HAIRLUT_MAX_PARAMETERS - count) * N;
    float theta_r[N], phi_r[N], offset[N], u_lobe[N], u_theta[N], u_phi[N], theta_i[N], phi_i[N], density[N], solid[N];
    const hairlut_samples out = {theta_i, phi_i, density, solid};
    for (int i = 0; i < N; ++i) {
        theta_r[i] = q->theta_r, phi_r[i] = q->phi_r, offset[i] = q->offset;
        u_lobe[i] = q->u_lobe, u_theta[i] = q->u_theta, u_phi[i] = q->u_phi;
        for (int p = 0; p < count; ++p)
            parameters[p * N + i] = strand[p];
    }
    hairlut_sample_strand_n(model, N, parameters, NULL, theta_r, phi_r, offset, u_lobe, u_theta, u_phi, out);
    for (int i = 0; i < N; ++i) {
        const hairlut_sample t = {theta_i[i], phi_i[i], density[i], solid[i]};
        REQUIRE(memcmp(&t, &s, sizeof s) == 0);
    }
    hairlut_pdf_strand_n(model, N, parameters, NULL, theta_r, phi_r, offset, theta_i, phi_i, density);
    for (int i = 0; i < N; ++i)
        REQUIRE(memcmp(&density[i], &pdf, sizeof pdf) == 0);
}

static inline void check_strand(const hairlut_model *model, const query *q, float place)
{
    float strand[HAIRLUT_MAX_PARAMETERS];
    strand_at(model, place, strand);
    const int no_number = hairlut_parameter_count(model) > 0 && isnan(strand[0]);
    const hairlut_sample s =
        hairlut_sample_strand(model, strand, NULL, q->theta_r, q->phi_r, q->offset, q->u_lobe, q->u_theta, q->u_phi);
    const float pdf = hairlut_pdf_strand(model, strand, NULL, q->theta_r, q->phi_r, q->offset, s.theta_i, s.phi_i);
    hairlut_viewer viewer;
    hairlut_viewer_at(&viewer, model, strand, NULL, q->theta_r, q->phi_r, q->offset);
    const hairlut_sample again = hairlut_viewer_sample(&viewer, q->u_lobe, q->u_theta, q->u_phi);
    const float pdf_again = hairlut_viewer_pdf(&viewer, s.theta_i, s.phi_i);
    REQUIRE(memcmp(&again, &s, sizeof s) == 0 && memcmp(&pdf_again, &pdf, sizeof pdf) == 0);
    check_sample(s);
    REQUIRE(isfinite(pdf) && pdf >= 0.0f);
    REQUIRE(!no_number || (s.pdf_angle == 0.0f && pdf == 0.0f));
    REQUIRE(no_number || !is_finite_query(q) || s.pdf_angle > 0.0f);
    check_strand_arrays(model, q, strand, s, pdf);
}

static inline void check_query(const hairlut_model *model, const query *q)
{
    const hairlut_sample s =
        hairlut_sample_hair(model, NULL, q->theta_r, q->phi_r, q->offset, q->u_lobe, q->u_theta, q->u_phi);
    const float pdf = hairlut_pdf_hair(model, NULL, q->theta_r, q->phi_r, q->offset, s.theta_i, s.phi_i);
    check_sample(s);
    REQUIRE(isfinite(pdf) && pdf >= 0.0f);
    REQUIRE(!is_finite_query(q) || s.pdf_angle > 0.0f);
    for (int lobe = -1; lobe <= hairlut_lobe_count(model); ++lobe)
        check_lobe(model, lobe, q);
    if (hairlut_parameter_count(model) > 0) {
        static const float places[] = {0.0f, 0.37f, 1.0f, -INFINITY, 3.0f, NAN};
        for (size_t k = 0; k < sizeof places / sizeof *places; ++k)
            check_strand(model, q, places[k]);
    }
}

static inline void check_model(const hairlut_model *model)
{
    static const float theta_r[] = {-10.0f, -1.57079637f, -0.7f, 0.0f, 0.3f, 1.57079637f, INFINITY, NAN};
    static const float offset[] = {0.0f, -1.0f, 0.4f, 1.0f, -0.2f, 3.0f, -INFINITY, NAN};
    static const float u[] = {0.0f, 2.3e-10f, 5.9604645e-8f, 0.25f, 0.5f, 0.75f, 0.99999994f, 1.0f, 2.0f, NAN};
    enum { ANGLES = sizeof theta_r / sizeof *theta_r, UNITS = sizeof u / sizeof *u };
    for (int i = 0; i < ANGLES; ++i)
        for (int j = 0; j < UNITS; ++j) {
            const query q = {theta_r[i], 1e3f * theta_r[i], offset[(i + j) % ANGLES], u[(j + 3) % UNITS],
                             u[j],       u[(j + i) % UNITS]};
            check_query(model, &q);
        }
}

#endif
