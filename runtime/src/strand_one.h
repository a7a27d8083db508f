/* SPDX-License-Identifier: BSD-3-Clause */
/* The whole hair of one strand: one.h, of tables and a mixture that are blended over the strand's parameters first. */
#ifndef HAIRLUT_STRAND_ONE_H
#define HAIRLUT_STRAND_ONE_H

#include "one.h"
#include "strand_axis.h"

/* What a call reads: the corners of each grid of nodes, and the mixture there. */
typedef struct strand {
    const hairlut_model *model;
    hairlut_corners corners[HAIRLUT_MOST_GRIDS];
    hairlut_mix mix;
    int known; /* no parameter is NaN */
} strand;

/* hairlut_corners_of, compiled once for each number of axes that is common. */
static inline void place_corners(const hairlut_node_grid *grid, const hairlut_node *places, hairlut_corners *corners)
{
    switch (grid->axis_count) {
    case 0:
        hairlut_corners_of(grid, places, 0, corners);
        break;
    case 1:
        hairlut_corners_of(grid, places, 1, corners);
        break;
    case 3:
        hairlut_corners_of(grid, places, 3, corners);
        break;
    default:
        hairlut_corners_of(grid, places, grid->axis_count, corners);
    }
}

static void place_strand(const hairlut_model *model, const float *parameters, strand *s)
{
    const hairlut_strands *strands = model->strands;
    hairlut_node places[HAIRLUT_MOST_SCALES];
    s->model = model;
    s->known = 1;
    for (int p = 0; p < strands->parameter_count; ++p)
        s->known &= parameters[p] == parameters[p];
    for (int k = 0; k < strands->scale_count; ++k) {
        const int p = strands->scales[k].parameter;
        places[k] = hairlut_nodes_place(&strands->scales[k].nodes,
                                        hairlut_clamp(parameters[p], strands->least[p], strands->most[p]));
    }
    for (int g = 0; g < strands->grid_count; ++g)
        place_corners(&strands->grids[g], places, &s->corners[g]);
}

static void mix_strand(strand *s, const float *shares, float theta_r, float offset)
{
    hairlut_mixture_fill(s->model, &s->corners[s->model->strands->mixture.grid], shares, theta_r, offset, &s->mix);
}

/* hairlut_lobe_draw */
static hairlut_drawn draw_strand(const strand *s, int k, float theta_r, float u_theta, float u_phi)
{
    const hairlut_lobe *lobe = &s->model->lobes[k];
    const hairlut_strands *strands = s->model->strands;
    const hairlut_blended theta = hairlut_blended_table(&lobe->theta, &strands->theta[k], s->corners),
                          phi = hairlut_blended_table(&lobe->phi, &strands->phi[k], s->corners);
    const hairlut_row row = hairlut_axis_row(&lobe->theta, theta_r);
    const hairlut_placed a = hairlut_strand_find_place(&theta, &row, u_theta);
    if (lobe->uniform)
        return hairlut_draw_uniform(&a, u_phi);
    const hairlut_row phi_row = hairlut_phi_row(lobe, theta_r, &row);
    const hairlut_placed b = hairlut_strand_find_place(&phi, &phi_row, u_phi);
    return hairlut_draw_both(&a, &b);
}

/* The direction on the axes of `count` lobes, two places a lobe. Tables have n corners, or any number where n is 0. All searches
 * are begun before one is ended, so that their loads overlap. */
HAIRLUT_INLINE void find_strand_of(const strand *s, const direction *d, const int *lobes, int count, hairlut_found *found,
                                   int n)
{
    hairlut_strand_search searches[2 * HAIRLUT_MAX_LOBES];
    hairlut_row rows[2 * HAIRLUT_MAX_LOBES + 1], *row = rows;
    int begun = 0;
    for (int l = 0, grid = -1; l < count; ++l, found += 2) {
        const int k = lobes[l];
        const hairlut_lobe *lobe = &s->model->lobes[k];
        const hairlut_strands *strands = s->model->strands;
        if (lobe->theta.grid != grid)
            *++row = hairlut_axis_row(&lobe->theta, d->theta_r);
        grid = lobe->theta.grid;
        hairlut_strand_begin_search(&searches[begun++], hairlut_blended_table(&lobe->theta, &strands->theta[k], s->corners),
                                    row, d->theta_i, &found[0], n);
        if (lobe->uniform) {
            found[1] = hairlut_find_uniform();
            continue;
        }
        if (lobe->phi.grid != grid)
            *++row = hairlut_axis_row(&lobe->phi, d->theta_r);
        grid = lobe->phi.grid;
        hairlut_strand_begin_search(&searches[begun++], hairlut_blended_table(&lobe->phi, &strands->phi[k], s->corners), row,
                                    hairlut_table_azimuth(lobe, d->r, d->i, s->mix.turn[k], s->mix.side), &found[1], n);
    }
    hairlut_strand_end_searches(searches, begun, n);
}

static void find_strand(const strand *s, const direction *d, const int *lobes, int count, hairlut_found *found)
{
    if (s->model->strands->pairs)
        find_strand_of(s, d, lobes, count, found, 2);
    else
        find_strand_of(s, d, lobes, count, found, 0);
}

/* pdf plus the sum of weight * density over the lobes that have a weight, but for lobe `drawn`. */
static float mixed_strand(const strand *s, const direction *d, int drawn, float pdf)
{
    hairlut_found found[2 * HAIRLUT_MAX_LOBES + 2];
    int lobes[HAIRLUT_MAX_LOBES + 1] = {0}, count = 0;
    for (int n = 0; n < s->mix.count; ++n) {
        lobes[count] = s->mix.lobes[n];
        count += lobes[count] != drawn;
    }
    find_strand(s, d, lobes, count, found);
    if (count % 2) { /* two at a time: the last beside itself */
        found[2 * count] = found[2 * count - 2];
        found[2 * count + 1] = found[2 * count - 1];
    }
    for (int n = 0; n < count; n += 2) {
        const hairlut_quad density = hairlut_densities(found + 2 * n);
        pdf += s->mix.weight[lobes[n]] * hairlut_quad_first(density);
        if (n + 1 < count)
            pdf += s->mix.weight[lobes[n + 1]] * hairlut_quad_third(density);
    }
    return pdf;
}

static hairlut_sample sample_strand_one(const hairlut_model *model, const float *parameters, const float *shares,
                                        float theta_r, float phi_r, float offset, float u_lobe, float u_theta, float u_phi)
{
    strand s;
    place_strand(model, parameters, &s);
    mix_strand(&s, shares, theta_r, offset);
    const int k = s.mix.lobes[hairlut_mixture_choose(&s.mix, u_lobe)];
    const hairlut_lobe *lobe = &model->lobes[k];
    const hairlut_drawn drawn = draw_strand(&s, k, theta_r, u_theta, u_phi);
    const float theta_i = hairlut_axis_inside(&lobe->theta, drawn.theta), r = hairlut_wrap(phi_r, -hairlut_pi);
    const float phi_i = lobe->uniform ? drawn.phi : hairlut_incident_azimuth(lobe, r, drawn.phi, s.mix.turn[k], s.mix.side);
    const int valid =
        s.known && hairlut_known(theta_r, phi_r, u_theta, u_phi) && !isunordered(offset, u_lobe) && s.mix.sum > 0.0f;
    const direction d = {theta_r, r, theta_i, phi_i};
    return hairlut_finish(theta_i, phi_i, valid ? mixed_strand(&s, &d, k, s.mix.weight[k] * drawn.pdf) : 0.0f);
}

static float pdf_strand_one(const hairlut_model *model, const float *parameters, const float *shares, float theta_r,
                            float phi_r, float offset, float theta_i, float phi_i)
{
    strand s;
    place_strand(model, parameters, &s);
    mix_strand(&s, shares, theta_r, offset);
    if (!s.known || !hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i) || offset != offset ||
        !(s.mix.sum > 0.0f))
        return 0.0f;
    const direction d = {theta_r, hairlut_wrap(phi_r, -hairlut_pi), theta_i, hairlut_wrap(phi_i, -hairlut_pi)};
    return mixed_strand(&s, &d, -1, 0.0f);
}

#endif
