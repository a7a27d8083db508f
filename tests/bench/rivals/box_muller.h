/* SPDX-License-Identifier: BSD-3-Clause
 * The Gaussians of `fitted` by Box and Muller (1958): two normal numbers from two uniform ones, drawn again until they lie in
 * their intervals. It needs no inverse, but an unknown number of uniform numbers, and it tears up their low discrepancy. The
 * density still needs erf at the ends. */
#ifndef RIVALS_BOX_MULLER_H
#define RIVALS_BOX_MULLER_H

#include <cstdint>
#include <cstring>

#include "loops.h"

namespace {

/* Further uniform numbers, from those that were rejected: a hash (splitmix, 32 bits) of their bits. */
inline float next(float u)
{
    uint32_t bits;
    std::memcpy(&bits, &u, sizeof bits);
    bits += 0x9e3779b9u;
    bits = (bits ^ (bits >> 16)) * 0x21f0aaadu;
    bits = (bits ^ (bits >> 15)) * 0x735a2d97u;
    return (float)((bits ^ (bits >> 15)) >> 8) * 0x1p-24f;
}

struct Pair {
    float first, second;
};

/* Two independent normal numbers over sqrt 2 */
inline Pair normal(float u, float v)
{
    const float radius = sqrtf(-logf(1.0f - u)), turn = 2.0f * pi * v;
    return {radius * cosf(turn), radius * sinf(turn)};
}

inline bool contains(const Row &row, float x)
{
    return x >= row.low && x <= row.high;
}

template <class Rows> struct BoxMuller : Hair<Rows, Gaussian<Libm>> {
    using Base = Hair<Rows, Gaussian<Libm>>;

    static Sample sample_direct(float theta_r, float phi_r, float u_theta, float u_phi)
    {
        const Row theta = Rows::template row<direct_theta>(theta_r), phi = Rows::template row<direct_phi>(theta_r);
        Pair z = normal(u_theta, u_phi);
        while (!(contains(theta, theta.mean + theta.width * z.first) && contains(phi, phi.mean + phi.width * z.second))) {
            u_theta = next(u_theta);
            u_phi = next(u_phi + 1.0f);
            z = normal(u_theta, u_phi);
        }
        return sample_of(angle(theta, z.first), turned(phi_r, angle(phi, z.second)),
                         density_at<Gaussian<Libm>>(theta, z.first) * density_at<Gaussian<Libm>>(phi, z.second));
    }

    static Sample sample_multiple(float theta_r, float, float u_theta, float u_phi)
    {
        const Row theta = Rows::template row<multiple_theta>(theta_r);
        const float phi_i = 2.0f * pi * u_phi - pi;
        float z = normal(u_theta, u_phi = next(u_phi)).first;
        while (!contains(theta, theta.mean + theta.width * z)) {
            u_theta = next(u_theta);
            u_phi = next(u_phi + 1.0f);
            z = normal(u_theta, u_phi).first;
        }
        return sample_of(angle(theta, z), phi_i, density_at<Gaussian<Libm>>(theta, z) * uniform_azimuth);
    }

    static Sample sample_hair(float theta_r, float phi_r, float u_lobe, float u_theta, float u_phi)
    {
        if (u_lobe < share) {
            const Sample drawn = sample_direct(theta_r, phi_r, u_theta, u_phi);
            return sample_of(drawn.theta_i, drawn.phi_i, Base::pdf_hair(theta_r, phi_r, drawn.theta_i, drawn.phi_i));
        }
        const Sample drawn = sample_multiple(theta_r, phi_r, u_theta, u_phi);
        return sample_of(drawn.theta_i, drawn.phi_i, Base::pdf_hair(theta_r, phi_r, drawn.theta_i, drawn.phi_i));
    }
};

/* The rows tabulated, as the hybrid's: its faster form. Densities are the hybrid's. */
constexpr rival box_muller_calls()
{
    using Own = BoxMuller<Tabulated<Gaussian<Libm>>>;
    rival all = calls<Own>("Box-Muller");
    all.pdf_direct = all.pdf_multiple = all.pdf_hair = nullptr;
    return all;
}

} // namespace

#endif
