/* The passes of batch_kernel.h for one axis. n is a multiple of LANES. */
#include "batch_kernel.h"

#include "axis_bench.h"

static void axis_sample(const hairlut_axis *shared, size_t n, const float *theta_r, const float *u, float *x, float *pdf)
{
    const hairlut_axis copy = *shared, *axis = &copy;
    for (size_t b = 0; b < n; b += BLOCK) {
        const size_t m = n - b < BLOCK ? n - b : BLOCK;
        draws q;
        place(axis, m, theta_r + b, u + b, &q, NULL);
        fetch(axis, m, &q);
        for (size_t s = 0; s < m; s += LANES) {
            real slope;
            store(x + b + s, clamp(draw(&q, s, &slope), all(axis->low), all(axis->high)));
            store(pdf + b + s, over(all(1.0f), slope));
        }
    }
}

static void axis_pdf(const hairlut_axis *axis, size_t n, const float *theta_r, const float *x, float *pdf)
{
    for (size_t b = 0; b < n; b += BLOCK) {
        const size_t m = n - b < BLOCK ? n - b : BLOCK;
        queries q;
        float holds[BLOCK];
        for (size_t s = 0; s < m; s += LANES) {
            const mask inside = ask(axis, load(theta_r + b + s), load(x + b + s), &q, s);
            store(holds + s, choose(inside, all(1.0f), all(0.0f)));
        }
        find_cells(axis, m, &q);
        for (size_t s = 0; s < m; s += LANES)
            store(pdf + b + s, over(load(holds + s), slope_at(&q, s)));
    }
}
