/* SPDX-License-Identifier: BSD-3-Clause */
/* A lobe for a block: lobe.h, operation by operation. n is a multiple of LANES, at most BLOCK. */
#ifndef HAIRLUT_BATCH_LOBE_H
#define HAIRLUT_BATCH_LOBE_H

#include "batch_angle.h"
#include "batch_strand_axis.h"
#include "lobe.h"

/* A lobe's tables at strands. */
typedef struct strand_lobe {
    strand_table theta, phi;
} strand_lobe;

/* Without parameters */
static const strand_lobe no_strands;

/* Lobe k at the strands of a block from `from` on; NULL: no parameters */
static inline strand_lobe lobe_at(strand_block *block, int k, size_t from)
{
    strand_lobe lobe = no_strands;
    if (block) {
        lobe.theta = table_at(block, &block->strands->theta[k].nodes, &block->theta, from);
        lobe.phi = table_at(block, &block->strands->phi[k].nodes, &block->phi, from);
    }
    return lobe;
}

/* At the strands of a list of n in the block */
static inline strand_lobe listed_lobe(strand_block *block, int k, const int *list, size_t n)
{
    strand_lobe lobe = lobe_at(block, k, 0);
    if (block) {
        list_strands(&lobe.theta, list, n, &block->listed_theta);
        list_strands(&lobe.phi, list, n, &block->listed_phi);
    }
    return lobe;
}

/* hairlut_lobe_draw */
static inline void draw_lobe(const hairlut_lobe *lobe, const strand_lobe *strands, size_t n, const float *theta_r,
                             const float *u_theta, const float *u_phi, float *theta_i, float *azimuth, float *pdf)
{
    axis_samples theta, phi;
    place(&lobe->theta, n, theta_r, u_theta, &theta);
    if (!lobe->uniform)
        place(&lobe->phi, n, theta_r, u_phi, &phi);
    fetch_samples_at(&lobe->theta, &strands->theta, n, &theta);
    if (!lobe->uniform)
        fetch_samples_at(&lobe->phi, &strands->phi, n, &phi);
    for (size_t s = 0; s < n; s += LANES) {
        real theta_slope, phi_slope;
        store(theta_i + s, draw(&theta, s, &theta_slope));
        if (lobe->uniform) {
            const real x = sub(mul(all(hairlut_two_pi), clamp(load(u_phi + s), all(0.0f), all(1.0f))), all(hairlut_pi));
            store(azimuth + s, choose(greater(all(hairlut_pi), x), x, all(-hairlut_pi)));
            store(pdf + s, over(all(hairlut_inverse_two_pi), theta_slope));
        } else {
            store(azimuth + s, draw(&phi, s, &phi_slope));
            store(pdf + s, over(all(1.0f), mul(theta_slope, phi_slope)));
        }
    }
}

/* hairlut_densities, of a lobe. azimuth: relative; not read where it is uniform. */
static inline void lobe_density(const hairlut_lobe *lobe, const strand_lobe *strands, size_t n, const float *theta_r,
                                const float *theta_i, const float *azimuth, float *pdf)
{
    axis_searches theta, phi;
    float contains[BLOCK]; /* 1, or 0 where the lobe's domain does not contain the direction */
    for (size_t s = 0; s < n; s += LANES) {
        const real r = load(theta_r + s);
        mask inside = begin_search(&lobe->theta, r, load(theta_i + s), &theta, s);
        if (!lobe->uniform)
            inside = both(inside, begin_search(&lobe->phi, r, load(azimuth + s), &phi, s));
        store(contains + s, choose(inside, all(1.0f), all(0.0f)));
    }
    end_search_at(&lobe->theta, &strands->theta, n, &theta);
    if (!lobe->uniform)
        end_search_at(&lobe->phi, &strands->phi, n, &phi);
    for (size_t s = 0; s < n; s += LANES) {
        real theta_root, phi_root;
        const real theta_bend = inverse(&theta, s, &theta_root), known = load(contains + s);
        if (lobe->uniform) {
            store(pdf + s, over(mul(known, mul(theta_bend, all(hairlut_inverse_two_pi))), theta_root));
        } else {
            const real phi_bend = inverse(&phi, s, &phi_root);
            store(pdf + s, over(mul(known, mul(theta_bend, phi_bend)), mul(theta_root, phi_root)));
        }
    }
}

/* hairlut_known, for the arguments of a sample or a density */
static inline mask known(real theta_r, real phi_r, real a, real b)
{
    return both(numbers(theta_r, a), numbers(b, sub(phi_r, phi_r)));
}

/* hairlut_table_azimuth */
static inline real table_azimuth(const hairlut_lobe *lobe, real r, real i, real turn, real side)
{
    return wrap_near(sub(mul(side, add(i, mul(all(lobe->sign), r))), turn), 0.0f);
}

/* hairlut_incident_azimuth */
static inline real incident_azimuth(const hairlut_lobe *lobe, real r, real x, real turn, real side)
{
    return wrap_near(sub(mul(side, add(x, turn)), mul(all(lobe->sign), r)), -hairlut_pi);
}

/* 1 where an azimuth is finite, which matters where it is read. */
static inline mask is_finite(real x)
{
    return at_least(all(FLT_MAX), magnitude(x));
}

/* hairlut_sample_lobe. The last pass reads the inputs of no vector but its own, before it writes there: outputs may be in place. */
static inline void sample_lobe_block(const hairlut_model *model, int lobe, size_t n, const float *const in[4],
                                     hairlut_samples out)
{
    const hairlut_lobe *l = &model->lobes[lobe];
    float theta_i[BLOCK], azimuth[BLOCK], pdf[BLOCK], valid[BLOCK];
    draw_lobe(l, &no_strands, n, in[0], in[2], in[3], theta_i, azimuth, pdf);
    for (size_t s = 0; s < n; s += LANES) {
        const real phi_r = load(in[1] + s), x = load(azimuth + s);
        const mask is_known = known(load(in[0] + s), phi_r, load(in[2] + s), load(in[3] + s));
        const real turned = incident_azimuth(l, wrap(phi_r, -hairlut_pi), x, all(0.0f), all(1.0f));
        store(valid + s, choose(is_known, load(pdf + s), all(0.0f)));
        store(azimuth + s, l->uniform ? x : turned);
    }
    for (size_t s = 0; s < n; s += LANES) {
        const real theta = load(theta_i + s), density = load(valid + s);
        store(out.theta_i + s, clamp(theta, all(l->theta.low), all(l->theta.high)));
        store(out.phi_i + s, load(azimuth + s));
        if (out.pdf_angle)
            store(out.pdf_angle + s, density);
        if (out.pdf_solid_angle)
            store(out.pdf_solid_angle + s, over(density, cosine(theta)));
    }
}

/* hairlut_pdf_lobe */
static inline void pdf_lobe_block(const hairlut_model *model, int lobe, size_t n, const float *const in[4], float *out)
{
    const hairlut_lobe *l = &model->lobes[lobe];
    float azimuth[BLOCK], valid[BLOCK], pdf[BLOCK];
    size_t first = 0;
    do { /* n is not 0, and so gcc sees that all of azimuth is set */
        const real phi_r = load(in[1] + first), phi_i = load(in[3] + first);
        const mask is_known = both(known(load(in[0] + first), phi_r, load(in[2] + first), phi_i), is_finite(phi_i));
        store(valid + first, choose(is_known, all(1.0f), all(0.0f)));
        const real r = wrap(phi_r, -hairlut_pi), i = wrap(phi_i, -hairlut_pi);
        store(azimuth + first, table_azimuth(l, r, i, all(0.0f), all(1.0f)));
        first += LANES;
    } while (first < n);
    lobe_density(l, &no_strands, n, in[0], in[2], azimuth, pdf);
    for (size_t s = 0; s < n; s += LANES)
        store(out + s, choose(greater(load(valid + s), all(0.0f)), load(pdf + s), all(0.0f)));
}

#endif
