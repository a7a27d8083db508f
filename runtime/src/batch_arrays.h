/* SPDX-License-Identifier: BSD-3-Clause */
/* Arrays of any n, put together from blocks of whole vectors. The last few are copied to arrays of a vector, and back. */
#ifndef HAIRLUT_BATCH_ARRAYS_H
#define HAIRLUT_BATCH_ARRAYS_H

#include "batch_hair.h"

/* How many of the n samples left are next: whole vectors, at most a block of them, or else the last n < LANES. */
static inline size_t part_size(size_t n)
{
    const size_t vectors = n - n % LANES;
    return n < LANES ? n : vectors < BLOCK ? vectors : BLOCK;
}

/* n < LANES inputs, filled up with zeros. */
static inline void pad(float padded[LANES], const float *from, size_t n)
{
    for (size_t l = 0; l < LANES; ++l)
        padded[l] = l < n ? from[l] : 0.0f;
}

static inline void copy(float *to, const float *from, size_t n)
{
    for (size_t l = 0; to && l < n; ++l)
        to[l] = from[l];
}

/* Samples from s on */
static inline hairlut_samples samples_from(hairlut_samples out, size_t s)
{
    const hairlut_samples rest = {out.theta_i + s, out.phi_i + s, out.pdf_angle ? out.pdf_angle + s : NULL,
                                  out.pdf_solid_angle ? out.pdf_solid_angle + s : NULL};
    return rest;
}

/* The results of a vector, of which the first n are copied out. */
typedef struct few_results {
    float values[4][LANES];
} few_results;

static inline hairlut_samples into(few_results *few)
{
    const hairlut_samples samples = {few->values[0], few->values[1], few->values[2], few->values[3]};
    return samples;
}

static inline void copy_out(hairlut_samples out, const few_results *few, size_t n)
{
    copy(out.theta_i, few->values[0], n);
    copy(out.phi_i, few->values[1], n);
    copy(out.pdf_angle, few->values[2], n);
    copy(out.pdf_solid_angle, few->values[3], n);
}

static void sample_lobe(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                        const float *u_theta, const float *u_phi, hairlut_samples out)
{
    for (size_t s = 0, m = part_size(n); s < n; s += m, m = part_size(n - s)) {
        const float *const here[4] = {theta_r + s, phi_r + s, u_theta + s, u_phi + s};
        if (m < LANES) {
            float padded[4][LANES];
            const float *const few_in[4] = {padded[0], padded[1], padded[2], padded[3]};
            few_results few;
            for (int k = 0; k < 4; ++k)
                pad(padded[k], here[k], m);
            sample_lobe_block(model, lobe, LANES, few_in, into(&few));
            copy_out(samples_from(out, s), &few, m);
        } else {
            sample_lobe_block(model, lobe, m, here, samples_from(out, s));
        }
    }
}

static void pdf_lobe(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                     const float *theta_i, const float *phi_i, float *pdf_angle)
{
    for (size_t s = 0, m = part_size(n); s < n; s += m, m = part_size(n - s)) {
        const float *const here[4] = {theta_r + s, phi_r + s, theta_i + s, phi_i + s};
        if (m < LANES) {
            float padded[4][LANES], result[LANES];
            const float *const few_in[4] = {padded[0], padded[1], padded[2], padded[3]};
            for (int k = 0; k < 4; ++k)
                pad(padded[k], here[k], m);
            pdf_lobe_block(model, lobe, LANES, few_in, result);
            copy(pdf_angle + s, result, m);
        } else {
            pdf_lobe_block(model, lobe, m, here, pdf_angle + s);
        }
    }
}

/* An array that may be NULL, from s on */
static inline const float *from_on(const float *array, size_t s)
{
    return array ? array + s : NULL;
}

static inline hair_inputs inputs_from(const hair_inputs *in, size_t s)
{
    const hair_inputs rest = {{from_on(in->given.shares, s), in->given.stride},
                              in->theta_r + s,
                              in->phi_r + s,
                              from_on(in->offset, s),
                              from_on(in->u_lobe, s),
                              from_on(in->u_theta, s),
                              from_on(in->u_phi, s),
                              from_on(in->theta_i, s),
                              from_on(in->phi_i, s)};
    return rest;
}

/* The inputs of a vector, of which the first n are the caller's. */
typedef struct few_inputs {
    float shares[HAIRLUT_MAX_LOBES][LANES], rest[8][LANES];
} few_inputs;

static inline const float *pad_one(float padded[LANES], const float *from, size_t n)
{
    if (from)
        pad(padded, from, n);
    return from ? padded : NULL;
}

static inline hair_inputs pad_inputs(few_inputs *few, const hair_inputs *in, int lobe_count, size_t n)
{
    hair_inputs padded;
    for (int k = 0; in->given.shares && k < lobe_count; ++k)
        pad(few->shares[k], in->given.shares + (size_t)k * in->given.stride, n);
    padded.given.shares = in->given.shares ? few->shares[0] : NULL;
    padded.given.stride = LANES;
    padded.theta_r = pad_one(few->rest[0], in->theta_r, n);
    padded.phi_r = pad_one(few->rest[1], in->phi_r, n);
    padded.offset = pad_one(few->rest[2], in->offset, n);
    padded.u_lobe = pad_one(few->rest[3], in->u_lobe, n);
    padded.u_theta = pad_one(few->rest[4], in->u_theta, n);
    padded.u_phi = pad_one(few->rest[5], in->u_phi, n);
    padded.theta_i = pad_one(few->rest[6], in->theta_i, n);
    padded.phi_i = pad_one(few->rest[7], in->phi_i, n);
    return padded;
}

static void sample_hair(const hairlut_model *model, size_t n, const float *shares, const float *theta_r, const float *phi_r,
                        const float *offset, const float *u_lobe, const float *u_theta, const float *u_phi,
                        hairlut_samples out)
{
    const hair_inputs in = {{shares, n}, theta_r, phi_r, offset, u_lobe, u_theta, u_phi, NULL, NULL};
    for (size_t s = 0, m = part_size(n); s < n; s += m, m = part_size(n - s)) {
        const hair_inputs here = inputs_from(&in, s);
        if (m < LANES) {
            few_inputs few_in;
            few_results few;
            const hair_inputs padded = pad_inputs(&few_in, &here, model->lobe_count, m);
            sample_hair_block(model, LANES, &padded, into(&few));
            copy_out(samples_from(out, s), &few, m);
        } else {
            sample_hair_block(model, m, &here, samples_from(out, s));
        }
    }
}

static void pdf_hair(const hairlut_model *model, size_t n, const float *shares, const float *theta_r, const float *phi_r,
                     const float *offset, const float *theta_i, const float *phi_i, float *pdf_angle)
{
    const hair_inputs in = {{shares, n}, theta_r, phi_r, offset, NULL, NULL, NULL, theta_i, phi_i};
    for (size_t s = 0, m = part_size(n); s < n; s += m, m = part_size(n - s)) {
        const hair_inputs here = inputs_from(&in, s);
        if (m < LANES) {
            few_inputs few_in;
            float result[LANES];
            const hair_inputs padded = pad_inputs(&few_in, &here, model->lobe_count, m);
            pdf_hair_block(model, LANES, &padded, result);
            copy(pdf_angle + s, result, m);
        } else {
            pdf_hair_block(model, m, &here, pdf_angle + s);
        }
    }
}

#endif
