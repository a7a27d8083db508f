/* SPDX-License-Identifier: BSD-3-Clause
 * The closed form of `fitted`: Gaussians cut to an interval and normalised there (the source text's eqs. 2 to 4), and the
 * logistic that Chiang 2016 puts in a Gaussian's place. Single precision throughout, as a renderer would. */
#ifndef RIVALS_GAUSSIAN_H
#define RIVALS_GAUSSIAN_H

#include <cmath>

#include "giles.h"

namespace {

constexpr float pi = 3.14159265f, half_pi = 1.57079633f, degree = 0.0174532925f;

enum Axis { direct_theta, direct_phi, multiple_theta, axes };

struct Lobe {
    float mean, sigma, low, high;
};

template <Axis axis> inline Lobe lobe(float theta_r)
{
    const float fourth = theta_r * theta_r * theta_r * theta_r;
    if (axis == direct_theta)
        return {(3.0f * theta_r - 2.0f) * degree - theta_r, 0.29f, -half_pi, half_pi};
    if (axis == direct_phi)
        return {pi, 0.25f * fourth + 0.59f, 0.0f, 2.0f * pi};
    return {(33.5f * sinf(1.25f * theta_r) - 1.0f) * degree - theta_r, 0.05f * fourth + 0.49f, -half_pi, half_pi};
}

/* Where erf and its inverse come from. */
struct Libm {
    static float erf(float x) { return erff(x); }
    static float erf_inverse(float x) { return giles(x); }
};

/* A bell curve: its width for a lobe's sigma, its CDF in any unit, the CDF's inverse, and its density times width, in the
 * CDF's unit. z is an angle from the mean, over the width. */
template <class Functions> struct Gaussian {
    static constexpr float width_of_sigma = 1.41421356f;
    static float cdf(float z) { return Functions::erf(z); }
    static float inverse(float e) { return Functions::erf_inverse(inside(e)); }
    static float bell(float z) { return 1.12837917f * expf(-z * z); } /* 2 / sqrt pi */
    /* off the poles of the inverse: the smallest step of a float below 1 */
    static float inside(float e)
    {
        e = e < 0.99999994f ? e : 0.99999994f;
        return e > -0.99999994f ? e : -0.99999994f;
    }
};

struct Logistic {
    static constexpr float width_of_sigma = 0.551328895f; /* sqrt 3 / pi: the same variance */
    static float cdf(float z) { return 1.0f / (1.0f + expf(-z)); }
    static float inverse(float v)
    {
        v = v < 0.99999994f ? v : 0.99999994f;
        v = v > 1e-9f ? v : 1e-9f;
        return logf(v / (1.0f - v));
    }
    static float bell(float z)
    {
        const float e = expf(-fabsf(z));
        return e / ((1.0f + e) * (1.0f + e));
    }
};

/* A lobe at one theta_r, ready to sample: the CDF at the low end and its difference over the interval. */
struct Row {
    float mean, width, start, span, low, high;
};

/* Rows computed anew for each sample. */
template <class Curve> struct Computed {
    template <Axis axis> static Row row(float theta_r)
    {
        const Lobe at = lobe<axis>(theta_r);
        const float width = Curve::width_of_sigma * at.sigma;
        const float start = Curve::cdf((at.low - at.mean) / width), end = Curve::cdf((at.high - at.mean) / width);
        return {at.mean, width, start, end - start, at.low, at.high};
    }
};

/* The hybrid: rows tabulated at nodes of theta_r and interpolated. A column each, as compilers can gather them; or a record
 * each, for one call at a time. */
template <class Curve> struct Tabulated {
    static constexpr int nodes = 64;
    float column[axes][4][nodes];
    float record[axes][nodes][4];
    static const Tabulated table;

    Tabulated()
    {
        fill<direct_theta>();
        fill<direct_phi>();
        fill<multiple_theta>();
    }

    template <Axis axis> void fill()
    {
        for (int j = 0; j < nodes; ++j) {
            const Row at = Computed<Curve>::template row<axis>(pi * ((float)j / (nodes - 1) - 0.5f));
            const float four[4] = {at.mean, at.width, at.start, at.span};
            for (int k = 0; k < 4; ++k)
                column[axis][k][j] = record[axis][j][k] = four[k];
        }
    }

    template <Axis axis> static Row row(float theta_r)
    {
        float r = (theta_r / pi + 0.5f) * (nodes - 1);
        r = r > 0.0f ? r : 0.0f;
        r = r < nodes - 1 ? r : nodes - 1;
        const int j = (int)r < nodes - 2 ? (int)r : nodes - 2;
        const float t = r - (float)j;
#ifdef RIVAL_ARRAYS_WIDTH
        const auto blend = [j, t](int k) {
            const auto &at = table.column[axis][k]; /* gathers need the index, not a pointer */
            return at[j] + t * (at[j + 1] - at[j]);
        };
#else
        const float *a = table.record[axis][j], *b = table.record[axis][j + 1];
        const auto blend = [a, b, t](int k) { return a[k] + t * (b[k] - a[k]); };
#endif
        const Lobe ends = lobe<axis>(0.0f);
        return {blend(0), blend(1), blend(2), blend(3), ends.low, ends.high};
    }
};

template <class Curve> const Tabulated<Curve> Tabulated<Curve>::table;

} // namespace

#endif
