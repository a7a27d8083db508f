/* The _n functions: the widest kernels that the processor and the operating system run. */
#include "batch.h"

#ifdef HAIRLUT_BATCH_X86
static int runs_avx2(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2");
}

/* From Ice Lake and Zen 4 on: those have VBMI2, which no kernel needs. The AVX-512 processors before them lower their clock for
 * vectors of 512 bits, also for what the engine runs next. */
static int runs_avx512(void)
{
    return runs_avx2() && __builtin_cpu_supports("popcnt") && __builtin_cpu_supports("avx512f")
           && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")
           && __builtin_cpu_supports("avx512vbmi2");
}
#endif

const hairlut_batch *hairlut_batch_level(int level)
{
    if (level == 0)
        return &hairlut_batch_portable;
#ifdef HAIRLUT_BATCH_X86
    if (level == 1 && runs_avx2())
        return &hairlut_batch_avx2;
    if (level == 2 && runs_avx512())
        return &hairlut_batch_avx512;
#endif
#ifdef HAIRLUT_BATCH_NEON
    if (level == 1)
        return &hairlut_batch_neon;
#endif
    return NULL;
}

/* A few loads and tests of what the C runtime found out when it started: no state of our own. */
const hairlut_batch *hairlut_batch_widest(void)
{
    const hairlut_batch *batch = hairlut_batch_level(0);
    for (int level = 1; hairlut_batch_level(level); ++level)
        batch = hairlut_batch_level(level);
    return batch;
}

void hairlut_sample_direct_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                             const float *u_theta, const float *u_phi, hairlut_samples out)
{
    hairlut_batch_widest()->sample_direct(model, n, theta_r, phi_r, u_theta, u_phi, out);
}

void hairlut_sample_multiple_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                               const float *u_theta, const float *u_phi, hairlut_samples out)
{
    hairlut_batch_widest()->sample_multiple(model, n, theta_r, phi_r, u_theta, u_phi, out);
}

void hairlut_pdf_direct_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                          const float *theta_i, const float *phi_i, float *pdf_angle)
{
    hairlut_batch_widest()->pdf_direct(model, n, theta_r, phi_r, theta_i, phi_i, pdf_angle);
}

void hairlut_pdf_multiple_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                            const float *theta_i, const float *phi_i, float *pdf_angle)
{
    hairlut_batch_widest()->pdf_multiple(model, n, theta_r, phi_r, theta_i, phi_i, pdf_angle);
}
