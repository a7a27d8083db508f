/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws, and asks for a density, with each strand's own roughness, from a model over parameters: strand DIRECTORY */
#include <stdio.h>

#include "hairlut.h"

int main(int argc, char **argv)
{
    hairlut_model *hair;
    float strand[HAIRLUT_MAX_PARAMETERS], least, most;
    char message[HAIRLUT_MESSAGE_SIZE] = "usage: strand DIRECTORY, of a model over beta_m";
    if (argc != 2 || hairlut_load_with(argv[1], NULL, &hair, message) != HAIRLUT_OK)
        return fprintf(stderr, "%s\n", message), 2;
    const int beta_m = hairlut_parameter_index(hair, "beta_m");
    for (int p = 0; p < hairlut_parameter_count(hair); ++p)
        hairlut_parameter_range(hair, p, NULL, NULL, &strand[p]); /* the standard values, but for beta_m */
    for (int k = 0; k <= 4 && hairlut_parameter_range(hair, beta_m, &least, &most, NULL); ++k) {
        strand[beta_m] = least + (most - least) * (float)k / 4.0f;
        hairlut_viewer viewer; /* what the calls at one hit have in common */
        hairlut_viewer_at(&viewer, hair, strand, NULL, 0.3f, 1.0f, 0.4f);
        const hairlut_sample s = hairlut_viewer_sample(&viewer, 0.1f, 0.25f, 0.75f);
        const float light = hairlut_viewer_pdf(&viewer, -0.2f, 3.0f); /* of a direction that a light chose */
        printf("beta_m %.3f: theta_i %.4f, %.4f per sr; another direction %.4f per rad^2\n", strand[beta_m], s.theta_i,
               s.pdf_solid_angle, light);
    }
    hairlut_free(hair);
    return 0;
}
