/* SPDX-License-Identifier: BSD-3-Clause */
/* The whole hair for a block: hair.c, operation by operation.
 *
 * The samples of a block are sorted by the lobe that they draw. Each lobe then draws for a range of its own, and the densities
 * of the others are those of the rest: what lies before the range and behind it. Densities of a lobe that some samples have no
 * share of are computed for a list of those that have. */
#ifndef HAIRLUT_BATCH_HAIR_H
#define HAIRLUT_BATCH_HAIR_H

#include "batch_lobe.h"
#include "batch_mixture.h"
#include "batch_sort.h"

/* A block's inputs. Parameters, shares and offset may be NULL. */
typedef struct hair_inputs {
    given_strands strands;
    given_shares given;
    const float *theta_r, *phi_r, *offset;
    const float *u_lobe, *u_theta, *u_phi; /* of samples */
    const float *theta_i, *phi_i;          /* of directions */
} hair_inputs;

/* Directions whose density is computed, and the viewer's. r and i are phi_r and phi_i in [-pi, pi). */
typedef struct directions {
    float theta_r[ROOM], r[ROOM], theta_i[ROOM], i[ROOM];
} directions;

static inline size_t whole_vectors(size_t n)
{
    return (n + LANES - 1) / LANES * LANES;
}

static inline real side_at(const hairlut_model *model, const mixture_block *m, size_t s)
{
    return model->mixture.mirrored ? load(m->side + s) : all(1.0f);
}

static inline real turn_at(const hairlut_model *model, const mixture_block *m, int k, size_t s)
{
    return model->mixture.turned ? load(m->turn[k] + s) : all(0.0f);
}

/* The azimuths by which lobe k's table is read for directions s .. s+LANES-1 */
static inline real azimuth_of(const hairlut_model *model, int k, const directions *d, const mixture_block *m, size_t s)
{
    return table_azimuth(&model->lobes[k], load(d->r + s), load(d->i + s), turn_at(model, m, k, s), side_at(model, m, s));
}

/* The density of lobe k of directions from .. from+n-1, to the same places of pdf. What is written beyond, up to a whole vector,
 * is a density too. */
static inline void range_density(const hairlut_model *model, int k, strand_block *strands, const directions *d,
                                 const mixture_block *m, size_t from, size_t n, float *pdf)
{
    const strand_lobe at = lobe_at(strands, k, from);
    float azimuth[BLOCK];
    const size_t padded = whole_vectors(n);
    for (size_t s = 0; s < padded && !model->lobes[k].uniform; s += LANES)
        store(azimuth + s, azimuth_of(model, k, d, m, from + s));
    lobe_density(&model->lobes[k], &at, padded, d->theta_r + from, d->theta_i + from, azimuth, pdf + from);
}

/* The same of those of the first n that have a share of the lobe and are not in from .. to-1; 0 for the others. */
static inline void list_density(const hairlut_model *model, int k, strand_block *strands, const directions *d,
                                const mixture_block *m, size_t n, size_t from, size_t to, float *pdf)
{
    float azimuth[ROOM], theta_r[BLOCK], theta_i[BLOCK], relative[BLOCK], density[BLOCK];
    int list[BLOCK];
    size_t count = 0;
    for (size_t s = 0; s < n; s += LANES)
        store(azimuth + s, model->lobes[k].uniform ? all(0.0f) : azimuth_of(model, k, d, m, s));
    for (size_t s = 0; s < n; ++s) {
        list[count] = (int)s;
        count += m->weight[k][s] > 0.0f && (s < from || s >= to);
        pdf[s] = 0.0f;
    }
    const size_t padded = whole_vectors(count);
    for (size_t s = count; s < padded; ++s)
        list[s] = list[0];
    for (size_t s = 0; s < padded; ++s) {
        theta_r[s] = d->theta_r[list[s]];
        theta_i[s] = d->theta_i[list[s]];
        relative[s] = azimuth[list[s]];
    }
    const strand_lobe at = listed_lobe(strands, k, list, padded);
    lobe_density(&model->lobes[k], &at, padded, theta_r, theta_i, relative, density);
    for (size_t s = 0; s < count; ++s)
        pdf[list[s]] = density[s];
}

/* Adds weight * density over the lobes, but for the lobe that a sample drew; `own` is NULL where none drew any. */
static inline void add_densities(const hairlut_model *model, strand_block *strands, const directions *d,
                                 const mixture_block *m, size_t n, const sorting *own, float *sum)
{
    float pdf[ROOM];
    for (int k = 0; k < model->lobe_count; ++k) {
        const size_t from = own ? own->first[k] : 0, to = own ? own->first[k + 1] : 0;
        if (!m->some[k])
            continue;
        if (!m->every[k]) {
            list_density(model, k, strands, d, m, n, from, to, pdf);
        } else {
            if (from > 0)
                range_density(model, k, strands, d, m, 0, from, pdf);
            for (size_t s = from; s < to; s += LANES)
                store(pdf + s, all(0.0f));
            if (to < n)
                range_density(model, k, strands, d, m, to, n - to, pdf);
        }
        for (size_t s = 0; s < n; s += LANES)
            store(sum + s, add(load(sum + s), mul(weight_at(model, m, k, s), load(pdf + s))));
    }
}

/* What a group of whole vectors reads beyond the end of a block. */
static inline void end_directions(directions *d, mixture_block *m, size_t n)
{
    store(d->theta_r + n, all(0.0f));
    store(d->r + n, all(0.0f));
    store(d->theta_i + n, all(0.0f));
    store(d->i + n, all(0.0f));
    store(m->side + n, all(0.0f));
}

/* The parameters of directions: `block` is to hold them. */
static inline void copy_strands(const hairlut_model *model, size_t n, given_strands given, strand_block *block)
{
    begin_strands(model->strands, n, block);
    for (int p = 0; p < model->strands->parameter_count; ++p)
        for (size_t s = 0; s < n; s += LANES)
            store(block->values[p] + s, load(given.values + (size_t)p * given.stride + s));
}

/* hairlut_pdf_hair, hairlut_pdf_strand; `strands` is room for their parameters, or NULL without */
static inline void pdf_hair_block(const hairlut_model *model, size_t n, const hair_inputs *in, strand_block *strands,
                                  float *out)
{
    directions d;
    mixture_block m;
    float sum[BLOCK];
    real share[HAIRLUT_MAX_LOBES];
    begin_mixtures(model, in->strands, in->given, n, &m, share);
    if (strands)
        copy_strands(model, n, in->strands, strands);
    end_directions(&d, &m, n);
    for (size_t s = 0; s < n; s += LANES) {
        const real theta_r = load(in->theta_r + s), phi_r = load(in->phi_r + s), theta_i = load(in->theta_i + s);
        const real phi_i = load(in->phi_i + s), offset = in->offset ? load(in->offset + s) : all(0.0f);
        const mask finite = both(both(known(theta_r, phi_r, theta_i, phi_i), is_finite(phi_i)), numbers(offset, offset));
        const mask wanted = both(finite, known_strands(model->strands, in->strands, s));
        const real sum_of_shares =
            m.constant ? all(model->mixture.mix.sum) : mix_at(model, in->strands, in->given, theta_r, offset, &m, s, share);
        store_weights(model, share, sum_of_shares, wanted, &m, s);
        store(d.theta_r + s, theta_r);
        store(d.r + s, wrap(phi_r, -hairlut_pi));
        store(d.theta_i + s, theta_i);
        store(d.i + s, wrap(phi_i, -hairlut_pi));
        store(sum + s, all(0.0f));
    }
    sum_up(model, n, &m);
    add_densities(model, strands, &d, &m, n, NULL, sum);
    for (size_t s = 0; s < n; s += LANES)
        store(out + s, choose(greater(load(m.valid + s), all(0.0f)), load(sum + s), all(0.0f)));
}

/* What samples draw from. */
typedef struct numbers_drawn {
    float theta[ROOM], phi[ROOM];
} numbers_drawn;

/* The parameters of samples */
static inline void sort_strands(const hairlut_model *model, const sorting *sorted, size_t n, given_strands given,
                                strand_block *block)
{
    begin_strands(model->strands, n, block);
    for (int p = 0; p < model->strands->parameter_count; ++p)
        sort_array(sorted, model->lobe_count, n, given.values + (size_t)p * given.stride, block->values[p]);
}

static inline void sort_mixtures(const hairlut_model *model, const sorting *sorted, size_t n, mixture_block *m)
{
    for (int k = 0; k < model->lobe_count; ++k) {
        if (!m->constant)
            sort_in_place(sorted, model->lobe_count, n, m->weight[k]);
        if (model->mixture.turned)
            sort_in_place(sorted, model->lobe_count, n, m->turn[k]);
    }
    if (model->mixture.mirrored)
        sort_in_place(sorted, model->lobe_count, n, m->side);
}

/* The mixtures of a block, and its inputs, in the order of the lobes drawn. What is valid, and the lobes, stay in the order of the
 * inputs. */
static inline void prepare(const hairlut_model *model, size_t n, const hair_inputs *in, strand_block *strands,
                           mixture_block *m, directions *d, numbers_drawn *u, sorting *own)
{
    float r[BLOCK];
    real share[HAIRLUT_MAX_LOBES];
    begin_mixtures(model, in->strands, in->given, n, m, share);
    for (size_t s = 0; s < n; s += LANES) {
        const real theta_r = load(in->theta_r + s), phi_r = load(in->phi_r + s), u_lobe = load(in->u_lobe + s);
        const real offset = in->offset ? load(in->offset + s) : all(0.0f);
        const mask drawable =
            both(known(theta_r, phi_r, load(in->u_theta + s), load(in->u_phi + s)), numbers(offset, u_lobe));
        const mask wanted = both(drawable, known_strands(model->strands, in->strands, s));
        const real sum =
            m->constant ? all(model->mixture.mix.sum) : mix_at(model, in->strands, in->given, theta_r, offset, m, s, share);
        store_weights(model, share, sum, wanted, m, s);
        choose_lobes(model, share, sum, u_lobe, m, s);
        store(r + s, wrap(phi_r, -hairlut_pi));
    }
    sum_up(model, n, m);
    sort_by_lobe(model->lobe_count, n, m->chosen, own);
    const float *const from[4] = {in->theta_r, r, in->u_theta, in->u_phi};
    float *const to[4] = {d->theta_r, d->r, u->theta, u->phi};
    sort_arrays(own, model->lobe_count, n, 4, from, to);
    sort_mixtures(model, own, n, m);
    if (strands)
        sort_strands(model, own, n, in->strands, strands);
}

/* What lobe k draws for its range of the sorted samples, and weight * density. Beyond its end, up to a whole vector, the next lobe writes again. */
static inline void draw_range(const hairlut_model *model, int k, strand_block *strands, const mixture_block *m,
                              const numbers_drawn *u, size_t from, size_t to, directions *d, float *pdf, float *cosines)
{
    const hairlut_lobe *lobe = &model->lobes[k];
    const strand_lobe at = lobe_at(strands, k, from);
    float theta_i[BLOCK], azimuth[BLOCK];
    const size_t padded = whole_vectors(to - from);
    draw_lobe(lobe, &at, padded, d->theta_r + from, u->theta + from, u->phi + from, theta_i, azimuth, pdf + from);
    for (size_t s = 0; s < padded; s += LANES) {
        const real theta = clamp(load(theta_i + s), all(lobe->theta.low), all(lobe->theta.high)), x = load(azimuth + s);
        store(pdf + from + s, mul(weight_at(model, m, k, from + s), load(pdf + from + s)));
        store(d->theta_i + from + s, theta);
        store(cosines + from + s, cosine(theta));
        store(d->i + from + s, lobe->uniform
                                   ? x
                                   : incident_azimuth(lobe, load(d->r + from + s), x, turn_at(model, m, k, from + s),
                                                      side_at(model, m, from + s)));
    }
}

/* Samples in the order of the inputs: what was sorted are theta_i, phi_i, densities and cosines of theta_i. */
static inline void put_samples(const hairlut_model *model, size_t n, const mixture_block *m, const sorting *own,
                               const float *const sorted[4], hairlut_samples out)
{
    for (size_t v = 0; v < n / LANES; ++v) {
        const size_t s = v * LANES;
        real sample[4];
        unsorted(own, model->lobe_count, m->chosen, v, 4, sorted, sample);
        const real density = choose(greater(load(m->valid + s), all(0.0f)), sample[2], all(0.0f));
        store(out.theta_i + s, sample[0]);
        store(out.phi_i + s, sample[1]);
        if (out.pdf_angle)
            store(out.pdf_angle + s, density);
        if (out.pdf_solid_angle)
            store(out.pdf_solid_angle + s, over(density, sample[3]));
    }
}

/* hairlut_sample_hair, hairlut_sample_strand; `strands` is as in pdf_hair_block. */
static inline void sample_hair_block(const hairlut_model *model, size_t n, const hair_inputs *in, strand_block *strands,
                                     hairlut_samples out)
{
    directions d;
    numbers_drawn u;
    mixture_block m;
    sorting own;
    float cosines[ROOM], pdf[ROOM];
    const float *const sorted[4] = {d.theta_i, d.i, pdf, cosines};
    prepare(model, n, in, strands, &m, &d, &u, &own);
    for (size_t s = 0; s <= n; s += LANES) { /* what is read, at least by lanes that are not used, is set */
        store(pdf + s, all(0.0f));
        store(cosines + s, all(1.0f));
    }
    for (int k = 0; k < model->lobe_count; ++k)
        if (draws_any(&own, k))
            draw_range(model, k, strands, &m, &u, own.first[k], own.first[k + 1], &d, pdf, cosines);
    end_directions(&d, &m, n);
    add_densities(model, strands, &d, &m, n, &own, pdf);
    put_samples(model, n, &m, &own, sorted, out);
}

#endif
