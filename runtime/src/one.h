/* SPDX-License-Identifier: BSD-3-Clause */
/* The functions of hairlut.h for one direction, for the instruction set that the including file is compiled for. */
#ifndef HAIRLUT_ONE_H
#define HAIRLUT_ONE_H

#include "lobe.h"
#include "mixture.h"

static hairlut_sample sample_lobe_one(const hairlut_model *model, int lobe, float theta_r, float phi_r, float u_theta,
                                      float u_phi)
{
    const hairlut_lobe *l = &model->lobes[lobe];
    const hairlut_row row = hairlut_axis_row(&l->theta, theta_r);
    const hairlut_drawn drawn = hairlut_lobe_draw(l, theta_r, &row, u_theta, u_phi);
    const float r = hairlut_wrap(phi_r, -hairlut_pi);
    const float turned = hairlut_incident_azimuth(l, r, drawn.phi, 0.0f, 1.0f);
    const float pdf = hairlut_known(theta_r, phi_r, u_theta, u_phi) ? drawn.pdf : 0.0f;
    /* theta_i as it was drawn: its cosine does not wait until it is moved into the domain */
    hairlut_sample s = hairlut_finish(drawn.theta, l->uniform ? drawn.phi : turned, pdf);
    s.theta_i = hairlut_axis_inside(&l->theta, drawn.theta);
    return s;
}

static float pdf_lobe_one(const hairlut_model *model, int lobe, float theta_r, float phi_r, float theta_i, float phi_i)
{
    const hairlut_lobe *l = &model->lobes[lobe];
    if (!hairlut_known(theta_r, phi_r, theta_i, phi_i - phi_i))
        return 0.0f;
    const hairlut_row row = hairlut_axis_row(&l->theta, theta_r), phi_row = hairlut_phi_row(l, theta_r, &row);
    const float r = hairlut_wrap(phi_r, -hairlut_pi), i = hairlut_wrap(phi_i, -hairlut_pi);
    hairlut_found found[2];
    found[0] = hairlut_axis_find(&l->theta, &row, theta_i);
    found[1] = l->uniform ? hairlut_find_uniform()
                          : hairlut_axis_find(&l->phi, &phi_row, hairlut_table_azimuth(l, r, i, 0.0f, 1.0f));
    return hairlut_density(found);
}

/* A direction, and the viewer's; r and i are phi_r and phi_i in [-pi, pi). */
typedef struct direction {
    float theta_r, r, theta_i, i;
} direction;

/* theta_r's row on each grid of rows */
HAIRLUT_INLINE void find_rows(const hairlut_model *model, float theta_r, hairlut_row *rows)
{
    for (int g = 0; g < model->grid_count; ++g)
        rows[g] = hairlut_axis_row(model->grids[g], theta_r);
}

/* The direction on the axes of lobe k, at their rows. */
HAIRLUT_INLINE void find_at(const hairlut_lobe *lobe, const hairlut_mix *mix, int k, const direction *d,
                            const hairlut_row *theta_row, const hairlut_row *phi_row, hairlut_found found[2])
{
    found[0] = hairlut_axis_find(&lobe->theta, theta_row, d->theta_i);
    found[1] = lobe->uniform ? hairlut_find_uniform()
                             : hairlut_axis_find(&lobe->phi, phi_row,
                                                 hairlut_table_azimuth(lobe, d->r, d->i, mix->turn[k], mix->side));
}

HAIRLUT_INLINE void find_lobe(const hairlut_model *model, const hairlut_mix *mix, int k, const direction *d,
                              const hairlut_row *rows, hairlut_found found[2])
{
    const hairlut_lobe *lobe = &model->lobes[k];
    find_at(lobe, mix, k, d, &rows[lobe->theta.grid], &rows[lobe->phi.grid], found);
}

/* The lobe that comes n-th in a list that leaves one out, by its place there. No branch: the one that was drawn is random. */
static inline int lobe_but(const hairlut_mix *mix, int n, int out)
{
    return mix->lobes[n + (n >= out)];
}

/* pdf plus weight * density of lobe a; of lobes a and b, at once */
HAIRLUT_INLINE float add_one(const hairlut_mix *mix, int a, const hairlut_found found[2], float pdf)
{
    return pdf + mix->weight[a] * hairlut_density(found);
}

HAIRLUT_INLINE float add_two(const hairlut_mix *mix, int a, int b, const hairlut_found found[4], float pdf)
{
    const hairlut_quad density = hairlut_densities(found);
    pdf += mix->weight[a] * hairlut_quad_first(density);
    return pdf + mix->weight[b] * hairlut_quad_third(density);
}

/* pdf plus the sum of weight * density over the lobes that have a weight, but for the one in place `out`; all, if that is their
 * number. Two lobes at once. */
static HAIRLUT_APART float mixed(const hairlut_model *model, const hairlut_mix *mix, const direction *d, int out, float pdf)
{
    const int count = mix->count - (out < mix->count);
    hairlut_row rows[HAIRLUT_MOST_TABLES];
    hairlut_found found[4];
    find_rows(model, d->theta_r, rows);
    int n = 0;
    for (; n + 1 < count; n += 2) {
        const int a = lobe_but(mix, n, out), b = lobe_but(mix, n + 1, out);
        find_lobe(model, mix, a, d, rows, found);
        find_lobe(model, mix, b, d, rows, found + 2);
        pdf = add_two(mix, a, b, found, pdf);
    }
    if (n < count) {
        const int a = lobe_but(mix, n, out);
        find_lobe(model, mix, a, d, rows, found);
        pdf = add_one(mix, a, found, pdf);
    }
    return pdf;
}

/* The whole hair for a viewer: the mixture there, phi_r in [-pi, pi), and whether any direction has a density. */
typedef struct hair {
    const hairlut_model *model;
    const hairlut_mix *mix;
    float theta_r, r;
    int known;
} hair;

HAIRLUT_INLINE hair hair_of(const hairlut_model *model, const hairlut_mix *mix, float theta_r, float phi_r, float offset)
{
    hair h = {model, mix, theta_r, phi_r, !isunordered(theta_r, offset) && mix->sum > 0.0f};
    if (HAIRLUT_MOSTLY(hairlut_in_turn(phi_r, -hairlut_pi)))
        return h;
    h.r = hairlut_wrap(phi_r, -hairlut_pi);
    h.known = h.known && hairlut_is_finite(phi_r);
    return h;
}

/* Whether there are two lobes, and all axes have the same rows, as in luts/fitted. Then a density is one piece of code without loops, its
 * row in registers: 1.4 times as fast. */
HAIRLUT_INLINE int two_on_a_grid(const hair *h)
{
    return h->mix->count == 2 && h->model->grid_count == 1;
}

/* `mixed` of two lobes on one grid: pdf plus that of the lobe that was not drawn; and of both. */
HAIRLUT_INLINE float mixed_other(const hair *h, const direction *d, const hairlut_row *row, int out, float pdf)
{
    const hairlut_mix *mix = h->mix;
    const int a = lobe_but(mix, 0, out);
    hairlut_found found[2];
    find_at(&h->model->lobes[a], mix, a, d, row, row, found);
    return add_one(mix, a, found, pdf);
}

HAIRLUT_INLINE float mixed_both(const hair *h, const direction *d, const hairlut_row *row)
{
    const hairlut_mix *mix = h->mix;
    const int a = mix->lobes[0], b = mix->lobes[1];
    hairlut_found found[4];
    find_at(&h->model->lobes[a], mix, a, d, row, row, found);
    find_at(&h->model->lobes[b], mix, b, d, row, row, found + 2);
    return add_two(mix, a, b, found, 0.0f);
}

HAIRLUT_INLINE hairlut_sample sample_of_hair(const hair *h, float u_lobe, float u_theta, float u_phi)
{
    const hairlut_mix *mix = h->mix;
    const int chosen = hairlut_mixture_choose(mix, u_lobe), k = mix->lobes[chosen];
    const hairlut_lobe *lobe = &h->model->lobes[k];
    const hairlut_row row = hairlut_axis_row(&lobe->theta, h->theta_r);
    const hairlut_drawn drawn = hairlut_lobe_draw(lobe, h->theta_r, &row, u_theta, u_phi);
    const float theta_i = hairlut_axis_inside(&lobe->theta, drawn.theta);
    const float phi_i = lobe->uniform ? drawn.phi : hairlut_incident_azimuth(lobe, h->r, drawn.phi, mix->turn[k], mix->side);
    if (!h->known || isunordered(u_theta, u_phi) || u_lobe != u_lobe)
        return hairlut_finish(theta_i, phi_i, 0.0f);
    const direction d = {h->theta_r, h->r, theta_i, phi_i};
    const float pdf = mix->weight[k] * drawn.pdf;
    return hairlut_finish(theta_i, phi_i,
                          two_on_a_grid(h) ? mixed_other(h, &d, &row, chosen, pdf) : mixed(h->model, mix, &d, chosen, pdf));
}

HAIRLUT_INLINE float pdf_of_hair(const hair *h, float theta_i, float phi_i)
{
    direction d = {h->theta_r, h->r, theta_i, phi_i};
    if (!h->known || theta_i != theta_i)
        return 0.0f;
    if (!HAIRLUT_MOSTLY(hairlut_in_turn(phi_i, -hairlut_pi))) {
        if (!hairlut_is_finite(phi_i))
            return 0.0f;
        d.i = hairlut_wrap(phi_i, -hairlut_pi);
    }
    if (!two_on_a_grid(h))
        return mixed(h->model, h->mix, &d, h->mix->count, 0.0f);
    const hairlut_row row = hairlut_axis_row(h->model->grids[0], h->theta_r);
    return mixed_both(h, &d, &row);
}

static hairlut_sample sample_hair_one(const hairlut_model *model, const float *shares, float theta_r, float phi_r,
                                      float offset, float u_lobe, float u_theta, float u_phi)
{
    hairlut_mix own;
    const hair h = hair_of(model, hairlut_mixture_at(model, shares, theta_r, offset, &own), theta_r, phi_r, offset);
    return sample_of_hair(&h, u_lobe, u_theta, u_phi);
}

static float pdf_hair_one(const hairlut_model *model, const float *shares, float theta_r, float phi_r, float offset,
                          float theta_i, float phi_i)
{
    hairlut_mix own;
    const hair h = hair_of(model, hairlut_mixture_at(model, shares, theta_r, offset, &own), theta_r, phi_r, offset);
    return pdf_of_hair(&h, theta_i, phi_i);
}

#endif
