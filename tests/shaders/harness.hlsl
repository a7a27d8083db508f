// SPDX-License-Identifier: BSD-3-Clause
StructuredBuffer<float4> hairs : register(t0);
cbuffer Place : register(b1) { int4 place; }; // (first texel, count, 0, 0)
StructuredBuffer<float4> inputs : register(t2);
RWStructuredBuffer<float4> outputs : register(u3);
#define HAIRLUT_FETCH(source, i) hairs[i]
//@hairlut
//@record

float4 packed_sample(hairlut_sample s)
{
    return float4(s.theta_i, s.phi_i, s.pdf_angle, s.pdf_solid_angle);
}

[numthreads(64, 1, 1)]
void main(uint3 id : SV_DispatchThreadID)
{
    int k = int(id.x);
    if (k >= place.y)
        return;
    int n = 4 * k;
    test_result r = test_record(hairlut_model_at(0, place.x), inputs[n], inputs[n + 1], inputs[n + 2], inputs[n + 3]);
    outputs[5 * k] = packed_sample(r.lobe);
    outputs[5 * k + 1] = packed_sample(r.hair);
    outputs[5 * k + 2] = packed_sample(r.given);
    outputs[5 * k + 3] = float4(r.pdf_lobe, r.pdf_hair, r.pdf_given, r.inverse_cosine);
    outputs[5 * k + 4] = float4(r.numbers.u_theta, r.numbers.u_phi, 0.0, 0.0);
}
