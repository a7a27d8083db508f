/* SPDX-License-Identifier: BSD-3-Clause
 * Whole calls on the hair `fitted`, for any curve and any way to its rows. The direct lobe is a curve in theta_i times one in
 * phi_i - phi_r; the multiple lobe is a curve in theta_i, with a uniform azimuth; the hair is an equal mixture of both. */
#ifndef RIVALS_HAIR_H
#define RIVALS_HAIR_H

#include "gaussian.h"
#include "rivals.h"

namespace {

constexpr float uniform_azimuth = 0.159154943f; /* 1 / (2 pi) */
constexpr float share = 0.5f;                   /* of the direct lobe */

struct Sample {
    float theta_i, phi_i, pdf_angle, pdf_solid_angle;
};

inline Sample sample_of(float theta_i, float phi_i, float density)
{
    return {theta_i, phi_i, density, density / cosf(theta_i)};
}

/* phi_r + relative in [-pi, pi), and phi_i - phi_r in [0, 2 pi), for azimuths in [-pi, pi) */
inline float turned(float phi_r, float relative)
{
    const float phi = phi_r + relative;
    return phi < pi ? phi : phi - 2.0f * pi;
}

inline float relative(float phi_r, float phi_i)
{
    const float turn = phi_i - phi_r;
    return turn < 0.0f ? turn + 2.0f * pi : turn;
}

inline float angle(const Row &row, float z)
{
    float x = row.mean + row.width * z;
    x = x < row.high ? x : row.high;
    return x > row.low ? x : row.low;
}

inline float value(const Row &row, float u)
{
    return row.start + u * row.span;
}

template <class Curve> float density_at(const Row &row, float z)
{
    return Curve::bell(z) / (row.width * row.span);
}

template <class Curve> float density_of(const Row &row, float x)
{
    return density_at<Curve>(row, (x - row.mean) / row.width);
}

template <class Rows, class Curve> struct Hair {
    static Sample sample_direct(float theta_r, float phi_r, float u_theta, float u_phi)
    {
        const Row theta = Rows::template row<direct_theta>(theta_r), phi = Rows::template row<direct_phi>(theta_r);
        const float z_theta = Curve::inverse(value(theta, u_theta)), z_phi = Curve::inverse(value(phi, u_phi));
        return sample_of(angle(theta, z_theta), turned(phi_r, angle(phi, z_phi)),
                         density_at<Curve>(theta, z_theta) * density_at<Curve>(phi, z_phi));
    }

    static float pdf_direct(float theta_r, float phi_r, float theta_i, float phi_i)
    {
        return density_of<Curve>(Rows::template row<direct_theta>(theta_r), theta_i) *
               density_of<Curve>(Rows::template row<direct_phi>(theta_r), relative(phi_r, phi_i));
    }

    static Sample sample_multiple(float theta_r, float, float u_theta, float u_phi)
    {
        const Row theta = Rows::template row<multiple_theta>(theta_r);
        const float z = Curve::inverse(value(theta, u_theta));
        return sample_of(angle(theta, z), 2.0f * pi * u_phi - pi, density_at<Curve>(theta, z) * uniform_azimuth);
    }

    static float pdf_multiple(float theta_r, float, float theta_i, float)
    {
        return density_of<Curve>(Rows::template row<multiple_theta>(theta_r), theta_i) * uniform_azimuth;
    }

    static float pdf_hair(float theta_r, float phi_r, float theta_i, float phi_i)
    {
        return share * pdf_direct(theta_r, phi_r, theta_i, phi_i) +
               (1.0f - share) * pdf_multiple(theta_r, phi_r, theta_i, phi_i);
    }

#ifdef RIVAL_ARRAYS_WIDTH
    /* both lobes' rows, and a choice */
    static Sample sample_hair(float theta_r, float phi_r, float u_lobe, float u_theta, float u_phi)
    {
        const Row first = Rows::template row<direct_theta>(theta_r), phi = Rows::template row<direct_phi>(theta_r);
        const Row second = Rows::template row<multiple_theta>(theta_r);
        const bool direct = u_lobe < share;
        const Row theta = {direct ? first.mean : second.mean,
                           direct ? first.width : second.width,
                           direct ? first.start : second.start,
                           direct ? first.span : second.span,
                           first.low,
                           first.high};
        const float theta_i = angle(theta, Curve::inverse(value(theta, u_theta)));
        const float drawn = angle(phi, Curve::inverse(value(phi, u_phi)));
        const float phi_i = direct ? turned(phi_r, drawn) : 2.0f * pi * u_phi - pi;
        return sample_of(theta_i, phi_i,
                         share * density_of<Curve>(first, theta_i) * density_of<Curve>(phi, relative(phi_r, phi_i)) +
                             (1.0f - share) * uniform_azimuth * density_of<Curve>(second, theta_i));
    }
#else
    static Sample sample_hair(float theta_r, float phi_r, float u_lobe, float u_theta, float u_phi)
    {
        if (u_lobe < share) {
            const Sample drawn = sample_direct(theta_r, phi_r, u_theta, u_phi);
            return sample_of(drawn.theta_i, drawn.phi_i,
                             share * drawn.pdf_angle +
                                 (1.0f - share) * pdf_multiple(theta_r, phi_r, drawn.theta_i, drawn.phi_i));
        }
        const Sample drawn = sample_multiple(theta_r, phi_r, u_theta, u_phi);
        return sample_of(drawn.theta_i, drawn.phi_i,
                         share * pdf_direct(theta_r, phi_r, drawn.theta_i, drawn.phi_i) + (1.0f - share) * drawn.pdf_angle);
    }
#endif
};

} // namespace

#endif
