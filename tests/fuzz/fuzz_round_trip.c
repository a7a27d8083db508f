/* SPDX-License-Identifier: BSD-3-Clause */
/* libFuzzer target: a model in memory, written to files and loaded again, gives the same bits; what the one door refuses,
 * the other refuses. The files go to the folder named in FUZZ_FOLDER. */
#include "write_exr.h"

/* Of a strand whose parameters lie at the part `place` of their ranges */
static void same_strands(const hairlut_model *a, const hairlut_model *b, const query *q, float place)
{
    float strand[HAIRLUT_MAX_PARAMETERS];
    strand_at(a, place, strand);
    const hairlut_sample s =
        hairlut_sample_strand(a, strand, NULL, q->theta_r, q->phi_r, q->offset, q->u_lobe, q->u_theta, q->u_phi);
    const hairlut_sample t =
        hairlut_sample_strand(b, strand, NULL, q->theta_r, q->phi_r, q->offset, q->u_lobe, q->u_theta, q->u_phi);
    REQUIRE(memcmp(&s, &t, sizeof s) == 0);
}

static void same_bits(const hairlut_model *a, const hairlut_model *b, const query *q)
{
    const hairlut_sample s = hairlut_sample_hair(a, NULL, q->theta_r, q->phi_r, q->offset, q->u_lobe, q->u_theta, q->u_phi);
    const hairlut_sample t = hairlut_sample_hair(b, NULL, q->theta_r, q->phi_r, q->offset, q->u_lobe, q->u_theta, q->u_phi);
    REQUIRE(memcmp(&s, &t, sizeof s) == 0);
    same_strands(a, b, q, 0.1f);
    same_strands(a, b, q, 0.8f);
    const float p = hairlut_pdf_hair(a, NULL, q->theta_r, q->phi_r, q->offset, s.theta_i, s.phi_i);
    const float r = hairlut_pdf_hair(b, NULL, q->theta_r, q->phi_r, q->offset, s.theta_i, s.phi_i);
    REQUIRE(memcmp(&p, &r, sizeof p) == 0);
    for (int lobe = 0; lobe < hairlut_lobe_count(a); ++lobe) {
        const hairlut_sample v = hairlut_sample_lobe(a, lobe, q->theta_r, q->phi_r, q->u_theta, q->u_phi);
        const hairlut_sample w = hairlut_sample_lobe(b, lobe, q->theta_r, q->phi_r, q->u_theta, q->u_phi);
        REQUIRE(memcmp(&v, &w, sizeof v) == 0);
    }
}

static void same_models(const hairlut_model *a, const hairlut_model *b)
{
    REQUIRE(hairlut_lobe_count(a) == hairlut_lobe_count(b));
    REQUIRE(hairlut_parameter_count(a) == hairlut_parameter_count(b));
    for (int p = 0; p < hairlut_parameter_count(a); ++p)
        REQUIRE(strcmp(hairlut_parameter_name(a, p), hairlut_parameter_name(b, p)) == 0);
    for (int lobe = 0; lobe < hairlut_lobe_count(a); ++lobe)
        REQUIRE(strcmp(hairlut_lobe_name(a, lobe), hairlut_lobe_name(b, lobe)) == 0);
    for (int k = 0; k < 200; ++k) {
        const float x = (float)k / 199.0f;
        const query q = {3.2f * x - 1.6f,
                         7.0f * x,
                         2.2f * fmodf(7.0f * x, 1.0f) - 1.1f,
                         fmodf(31.0f * x, 1.0f),
                         fmodf(13.0f * x, 1.0f),
                         fmodf(89.0f * x, 1.0f)};
        same_bits(a, b, &q);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static described d;
    const char *folder = getenv("FUZZ_FOLDER");
    reader r = {data, size};
    char message[HAIRLUT_MESSAGE_SIZE] = "";
    hairlut_model *made, *loaded;
    REQUIRE(folder);
    describe(&r, &d, take_byte(&r) & (32 | 128)); /* what files cannot say is left out: a range or a domain of one's own */
    write_files(folder, &d);
    const hairlut_result result = hairlut_model_create(&d.desc, NULL, &made, NULL);
    REQUIRE((hairlut_load_with(folder, NULL, &loaded, message) == HAIRLUT_OK) == (result == HAIRLUT_OK));
    if (made) {
        same_models(made, loaded);
        const query q = take_query(&r);
        same_bits(made, loaded, &q);
    }
    hairlut_free(made);
    hairlut_free(loaded);
    return 0;
}
