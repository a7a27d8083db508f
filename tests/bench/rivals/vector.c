/* The analytic sampler and the hybrid over arrays, for the compiler to vectorise (-O3 -ffast-math -march=native and the
 * vector mathematics of the C library). Built twice: WIDTH is 256 or 512, the preferred vector width. */
#include "rivals.h"

#define JOIN(a, b) a##b
#define NAME(a, width) JOIN(a, width)

static inline void analytic(rival_table table, size_t n, const float *restrict theta_r, const float *restrict u,
                            float *restrict x, float *restrict pdf)
{
    for (size_t i = 0; i < n; ++i) {
        const rival_lobe lobe = rival_lobe_at(table, theta_r[i]);
        const float start = erff((lobe.low - lobe.mean) / lobe.width);
        const float span = erff((lobe.high - lobe.mean) / lobe.width) - start;
        const float z = rival_erfinv(rival_inside(start + u[i] * span));
        x[i] = rival_angle(z, lobe.mean, lobe.width, lobe.low, lobe.high);
        pdf[i] = rival_density(z, lobe.width, span);
    }
}

/* one loop a table: no switch inside */
void NAME(rival_analytic_vector, WIDTH)(rival_table table, RIVAL_ARRAYS)
{
    switch (table) {
    case PRINTED_DIRECT_THETA:
        analytic(PRINTED_DIRECT_THETA, n, theta_r, u, x, pdf);
        break;
    case FITTED_DIRECT_THETA:
        analytic(FITTED_DIRECT_THETA, n, theta_r, u, x, pdf);
        break;
    case DIRECT_PHI:
        analytic(DIRECT_PHI, n, theta_r, u, x, pdf);
        break;
    case MULTIPLE_THETA:
        analytic(MULTIPLE_THETA, n, theta_r, u, x, pdf);
        break;
    }
}

static inline float blend(const float *column, int j, float t)
{
    return column[j] + t * (column[j + 1] - column[j]);
}

static inline void hybrid(const rival_rows *restrict rows, size_t n, const float *restrict theta_r,
                          const float *restrict u, float *restrict x, float *restrict pdf)
{
    const float low = rows->low, high = rows->high;
    for (size_t i = 0; i < n; ++i) {
        float r = (theta_r[i] / RIVAL_PI + 0.5f) * (RIVAL_ROWS - 1);
        r = r > 0.0f ? r : 0.0f;
        r = r < RIVAL_ROWS - 1 ? r : RIVAL_ROWS - 1;
        const int j = (int)r < RIVAL_ROWS - 2 ? (int)r : RIVAL_ROWS - 2;
        const float t = r - (float)j;
        const float start = blend(rows->column[0], j, t), span = blend(rows->column[1], j, t);
        const float mean = blend(rows->column[2], j, t), width = blend(rows->column[3], j, t);
        const float z = rival_erfinv(rival_inside(start + u[i] * span));
        x[i] = rival_angle(z, mean, width, low, high);
        pdf[i] = rival_density(z, width, span);
    }
}

void NAME(rival_hybrid_vector, WIDTH)(const rival_rows *rows, RIVAL_ARRAYS)
{
    hybrid(rows, n, theta_r, u, x, pdf);
}
