/* SPDX-License-Identifier: BSD-3-Clause
 * Functions of one direction as calls over arrays: of a function that is not inlined, or vectorised by the compiler. */
#ifndef RIVALS_LOOPS_H
#define RIVALS_LOOPS_H

#include "hair.h"
#include "how.h"

namespace {

inline void put(const rival_arrays &all, size_t i, Sample s)
{
    all.theta_i[i] = s.theta_i;
    all.phi_i[i] = s.phi_i;
    all.pdf_angle[i] = s.pdf_angle;
    all.pdf_solid_angle[i] = s.pdf_solid_angle;
}

/* One lobe of two numbers, one density, and the mixture */
template <Sample (*one)(float, float, float, float)> struct Two {
    RIVAL_ONE static Sample call(float theta_r, float phi_r, float u_theta, float u_phi)
    {
        return one(theta_r, phi_r, u_theta, u_phi);
    }
    static void loop(const rival_arrays *arrays)
    {
        const rival_arrays all = *arrays;
        RIVAL_EACH(i, all.n) put(all, i, call(all.theta_r[i], all.phi_r[i], all.u_theta[i], all.u_phi[i]));
    }
};

template <float (*one)(float, float, float, float)> struct Density {
    RIVAL_ONE static float call(float theta_r, float phi_r, float theta_i, float phi_i)
    {
        return one(theta_r, phi_r, theta_i, phi_i);
    }
    static void loop(const rival_arrays *arrays)
    {
        const rival_arrays all = *arrays;
        RIVAL_EACH(i, all.n) all.pdf_light[i] = call(all.theta_r[i], all.phi_r[i], all.theta_light[i], all.phi_light[i]);
    }
};

template <Sample (*one)(float, float, float, float, float)> struct Three {
    RIVAL_ONE static Sample call(float theta_r, float phi_r, float u_lobe, float u_theta, float u_phi)
    {
        return one(theta_r, phi_r, u_lobe, u_theta, u_phi);
    }
    static void loop(const rival_arrays *arrays)
    {
        const rival_arrays all = *arrays;
        RIVAL_EACH(i, all.n) put(all, i, call(all.theta_r[i], all.phi_r[i], all.u_lobe[i], all.u_theta[i], all.u_phi[i]));
    }
};

/* Both functions for each direction, one after the other; over arrays in one loop, where the compiler shares what they have in
 * common. */
template <class Hair> void vertex(const rival_arrays *arrays)
{
    const rival_arrays all = *arrays;
    RIVAL_EACH(i, all.n)
    {
        put(all, i,
            Three<Hair::sample_hair>::call(all.theta_r[i], all.phi_r[i], all.u_lobe[i], all.u_theta[i], all.u_phi[i]));
        all.pdf_light[i] = Density<Hair::pdf_hair>::call(all.theta_r[i], all.phi_r[i], all.theta_light[i], all.phi_light[i]);
    }
}

template <class Hair> constexpr rival calls(const char *name)
{
    return {"fitted",
            name,
            RIVAL_HOW,
            Two<Hair::sample_direct>::loop,
            Density<Hair::pdf_direct>::loop,
            Two<Hair::sample_multiple>::loop,
            Density<Hair::pdf_multiple>::loop,
            Three<Hair::sample_hair>::loop,
            Density<Hair::pdf_hair>::loop,
            vertex<Hair>,
            nullptr};
}

} // namespace

#endif
