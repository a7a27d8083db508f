/* The C library behind two calls: a model from three tables, and every function that the shaders have too. */
#include <stddef.h>

#include "hairlut.h"

enum { INPUTS = 8, OUTPUTS = 20 };

/* sizes: width, height, warp of each table; numbers: theta_r_min, theta_r_max, domain_min, domain_max, warp_e, cell_limit.
 * NULL if the library refuses a table. The process ends soon: nobody frees the model. */
const hairlut_model *create(const float *const texels[3], const int *sizes, const float *numbers, int azimuth)
{
    hairlut_model_desc desc = {.azimuth = (hairlut_azimuth)azimuth};
    hairlut_table *const tables[3] = {&desc.direct_theta, &desc.direct_phi, &desc.multiple_theta};
    for (int k = 0; k < 3; ++k, sizes += 3, numbers += 6)
        *tables[k] = (hairlut_table){texels[k],  sizes[0],   sizes[1],   numbers[0], numbers[1],
                                     numbers[2], numbers[3], (hairlut_warp)sizes[2], numbers[4], numbers[5]};
    hairlut_model *model = NULL;
    return hairlut_model_create(&desc, NULL, &model, NULL) == HAIRLUT_OK ? model : NULL;
}

static void put(float *out, hairlut_sample s)
{
    out[0] = s.theta_i;
    out[1] = s.phi_i;
    out[2] = s.pdf_angle;
    out[3] = s.pdf_solid_angle;
}

/* n records of eight inputs to n results. */
void evaluate(const hairlut_model *model, size_t n, const float *in, float *out)
{
    for (size_t k = 0; k < n; ++k, in += INPUTS, out += OUTPUTS) {
        const float theta_r = in[0], phi_r = in[1], u_theta = in[2], u_phi = in[3];
        const float u_lobe = in[4], weight = in[5], theta_i = in[6], phi_i = in[7];
        put(out, hairlut_sample_direct(model, theta_r, phi_r, u_theta, u_phi));
        put(out + 4, hairlut_sample_multiple(model, theta_r, phi_r, u_theta, u_phi));
        put(out + 8, hairlut_sample_mixture(model, weight, theta_r, phi_r, u_lobe, u_theta, u_phi));
        out[12] = hairlut_pdf_direct(model, theta_r, phi_r, theta_i, phi_i);
        out[13] = hairlut_pdf_multiple(model, theta_r, phi_r, theta_i, phi_i);
        out[14] = hairlut_pdf_mixture(model, weight, theta_r, phi_r, theta_i, phi_i);
        out[15] = hairlut_pdf_to_solid_angle(1.0f, theta_i);
        hairlut_invert_direct(model, theta_r, phi_r, theta_i, phi_i, out + 16);
        hairlut_invert_multiple(model, theta_r, phi_r, theta_i, phi_i, out + 18);
    }
}
