/* Arrays of any n, put together from blocks of whole vectors. */
#ifndef HAIRLUT_BATCH_ARRAYS_H
#define HAIRLUT_BATCH_ARRAYS_H

#include <stdint.h>

#include "batch_cells.h"

/* From so many samples on it is worth a vector of few to go on from where vectors fill a cache line, or half of one: those
 * across two lines cost a sample 3 to 5 %, a density nothing (tests/bench/NOTES.md). */
enum { ALIGNED_FROM = 16 * BLOCK };

/* n is a multiple of LANES, at most BLOCK */
typedef void (*sample_block)(const hairlut_model *, size_t n, const float *const in[4], hairlut_samples);
typedef void (*pdf_block)(const hairlut_model *, size_t n, const float *const in[4], float *);

/* How many of the n samples left are next: whole vectors, at most a block of them, or else the last n < LANES. */
static inline size_t part_size(size_t n)
{
    const size_t whole_vectors = n - n % LANES;
    return n < LANES ? n : whole_vectors < BLOCK ? whole_vectors : BLOCK;
}

/* How many samples come before an output's first aligned vector. The other arrays of a caller mostly begin alike. */
static inline size_t until_aligned(const float *out, size_t n)
{
    const size_t vector = LANES * sizeof(float), beyond = (uintptr_t)out % vector;
    return n < ALIGNED_FROM || beyond == 0 ? 0 : (vector - beyond) / sizeof(float);
}

/* n < LANES inputs, filled up with zeros. */
static inline void pad(float padded[4][LANES], const float *const in[4], size_t n)
{
    for (int k = 0; k < 4; ++k)
        for (size_t l = 0; l < LANES; ++l)
            padded[k][l] = l < n ? in[k][l] : 0.0f;
}

static inline void copy(float *to, const float *from, size_t n)
{
    for (size_t l = 0; to && l < n; ++l)
        to[l] = from[l];
}

static inline void sample_few(sample_block block, const hairlut_model *model, size_t n, const float *const in[4],
                              hairlut_samples out)
{
    float padded[4][LANES], result[4][LANES];
    const float *const here[4] = {padded[0], padded[1], padded[2], padded[3]};
    const hairlut_samples there = {result[0], result[1], result[2], result[3]};
    pad(padded, in, n);
    block(model, LANES, here, there);
    copy(out.theta_i, result[0], n);
    copy(out.phi_i, result[1], n);
    copy(out.pdf_angle, result[2], n);
    copy(out.pdf_solid_angle, result[3], n);
}

static inline void sample_blocks(sample_block block, const hairlut_model *model, size_t n, const float *const in[4],
                                 hairlut_samples out)
{
    const size_t unaligned = until_aligned(out.theta_i, n);
    for (size_t s = 0, m = unaligned > 0 ? unaligned : part_size(n); s < n; s += m, m = part_size(n - s)) {
        const float *const here[4] = {in[0] + s, in[1] + s, in[2] + s, in[3] + s};
        if (m < LANES)
            sample_few(block, model, m, here, hairlut_samples_from(out, s));
        else
            block(model, m, here, hairlut_samples_from(out, s));
    }
}

static inline void pdf_few(pdf_block block, const hairlut_model *model, size_t n, const float *const in[4], float *out)
{
    float padded[4][LANES], result[LANES];
    const float *const here[4] = {padded[0], padded[1], padded[2], padded[3]};
    pad(padded, in, n);
    block(model, LANES, here, result);
    copy(out, result, n);
}

static inline void pdf_blocks(pdf_block block, const hairlut_model *model, size_t n, const float *const in[4], float *out)
{
    for (size_t s = 0, m = part_size(n); s < n; s += m, m = part_size(n - s)) {
        const float *const here[4] = {in[0] + s, in[1] + s, in[2] + s, in[3] + s};
        if (m < LANES)
            pdf_few(block, model, m, here, out + s);
        else
            block(model, m, here, out + s);
    }
}

#endif
