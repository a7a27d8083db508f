/* Models from tables in memory: what a table must fulfil, and the padded copy that the kernels read. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "allocator.h"
#include "internal.h"
#include "message.h"
#include "warp.h"

enum { MAX_SIDE = 4096 }; /* 64 MiB of texels, a wrong size is refused before it is allocated */

/* The floats next to pi/2 and 2 pi, both just above. */
static const float half_pi = 1.57079637f;
static const float two_pi = 6.28318548f;

/* No cell is narrower: the product of two axes' densities and of 1/cos at the pole stays a float. */
static const float narrowest_cell = 1e-12f;

int hairlut_version(void)
{
    return HAIRLUT_VERSION;
}

const char *hairlut_result_string(hairlut_result result)
{
    switch (result) {
    case HAIRLUT_OK:
        return "ok";
    case HAIRLUT_ERROR_ARGUMENT:
        return "an argument is null or out of its range";
    case HAIRLUT_ERROR_MEMORY:
        return "out of memory";
    case HAIRLUT_ERROR_FILE:
        return "a file is missing, truncated or not an OpenEXR image";
    case HAIRLUT_ERROR_ATTRIBUTE:
        return "a header attribute is missing or has an unexpected value";
    case HAIRLUT_ERROR_VERSION:
        return "the file is of a newer format than this library reads";
    case HAIRLUT_ERROR_TABLE:
        return "the texels are not a table of increasing angles within the domain";
    case HAIRLUT_ERROR_UNSUPPORTED:
        return "the file needs a feature that the OpenEXR library in use lacks";
    }
    return "unknown result";
}

/* NaN is in no range */
static int within(float low, float high, float bound_low, float bound_high)
{
    return low >= bound_low && low < high && high <= bound_high;
}

static hairlut_result validate_numbers(const hairlut_table *t, char *message)
{
    if (!t->texels)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "texels is NULL: expected width*height floats");
    if (t->width < 4 || t->height < 2 || t->width > MAX_SIDE || t->height > MAX_SIDE)
        return hairlut_fail(HAIRLUT_ERROR_TABLE, message, "size is %dx%d: expected a width of 4 to %d and a height of 2 to %d",
                    t->width, t->height, (int)MAX_SIDE, (int)MAX_SIDE);
    if (!within(t->theta_r_min, t->theta_r_max, -two_pi, two_pi) || t->theta_r_max - t->theta_r_min < 1e-6f)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                            "theta_r_min %g, theta_r_max %g: expected increasing angles from -2 pi to 2 pi",
                            (double)t->theta_r_min, (double)t->theta_r_max);
    if (!within(t->domain_min, t->domain_max, -two_pi, two_pi))
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                            "domain_min %g, domain_max %g: expected increasing angles from -2 pi to 2 pi",
                            (double)t->domain_min, (double)t->domain_max);
    if (t->warp != HAIRLUT_WARP_UNIFORM && t->warp != HAIRLUT_WARP_OCTAVES)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "warp is %d: expected HAIRLUT_WARP_UNIFORM or HAIRLUT_WARP_OCTAVES",
                    (int)t->warp);
    if (t->warp == HAIRLUT_WARP_OCTAVES && !(t->warp_e >= 1e-12f && t->warp_e <= 1.0f))
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "warp_e is %g: expected 1e-12 to 1", (double)t->warp_e);
    if (!(t->cell_limit >= 0.0f && t->cell_limit <= 0.95f))
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "cell_limit is %g: expected 0 to 0.95", (double)t->cell_limit);
    return HAIRLUT_OK;
}

static hairlut_result validate_row(const hairlut_table *t, int j, char *message)
{
    const float *row = t->texels + (size_t)j * (size_t)t->width;
    for (int i = 0; i + 1 < t->width; ++i)
        if (!(row[i + 1] - row[i] >= narrowest_cell))
            return hairlut_fail(HAIRLUT_ERROR_TABLE, message,
                                "row %d, columns %d and %d: %.9g, %.9g: expected angles that increase by at least %g", j, i,
                                i + 1, (double)row[i], (double)row[i + 1], (double)narrowest_cell);
    if (row[0] != t->domain_min || row[t->width - 1] != t->domain_max)
        return hairlut_fail(HAIRLUT_ERROR_TABLE, message,
                            "row %d runs from %.9g to %.9g: expected the whole domain, %.9g to %.9g", j, (double)row[0],
                            (double)row[t->width - 1], (double)t->domain_min, (double)t->domain_max);
    return HAIRLUT_OK;
}

hairlut_result hairlut_validate(const hairlut_table *table, char *message)
{
    if (!table)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "table is NULL");
    hairlut_result result = validate_numbers(table, message);
    for (int j = 0; result == HAIRLUT_OK && j < table->height; ++j)
        result = validate_row(table, j, message);
    return result;
}

/* A group of the texels of columns i, i + step and so on. */
static void store_group(float *stored, const float *row, const float *above, int width, int i, int step)
{
    const int size = HAIRLUT_GROUP_SIZE(width);
    for (int k = 0; k < size; ++k, i += step) {
        const int inner = i < width - 1;
        stored[k] = inner ? row[i] : HAIRLUT_NO_TEXEL;
        if (HAIRLUT_IS_SMALL(width))
            stored[size + k] = inner ? above[i] - row[i] : 0.0f;
    }
}

/* A row as internal.h lays it out. */
static void store_row(float *stored, const float *row, const float *above, int width)
{
    const int step = HAIRLUT_STEP(width), size = HAIRLUT_GROUP_SIZE(width);
    store_group(stored, row, above, width, step, step);
    for (int first = 0; first < HAIRLUT_WHOLE(width - 1, step); first += size)
        store_group(stored += HAIRLUT_LINE, row, above, width, first + 1, 1);
}

/* A row counted from one of its ends: texel and knot k, and what follows from them for cell k, between knots k and k+1. */
typedef struct row_view {
    const float *first;
    int step; /* 1 from the low end, -1 from the high end */
    int width;
    const float *knots;
} row_view;

static double texel(const row_view *row, int k)
{
    return (double)row->first[k * row->step];
}

static double width_in_x(const row_view *row, int k)
{
    return texel(row, k + 1) - texel(row, k);
}

static double width_in_u(const row_view *row, int k)
{
    return (double)row->knots[k + 1] - (double)row->knots[k];
}

/* dx/du at an inner knot: the density there is that of both cells, blended linearly in x. */
static double knot_slope(const row_view *row, int k)
{
    const double d = width_in_x(row, k), before = width_in_x(row, k - 1);
    return (before + d) / (d * width_in_u(row, k - 1) / before + before * width_in_u(row, k) / d);
}

/* The curvature of cell k (luts/FORMAT.md, "Reading", step 3). */
static double curvature(const row_view *row, int k, double limit)
{
    const double d = width_in_x(row, k), h = width_in_u(row, k), bound = limit * fabs(d);
    double c;
    if (k == 0)
        c = d - h * width_in_x(row, 1) / width_in_u(row, 1);
    else if (k == row->width - 2)
        c = h * width_in_x(row, k - 1) / width_in_u(row, k - 1) - d;
    else
        c = h * (knot_slope(row, k) - knot_slope(row, k + 1)) / 2.0;
    return c < -bound ? -bound : c > bound ? bound : c;
}

static void store_cell(float *stored, const row_view *row, int k, double limit)
{
    const double h = width_in_u(row, k), c = curvature(row, k, limit);
    stored[0] = (float)texel(row, k);
    stored[1] = (float)((width_in_x(row, k) + c) / h);
    stored[2] = (float)(c / (h * h));
    stored[3] = row->knots[k];
}

/* The cells of row j of an axis; knots are those of its half, and one more. */
static void store_cells(const hairlut_axis *axis, float *cells, int j, const float *row, const float *knots, float limit)
{
    const int width = axis->columns;
    const row_view views[2] = {{row, 1, width, knots}, {row + width - 1, -1, width, knots}};
    for (int end = 0; end < 2; ++end) {
        float *cell = cells + HAIRLUT_CELL * j + end * (axis->ends[1] - axis->ends[0]);
        for (int k = 0; k < HAIRLUT_HALF(width); ++k, cell += axis->pitch)
            store_cell(cell, &views[end], k, (double)limit);
    }
}

/* Floats in memory, whole cache lines */
static size_t rows_floats(const hairlut_table *t)
{
    return (size_t)HAIRLUT_STORED(t->width, t->height);
}

static size_t cells_floats(const hairlut_table *t)
{
    return (size_t)HAIRLUT_WHOLE(HAIRLUT_CELLS(t->width, t->height), HAIRLUT_LINE);
}

/* Fills an axis whose rows and cells go to `memory`; returns the end of what it filled. */
static float *build_axis(hairlut_axis *axis, const hairlut_table *t, float *memory)
{
    float *rows = memory, *cells = memory + rows_floats(t);
    const hairlut_warp_scale scale = hairlut_scale_warp(t->warp, t->warp_e, t->width);
    const float row_scale = (float)((t->height - 1) / ((double)t->theta_r_max - (double)t->theta_r_min));
    const hairlut_axis filled =
        HAIRLUT_AXIS(rows, cells, t->width, t->height, t->theta_r_min, row_scale, t->domain_min, t->domain_max, (int)t->warp,
                     (float)scale.e, (float)scale.f0, (float)scale.k);
    float knots[MAX_SIDE / 2 + 3]; /* of a half, one cell beyond its middle, and the next cell's end for its slope */
    *axis = filled;
    for (int k = 0; k < HAIRLUT_HALF(t->width) + 2 && k < t->width; ++k)
        knots[k] = (float)hairlut_warp_u(t->warp, &scale, t->width, k);
    for (int j = 0; j <= t->height; ++j) {
        const float *row = t->texels + (size_t)(j < t->height ? j : t->height - 1) * (size_t)t->width;
        const float *above = j + 1 < t->height ? row + t->width : row;
        store_row(rows + (size_t)j * (size_t)axis->stride, row, above, t->width);
        store_cells(axis, cells, j, row, knots, t->cell_limit);
    }
    return cells + cells_floats(t);
}

static hairlut_result validate_all(const hairlut_model_desc *desc, char *message)
{
    const struct {
        const char *name;
        const hairlut_table *table;
        float low, high;
    } parts[3] = {
        {"direct_theta", &desc->direct_theta, -half_pi, half_pi},
        {"direct_phi", &desc->direct_phi, 0.0f, two_pi},
        {"multiple_theta", &desc->multiple_theta, -half_pi, half_pi},
    };
    char detail[HAIRLUT_MESSAGE_SIZE];
    for (int k = 0; k < 3; ++k) {
        const hairlut_table *t = parts[k].table;
        const hairlut_result result = hairlut_validate(t, detail);
        if (result != HAIRLUT_OK)
            return hairlut_fail(result, message, "%s: %.480s", parts[k].name, detail);
        if (!within(t->domain_min, t->domain_max, parts[k].low, parts[k].high))
            return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "%s: domain %.9g to %.9g: expected to lie within %.9g to %.9g",
                                parts[k].name, (double)t->domain_min, (double)t->domain_max, (double)parts[k].low,
                                (double)parts[k].high);
    }
    if (desc->azimuth != HAIRLUT_AZIMUTH_SUM && desc->azimuth != HAIRLUT_AZIMUTH_DIFFERENCE)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                            "azimuth is %d: expected HAIRLUT_AZIMUTH_SUM or HAIRLUT_AZIMUTH_DIFFERENCE", (int)desc->azimuth);
    return HAIRLUT_OK;
}

hairlut_result hairlut_model_create(const hairlut_model_desc *desc, const hairlut_allocator *allocator,
                                    hairlut_model **out, char *message)
{
    if (!out)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "out is NULL");
    *out = NULL;
    if (!desc)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "desc is NULL");
    hairlut_allocator a;
    hairlut_result result = hairlut_choose_allocator(allocator, &a, message);
    if (result == HAIRLUT_OK)
        result = validate_all(desc, message);
    if (result != HAIRLUT_OK)
        return result;
    const hairlut_table *tables[3] = {&desc->direct_theta, &desc->direct_phi, &desc->multiple_theta};
    size_t floats = 0;
    for (int k = 0; k < 3; ++k)
        floats += rows_floats(tables[k]) + cells_floats(tables[k]);
    /* one block: the struct, then the tables from the next cache line on */
    const size_t line = HAIRLUT_LINE * sizeof(float);
    void *memory;
    result = hairlut_allocate(&a, sizeof(hairlut_model) + line + floats * sizeof(float), &memory, message);
    if (result != HAIRLUT_OK)
        return result;
    hairlut_model *model = memory;
    float *next = (float *)(model + 1) + (line - (uintptr_t)(model + 1) % line) % line / sizeof(float);
    next = build_axis(&model->direct_theta, tables[0], next);
    next = build_axis(&model->direct_phi, tables[1], next);
    build_axis(&model->multiple_theta, tables[2], next);
    model->azimuth = desc->azimuth;
    model->allocator = a;
    *out = model;
    return HAIRLUT_OK;
}

void hairlut_free(hairlut_model *model)
{
    if (model && model->allocator.release) {
        const hairlut_allocator a = model->allocator;
        a.release(a.user, model);
    }
}

void hairlut_table_size(const hairlut_model *model, hairlut_part part, int *width, int *height)
{
    const hairlut_axis *axes[3] = {&model->direct_theta, &model->direct_phi, &model->multiple_theta};
    *width = axes[part]->columns;
    *height = axes[part]->height;
}
