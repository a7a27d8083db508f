/* SPDX-License-Identifier: BSD-3-Clause */
/* The shaders' body as C++: the same records in and out, and a count of its fetches. */
#include <stddef.h>

namespace {
thread_local long fetches; // of everything but the head of a model
}

#define HAIRLUT_SOURCE const hairlut_float4 *
#define HAIRLUT_FETCH(source, i) (++fetches, (source)[i])
#define HAIRLUT_HEADER(source, i) ((source)[i])
#include "hairlut.cuh"

namespace hairlut_gpu {
#include "record.inl"
}

using namespace hairlut_gpu;

static void put(float *out, hairlut_sample s)
{
    out[0] = s.theta_i;
    out[1] = s.phi_i;
    out[2] = s.pdf_angle;
    out[3] = s.pdf_solid_angle;
}

extern "C" void evaluate(const float *stream, int first, size_t n, const float *in, float *out)
{
    const hairlut_float4 *texels = reinterpret_cast<const hairlut_float4 *>(stream);
    const hairlut_float4 *record = reinterpret_cast<const hairlut_float4 *>(in);
    for (size_t k = 0; k < n; ++k, record += 4, out += 20) {
        const test_result r = test_record(hairlut_model_at(texels, first), record[0], record[1], record[2], record[3]);
        put(out, r.lobe);
        put(out + 4, r.hair);
        put(out + 8, r.given);
        out[12] = r.pdf_lobe;
        out[13] = r.pdf_hair;
        out[14] = r.pdf_given;
        out[15] = r.inverse_cosine;
        out[16] = r.numbers.u_theta;
        out[17] = r.numbers.u_phi;
        out[18] = out[19] = 0.0f;
    }
}

/* Fetches, without those of the head, of: a lobe's sample, a lobe's density, the mixture, the whole hair's sample and density with
 * a mixture that is there. Parameters lie between nodes. */
extern "C" void count(const float *stream, int first, long *counts)
{
    hairlut_model hair = hairlut_model_at(reinterpret_cast<const hairlut_float4 *>(stream), first);
    for (int p = 0; p < hair.parameter_count; ++p) {
        const hairlut_float4 range = HAIRLUT_HEADER(hair.source, hair.ranges + p);
        hair.parameters.value[p] = range.x + 0.37f * (range.y - range.x);
    }
    fetches = 0;
    (void)hairlut_sample_lobe(hair, 0, 0.3f, 0.1f, 0.2f, 0.6f);
    counts[0] = fetches;
    fetches = 0;
    (void)hairlut_pdf_lobe(hair, 0, 0.3f, 0.1f, 0.2f, 0.6f);
    counts[1] = fetches;
    fetches = 0;
    const hairlut_mixture mixture = hairlut_mixture_at(hair, 0.3f, 0.4f);
    counts[2] = fetches;
    fetches = 0;
    (void)hairlut_sample_hair_at(hair, mixture, 0.3f, 0.1f, 0.1f, 0.2f, 0.6f);
    counts[3] = fetches;
    fetches = 0;
    (void)hairlut_pdf_hair_at(hair, mixture, 0.3f, 0.1f, 0.2f, 0.6f);
    counts[4] = fetches;
}
