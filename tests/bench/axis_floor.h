/* The floor below which no table of this layout gets: a 16-byte load of a cell's four corners and a transpose. n is a multiple
 * of LANES. */
#include "batch_kernel.h"

#include "axis_bench.h"

static inline void store_corners(const float *cells, const int *at, float *corners)
{
    real corner[4];
    gather4(cells, at, corner);
    for (int k = 0; k < 4; ++k)
        store(corners + k * LANES, corner[k]);
}

static void floor_index(const float *cells, size_t n, const int *index, float *corners)
{
    for (size_t s = 0; s < n; s += LANES)
        store_corners(cells, index + s, corners + 4 * s);
}

static void floor_angles(const hairlut_axis *axis, const float *cells, size_t n, const float *theta_r, const float *u,
                         float *corners)
{
    const real columns = all((float)(axis->columns - 1)), origin = all(axis->row_origin), scale = all(axis->row_scale);
    for (size_t b = 0; b < n; b += BLOCK) {
        int at[BLOCK];
        const size_t m = n - b < BLOCK ? n - b : BLOCK;
        for (size_t s = 0; s < m; s += LANES) {
            const whole j = truncated(mul(sub(load(theta_r + b + s), origin), scale));
            const whole i = truncated(mul(load(u + b + s), columns));
            const whole cell = iadd(imul(j, iall(axis->columns - 1)), i);
            istore(at + s, iadd(iadd(cell, cell), iadd(cell, cell)));
        }
        for (size_t s = 0; s < m; s += LANES)
            store_corners(cells, at + s, corners + 4 * (b + s));
    }
}
