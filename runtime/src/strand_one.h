/* SPDX-License-Identifier: BSD-3-Clause */
/* The whole hair of one strand: one.h, of tables and a mixture that are blended over the strand's parameters. */
#ifndef HAIRLUT_STRAND_ONE_H
#define HAIRLUT_STRAND_ONE_H

#include "one.h"
#include "strand_axis.h"

/* A direction in the hair of one strand: the corners of each grid of nodes, and the rows of theta_r on each grid of rows. */
typedef struct strand {
    hair hair;
    const hairlut_corners *corners;
    float theta_i, i; /* i: phi_i in [-pi, pi) */
    hairlut_row rows[HAIRLUT_MOST_TABLES];
} strand;

/* The corners of all grids. Returns whether no parameter is NaN. */
static int place_strand(const hairlut_model *model, const float *parameters, hairlut_corners *corners)
{
    const hairlut_strands *strands = model->strands;
    float clamped[HAIRLUT_MAX_PARAMETERS];
    int known = 1;
    for (int p = 0; p < strands->parameter_count; ++p) {
        known &= parameters[p] == parameters[p];
        clamped[p] = hairlut_clamp(parameters[p], strands->least[p], strands->most[p]);
    }
    for (int g = 0; g < strands->grid_count; ++g)
        hairlut_corners_of(&strands->grids[g], clamped, &corners[g]);
    return known;
}

static void mix_strand(const hairlut_model *model, const hairlut_corners *corners, const float *shares, float theta_r,
                       float offset, hairlut_mix *mix)
{
    hairlut_mixture_fill(model, &corners[model->strands->mixture.grid], shares, theta_r, offset, mix);
}

/* All but the direction. */
HAIRLUT_INLINE void begin_strand(strand *v, const hair *h, const hairlut_corners *corners)
{
    v->hair = *h;
    v->corners = corners;
    find_rows(h->model, h->theta_r, v->rows);
}

HAIRLUT_INLINE void start_search(const strand *v, const hairlut_strand_table *table, hairlut_strand_search *s)
{
    hairlut_strand_start(s, table, v->rows, v->corners);
}

/* hairlut_lobe_draw */
HAIRLUT_INLINE hairlut_drawn draw_strand(const strand *v, int k, float u_theta, float u_phi)
{
    hairlut_strand_search theta, phi;
    start_search(v, &v->hair.model->strands->theta[k], &theta);
    const hairlut_placed a = hairlut_strand_find_place(&theta, u_theta, theta.table->nodes.count);
    if (theta.table->uniform)
        return hairlut_draw_uniform(&a, u_phi);
    start_search(v, &v->hair.model->strands->phi[k], &phi);
    const hairlut_placed b = hairlut_strand_find_place(&phi, u_phi, phi.table->nodes.count);
    return hairlut_draw_both(&a, &b);
}

/* hairlut_wrap_near of four, with low = 0 */
static inline void wrap_four(hairlut_quad x, float *wrapped)
{
    const hairlut_quad integers = hairlut_quad_all(hairlut_integers), high = hairlut_quad_all(hairlut_two_pi_high),
                       low = hairlut_quad_all(hairlut_two_pi_low), most = hairlut_quad_all(hairlut_below_two_pi);
    const hairlut_quad turns =
        hairlut_quad_add(hairlut_quad_mul(x, hairlut_quad_all(hairlut_inverse_two_pi)), hairlut_quad_all(hairlut_half_down));
    const hairlut_quad n = hairlut_quad_sub(hairlut_quad_add(turns, integers), integers);
    const hairlut_quad near = hairlut_quad_sub(hairlut_quad_sub(x, hairlut_quad_mul(n, high)), hairlut_quad_mul(n, low));
    hairlut_quad_store(wrapped, near);
    if (hairlut_quad_count(hairlut_quad_all(0.0f), near) + hairlut_quad_count(near, most) < 8)
        for (int l = 0; l < 4; ++l)
            wrapped[l] = hairlut_wrap(wrapped[l], 0.0f);
}

/* hairlut_table_azimuth of all lobes */
static inline void table_azimuths(const strand *v, float *azimuth)
{
    const hairlut_quad i = hairlut_quad_all(v->i), r = hairlut_quad_all(v->hair.r),
                       side = hairlut_quad_all(v->hair.mix->side);
    for (int k = 0; k < v->hair.model->lobe_count; k += 4) {
        const hairlut_quad relative =
            hairlut_quad_add(i, hairlut_quad_mul(hairlut_quad_anywhere(v->hair.model->strands->sign + k), r));
        const hairlut_quad x =
            hairlut_quad_sub(hairlut_quad_mul(side, relative), hairlut_quad_anywhere(v->hair.mix->turn + k));
        wrap_four(x, azimuth + k);
    }
}

/* Where the direction lies on the axes of lobe k is found by two searches, which are begun; of a uniform azimuth, the second is not
 * used. Tables have n corners, or any number where n is 0. */
HAIRLUT_INLINE void begin_lobe(const strand *v, int k, float azimuth, hairlut_strand_search search[2], int n)
{
    start_search(v, &v->hair.model->strands->theta[k], &search[0]);
    hairlut_strand_begin_search(&search[0], v->theta_i, n > 0 ? n : search[0].table->nodes.count);
    if (search[0].table->uniform)
        return;
    start_search(v, &v->hair.model->strands->phi[k], &search[1]);
    hairlut_strand_begin_search(&search[1], azimuth, n > 0 ? n : search[1].table->nodes.count);
}

HAIRLUT_INLINE void end_lobe(hairlut_strand_search search[2], int n)
{
    hairlut_strand_end_search(&search[0], n > 0 ? n : search[0].table->nodes.count);
    if (!search[0].table->uniform)
        hairlut_strand_end_search(&search[1], n > 0 ? n : search[1].table->nodes.count);
}

HAIRLUT_INLINE void read_lobe(const hairlut_strand_search search[2], hairlut_found found[2], int n)
{
    hairlut_strand_read(&search[0], &found[0], n > 0 ? n : search[0].table->nodes.count);
    if (search[0].table->uniform)
        found[1] = hairlut_find_uniform();
    else
        hairlut_strand_read(&search[1], &found[1], n > 0 ? n : search[1].table->nodes.count);
}

/* pdf plus the sum of weight * density over the lobes that have a weight, but for the one in place `out`, as in `mixed`. */
HAIRLUT_INLINE float mixed_of(const strand *v, int out, float pdf, int n)
{
    hairlut_strand_search searches[2 * HAIRLUT_MAX_LOBES];
    const hairlut_mix *mix = v->hair.mix;
    const int count = mix->count - (out < mix->count);
    float azimuth[HAIRLUT_MAX_LOBES];
    hairlut_found found[4];
    table_azimuths(v, azimuth);
    for (int l = 0; l < count; ++l) {
        const int k = lobe_but(mix, l, out);
        begin_lobe(v, k, azimuth[k], searches + 2 * l, n);
    }
    for (int l = 0; l < count && !v->hair.model->strands->whole; ++l)
        end_lobe(searches + 2 * l, n);
    int l = 0;
    for (; l + 1 < count; l += 2) {
        const int a = lobe_but(mix, l, out), b = lobe_but(mix, l + 1, out);
        read_lobe(searches + 2 * l, found, n);
        read_lobe(searches + 2 * l + 2, found + 2, n);
        pdf = add_two(mix, a, b, found, pdf);
    }
    if (l < count) {
        const int a = lobe_but(mix, l, out);
        read_lobe(searches + 2 * l, found, n);
        pdf = add_one(mix, a, found, pdf);
    }
    return pdf;
}

/* For any number of corners: apart, as it would crowd the other out of the instruction cache. */
static HAIRLUT_APART float mixed_any(const strand *v, int out, float pdf)
{
    return mixed_of(v, out, pdf, 0);
}

static float mixed_strand(const strand *v, int out, float pdf)
{
    return v->hair.model->strands->pairs ? mixed_of(v, out, pdf, 2) : mixed_any(v, out, pdf);
}

/* sample_of_hair */
HAIRLUT_INLINE hairlut_sample sample_of_strand(const hair *h, const hairlut_corners *corners, float u_lobe, float u_theta,
                                               float u_phi)
{
    strand v;
    const hairlut_mix *mix = h->mix;
    const int chosen = hairlut_mixture_choose(mix, u_lobe), k = mix->lobes[chosen];
    const hairlut_lobe *lobe = &h->model->lobes[k];
    begin_strand(&v, h, corners);
    const hairlut_drawn drawn = draw_strand(&v, k, u_theta, u_phi);
    v.theta_i = hairlut_axis_inside(&lobe->theta, drawn.theta);
    v.i = lobe->uniform ? drawn.phi : hairlut_incident_azimuth(lobe, h->r, drawn.phi, mix->turn[k], mix->side);
    if (!h->known || isunordered(u_theta, u_phi) || u_lobe != u_lobe)
        return hairlut_finish(v.theta_i, v.i, 0.0f);
    return hairlut_finish(v.theta_i, v.i, mixed_strand(&v, chosen, mix->weight[k] * drawn.pdf));
}

/* pdf_of_hair */
HAIRLUT_INLINE float pdf_of_strand(const hair *h, const hairlut_corners *corners, float theta_i, float phi_i)
{
    strand v;
    if (!h->known || !hairlut_known(theta_i, phi_i, 0.0f, 0.0f))
        return 0.0f;
    begin_strand(&v, h, corners);
    v.theta_i = theta_i;
    v.i = hairlut_wrap(phi_i, -hairlut_pi);
    return mixed_strand(&v, h->mix->count, 0.0f);
}

static hairlut_sample sample_strand_one(const hairlut_model *model, const float *parameters, const float *shares,
                                        float theta_r, float phi_r, float offset, float u_lobe, float u_theta, float u_phi)
{
    hairlut_corners corners[HAIRLUT_MOST_GRIDS];
    hairlut_mix mix;
    const int known = place_strand(model, parameters, corners);
    mix_strand(model, corners, shares, theta_r, offset, &mix);
    hair h = hair_of(model, &mix, theta_r, phi_r, offset);
    h.known &= known;
    return sample_of_strand(&h, corners, u_lobe, u_theta, u_phi);
}

static float pdf_strand_one(const hairlut_model *model, const float *parameters, const float *shares, float theta_r,
                            float phi_r, float offset, float theta_i, float phi_i)
{
    hairlut_corners corners[HAIRLUT_MOST_GRIDS];
    hairlut_mix mix;
    const int known = place_strand(model, parameters, corners);
    mix_strand(model, corners, shares, theta_r, offset, &mix);
    hair h = hair_of(model, &mix, theta_r, phi_r, offset);
    h.known &= known;
    return pdf_of_strand(&h, corners, theta_i, phi_i);
}

#endif
