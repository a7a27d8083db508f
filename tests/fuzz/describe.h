/* SPDX-License-Identifier: BSD-3-Clause */
/* A model's descriptors out of any bytes: sizes, numbers and texels as they come, or tamed so that many inputs are good
 * models. */
#ifndef DESCRIBE_H
#define DESCRIBE_H

#include <string.h>

#include "check.h"

enum {
    MOST_LOBES = 4,
    MOST_WIDTH = 80,
    MOST_HEIGHT = 8,
    MOST_NODES = 4,
    DESCRIBED_TABLES = 2 * MOST_LOBES,
    PARAMETERS = 2,
    MOST_VALUES = 3,                        /* nodes of a parameter */
    MOST_BLOCKS = MOST_VALUES * MOST_VALUES /* of rows */
};

typedef struct reader {
    const uint8_t *data;
    size_t size;
} reader;

/* The next bytes, or zeros behind the end. */
static inline void take(reader *r, void *value, size_t size)
{
    memset(value, 0, size);
    const size_t count = size < r->size ? size : r->size;
    if (count)
        memcpy(value, r->data, count);
    r->data += count;
    r->size -= count;
}

static inline float take_float(reader *r)
{
    float value;
    take(r, &value, sizeof value);
    return value;
}

static inline uint8_t take_byte(reader *r)
{
    uint8_t value;
    take(r, &value, 1);
    return value;
}

/* A number from low to high. */
static inline float take_between(reader *r, float low, float high)
{
    uint16_t value;
    take(r, &value, sizeof value);
    const float x = low + (high - low) * (float)value / 65535.0f;
    return x > high ? high : x;
}

/* Descriptors and what they point to. */
typedef struct described {
    float texels[DESCRIBED_TABLES][2 * MOST_WIDTH * MOST_HEIGHT * MOST_BLOCKS];
    float theta_r[MOST_NODES], offset[MOST_NODES];
    float share[MOST_LOBES * MOST_NODES * MOST_NODES * MOST_BLOCKS],
        turn[MOST_LOBES * MOST_NODES * MOST_NODES * MOST_BLOCKS];
    hairlut_parameter parameters[PARAMETERS];
    float values[PARAMETERS][MOST_VALUES];
    hairlut_parameter_nodes axes[PARAMETERS]; /* over all parameters: those of the mixture */
    hairlut_parameter_nodes own[DESCRIBED_TABLES][PARAMETERS];
    char names[MOST_LOBES][8];
    hairlut_table tables[DESCRIBED_TABLES];
    hairlut_lobe_desc lobes[MOST_LOBES];
    hairlut_mixture_desc mixture;
    hairlut_model_desc desc;
} described;

/* Cells whose widths are powers of two by the next bytes, stretched over the domain; slopes likewise. */
static inline void take_row(reader *r, float *row, int width, float low, float high)
{
    double total = 0.0, sum = 0.0, widths[MOST_WIDTH];
    for (int i = 0; i + 1 < width; ++i)
        total += widths[i] = ldexp(1.0, -(take_byte(r) % 16));
    for (int i = 0; i < width; ++i) {
        row[2 * i] = i == 0 ? low : i == width - 1 ? high : (float)(low + (high - low) * (sum / total));
        row[2 * i + 1] = ldexpf(1.0f, take_byte(r) % 60 - 25);
        sum += i + 1 < width ? widths[i] : 0.0;
    }
}

/* Parameters with their nodes; flag 16: any numbers */
static inline void take_parameters(reader *r, described *d, int any)
{
    static const char *const names[PARAMETERS] = {"beta_m", "absorption"};
    for (int p = 0; p < PARAMETERS; ++p) {
        const int count = any ? take_byte(r) % (MOST_VALUES + 1) : 2 + take_byte(r) % (MOST_VALUES - 1);
        const float least = any ? take_float(r) : take_between(r, -2.0f, 2.0f),
                    most = any ? take_float(r) : least + take_between(r, 0.1f, 3.0f),
                    standard = any ? take_float(r) : least + 0.5f * (most - least);
        const hairlut_parameter parameter = {sizeof parameter, names[p], least, most, standard};
        const int number = any && take_byte(r) % 8 == 0 ? (int)take_byte(r) - 1 : p;
        const hairlut_parameter_nodes nodes = {sizeof nodes, number, count, d->values[p]};
        d->parameters[p] = parameter;
        for (int k = 0; k < count; ++k)
            d->values[p][k] = k == 0 ? least : k == count - 1 ? most : any ? take_float(r) : least + 0.3f * (most - least);
        d->axes[p] = nodes;
    }
}

/* Some of them, by the bits of a byte, for a table; returns how many. */
static inline int take_axes(reader *r, const described *d, hairlut_parameter_nodes *own)
{
    const int which = take_byte(r);
    int count = 0;
    for (int p = 0; p < PARAMETERS; ++p)
        if (which >> p & 1)
            own[count++] = d->axes[p];
    return count;
}

static inline int blocks_of(const hairlut_parameter_nodes *axes, int count)
{
    int blocks = 1;
    for (int k = 0; k < count; ++k)
        blocks *= axes[k].count;
    return blocks;
}

/* Flags: 1 any range of theta_r, 2 any domain, 4 any warp, 8 any texels, 128 over parameters */
static inline hairlut_table take_table(reader *r, described *d, int number, int flags)
{
    const int is_phi = number % 2;
    float *texels = d->texels[number];
    hairlut_table t;
    t.size = sizeof t;
    t.texels = texels;
    t.width = flags & 8 ? take_byte(r) % (MOST_WIDTH + 1) : 4 + take_byte(r) % (MOST_WIDTH - 3);
    t.height = flags & 8 ? take_byte(r) % (MOST_HEIGHT + 1) : 2 + take_byte(r) % (MOST_HEIGHT - 1);
    t.theta_r_min = flags & 1 ? take_float(r) : take_between(r, -1.57f, 0.0f);
    t.theta_r_max = flags & 1 ? take_float(r) : take_between(r, 0.01f, 1.57f);
    t.domain_min = flags & 2 ? take_float(r) : is_phi ? 0.0f : -1.57079637f;
    t.domain_max = flags & 2 ? take_float(r) : is_phi ? 6.28318548f : 1.57079637f;
    t.warp = flags & 4 ? (hairlut_warp)(take_byte(r) % 3) : (hairlut_warp)(take_byte(r) % 2);
    t.warp_e = flags & 4 ? take_float(r) : ldexpf(1.0f, -(take_byte(r) % 39));
    t.axis_count = flags & 128 ? take_axes(r, d, d->own[number]) : 0;
    t.axes = d->own[number];
    for (int j = 0; j < t.height * blocks_of(t.axes, t.axis_count) && t.width > 1; ++j) {
        if (flags & 8)
            take(r, texels + 2 * j * t.width, 2 * sizeof(float) * (size_t)t.width);
        else
            take_row(r, texels + 2 * j * t.width, t.width, t.domain_min, t.domain_max);
    }
    return t;
}

static inline void take_nodes(reader *r, float *nodes, int count, float low, float high, int any)
{
    for (int k = 0; k < count; ++k)
        nodes[k] = any ? take_float(r) : count == 1 ? 0.0f : low + (high - low) * (float)k / (float)(count - 1);
}

/* Lobes of tables of their own, or of those of the lobe before. Flags as of take_table, and 16 any nodes and parameters, 32 any
 * shares and turns. */
static inline void describe(reader *r, described *d, int flags)
{
    const int lobes = 1 + take_byte(r) % MOST_LOBES, rows = 1 + take_byte(r) % MOST_NODES,
              columns = 1 + take_byte(r) % MOST_NODES;
    const int mirrored = take_byte(r) % (flags & 16 ? 3 : 2);
    if (flags & 128)
        take_parameters(r, d, flags & 16);
    const int axis_count = flags & 128 ? PARAMETERS : 0, blocks = blocks_of(d->axes, axis_count);
    for (int k = 0; k < lobes; ++k) {
        const int shape = take_byte(r), own = k == 0 || shape & 1;
        snprintf(d->names[k], sizeof d->names[k], "lobe%d", k % 10);
        if (own)
            d->tables[2 * k] = take_table(r, d, 2 * k, flags);
        if (shape & 2)
            d->tables[2 * k + 1] = take_table(r, d, 2 * k + 1, flags);
        const hairlut_lobe_desc lobe = {sizeof lobe, d->names[k], own ? &d->tables[2 * k] : d->lobes[k - 1].theta,
                                        shape & 2 ? &d->tables[2 * k + 1]
                                        : own     ? NULL
                                                  : d->lobes[k - 1].phi,
                                        k > 0 && !own && !(shape & 2) ? d->lobes[k - 1].azimuth
                                                                      : (hairlut_azimuth)(shape >> 2 & 1)};
        d->lobes[k] = lobe;
    }
    take_nodes(r, d->theta_r, rows, -1.5f, 1.5f, flags & 16);
    take_nodes(r, d->offset, columns, mirrored ? 0.0f : -1.0f, 1.0f, flags & 16);
    for (int k = 0; k < lobes * blocks * rows * columns; ++k) {
        d->share[k] = flags & 32 ? take_float(r) : (float)(1 + take_byte(r));
        d->turn[k] = flags & 32 ? take_float(r) : take_between(r, -25.0f, 25.0f);
    }
    const hairlut_mixture_desc mixture = {sizeof mixture, rows,    columns,  d->theta_r, d->offset,
                                          d->share,       d->turn, mirrored, axis_count, d->axes};
    d->mixture = mixture;
    const hairlut_model_desc desc = {sizeof desc, lobes, d->lobes, &d->mixture, axis_count, d->parameters};
    d->desc = desc;
}

static inline query take_query(reader *r)
{
    const float theta_r = take_float(r), phi_r = take_float(r), offset = take_float(r), u_lobe = take_float(r);
    const float u_theta = take_float(r), u_phi = take_float(r);
    const query q = {theta_r, phi_r, offset, u_lobe, u_theta, u_phi};
    return q;
}

#endif
