/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws samples from the tables compiled into the library and from table files, and prints both with the tables' sizes
 * and measured errors: print_samples [DIRECTORY...], each directory named after its model. */
#include <stdio.h>
#include <string.h>

#include "hairlut.h"

#ifdef PRINT_SAMPLES_EXR
#include <openexr.h>
#endif

#ifdef PRINT_SAMPLES_EXR
/* A text attribute of a file, or "?" */
static void read_attribute(const char *path, const char *attribute, char *text, size_t size)
{
    exr_context_t file = NULL;
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    const char *value = NULL;
    int length = 0;
    snprintf(text, size, "?");
    if (exr_start_read(&file, path, &initializer) == EXR_ERR_SUCCESS &&
        exr_attr_get_string(file, 0, attribute, &length, &value) == EXR_ERR_SUCCESS)
        snprintf(text, size, "%.*s", length, value);
    exr_finish(&file);
}
#endif

/* One line: a lobe's table and, where its file is known, its measured errors. */
static void print_table(const hairlut_model *model, const char *directory, int lobe, hairlut_angle angle)
{
    int width, height;
    char name[64], size[32], variance[32] = "-", weight[32] = "-";
    hairlut_table_size(model, lobe, angle, &width, &height);
    if (width == 0)
        return;
    snprintf(name, sizeof name, "%s_%s", hairlut_lobe_name(model, lobe), angle == HAIRLUT_PHI ? "phi" : "theta");
    snprintf(size, sizeof size, "%dx%d", width, height);
#ifdef PRINT_SAMPLES_EXR
    if (directory) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s.exr", directory, name);
        read_attribute(path, "hairlut.error.relative_variance", variance, sizeof variance);
        read_attribute(path, "hairlut.error.largest_weight", weight, sizeof weight);
    }
#else
    (void)directory;
#endif
    printf("    %-15s %9s %9d %19s %15s\n", name, size, width * height * 8, variance, weight);
}

static void print_lobe(const hairlut_model *model, int lobe)
{
    const float degree = 0.0174532925f;
    const float theta_r[4] = {-75.0f * degree, -20.0f * degree, 10.0f * degree, 50.0f * degree};
    const float phi_r = 60.0f * degree;
    for (int k = 0; k < 4; ++k) {
        const float u_theta = 0.2f + 0.2f * (float)k, u_phi = 0.9f - 0.25f * (float)k;
        const hairlut_sample s = hairlut_sample_lobe(model, lobe, theta_r[k], phi_r, u_theta, u_phi);
        printf("    %-8s %8.1f %8.1f %10.2f %6.2f %10.3f %9.3f %12.5f\n", hairlut_lobe_name(model, lobe),
               (double)(theta_r[k] / degree), (double)(phi_r / degree), (double)u_theta, (double)u_phi,
               (double)(s.theta_i / degree), (double)(s.phi_i / degree), (double)s.pdf_solid_angle);
    }
}

static void print_model(const hairlut_model *model, const char *title, const char *directory)
{
    printf("\n%s\n", title);
    printf("    %-15s %9s %9s %19s %15s\n", "table", "size", "bytes", "relative variance", "largest weight");
    for (int lobe = 0; lobe < hairlut_lobe_count(model); ++lobe) {
        print_table(model, directory, lobe, HAIRLUT_THETA);
        print_table(model, directory, lobe, HAIRLUT_PHI);
    }
    printf("    %-8s %8s %8s %10s %6s %10s %9s %12s\n", "lobe", "theta_r", "phi_r", "u_theta", "u_phi", "theta_i", "phi_i",
           "pdf per sr");
    for (int lobe = 0; lobe < hairlut_lobe_count(model); ++lobe)
        print_lobe(model, lobe);
}

static int print_directory(const char *directory)
{
#ifdef PRINT_SAMPLES_EXR
    char message[HAIRLUT_MESSAGE_SIZE], title[1024];
    hairlut_model *model;
    if (hairlut_load_with(directory, NULL, &model, message) != HAIRLUT_OK) {
        fprintf(stderr, "hairlut: %s\n", message);
        return 1;
    }
    snprintf(title, sizeof title, "files in %s", directory);
    print_model(model, title, directory);
    hairlut_free(model);
    return 0;
#else
    printf("\nfiles in %s: not read, the library was built without OpenEXR (apt-get install libopenexr-dev)\n", directory);
    return 0;
#endif
}

/* The compiled-in tables were generated from files: the errors stand in the headers of those. */
static void print_compiled_in(const char *name, int argc, char **argv)
{
    char title[64];
    const char *directory = NULL;
    const size_t length = strlen(name);
    for (int k = 1; k < argc; ++k) {
        const size_t whole = strlen(argv[k]);
        if (whole >= length && strcmp(argv[k] + whole - length, name) == 0)
            directory = argv[k];
    }
    snprintf(title, sizeof title, "compiled in: %s", name);
    print_model(hairlut_builtin(name), title, directory);
}

int main(int argc, char **argv)
{
    int failures = 0;
    printf("Incident directions drawn for a viewer direction (theta_r, phi_r), in degrees\n");
    print_compiled_in("printed", argc, argv);
    print_compiled_in("fitted", argc, argv);
    for (int k = 1; k < argc; ++k)
        failures += print_directory(argv[k]);
    return failures != 0;
}
