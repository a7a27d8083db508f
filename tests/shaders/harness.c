/* SPDX-License-Identifier: BSD-3-Clause */
/* The C library behind two calls: a model from arrays, and every function that the shaders have too. */
#include <stddef.h>

#include "hairlut.h"

enum { INPUTS = 16, OUTPUTS = 20, MAX_TABLES = 2 * HAIRLUT_MAX_LOBES };

/* texels[k], sizes[3k]: width, height, warp, numbers[5k]: theta_r_min, theta_r_max, domain_min, domain_max, e of table k; lobes[3k]:
 * table of theta, of phi (-1: none), and azimuth of lobe k; grid: nodes of theta_r, of the offset, mirrored; ranges[3p]: least, most
 * and standard value of parameter p; axes: of each table, then of the mixture, their number, and for each its parameter and the number
 * of nodes, which follow each other in `nodes`. NULL if the library refuses the model. The process ends soon: nobody frees it. */
const hairlut_model *create(int table_count, const float *const *texels, const int *sizes, const float *numbers,
                            int lobe_count, const int *lobes, const int *grid, const float *theta_r, const float *offset,
                            const float *share, const float *turn, int parameter_count, const float *ranges, const int *axes,
                            const float *nodes, char *message)
{
    static const char *const names[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l", "m", "n", "o", "p"};
    static const char *const parameter_names[] = {"p", "q", "r", "s", "t", "u0", "v", "w"};
    hairlut_parameter parameters[HAIRLUT_MAX_PARAMETERS];
    hairlut_parameter_nodes taken[MAX_TABLES + 1][4];
    hairlut_table tables[MAX_TABLES];
    hairlut_lobe_desc descs[HAIRLUT_MAX_LOBES];
    for (int p = 0; p < parameter_count; ++p, ranges += 3)
        parameters[p] = (hairlut_parameter){sizeof *parameters, parameter_names[p], ranges[0], ranges[1], ranges[2]};
    int axis_counts[MAX_TABLES + 1];
    for (int k = 0; k <= table_count; ++k) {
        axis_counts[k] = *axes++;
        for (int a = 0; a < axis_counts[k]; ++a, nodes += axes[1], axes += 2)
            taken[k][a] = (hairlut_parameter_nodes){sizeof taken[k][a], axes[0], axes[1], nodes};
    }
    for (int k = 0; k < table_count; ++k, sizes += 3, numbers += 5)
        tables[k] = (hairlut_table){
            sizeof *tables,         texels[k],  sizes[0],       sizes[1], numbers[0], numbers[1], numbers[2], numbers[3],
            (hairlut_warp)sizes[2], numbers[4], axis_counts[k], taken[k]};
    for (int k = 0; k < lobe_count; ++k, lobes += 3)
        descs[k] = (hairlut_lobe_desc){sizeof *descs, names[k], &tables[lobes[0]], lobes[1] < 0 ? NULL : &tables[lobes[1]],
                                       (hairlut_azimuth)lobes[2]};
    const hairlut_mixture_desc mixture = {
        sizeof mixture,           grid[0],           grid[1], theta_r, offset, share, turn, grid[2],
        axis_counts[table_count], taken[table_count]};
    const hairlut_model_desc desc = {sizeof desc, lobe_count, descs, &mixture, parameter_count, parameters};
    hairlut_model *model = NULL;
    return hairlut_model_create(&desc, NULL, &model, message) == HAIRLUT_OK ? model : NULL;
}

static void put(float *out, hairlut_sample s)
{
    out[0] = s.theta_i;
    out[1] = s.phi_i;
    out[2] = s.pdf_angle;
    out[3] = s.pdf_solid_angle;
}

/* n records to n results. Shares of a record's own: `share` for even lobes, 1 - share for odd ones. */
void evaluate(const hairlut_model *model, size_t n, const float *in, float *out)
{
    for (size_t k = 0; k < n; ++k, in += INPUTS, out += OUTPUTS) {
        const float theta_r = in[0], phi_r = in[1], offset = in[2], share = in[4];
        const float u_lobe = in[5], u_theta = in[6], u_phi = in[7], theta_i = in[8], phi_i = in[9];
        const int lobe = (int)in[3];
        float shares[HAIRLUT_MAX_LOBES];
        for (int l = 0; l < HAIRLUT_MAX_LOBES; ++l)
            shares[l] = l % 2 ? 1.0f - share : share;
        put(out, hairlut_sample_lobe(model, lobe, theta_r, phi_r, u_theta, u_phi));
        put(out + 4, hairlut_sample_strand(model, in + 10, NULL, theta_r, phi_r, offset, u_lobe, u_theta, u_phi));
        put(out + 8, hairlut_sample_strand(model, in + 10, shares, theta_r, phi_r, offset, u_lobe, u_theta, u_phi));
        out[12] = hairlut_pdf_lobe(model, lobe, theta_r, phi_r, theta_i, phi_i);
        out[13] = hairlut_pdf_strand(model, in + 10, NULL, theta_r, phi_r, offset, theta_i, phi_i);
        out[14] = hairlut_pdf_strand(model, in + 10, shares, theta_r, phi_r, offset, theta_i, phi_i);
        out[15] = hairlut_pdf_to_solid_angle(1.0f, theta_i);
        hairlut_invert_lobe(model, lobe, theta_r, phi_r, theta_i, phi_i, out + 16);
        out[18] = out[19] = 0.0f;
    }
}
