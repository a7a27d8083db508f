/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws with each strand's own roughness, from a model over parameters: strand DIRECTORY */
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
        const hairlut_sample s = hairlut_sample_strand(hair, strand, NULL, 0.3f, 1.0f, 0.4f, 0.1f, 0.25f, 0.75f);
        printf("beta_m %.3f: theta_i %.4f, %.4f per sr\n", strand[beta_m], s.theta_i, s.pdf_solid_angle);
    }
    hairlut_free(hair);
    return 0;
}
