/* What every rival computes: a Gaussian cut to an interval and normalised there (the source text's eqs. 2 to 4), sampled by
 * the inverse of its cumulative probability, with the density of the sample. Single precision, as a renderer would. */
#ifndef RIVALS_LOBE_H
#define RIVALS_LOBE_H

#include <math.h>

typedef enum rival_table {
    PRINTED_DIRECT_THETA,
    FITTED_DIRECT_THETA,
    DIRECT_PHI,
    MULTIPLE_THETA
} rival_table;

typedef struct rival_lobe {
    float mean, width; /* width = sigma sqrt 2 */
    float low, high;
} rival_lobe;

#define RIVAL_PI 3.14159265f
#define RIVAL_DEGREE 0.0174532925f
#define RIVAL_SQRT2 1.41421356f
#define RIVAL_2_SQRT_PI 1.12837917f /* 2 / sqrt pi */

static inline rival_lobe rival_lobe_at(rival_table table, float theta_r)
{
    const float square = theta_r * theta_r, half_pi = 0.5f * RIVAL_PI;
    rival_lobe lobe = {0.0f, 0.29f * RIVAL_SQRT2, -half_pi, half_pi};
    switch (table) {
    case PRINTED_DIRECT_THETA:
        lobe.mean = 2.0f * theta_r - 2.0f * RIVAL_DEGREE;
        break;
    case FITTED_DIRECT_THETA:
        lobe.mean = (3.0f * theta_r - 2.0f) * RIVAL_DEGREE - theta_r;
        break;
    case DIRECT_PHI:
        lobe.mean = RIVAL_PI;
        lobe.width = (0.25f * square * square + 0.59f) * RIVAL_SQRT2;
        lobe.low = 0.0f;
        lobe.high = 2.0f * RIVAL_PI;
        break;
    case MULTIPLE_THETA:
        lobe.mean = (33.5f * sinf(1.25f * theta_r) - 1.0f) * RIVAL_DEGREE - theta_r;
        lobe.width = (0.05f * square * square + 0.49f) * RIVAL_SQRT2;
        break;
    }
    return lobe;
}

/* The inverse of erf in single precision, with the published coefficients of M. Giles, "Approximating the erfinv
 * function" (GPU Computing Gems, 2011): one polynomial for the middle, one for the tails. */
static inline float rival_erfinv(float x)
{
    const float w = -logf((1.0f - x) * (1.0f + x));
    const float a = w - 2.5f, b = sqrtf(w > 5.0f ? w : 5.0f) - 3.0f;
    float p = 2.81022636e-08f, q = -0.000200214257f;
    p = 3.43273939e-07f + p * a;
    p = -3.5233877e-06f + p * a;
    p = -4.39150654e-06f + p * a;
    p = 0.00021858087f + p * a;
    p = -0.00125372503f + p * a;
    p = -0.00417768164f + p * a;
    p = 0.246640727f + p * a;
    p = 1.50140941f + p * a;
    q = 0.000100950558f + q * b;
    q = 0.00134934322f + q * b;
    q = -0.00367342844f + q * b;
    q = 0.00573950773f + q * b;
    q = -0.0076224613f + q * b;
    q = 0.00943887047f + q * b;
    q = 1.00167406f + q * b;
    q = 2.83297682f + q * b;
    return (w < 5.0f ? p : q) * x;
}

/* The same with the branch that a scalar program takes. */
static inline float rival_erfinv_branch(float x)
{
    const float w = -logf((1.0f - x) * (1.0f + x));
    float p;
    if (w < 5.0f) {
        const float a = w - 2.5f;
        p = 2.81022636e-08f;
        p = 3.43273939e-07f + p * a;
        p = -3.5233877e-06f + p * a;
        p = -4.39150654e-06f + p * a;
        p = 0.00021858087f + p * a;
        p = -0.00125372503f + p * a;
        p = -0.00417768164f + p * a;
        p = 0.246640727f + p * a;
        p = 1.50140941f + p * a;
    } else {
        const float b = sqrtf(w) - 3.0f;
        p = -0.000200214257f;
        p = 0.000100950558f + p * b;
        p = 0.00134934322f + p * b;
        p = -0.00367342844f + p * b;
        p = 0.00573950773f + p * b;
        p = -0.0076224613f + p * b;
        p = 0.00943887047f + p * b;
        p = 1.00167406f + p * b;
        p = 2.83297682f + p * b;
    }
    return p * x;
}

/* erf stays off its poles: the smallest step of a float below 1 */
static inline float rival_inside(float e)
{
    e = e < 0.99999994f ? e : 0.99999994f;
    return e > -0.99999994f ? e : -0.99999994f;
}

/* The end of every rival: the angle of e = erf((x - mean)/width), kept in the interval, and its density, where span is
 * erf's difference over the interval. */
static inline float rival_angle(float z, float mean, float width, float low, float high)
{
    float x = mean + width * z;
    x = x < high ? x : high;
    return x > low ? x : low;
}

static inline float rival_density(float z, float width, float span)
{
    return RIVAL_2_SQRT_PI * expf(-z * z) / (width * span);
}

/* The hybrid's table: what depends on theta_r alone, at ROWS places, interpolated linearly. */
enum { RIVAL_ROWS = 64 };
typedef struct rival_rows {
    float low, high;
    float row[RIVAL_ROWS][4];    /* erf at the low end, erf's span, mean, width */
    float column[4][RIVAL_ROWS]; /* the same, as compilers can gather it */
} rival_rows;

#endif
