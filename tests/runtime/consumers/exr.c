/* SPDX-License-Identifier: BSD-3-Clause */
/* Loads a model from the directory given. */
#include <stdio.h>

#include "hairlut.h"

int main(int argc, char **argv)
{
    char message[HAIRLUT_MESSAGE_SIZE];
    hairlut_model *model;
    if (argc != 2 || hairlut_load_with(argv[1], NULL, &model, message) != HAIRLUT_OK) {
        fprintf(stderr, "%s\n", argc == 2 ? message : "usage: exr DIRECTORY");
        return 1;
    }
    const hairlut_sample s = hairlut_sample_direct(model, 0.3f, 1.0f, 0.25f, 0.75f);
    hairlut_free(model);
    return s.pdf_angle > 0.0f ? 0 : 1;
}
