/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs one function for a number of samples, under callgrind: instructions FUNCTION MODEL. Collection is switched on
 * inside `counted` alone. MODEL: the name of a compiled-in one, or `strands` for one over a parameter. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hairlut.h"

enum { N = 4096 };

static float theta_r[N], phi_r[N], u_lobe[N], u_theta[N], u_phi[N], theta_i[N], phi_i[N], pdf[N], solid[N], parameter[N];

static hairlut_viewer viewers[N];

static float unit(void)
{
    static unsigned state = 1;
    state = state * 1664525u + 1013904223u;
    return (float)(state >> 8) / 16777216.0f;
}

static void keep(int i, hairlut_sample s)
{
    theta_i[i] = s.theta_i;
    phi_i[i] = s.phi_i;
    pdf[i] = s.pdf_angle;
    solid[i] = s.pdf_solid_angle;
}

__attribute__((noinline)) void counted(const char *what, const hairlut_model *m)
{
    const hairlut_samples out = {theta_i, phi_i, pdf, solid};
    if (strcmp(what, "sample_direct") == 0)
        for (int i = 0; i < N; ++i)
            keep(i, hairlut_sample_direct(m, theta_r[i], phi_r[i], u_theta[i], u_phi[i]));
    else if (strcmp(what, "sample_multiple") == 0)
        for (int i = 0; i < N; ++i)
            keep(i, hairlut_sample_multiple(m, theta_r[i], phi_r[i], u_theta[i], u_phi[i]));
    else if (strcmp(what, "pdf_direct") == 0)
        for (int i = 0; i < N; ++i)
            pdf[i] = hairlut_pdf_direct(m, theta_r[i], phi_r[i], theta_i[i], phi_i[i]);
    else if (strcmp(what, "pdf_multiple") == 0)
        for (int i = 0; i < N; ++i)
            pdf[i] = hairlut_pdf_multiple(m, theta_r[i], phi_r[i], theta_i[i], phi_i[i]);
    else if (strcmp(what, "sample_direct_n") == 0)
        hairlut_sample_direct_n(m, N, theta_r, phi_r, u_theta, u_phi, out);
    else if (strcmp(what, "sample_multiple_n") == 0)
        hairlut_sample_multiple_n(m, N, theta_r, phi_r, u_theta, u_phi, out);
    else if (strcmp(what, "pdf_direct_n") == 0)
        hairlut_pdf_direct_n(m, N, theta_r, phi_r, theta_i, phi_i, pdf);
    else if (strcmp(what, "pdf_multiple_n") == 0)
        hairlut_pdf_multiple_n(m, N, theta_r, phi_r, theta_i, phi_i, pdf);
    else if (strcmp(what, "sample_hair") == 0)
        for (int i = 0; i < N; ++i)
            keep(i, hairlut_sample_hair(m, NULL, theta_r[i], phi_r[i], 0.0f, u_lobe[i], u_theta[i], u_phi[i]));
    else if (strcmp(what, "pdf_hair") == 0)
        for (int i = 0; i < N; ++i)
            pdf[i] = hairlut_pdf_hair(m, NULL, theta_r[i], phi_r[i], 0.0f, theta_i[i], phi_i[i]);
    else if (strcmp(what, "sample_hair_n") == 0)
        hairlut_sample_hair_n(m, N, NULL, theta_r, phi_r, NULL, u_lobe, u_theta, u_phi, out);
    else if (strcmp(what, "pdf_hair_n") == 0)
        hairlut_pdf_hair_n(m, N, NULL, theta_r, phi_r, NULL, theta_i, phi_i, pdf);
    else if (strcmp(what, "viewer_at") == 0)
        for (int i = 0; i < N; ++i)
            hairlut_viewer_at(&viewers[i], m, NULL, NULL, theta_r[i], phi_r[i], 0.4f);
    else if (strcmp(what, "viewer_sample") == 0)
        for (int i = 0; i < N; ++i)
            keep(i, hairlut_viewer_sample(&viewers[i], u_lobe[i], u_theta[i], u_phi[i]));
    else if (strcmp(what, "viewer_pdf") == 0)
        for (int i = 0; i < N; ++i)
            pdf[i] = hairlut_viewer_pdf(&viewers[i], theta_i[i], phi_i[i]);
    else if (strcmp(what, "sample_strand_n") == 0)
        hairlut_sample_strand_n(m, N, parameter, NULL, theta_r, phi_r, NULL, u_lobe, u_theta, u_phi, out);
    else if (strcmp(what, "pdf_strand_n") == 0)
        hairlut_pdf_strand_n(m, N, parameter, NULL, theta_r, phi_r, NULL, theta_i, phi_i, pdf);
    else if (strcmp(what, "nothing") != 0)
        exit(2);
}

enum { WIDTH = 24, HEIGHT = 16, NODES = 5, LOBES = 2 };

/* Quantiles from low to high, and their slopes, all rows alike. */
static void fill_table(float *texels, float low, float high)
{
    for (int k = 0; k < NODES * HEIGHT * WIDTH; ++k) {
        const int column = k % WIDTH;
        texels[2 * k] = column == WIDTH - 1 ? high : low + (high - low) * (float)column / (WIDTH - 1);
        texels[2 * k + 1] = high - low;
    }
}

/* Two lobes, whose tables and shares depend on one parameter. The rows of theta_i are told apart by a step in one texel. */
static hairlut_model *make_strands(void)
{
    static const float nodes[NODES] = {0.0f, 0.2f, 0.5f, 0.7f, 1.0f};
    static const float share[LOBES * NODES] = {1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 0.5f, 1.0f, 2.0f, 1.0f, 3.0f};
    static const hairlut_parameter_nodes axis = {sizeof axis, 0, NODES, nodes};
    static const hairlut_parameter one = {sizeof one, "rough", 0.0f, 1.0f, 0.5f};
    static float theta_texels[2 * NODES * HEIGHT * WIDTH], phi_texels[2 * NODES * HEIGHT * WIDTH];
    const float pi = 3.14159274f, half = 1.57079637f, e = 1.0f / 262144.0f;
    fill_table(theta_texels, -half, half);
    fill_table(phi_texels, 0.0f, 2.0f * pi);
    for (int j = 0; j < NODES * HEIGHT; ++j)
        theta_texels[2 * (j * WIDTH + WIDTH / 2)] += (float)j * 1e-4f;
    const hairlut_table theta = {sizeof theta, theta_texels,         WIDTH, HEIGHT, -half, half, -half,
                                 half,         HAIRLUT_WARP_UNIFORM, e,     1,      &axis};
    const hairlut_table phi = {sizeof phi, phi_texels,           WIDTH, HEIGHT, -half, half, 0.0f,
                               2.0f * pi,  HAIRLUT_WARP_UNIFORM, e,     1,      &axis};
    const hairlut_lobe_desc lobes[LOBES] = {{sizeof *lobes, "a", &theta, &phi, HAIRLUT_AZIMUTH_DIFFERENCE},
                                            {sizeof *lobes, "b", &theta, &phi, HAIRLUT_AZIMUTH_DIFFERENCE}};
    const hairlut_mixture_desc mixture = {sizeof mixture, 1, 1, NULL, NULL, share, NULL, 0, 1, &axis};
    const hairlut_model_desc desc = {sizeof desc, LOBES, lobes, &mixture, 1, &one};
    char message[HAIRLUT_MESSAGE_SIZE];
    hairlut_model *model = NULL;
    if (hairlut_model_create(&desc, NULL, &model, message) != HAIRLUT_OK)
        fprintf(stderr, "%s\n", message);
    return model;
}

int main(int argc, char **argv)
{
    const int strands = argc == 3 && strcmp(argv[2], "strands") == 0;
    hairlut_model *made = strands ? make_strands() : NULL;
    const hairlut_model *model = strands ? made : argc == 3 ? hairlut_builtin(argv[2]) : NULL;
    if (!model)
        return 2;
    for (int i = 0; i < N; ++i) {
        theta_r[i] = (unit() - 0.5f) * 3.14159274f;
        phi_r[i] = (unit() - 0.5f) * 6.28318548f;
        u_theta[i] = unit();
        u_phi[i] = unit();
        u_lobe[i] = unit();
        parameter[i] = unit();
        keep(i, hairlut_sample_hair(model, NULL, theta_r[i], phi_r[i], 0.0f, u_lobe[i], u_theta[i], u_phi[i]));
        hairlut_viewer_at(&viewers[i], model, NULL, NULL, theta_r[i], phi_r[i], 0.4f);
    }
    counted(argv[1], model);
    hairlut_free(made);
    printf("%d\n", N);
    return 0;
}
