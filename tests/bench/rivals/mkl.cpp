/* SPDX-License-Identifier: BSD-3-Clause
 * The closed form of `fitted` with the vector mathematics of MKL, in its fastest mode: erf and its inverse over blocks that stay
 * in the first-level cache, the rest vectorised by the compiler. */
#include <mkl_vml.h>

#define RIVAL_ARRAYS_WIDTH 512
#include "loops.h"

namespace {

constexpr int block = 256;
constexpr MKL_INT64 mode = VML_EP | VML_FTZDAZ_ON | VML_ERRMODE_IGNORE;
using Curve = Gaussian<Libm>; /* its widths and its bell; erf and the inverse are MKL's */

/* The rows of one axis for a block of theta_r */
template <Axis axis> struct Rows {
    float mean[block], width[block], start[block], span[block];

    void fill(int m, const float *theta_r)
    {
        float end[block];
        for (int i = 0; i < m; ++i) {
            const Lobe at = lobe<axis>(theta_r[i]);
            mean[i] = at.mean;
            width[i] = Curve::width_of_sigma * at.sigma;
            start[i] = (at.low - at.mean) / width[i];
            end[i] = (at.high - at.mean) / width[i];
        }
        vmsErf(m, start, start, mode);
        vmsErf(m, end, end, mode);
        for (int i = 0; i < m; ++i)
            span[i] = end[i] - start[i];
    }
    Row operator[](int i) const
    {
        const Lobe ends = lobe<axis>(0.0f);
        return {mean[i], width[i], start[i], span[i], ends.low, ends.high};
    }
};

/* z of u for each row of a block */
template <class Of> void invert(int m, const Of &row, const float *u, float *z)
{
    for (int i = 0; i < m; ++i)
        z[i] = Curve::inside(value(row(i), u[i]));
    vmsErfInv(m, z, z, mode);
}

/* f(s, m) for blocks of m from s on */
template <class Each> void blocks(size_t n, Each f)
{
    for (size_t s = 0; s < n; s += block)
        f(s, n - s < block ? (int)(n - s) : block);
}

void sample_direct(const rival_arrays *all)
{
    static thread_local Rows<direct_theta> theta;
    static thread_local Rows<direct_phi> phi;
    blocks(all->n, [all](size_t s, int m) {
        float z_theta[block], z_phi[block];
        theta.fill(m, all->theta_r + s);
        phi.fill(m, all->theta_r + s);
        invert(m, [](int i) { return theta[i]; }, all->u_theta + s, z_theta);
        invert(m, [](int i) { return phi[i]; }, all->u_phi + s, z_phi);
        RIVAL_EACH(i, (size_t)m)
        put(*all, s + i,
            sample_of(angle(theta[(int)i], z_theta[i]), turned(all->phi_r[s + i], angle(phi[(int)i], z_phi[i])),
                      density_at<Curve>(theta[(int)i], z_theta[i]) * density_at<Curve>(phi[(int)i], z_phi[i])));
    });
}

void sample_multiple(const rival_arrays *all)
{
    static thread_local Rows<multiple_theta> theta;
    blocks(all->n, [all](size_t s, int m) {
        float z[block];
        theta.fill(m, all->theta_r + s);
        invert(m, [](int i) { return theta[i]; }, all->u_theta + s, z);
        RIVAL_EACH(i, (size_t)m)
        put(*all, s + i,
            sample_of(angle(theta[(int)i], z[i]), 2.0f * pi * all->u_phi[s + i] - pi,
                      density_at<Curve>(theta[(int)i], z[i]) * uniform_azimuth));
    });
}

void pdf_direct(const rival_arrays *all)
{
    static thread_local Rows<direct_theta> theta;
    static thread_local Rows<direct_phi> phi;
    blocks(all->n, [all](size_t s, int m) {
        theta.fill(m, all->theta_r + s);
        phi.fill(m, all->theta_r + s);
        RIVAL_EACH(i, (size_t)m)
        all->pdf_light[s + i] = density_of<Curve>(theta[(int)i], all->theta_light[s + i]) *
                                density_of<Curve>(phi[(int)i], relative(all->phi_r[s + i], all->phi_light[s + i]));
    });
}

void pdf_multiple(const rival_arrays *all)
{
    static thread_local Rows<multiple_theta> theta;
    blocks(all->n, [all](size_t s, int m) {
        theta.fill(m, all->theta_r + s);
        RIVAL_EACH(i, (size_t)m)
        all->pdf_light[s + i] = density_of<Curve>(theta[(int)i], all->theta_light[s + i]) * uniform_azimuth;
    });
}

/* All rows of the hair, for a block */
struct HairRows {
    Rows<direct_theta> first;
    Rows<direct_phi> phi;
    Rows<multiple_theta> second;

    void fill(int m, const float *theta_r)
    {
        first.fill(m, theta_r);
        phi.fill(m, theta_r);
        second.fill(m, theta_r);
    }
    float density(int i, float phi_r, float theta_i, float phi_i) const
    {
        return share * density_of<Curve>(first[i], theta_i) * density_of<Curve>(phi[i], relative(phi_r, phi_i)) +
               (1.0f - share) * uniform_azimuth * density_of<Curve>(second[i], theta_i);
    }
};

void sample_block(const rival_arrays *arrays, const HairRows &rows, size_t s, int m)
{
    const rival_arrays all = *arrays;
    const float *u_lobe = all.u_lobe + s;
    float z_theta[block], z_phi[block];
    invert(m, [&](int i) { return u_lobe[i] < share ? rows.first[i] : rows.second[i]; }, all.u_theta + s, z_theta);
    invert(m, [&](int i) { return rows.phi[i]; }, all.u_phi + s, z_phi);
    RIVAL_EACH(k, (size_t)m)
    {
        const int i = (int)k;
        const Row first = rows.first[i], second = rows.second[i];
        const float mean = u_lobe[k] < share ? first.mean : second.mean,
                    width = u_lobe[k] < share ? first.width : second.width;
        const float theta_i = angle({mean, width, 0.0f, 0.0f, first.low, first.high}, z_theta[k]);
        const float phi_r = all.phi_r[s + k], drawn = turned(phi_r, angle(rows.phi[i], z_phi[k]));
        const float phi_i = u_lobe[k] < share ? drawn : 2.0f * pi * all.u_phi[s + k] - pi;
        put(all, s + k, sample_of(theta_i, phi_i, rows.density(i, phi_r, theta_i, phi_i)));
    }
}

void density_block(const rival_arrays *all, const HairRows &rows, size_t s, int m)
{
    RIVAL_EACH(k, (size_t)m)
    all->pdf_light[s + k] = rows.density((int)k, all->phi_r[s + k], all->theta_light[s + k], all->phi_light[s + k]);
}

thread_local HairRows rows;

void sample_hair(const rival_arrays *all)
{
    blocks(all->n, [all](size_t s, int m) {
        rows.fill(m, all->theta_r + s);
        sample_block(all, rows, s, m);
    });
}

void pdf_hair(const rival_arrays *all)
{
    blocks(all->n, [all](size_t s, int m) {
        rows.fill(m, all->theta_r + s);
        density_block(all, rows, s, m);
    });
}

void vertex(const rival_arrays *all)
{
    blocks(all->n, [all](size_t s, int m) {
        rows.fill(m, all->theta_r + s);
        sample_block(all, rows, s, m);
        density_block(all, rows, s, m);
    });
}

} // namespace

extern "C" const rival rivals_mkl[] = {
    {"fitted", "MKL", "arrays", sample_direct, pdf_direct, sample_multiple, pdf_multiple, sample_hair, pdf_hair, vertex},
    {},
};
