Texture2D<float> tables : register(t0);
cbuffer Axes : register(b1) { float4 axes[10]; }; // the last one: (azimuth, count, 0, 0)
StructuredBuffer<float4> inputs : register(t2);
RWStructuredBuffer<float4> outputs : register(u3);
#define HAIRLUT_FETCH(table, column, row) tables.Load(int3(column, (table) + (row), 0))
//@hairlut

float4 packed_sample(hairlut_sample s)
{
    return float4(s.theta_i, s.phi_i, s.pdf_angle, s.pdf_solid_angle);
}

[numthreads(64, 1, 1)]
void main(uint3 id : SV_DispatchThreadID)
{
    uint k = id.x;
    if (k >= uint(axes[9].y))
        return;
    hairlut_model hair;
    hair.direct_theta = hairlut_axis_of(axes[0], axes[1], axes[2]);
    hair.direct_phi = hairlut_axis_of(axes[3], axes[4], axes[5]);
    hair.multiple_theta = hairlut_axis_of(axes[6], axes[7], axes[8]);
    hair.azimuth = int(axes[9].x);
    float4 a = inputs[2 * k];
    float4 b = inputs[2 * k + 1];
    outputs[5 * k] = packed_sample(hairlut_sample_direct(hair, a.x, a.y, a.z, a.w));
    outputs[5 * k + 1] = packed_sample(hairlut_sample_multiple(hair, a.x, a.y, a.z, a.w));
    outputs[5 * k + 2] = packed_sample(hairlut_sample_mixture(hair, b.y, a.x, a.y, b.x, a.z, a.w));
    outputs[5 * k + 3] = float4(hairlut_pdf_direct(hair, a.x, a.y, b.z, b.w), hairlut_pdf_multiple(hair, a.x, a.y, b.z, b.w),
                                hairlut_pdf_mixture(hair, b.y, a.x, a.y, b.z, b.w), hairlut_pdf_to_solid_angle(1.0, b.z));
    outputs[5 * k + 4] = float4(hairlut_invert_direct(hair, a.x, a.y, b.z, b.w),
                                hairlut_invert_multiple(hair, a.x, a.y, b.z, b.w));
}
