/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs one function for a number of samples, under callgrind: instructions FUNCTION MODEL. Collection is switched on
 * inside `counted` alone. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hairlut.h"

enum { N = 4096 };

static float theta_r[N], phi_r[N], u_lobe[N], u_theta[N], u_phi[N], theta_i[N], phi_i[N], pdf[N], solid[N];

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
    else if (strcmp(what, "nothing") != 0)
        exit(2);
}

int main(int argc, char **argv)
{
    const hairlut_model *model = argc == 3 ? hairlut_builtin(argv[2]) : NULL;
    if (!model)
        return 2;
    for (int i = 0; i < N; ++i) {
        theta_r[i] = (unit() - 0.5f) * 3.14159274f;
        phi_r[i] = (unit() - 0.5f) * 6.28318548f;
        u_theta[i] = unit();
        u_phi[i] = unit();
        u_lobe[i] = unit();
        keep(i, hairlut_sample_hair(model, NULL, theta_r[i], phi_r[i], 0.0f, u_lobe[i], u_theta[i], u_phi[i]));
        hairlut_viewer_at(&viewers[i], model, NULL, NULL, theta_r[i], phi_r[i], 0.4f);
    }
    counted(argv[1], model);
    printf("%d\n", N);
    return 0;
}
