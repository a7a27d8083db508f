/* SPDX-License-Identifier: BSD-3-Clause */
/* One record, in every language that takes the body as it stands: shaders' twin of `evaluate` in harness.c. */
struct test_result {
    hairlut_sample lobe;
    hairlut_sample hair;
    hairlut_sample given; // with shares of the record's own
    float pdf_lobe;
    float pdf_hair;
    float pdf_given;
    float inverse_cosine;
    hairlut_numbers numbers;
};

HAIRLUT_FN test_result test_record(hairlut_model hair, hairlut_float4 a, hairlut_float4 b, hairlut_float4 c)
{
    hairlut_mixture mixture = hairlut_mixture_at(hair, a.x, a.z);
    for (int k = 0; k < hair.lobes; ++k) {
        mixture.share[k] = (k & 1) == 0 ? b.x : 1.0f - b.x;
    }
    int lobe = int(a.w);
    test_result r;
    r.lobe = hairlut_sample_lobe(hair, lobe, a.x, a.y, b.z, b.w);
    r.hair = hairlut_sample_hair(hair, a.x, a.y, a.z, b.y, b.z, b.w);
    r.given = hairlut_sample_hair_at(hair, mixture, a.x, a.y, b.y, b.z, b.w);
    r.pdf_lobe = hairlut_pdf_lobe(hair, lobe, a.x, a.y, c.x, c.y);
    r.pdf_hair = hairlut_pdf_hair(hair, a.x, a.y, a.z, c.x, c.y);
    r.pdf_given = hairlut_pdf_hair_at(hair, mixture, a.x, a.y, c.x, c.y);
    r.inverse_cosine = hairlut_pdf_to_solid_angle(1.0f, c.x);
    r.numbers = hairlut_invert_lobe(hair, lobe, a.x, a.y, c.x, c.y);
    return r;
}
