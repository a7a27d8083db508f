/* SPDX-License-Identifier: BSD-3-Clause */
/* The header in C99, alone in its file, with warnings as errors; and a walk through the API. */
#include "hairlut.h"

#include "hairlut.h" /* twice: it guards itself */

int main(void)
{
    const hairlut_model *hair = hairlut_builtin("fitted");
    const hairlut_sample s = hairlut_sample_direct(hair, 0.3f, 1.0f, 0.25f, 0.75f);
    const float pdf = hairlut_pdf_direct(hair, 0.3f, 1.0f, s.theta_i, s.phi_i);
    const hairlut_sample h = hairlut_sample_hair(hair, NULL, 0.3f, 1.0f, 0.0f, 0.9f, 0.25f, 0.75f);
    const float ratio = pdf / s.pdf_angle;
    if (!(h.pdf_angle > 0.0f) || hairlut_lobe_index(hair, hairlut_lobe_name(hair, 1)) != 1)
        return 3;
    if (hairlut_version() != HAIRLUT_VERSION || hairlut_builtin("other") != NULL)
        return 2;
    return ratio > 0.9999f && ratio < 1.0001f ? 0 : 1;
}
