/* SPDX-License-Identifier: BSD-3-Clause */
/* The whole hair of one strand: hair.c, of tables and a mixture that are blended over the strand's parameters first. */
#include "batch.h"
#include "corners.h"
#include "hair.h"
#include "strand_axis.h"
#include "strand_mixture.h"

/* What a call reads: the corners of each grid of nodes, and the mixture there. */
typedef struct strand {
    const hairlut_model *model;
    hairlut_corners corners[HAIRLUT_MOST_GRIDS];
    hairlut_mix mix;
    int known; /* no parameter is NaN */
} strand;

/* hairlut_corners_of, compiled once for each number of axes that is common. */
static inline void place_corners(const hairlut_node_grid *grid, const hairlut_row *places, hairlut_corners *corners)
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
    hairlut_row places[HAIRLUT_MOST_SCALES];
    s->model = model;
    s->known = 1;
    for (int p = 0; p < strands->parameter_count; ++p)
        s->known &= parameters[p] == parameters[p];
    for (int k = 0; k < strands->scale_count; ++k) {
        const int p = strands->scales[k].parameter;
        places[k] =
            hairlut_scale_place(&strands->scales[k], hairlut_clamp(parameters[p], strands->least[p], strands->most[p]));
    }
    for (int g = 0; g < strands->grid_count; ++g)
        place_corners(&strands->grids[g], places, &s->corners[g]);
}

static void mix_strand(strand *s, const float *shares, float theta_r, float offset)
{
    const float h = hairlut_clamp(offset, -1.0f, 1.0f);
    hairlut_mix *mix = &s->mix;
    mix->side = (float)(1 - 2 * (s->model->mixture.mirrored & (h < 0.0f)));
    hairlut_strand_mixture(s->model, &s->corners[s->model->strands->mixture.grid], theta_r, h, mix);
    mix->sum = 0.0f;
    for (int k = 0; k < s->model->lobe_count; ++k)
        mix->sum += mix->share[k];
    if (shares)
        hairlut_mixture_given(s->model->lobe_count, shares, 1, mix);
    const float unit = 1.0f / mix->sum;
    for (int k = 0; k < s->model->lobe_count; ++k)
        mix->weight[k] = mix->share[k] * unit;
}

/* hairlut_lobe_draw */
static hairlut_drawn draw(const strand *s, int k, float theta_r, float u_theta, float u_phi)
{
    const hairlut_lobe *lobe = &s->model->lobes[k];
    const hairlut_strands *strands = s->model->strands;
    const hairlut_blended theta = hairlut_blended_table(&lobe->theta, &strands->theta[k], s->corners),
                          phi = hairlut_blended_table(&lobe->phi, &strands->phi[k], s->corners);
    const hairlut_row row = hairlut_axis_row(&lobe->theta, theta_r);
    const hairlut_placed a = hairlut_strand_find_place(&theta, row, u_theta);
    if (lobe->uniform)
        return hairlut_draw_uniform(&a, u_phi);
    const hairlut_placed b = hairlut_strand_find_place(&phi, hairlut_phi_row(lobe, theta_r, row), u_phi);
    return hairlut_draw_both(&a, &b);
}

/* The azimuth by which lobe k's table is searched; r and i are phi_r and phi_i in [-pi, pi). */
static float lobe_azimuth(const strand *s, int k, float r, float i)
{
    return hairlut_turned_relative(hairlut_relative_azimuth(s->model->lobes[k].azimuth, r, i), s->mix.turn[k], s->mix.side);
}

/* Begins the searches of a lobe's axes, as hairlut_lobe_begin_search. Returns 1 where its domain contains the direction, else 0. */
HAIRLUT_INLINE float begin_search(const strand *s, int k, float theta_r, float theta_i, float phi,
                                  hairlut_strand_search *next)
{
    const hairlut_lobe *lobe = &s->model->lobes[k];
    const hairlut_strands *strands = s->model->strands;
    const hairlut_blended theta = hairlut_blended_table(&lobe->theta, &strands->theta[k], s->corners);
    const hairlut_row row = hairlut_axis_row(&lobe->theta, theta_r);
    hairlut_strand_begin_search(&next[0], &theta, row, hairlut_axis_inside(&lobe->theta, theta_i));
    if (lobe->uniform)
        return (float)(next[0].x == theta_i);
    const hairlut_blended azimuth = hairlut_blended_table(&lobe->phi, &strands->phi[k], s->corners);
    hairlut_strand_begin_search(&next[1], &azimuth, hairlut_phi_row(lobe, theta_r, row),
                                hairlut_axis_inside(&lobe->phi, phi));
    return (float)((next[0].x == theta_i) & (next[1].x == phi));
}

/* The root and bend of all searches; whole quads are written. */
static void end_searches(hairlut_strand_search *search, int count, float *root, float *bend)
{
    hairlut_found found[2 * HAIRLUT_MAX_LOBES + 3];
    for (int k = 0; k < count; ++k)
        hairlut_strand_end_search(&search[k]);
    for (int k = 0; k < count; ++k)
        found[k] = hairlut_strand_find(&search[k]);
    if (count > 0)
        found[count] = found[count + 1] = found[count + 2] = found[0];
    for (int first = 0; first < count; first += 4) {
        const hairlut_inverses inverse = hairlut_invert_four(found + first);
        hairlut_quad_store(root + first, inverse.root);
        hairlut_quad_store(bend + first, inverse.bend);
    }
}

/* The sum of weight * density. Lobe `drawn`, if there is one, has the density `known`. */
static float mixed(const strand *s, float theta_r, float r, float theta_i, float i, int drawn, float known)
{
    hairlut_strand_search searches[2 * HAIRLUT_MAX_LOBES];
    float contains[HAIRLUT_MAX_LOBES], root[2 * HAIRLUT_MAX_LOBES], bend[2 * HAIRLUT_MAX_LOBES], pdf = 0.0f;
    const hairlut_lobe *lobes = s->model->lobes;
    int count = 0;
    for (int k = 0; k < s->model->lobe_count; ++k) {
        if (k == drawn || !(s->mix.weight[k] > 0.0f))
            continue;
        const float phi = lobes[k].uniform ? 0.0f : lobe_azimuth(s, k, r, i);
        contains[k] = begin_search(s, k, theta_r, theta_i, phi, searches + count);
        count += lobes[k].uniform ? 1 : 2;
    }
    end_searches(searches, count, root, bend);
    for (int k = 0, a = 0; k < s->model->lobe_count; ++k) {
        if (!(s->mix.weight[k] > 0.0f))
            continue;
        pdf += s->mix.weight[k] * (k == drawn ? known : hairlut_lobe_density(&lobes[k], contains[k], root + a, bend + a));
        a += k == drawn ? 0 : lobes[k].uniform ? 1 : 2;
    }
    return pdf;
}

hairlut_sample hairlut_sample_strand(const hairlut_model *model, const float *parameters, const float *shares, float theta_r,
                                     float phi_r, float offset, float u_lobe, float u_theta, float u_phi)
{
    strand s;
    if (!model->strands || !parameters)
        return hairlut_sample_hair(model, shares, theta_r, phi_r, offset, u_lobe, u_theta, u_phi);
    place_strand(model, parameters, &s);
    mix_strand(&s, shares, theta_r, offset);
    const int k = hairlut_mixture_choose(&s.mix, model->lobe_count, u_lobe);
    const hairlut_lobe *lobe = &model->lobes[k];
    const hairlut_drawn drawn = draw(&s, k, theta_r, u_theta, u_phi);
    const float theta_i = hairlut_axis_inside(&lobe->theta, drawn.theta), r = hairlut_wrap(phi_r, -hairlut_pi);
    const float phi_i =
        lobe->uniform ? drawn.phi : hairlut_turned_incident(lobe->azimuth, r, drawn.phi, s.mix.turn[k], s.mix.side);
    const int valid =
        s.known && hairlut_known(theta_r, phi_r, u_theta, u_phi) && !isunordered(offset, u_lobe) && s.mix.sum > 0.0f;
    return hairlut_finish(theta_i, phi_i, valid ? mixed(&s, theta_r, r, theta_i, phi_i, k, drawn.pdf) : 0.0f);
}

float hairlut_pdf_strand(const hairlut_model *model, const float *parameters, const float *shares, float theta_r,
                         float phi_r, float offset, float theta_i, float phi_i)
{
    strand s;
    if (!model->strands || !parameters)
        return hairlut_pdf_hair(model, shares, theta_r, phi_r, offset, theta_i, phi_i);
    place_strand(model, parameters, &s);
    mix_strand(&s, shares, theta_r, offset);
    if (!s.known || !hairlut_known(theta_r, phi_r, theta_i, phi_i) || !hairlut_is_finite(phi_i) || offset != offset ||
        !(s.mix.sum > 0.0f))
        return 0.0f;
    return mixed(&s, theta_r, hairlut_wrap(phi_r, -hairlut_pi), theta_i, hairlut_wrap(phi_i, -hairlut_pi), -1, 0.0f);
}

/* ---- arrays --------------------------------------------------------------------------------------------------- */

void hairlut_sample_strand_n(const hairlut_model *model, size_t n, const float *parameters, const float *shares,
                             const float *theta_r, const float *phi_r, const float *offset, const float *u_lobe,
                             const float *u_theta, const float *u_phi, hairlut_samples out)
{
    float values[HAIRLUT_MAX_PARAMETERS], own[HAIRLUT_MAX_LOBES];
    if (!model->strands || !parameters) {
        hairlut_sample_hair_n(model, n, shares, theta_r, phi_r, offset, u_lobe, u_theta, u_phi, out);
        return;
    }
    for (size_t i = 0; i < n; ++i) {
        const hairlut_sample s =
            hairlut_sample_strand(model, hairlut_gather(parameters, model->strands->parameter_count, n, i, values),
                                  hairlut_gather(shares, model->lobe_count, n, i, own), theta_r[i], phi_r[i],
                                  offset ? offset[i] : 0.0f, u_lobe[i], u_theta[i], u_phi[i]);
        hairlut_put(out, i, s);
    }
}

void hairlut_pdf_strand_n(const hairlut_model *model, size_t n, const float *parameters, const float *shares,
                          const float *theta_r, const float *phi_r, const float *offset, const float *theta_i,
                          const float *phi_i, float *pdf_angle)
{
    float values[HAIRLUT_MAX_PARAMETERS], own[HAIRLUT_MAX_LOBES];
    if (!model->strands || !parameters) {
        hairlut_pdf_hair_n(model, n, shares, theta_r, phi_r, offset, theta_i, phi_i, pdf_angle);
        return;
    }
    for (size_t i = 0; i < n; ++i)
        pdf_angle[i] = hairlut_pdf_strand(model, hairlut_gather(parameters, model->strands->parameter_count, n, i, values),
                                          hairlut_gather(shares, model->lobe_count, n, i, own), theta_r[i], phi_r[i],
                                          offset ? offset[i] : 0.0f, theta_i[i], phi_i[i]);
}
