/* The analytic sampler and the hybrid, one call a sample, built with the flags of the library. */
#include "rivals.h"

typedef struct draw {
    float x, pdf;
} draw;

#define CALL __attribute__((noinline)) static

CALL draw analytic(rival_table table, float theta_r, float u)
{
    const rival_lobe lobe = rival_lobe_at(table, theta_r);
    const float start = erff((lobe.low - lobe.mean) / lobe.width);
    const float span = erff((lobe.high - lobe.mean) / lobe.width) - start;
    const float z = rival_erfinv_branch(rival_inside(start + u * span));
    const draw d = {rival_angle(z, lobe.mean, lobe.width, lobe.low, lobe.high), rival_density(z, lobe.width, span)};
    return d;
}

void rival_analytic_scalar(rival_table table, RIVAL_ARRAYS)
{
    for (size_t i = 0; i < n; ++i) {
        const draw d = analytic(table, theta_r[i], u[i]);
        x[i] = d.x;
        pdf[i] = d.pdf;
    }
}

void rival_fill_rows(rival_table table, rival_rows *rows)
{
    for (int j = 0; j < RIVAL_ROWS; ++j) {
        const rival_lobe lobe = rival_lobe_at(table, RIVAL_PI * ((float)j / (RIVAL_ROWS - 1) - 0.5f));
        const float start = erff((lobe.low - lobe.mean) / lobe.width);
        const float span = erff((lobe.high - lobe.mean) / lobe.width) - start;
        const float row[4] = {start, span, lobe.mean, lobe.width};
        for (int k = 0; k < 4; ++k)
            rows->row[j][k] = rows->column[k][j] = row[k];
        rows->low = lobe.low;
        rows->high = lobe.high;
    }
}

CALL draw hybrid(const rival_rows *rows, float theta_r, float u)
{
    float r = (theta_r / RIVAL_PI + 0.5f) * (RIVAL_ROWS - 1);
    r = r > 0.0f ? r : 0.0f;
    r = r < RIVAL_ROWS - 1 ? r : RIVAL_ROWS - 1;
    const int j = (int)r < RIVAL_ROWS - 2 ? (int)r : RIVAL_ROWS - 2;
    const float t = r - (float)j;
    const float *a = rows->row[j], *b = rows->row[j + 1];
    const float start = a[0] + t * (b[0] - a[0]), span = a[1] + t * (b[1] - a[1]);
    const float mean = a[2] + t * (b[2] - a[2]), width = a[3] + t * (b[3] - a[3]);
    const float z = rival_erfinv_branch(rival_inside(start + u * span));
    const draw d = {rival_angle(z, mean, width, rows->low, rows->high), rival_density(z, width, span)};
    return d;
}

void rival_hybrid_scalar(const rival_rows *rows, RIVAL_ARRAYS)
{
    for (size_t i = 0; i < n; ++i) {
        const draw d = hybrid(rows, theta_r[i], u[i]);
        x[i] = d.x;
        pdf[i] = d.pdf;
    }
}
