/* One call a sample, as a renderer does. */
#include "axis.h"

#include "axis_bench.h"

typedef struct drawn {
    float x, pdf;
} drawn;

__attribute__((noinline)) static drawn draw(const hairlut_axis *axis, float theta_r, float u)
{
    const hairlut_draw d = hairlut_axis_sample(axis, theta_r, u);
    const drawn result = {hairlut_axis_inside(axis, d.x), 1.0f / d.slope};
    return result;
}

__attribute__((noinline)) static float density(const hairlut_axis *axis, float theta_r, float x)
{
    return hairlut_axis_holds(axis, x) / hairlut_axis_slope(axis, hairlut_axis_look_up(axis, theta_r, x), x);
}

static void sample(const hairlut_axis *axis, size_t n, const float *theta_r, const float *u, float *x, float *pdf)
{
    for (size_t i = 0; i < n; ++i) {
        const drawn d = draw(axis, theta_r[i], u[i]);
        x[i] = d.x;
        pdf[i] = d.pdf;
    }
}

static void pdf_of(const hairlut_axis *axis, size_t n, const float *theta_r, const float *x, float *pdf)
{
    for (size_t i = 0; i < n; ++i)
        pdf[i] = density(axis, theta_r[i], x[i]);
}

const axis_kernels axis_scalar = {"scalar", sample, pdf_of, NULL, NULL};
