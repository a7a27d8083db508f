/* SPDX-License-Identifier: BSD-3-Clause */
#include <hairlut.h>

int main(void)
{
    const hairlut_model *hair = hairlut_builtin("fitted");
    const hairlut_sample s = hairlut_sample_hair(hair, NULL, 0.3f, 1.0f, 0.0f, 0.5f, 0.25f, 0.75f);
    return hairlut_version() == HAIRLUT_VERSION && s.pdf_angle > 0.0f ? 0 : 1;
}
