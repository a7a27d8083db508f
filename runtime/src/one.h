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
    hairlut_found found[4];
    found[0] = found[2] = hairlut_axis_find(&l->theta, &row, theta_i);
    found[1] = found[3] = l->uniform ? hairlut_find_uniform()
                                     : hairlut_axis_find(&l->phi, &phi_row, hairlut_table_azimuth(l, r, i, 0.0f, 1.0f));
    return hairlut_quad_first(hairlut_densities(found));
}

/* A direction, and the viewer's; r and i are phi_r and phi_i in [-pi, pi). */
typedef struct direction {
    float theta_r, r, theta_i, i;
} direction;

/* theta_r's row on a grid of rows, by its number. */
typedef struct grid_row {
    hairlut_row row;
    int grid;
} grid_row;

static inline grid_row row_of(const hairlut_axis *axis, float theta_r)
{
    const grid_row found = {hairlut_axis_row(axis, theta_r), axis->grid};
    return found;
}

/* The direction on the axes of lobe k. *at is of any grid; it becomes that of the lobe's axis of theta_i. */
HAIRLUT_INLINE void find_lobe(const hairlut_model *model, const hairlut_mix *mix, int k, const direction *d, grid_row *at,
                              hairlut_found found[2])
{
    const hairlut_lobe *lobe = &model->lobes[k];
    if (lobe->theta.grid != at->grid)
        *at = row_of(&lobe->theta, d->theta_r);
    found[0] = hairlut_axis_find(&lobe->theta, &at->row, d->theta_i);
    if (lobe->uniform) {
        found[1] = hairlut_find_uniform();
    } else {
        const hairlut_row phi_row = hairlut_phi_row(lobe, d->theta_r, &at->row);
        found[1] = hairlut_axis_find(&lobe->phi, &phi_row, hairlut_table_azimuth(lobe, d->r, d->i, mix->turn[k], mix->side));
    }
}

/* The lobe that comes n-th in a list that leaves one out, by its place there. No branch: the one that was drawn is random. */
static inline int lobe_but(const hairlut_mix *mix, int n, int out)
{
    return mix->lobes[n + (n >= out)];
}

/* pdf plus weight * density of lobe a. `at` is theta_r's row on any grid. */
HAIRLUT_INLINE float with_one(const hairlut_model *model, const hairlut_mix *mix, const direction *d, const grid_row *at,
                              int a, float pdf)
{
    hairlut_found found[4];
    grid_row row = *at;
    find_lobe(model, mix, a, d, &row, found);
    found[2] = found[0];
    found[3] = found[1];
    return pdf + mix->weight[a] * hairlut_quad_first(hairlut_densities(found));
}

/* Likewise of lobes a and b, at once. */
static float with_two(const hairlut_model *model, const hairlut_mix *mix, const direction *d, const grid_row *at, int a,
                      int b, float pdf)
{
    hairlut_found found[4];
    grid_row row = *at;
    find_lobe(model, mix, a, d, &row, found);
    find_lobe(model, mix, b, d, &row, found + 2);
    const hairlut_quad density = hairlut_densities(found);
    pdf += mix->weight[a] * hairlut_quad_first(density);
    pdf += mix->weight[b] * hairlut_quad_third(density);
    return pdf;
}

/* pdf plus the sum of weight * density over the lobes that have a weight, but for the one in place `out`; all, if that is their
 * number. */
HAIRLUT_INLINE float mixed(const hairlut_model *model, const hairlut_mix *mix, const direction *d, const grid_row *at,
                           int out, float pdf)
{
    const int count = mix->count - (out < mix->count);
    int n = 0;
    if (count % 2)
        pdf = with_one(model, mix, d, at, lobe_but(mix, n++, out), pdf);
    for (; n < count; n += 2)
        pdf = with_two(model, mix, d, at, lobe_but(mix, n, out), lobe_but(mix, n + 1, out), pdf);
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
    const hair h = {model, mix, theta_r, hairlut_wrap(phi_r, -hairlut_pi),
                    hairlut_known(theta_r, phi_r, offset, 0.0f) && mix->sum > 0.0f};
    return h;
}

HAIRLUT_INLINE hairlut_sample sample_of_hair(const hair *h, float u_lobe, float u_theta, float u_phi)
{
    const hairlut_mix *mix = h->mix;
    const int chosen = hairlut_mixture_choose(mix, u_lobe), k = mix->lobes[chosen];
    const hairlut_lobe *lobe = &h->model->lobes[k];
    const grid_row at = row_of(&lobe->theta, h->theta_r);
    const hairlut_drawn drawn = hairlut_lobe_draw(lobe, h->theta_r, &at.row, u_theta, u_phi);
    const float theta_i = hairlut_axis_inside(&lobe->theta, drawn.theta);
    const float phi_i = lobe->uniform ? drawn.phi : hairlut_incident_azimuth(lobe, h->r, drawn.phi, mix->turn[k], mix->side);
    if (!h->known || isunordered(u_theta, u_phi) || u_lobe != u_lobe)
        return hairlut_finish(theta_i, phi_i, 0.0f);
    const direction d = {h->theta_r, h->r, theta_i, phi_i};
    return hairlut_finish(theta_i, phi_i, mixed(h->model, mix, &d, &at, chosen, mix->weight[k] * drawn.pdf));
}

HAIRLUT_INLINE float pdf_of_hair(const hair *h, float theta_i, float phi_i)
{
    if (!h->known || !hairlut_known(theta_i, phi_i, 0.0f, 0.0f))
        return 0.0f;
    const direction d = {h->theta_r, h->r, theta_i, hairlut_wrap(phi_i, -hairlut_pi)};
    const grid_row at = row_of(&h->model->lobes[h->mix->lobes[0]].theta, h->theta_r);
    return mixed(h->model, h->mix, &d, &at, h->mix->count, 0.0f);
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
