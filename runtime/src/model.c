/* Models from tables in memory: what a table must fulfil, and the padded copy that the kernels read. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "allocator.h"
#include "internal.h"
#include "message.h"
#include "warp.h"

enum { MAX_SIDE = 4096 }; /* 64 MiB a table: a wrong size is refused before it is allocated */

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
    if (t->warp != HAIRLUT_WARP_UNIFORM && t->warp != HAIRLUT_WARP_QUARTIC)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "warp is %d: expected HAIRLUT_WARP_UNIFORM or HAIRLUT_WARP_QUARTIC",
                    (int)t->warp);
    if (t->warp == HAIRLUT_WARP_QUARTIC && !(t->warp_e >= 1e-12f && t->warp_e <= 1.0f))
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

/* A row as internal.h lays it out. The texels beyond both ends are such that a blended end cell takes the curvature
 * d - d_neighbour. */
static void store_row(float *stored, const float *row, int width)
{
    for (int k = 0; k < HAIRLUT_PIVOTS; ++k) {
        const int i = (k + 1) * HAIRLUT_STEP(width);
        stored[k] = i <= width - 2 ? row[i] : HAIRLUT_NO_TEXEL;
    }
    float *padded = stored + HAIRLUT_PIVOTS;
    memcpy(padded + 1, row, (size_t)width * sizeof *row);
    const double first = row[0], second = row[1], third = row[2];
    const double last = row[width - 1], last1 = row[width - 2], last2 = row[width - 3];
    padded[0] = (float)(first - 4.0 * (second - first) + 3.0 * (third - second));
    padded[width + 1] = (float)(last + 4.0 * (last - last1) - 3.0 * (last1 - last2));
    for (int k = HAIRLUT_PIVOTS + width + 2; k < HAIRLUT_STRIDE(width); ++k)
        stored[k] = 0.0f;
}

static size_t stored_floats(const hairlut_table *t)
{
    return (size_t)HAIRLUT_STORED(t->width, t->height);
}

/* Fills an axis whose rows go to `rows`; returns the end of what it filled. */
static float *build_axis(hairlut_axis *axis, const hairlut_table *t, float *rows)
{
    const hairlut_warp_scale scale = hairlut_scale_warp(t->warp, t->warp_e, t->width);
    const float row_scale = (float)((t->height - 1) / ((double)t->theta_r_max - (double)t->theta_r_min));
    const hairlut_axis filled =
        HAIRLUT_AXIS(rows, t->width, t->height, t->theta_r_min, row_scale, t->domain_min, t->domain_max, (int)t->warp,
                     (float)scale.e, sqrtf(sqrtf((float)scale.e)), (float)scale.k, t->cell_limit);
    *axis = filled;
    for (int j = 0; j < t->height; ++j)
        store_row(rows + (size_t)j * (size_t)axis->stride, t->texels + (size_t)j * (size_t)t->width, t->width);
    for (size_t k = stored_floats(t) - HAIRLUT_LINE; k < stored_floats(t); ++k)
        rows[k] = 0.0f;
    return rows + stored_floats(t);
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
    const size_t floats = stored_floats(&desc->direct_theta) + stored_floats(&desc->direct_phi)
                          + stored_floats(&desc->multiple_theta);
    /* one block: the struct, then the rows from the next cache line on */
    const size_t line = HAIRLUT_LINE * sizeof(float);
    void *memory;
    result = hairlut_allocate(&a, sizeof(hairlut_model) + line + floats * sizeof(float), &memory, message);
    if (result != HAIRLUT_OK)
        return result;
    hairlut_model *model = memory;
    float *rows = (float *)(model + 1) + (line - (uintptr_t)(model + 1) % line) % line / sizeof(float);
    rows = build_axis(&model->direct_theta, &desc->direct_theta, rows);
    rows = build_axis(&model->direct_phi, &desc->direct_phi, rows);
    build_axis(&model->multiple_theta, &desc->multiple_theta, rows);
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
