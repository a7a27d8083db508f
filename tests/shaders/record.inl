/* SPDX-License-Identifier: BSD-3-Clause */
/* One record, in every language that takes the body as it stands: shaders' twin of `evaluate` in harness.c. */
struct test_result {
    hairlut_sample lobe;
    hairlut_sample hair;  // with parameters of the record's own
    hairlut_sample given; // with shares of the record's own too
    float pdf_lobe;
    float pdf_hair;
    float pdf_given;
    float inverse_cosine;
    hairlut_numbers numbers;
};

HAIRLUT_FN test_result test_record(hairlut_model hair, hairlut_float4 a, hairlut_float4 b, hairlut_float4 c, hairlut_float4 d)
{
    hairlut_parameters own = hair.parameters;
    own.value[0] = c.z;
    own.value[1] = c.w;
    own.value[2] = d.x;
    own.value[3] = d.y;
    own.value[4] = d.z;
    own.value[5] = d.w;
    hairlut_model strand = hairlut_strand(hair, own);
    hairlut_mixture mixture = hairlut_mixture_at(strand, a.x, a.z);
    for (int k = 0; k < hair.lobes; ++k) {
        mixture.share[k] = (k & 1) == 0 ? b.x : 1.0f - b.x;
    }
    int lobe = int(a.w);
    test_result r;
    r.lobe = hairlut_sample_lobe(hair, lobe, a.x, a.y, b.z, b.w);
    r.hair = hairlut_sample_strand(hair, own, a.x, a.y, a.z, b.y, b.z, b.w);
    r.given = hairlut_sample_hair_at(strand, mixture, a.x, a.y, b.y, b.z, b.w);
    r.pdf_lobe = hairlut_pdf_lobe(hair, lobe, a.x, a.y, c.x, c.y);
    r.pdf_hair = hairlut_pdf_strand(hair, own, a.x, a.y, a.z, c.x, c.y);
    r.pdf_given = hairlut_pdf_hair_at(strand, mixture, a.x, a.y, c.x, c.y);
    r.inverse_cosine = hairlut_pdf_to_solid_angle(1.0f, c.x);
    r.numbers = hairlut_invert_lobe(hair, lobe, a.x, a.y, c.x, c.y);
    return r;
}
