/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes a model's descriptors as files of format 2 (luts/FORMAT.md), from that page alone: plain scanlines, not
 * compressed. */
#ifndef WRITE_EXR_H
#define WRITE_EXR_H

#include <stdarg.h>

#include "describe.h"
#include "exr_digest.h"
#include "warp.h"

static inline void put_bytes(FILE *file, const void *bytes, size_t size)
{
    REQUIRE(fwrite(bytes, 1, size, file) == size);
}

static inline void put_number(FILE *file, uint64_t value, int bytes)
{
    for (int k = 0; k < bytes; ++k)
        putc((int)(value >> 8 * k & 255), file);
}

static inline void put_float(FILE *file, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_number(file, bits, 4);
}

static inline void put_attribute(FILE *file, const char *name, const char *type, size_t size)
{
    put_bytes(file, name, strlen(name) + 1);
    put_bytes(file, type, strlen(type) + 1);
    put_number(file, size, 4);
}

static inline void put_text(FILE *file, const char *name, const char *format, ...)
{
    static char text[1 << 15];
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    REQUIRE(length >= 0 && (size_t)length < sizeof text);
    put_attribute(file, name, "string", (size_t)length);
    put_bytes(file, text, (size_t)length);
}

/* "1.5 2.5 ..." */
static inline const char *listed(char *text, size_t size, const double *values, int count)
{
    size_t at = 0;
    text[0] = '\0';
    for (int k = 0; k < count; ++k)
        at += (size_t)snprintf(text + at, size - at, "%s%.17g", k ? " " : "", values[k]);
    return text;
}

/* What every file has, for channels in the order of their names. */
static inline void put_start(FILE *file, const char *const *channels, int count, int width, int height, const char *table)
{
    size_t size = 1;
    for (int k = 0; k < count; ++k)
        size += strlen(channels[k]) + 1 + 16;
    put_number(file, 0x01312f76, 4);
    put_number(file, 2, 4);
    put_attribute(file, "channels", "chlist", size);
    for (int k = 0; k < count; ++k) {
        put_bytes(file, channels[k], strlen(channels[k]) + 1);
        put_number(file, 2, 4); /* FLOAT */
        put_number(file, 0, 4);
        put_number(file, 1, 4);
        put_number(file, 1, 4);
    }
    putc(0, file);
    put_attribute(file, "compression", "compression", 1);
    putc(0, file);
    for (int k = 0; k < 2; ++k) {
        put_attribute(file, k ? "displayWindow" : "dataWindow", "box2i", 16);
        put_number(file, 0, 8);
        put_number(file, (uint64_t)(width - 1), 4);
        put_number(file, (uint64_t)(height - 1), 4);
    }
    put_attribute(file, "lineOrder", "lineOrder", 1);
    putc(0, file);
    put_attribute(file, "pixelAspectRatio", "float", 4);
    put_float(file, 1.0f);
    put_attribute(file, "screenWindowCenter", "v2f", 8);
    put_number(file, 0, 8);
    put_attribute(file, "screenWindowWidth", "float", 4);
    put_float(file, 1.0f);
    put_attribute(file, "hairlut.format", "int", 4);
    put_number(file, 2, 4);
    put_text(file, "hairlut.model", "fuzzed");
    put_text(file, "hairlut.unit", "rad");
    put_text(file, "hairlut.table", "%s", table);
}

/* The digest, the end of the header, and the texels: `count` floats each, as the digest orders them. */
static inline uint32_t put_texels(FILE *file, const float *texels, int count, int width, int height)
{
    const uint32_t digest = hairlut_exr_digest(texels, (size_t)count * (size_t)width * (size_t)height);
    const uint64_t line = 8 + 4 * (uint64_t)count * (uint64_t)width;
    put_text(file, "hairlut.digest", "crc32 %08lx", (unsigned long)digest);
    putc(0, file);
    const uint64_t first = (uint64_t)ftell(file) + 8 * (uint64_t)height;
    for (int y = 0; y < height; ++y)
        put_number(file, first + line * (uint64_t)y, 8);
    for (int y = 0; y < height; ++y) {
        put_number(file, (uint64_t)y, 4);
        put_number(file, line - 8, 4);
        for (int c = 0; c < count; ++c)
            for (int x = 0; x < width; ++x)
                put_float(file, texels[(y * width + x) * count + c]);
    }
    return digest;
}

static inline FILE *create_file(const char *directory, const char *table)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.exr", directory, table);
    FILE *file = fopen(path, "wb");
    REQUIRE(file);
    return file;
}

/* hairlut.axes, ending with `last`, and the nodes of those that the file depends on */
static inline void put_axes(FILE *file, const described *d, const hairlut_parameter_nodes *axes, int count, const char *last)
{
    char names[80] = "", attribute[80], text[400];
    double nodes[MOST_VALUES];
    for (int k = 0; k < count; ++k) {
        const char *name = d->parameters[axes[k].parameter].name;
        for (int i = 0; i < axes[k].count; ++i)
            nodes[i] = axes[k].values[i];
        snprintf(attribute, sizeof attribute, "hairlut.axis.%s", name);
        put_text(file, attribute, "%s", listed(text, sizeof text, nodes, axes[k].count));
        strcat(strcat(names, name), " ");
    }
    put_text(file, "hairlut.axes", "%s%s", names, last);
}

/* Returns the digest. */
static inline uint32_t write_table(const char *directory, const described *d, const char *name, const hairlut_table *t,
                                   const char *azimuth)
{
    const int rows = t->height * blocks_of(t->axes, t->axis_count);
    static const char *const channels[] = {"Y", "dxdu"};
    static char text[1 << 15];
    double knots[MOST_WIDTH];
    const int octaves = t->warp == HAIRLUT_WARP_OCTAVES;
    const hairlut_warp_scale scale = hairlut_scale_warp(t->warp, t->warp_e, t->width);
    FILE *file = create_file(directory, name);
    put_start(file, channels, 2, t->width, rows, name);
    if (t->axis_count > 0)
        put_axes(file, d, t->axes, t->axis_count, "theta_r");
    put_text(file, "hairlut.angle", strcmp(azimuth, "none") == 0 ? "theta_i" : "phi");
    put_text(file, "hairlut.azimuth", "%s", azimuth);
    put_text(file, "hairlut.warp", octaves ? "octaves e=%.17g" : "uniform", (double)t->warp_e);
    put_text(file, "hairlut.cell", "rational quadratic");
    put_text(file, "hairlut.theta_r_range", "%.17g %.17g", (double)t->theta_r_min, (double)t->theta_r_max);
    put_text(file, "hairlut.domain", "%.17g %.17g", strcmp(azimuth, "none") == 0 ? -1.5707963267948966 : 0.0,
             strcmp(azimuth, "none") == 0 ? 1.5707963267948966 : 6.283185307179586);
    for (int i = 0; i < t->width; ++i)
        knots[i] = hairlut_warp_u(t->warp, &scale, t->width, i);
    put_text(file, "hairlut.knots", "%s", listed(text, sizeof text, knots, t->width));
    const uint32_t digest = put_texels(file, t->texels, 2, t->width, rows);
    REQUIRE(fclose(file) == 0);
    return digest;
}

/* The files of a model. A table is named after the first lobe that has it. */
static inline void write_files(const char *directory, const described *d)
{
    static float texels[2 * MOST_LOBES * MOST_NODES * MOST_NODES * MOST_BLOCKS];
    const hairlut_mixture_desc *m = &d->mixture;
    char channel_names[2 * MOST_LOBES][16], names[2 * MOST_LOBES][16], text[4096];
    const char *channels[2 * MOST_LOBES];
    uint32_t digests[2 * MOST_LOBES];
    double nodes[MOST_NODES];
    for (int k = 0; k < d->desc.lobe_count; ++k) {
        const hairlut_lobe_desc *lobe = &d->lobes[k];
        const hairlut_table *tables[2] = {lobe->theta, lobe->phi};
        for (int n = 0; n < 2; ++n) {
            const int owner = tables[n] ? (int)(tables[n] - d->tables) / 2 : k;
            snprintf(names[2 * k + n], sizeof names[0], "lobe%d_%s", owner % 10, n ? "phi" : "theta");
            if (tables[n])
                digests[2 * k + n] = write_table(directory, d, names[2 * k + n], tables[n],
                                                 n == 0                                 ? "none"
                                                 : lobe->azimuth == HAIRLUT_AZIMUTH_SUM ? "sum"
                                                                                        : "difference");
            snprintf(channel_names[2 * k + n], sizeof channel_names[0], "lobe%d.%s", k % 10, n ? "turn" : "share");
            channels[2 * k + n] = channel_names[2 * k + n];
        }
    }
    const int count = 2 * d->desc.lobe_count, rows = m->theta_r_count * blocks_of(m->axes, m->axis_count);
    const int grid = rows * m->offset_count;
    FILE *file = create_file(directory, "mixture");
    put_start(file, channels, count, m->offset_count, rows, "mixture");
    text[0] = '\0';
    for (int k = 0; k < d->desc.lobe_count; ++k)
        strcat(strcat(text, k ? " " : ""), d->names[k]);
    put_text(file, "hairlut.lobes", "%s", text);
    for (int k = 0; k < d->desc.lobe_count; ++k) {
        char attribute[32];
        snprintf(attribute, sizeof attribute, "hairlut.lobe.%s", d->names[k]);
        if (d->lobes[k].phi)
            put_text(file, attribute, "%s %08lx %s %08lx", names[2 * k], (unsigned long)digests[2 * k], names[2 * k + 1],
                     (unsigned long)digests[2 * k + 1]);
        else
            put_text(file, attribute, "%s %08lx", names[2 * k], (unsigned long)digests[2 * k]);
    }
    put_axes(file, d, m->axes, m->axis_count, "theta_r offset");
    for (int p = 0; p < d->desc.parameter_count; ++p) {
        const hairlut_parameter *parameter = &d->parameters[p];
        char attribute[32];
        snprintf(attribute, sizeof attribute, "hairlut.parameter.%s", parameter->name);
        put_text(file, attribute, "%.17g %.17g %.17g", (double)parameter->least, (double)parameter->most,
                 (double)parameter->standard);
    }
    for (int k = 0; k < m->theta_r_count; ++k)
        nodes[k] = m->theta_r[k];
    put_text(file, "hairlut.axis.theta_r", "%s", listed(text, sizeof text, nodes, m->theta_r_count));
    for (int k = 0; k < m->offset_count; ++k)
        nodes[k] = m->offset[k];
    put_text(file, "hairlut.axis.offset", "%s", listed(text, sizeof text, nodes, m->offset_count));
    put_text(file, "hairlut.mirrored", "%d", m->mirrored);
    for (int k = 0; k < d->desc.lobe_count; ++k)
        for (int node = 0; node < grid; ++node) {
            texels[node * count + 2 * k] = m->share[k * grid + node];
            texels[node * count + 2 * k + 1] = m->turn[k * grid + node];
        }
    put_texels(file, texels, count, m->offset_count, rows);
    REQUIRE(fclose(file) == 0);
}

#endif
