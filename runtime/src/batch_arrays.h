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
    const hair_inputs rest = {{from_on(in->strands.values, s), in->strands.stride},
                              {from_on(in->given.shares, s), in->given.stride},
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
    float parameters[HAIRLUT_MAX_PARAMETERS][LANES], shares[HAIRLUT_MAX_LOBES][LANES], rest[8][LANES];
} few_inputs;

static inline const float *pad_one(float padded[LANES], const float *from, size_t n)
{
    if (from)
        pad(padded, from, n);
    return from ? padded : NULL;
}

/* `count` arrays, each `stride` behind the one before; NULL for NULL */
static inline const float *pad_all(float padded[][LANES], const float *from, size_t stride, int count, size_t n)
{
    for (int k = 0; from && k < count; ++k)
        pad(padded[k], from + (size_t)k * stride, n);
    return from ? padded[0] : NULL;
}

static inline hair_inputs pad_inputs(few_inputs *few, const hair_inputs *in, const hairlut_model *model, size_t n)
{
    hair_inputs padded;
    const int parameters = model->strands ? model->strands->parameter_count : 0;
    padded.strands.values = pad_all(few->parameters, in->strands.values, in->strands.stride, parameters, n);
    padded.given.shares = pad_all(few->shares, in->given.shares, in->given.stride, model->lobe_count, n);
    padded.strands.stride = padded.given.stride = LANES;
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

/* `strands` is room for the strands of a block; NULL without parameters. */
static void sample_all(const hairlut_model *model, size_t n, const hair_inputs *in, strand_block *strands,
                       hairlut_samples out)
{
    for (size_t s = 0, m = part_size(n); s < n; s += m, m = part_size(n - s)) {
        const hair_inputs here = inputs_from(in, s);
        if (m < LANES) {
            few_inputs few_in;
            few_results few;
            const hair_inputs padded = pad_inputs(&few_in, &here, model, m);
            sample_hair_block(model, LANES, &padded, strands, into(&few));
            copy_out(samples_from(out, s), &few, m);
        } else {
            sample_hair_block(model, m, &here, strands, samples_from(out, s));
        }
    }
}

static void pdf_all(const hairlut_model *model, size_t n, const hair_inputs *in, strand_block *strands, float *pdf_angle)
{
    for (size_t s = 0, m = part_size(n); s < n; s += m, m = part_size(n - s)) {
        const hair_inputs here = inputs_from(in, s);
        if (m < LANES) {
            few_inputs few_in;
            float result[LANES];
            const hair_inputs padded = pad_inputs(&few_in, &here, model, m);
            pdf_hair_block(model, LANES, &padded, strands, result);
            copy(pdf_angle + s, result, m);
        } else {
            pdf_hair_block(model, m, &here, strands, pdf_angle + s);
        }
    }
}

static void sample_hair(const hairlut_model *model, size_t n, const float *shares, const float *theta_r, const float *phi_r,
                        const float *offset, const float *u_lobe, const float *u_theta, const float *u_phi,
                        hairlut_samples out)
{
    const hair_inputs in = {{NULL, 0}, {shares, n}, theta_r, phi_r, offset, u_lobe, u_theta, u_phi, NULL, NULL};
    sample_all(model, n, &in, NULL, out);
}

static void pdf_hair(const hairlut_model *model, size_t n, const float *shares, const float *theta_r, const float *phi_r,
                     const float *offset, const float *theta_i, const float *phi_i, float *pdf_angle)
{
    const hair_inputs in = {{NULL, 0}, {shares, n}, theta_r, phi_r, offset, NULL, NULL, NULL, theta_i, phi_i};
    pdf_all(model, n, &in, NULL, pdf_angle);
}

static void sample_strand(const hairlut_model *model, size_t n, const float *parameters, const float *shares,
                          const float *theta_r, const float *phi_r, const float *offset, const float *u_lobe,
                          const float *u_theta, const float *u_phi, hairlut_samples out)
{
    const hair_inputs in = {{parameters, n}, {shares, n}, theta_r, phi_r, offset, u_lobe, u_theta, u_phi, NULL, NULL};
    strand_block strands;
    sample_all(model, n, &in, &strands, out);
}

static void pdf_strand(const hairlut_model *model, size_t n, const float *parameters, const float *shares,
                       const float *theta_r, const float *phi_r, const float *offset, const float *theta_i,
                       const float *phi_i, float *pdf_angle)
{
    const hair_inputs in = {{parameters, n}, {shares, n}, theta_r, phi_r, offset, NULL, NULL, NULL, theta_i, phi_i};
    strand_block strands;
    pdf_all(model, n, &in, &strands, pdf_angle);
}

#endif
