/* SPDX-License-Identifier: BSD-3-Clause */
#include "exr_slopes.h"

#include "warp.h"

/* What a reader accepts, rad per unit of u. NaN becomes the least. */
static float rounded(double slope)
{
    return (float)(!(slope > 1e-9) ? 1e-9 : slope > 1e12 ? 1e12 : slope);
}

/* At a knot between cells of d0, d1 in x and h0, h1 in u: 1/slope, the density, is that of both cells, blended linearly
 * in x. */
static double inner_slope(double d0, double d1, double h0, double h1)
{
    return (d0 + d1) / (d1 * h0 / d0 + d0 * h1 / d1);
}

/* At an end of a row: a parabola's, from that at the next knot, but at least an eighth of the cell's mean slope. As
 * slopes are positive it is at most twice that. */
static double end_slope(double mean, double next)
{
    const double slope = 2.0 * mean - next;
    return slope < mean / 8.0 ? mean / 8.0 : slope;
}

/* The width in u of cell i. Its ends are counted from the nearer end of the u axis: no cancellation. */
static double cell_width(const hairlut_table *t, const hairlut_warp_scale *scale, int i)
{
    const int last = t->width - 1, near_end = 2 * i >= last ? last - i - 1 : i;
    return hairlut_warp_u(t->warp, scale, t->width, near_end + 1) - hairlut_warp_u(t->warp, scale, t->width, near_end);
}

static void derive_row(const hairlut_table *t, const hairlut_warp_scale *scale, float *row)
{
    const int last = t->width - 1;
    double d0 = 0.0, h0 = 0.0, inner = 0.0;
    for (int i = 0; i < last; ++i) {
        const double d = (double)row[2 * i + 2] - (double)row[2 * i], h = cell_width(t, scale, i);
        if (i > 0) {
            inner = inner_slope(d0, d, h0, h);
            row[2 * i + 1] = rounded(inner);
        }
        if (i == 1)
            row[1] = rounded(end_slope(d0 / h0, inner));
        d0 = d;
        h0 = h;
    }
    row[2 * last + 1] = rounded(end_slope(d0 / h0, inner));
}

void hairlut_exr_derive_slopes(const hairlut_table *table, float *texels)
{
    const hairlut_warp_scale scale = hairlut_scale_warp(table->warp, table->warp_e, table->width);
    for (int j = 0; j < table->height; ++j)
        derive_row(table, &scale, texels + 2 * (size_t)table->width * (size_t)j);
}
