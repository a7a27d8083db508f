/* SPDX-License-Identifier: BSD-3-Clause */
/* Models from descriptors in memory, and what they say about themselves. */
#include <stdint.h>
#include <string.h>

#include "allocator.h"
#include "angle.h"
#include "build.h"

enum { MOST_TABLES = 2 * HAIRLUT_MAX_LOBES };

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
        return "the texels are not a table of increasing angles within the domain, or the numbers are not a mixture";
    case HAIRLUT_ERROR_UNSUPPORTED:
        return "the file needs a feature that the OpenEXR library in use lacks";
    }
    return "unknown result";
}

/* Descriptor k; their stride is what the first one states. */
static const hairlut_lobe_desc *lobe_at(const hairlut_model_desc *desc, int k)
{
    return (const hairlut_lobe_desc *)((const char *)desc->lobes + (size_t)k * desc->lobes->size);
}

static int is_name(const char *name)
{
    size_t length = 0;
    for (; name[length] && length < HAIRLUT_NAME_SIZE; ++length) {
        const char c = name[length];
        const int letter = c >= 'a' && c <= 'z';
        if (!letter && (length == 0 || !((c >= '0' && c <= '9') || c == '_')))
            return 0;
    }
    return length > 0 && length < HAIRLUT_NAME_SIZE;
}

static hairlut_result validate_table(const hairlut_lobe_desc *lobe, const char *angle, const hairlut_table *t, float low,
                                     float high, char *message)
{
    char detail[HAIRLUT_MESSAGE_SIZE];
    const hairlut_result result = hairlut_validate(t, detail);
    if (result != HAIRLUT_OK)
        return hairlut_fail(result, message, "%s_%s: %.460s", lobe->name, angle, detail);
    if (!hairlut_within(t->domain_min, t->domain_max, low, high))
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                            "%s_%s: domain %.9g to %.9g: expected to lie within %.9g to %.9g", lobe->name, angle,
                            (double)t->domain_min, (double)t->domain_max, (double)low, (double)high);
    return HAIRLUT_OK;
}

static hairlut_result validate_lobe(const hairlut_model_desc *desc, int k, char *message)
{
    const hairlut_lobe_desc *lobe = lobe_at(desc, k);
    hairlut_result result = hairlut_check_size("hairlut_lobe_desc", lobe->size, desc->lobes->size, message);
    if (result != HAIRLUT_OK)
        return result;
    if (!lobe->name || !is_name(lobe->name))
        return hairlut_fail(
            HAIRLUT_ERROR_ARGUMENT, message, "lobe %d: name is %s%.40s%s: expected [a-z][a-z0-9_]*, at most %d characters",
            k, lobe->name ? "'" : "", lobe->name ? lobe->name : "NULL", lobe->name ? "'" : "", HAIRLUT_NAME_SIZE - 1);
    for (int l = 0; l < k; ++l)
        if (strcmp(lobe_at(desc, l)->name, lobe->name) == 0)
            return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                                "lobes %d and %d are both named '%s': expected names that differ", l, k, lobe->name);
    result = validate_table(lobe, "theta", lobe->theta, -hairlut_half_pi_high, hairlut_half_pi_high, message);
    if (result == HAIRLUT_OK && lobe->phi)
        result = validate_table(lobe, "phi", lobe->phi, 0.0f, hairlut_two_pi, message);
    if (result == HAIRLUT_OK && lobe->phi && lobe->azimuth != HAIRLUT_AZIMUTH_SUM &&
        lobe->azimuth != HAIRLUT_AZIMUTH_DIFFERENCE)
        result = hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                              "lobe %d: azimuth is %d: expected HAIRLUT_AZIMUTH_SUM or HAIRLUT_AZIMUTH_DIFFERENCE", k,
                              (int)lobe->azimuth);
    return result;
}

static hairlut_result validate_model(const hairlut_model_desc *desc, char *message)
{
    if (!desc)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "desc is NULL");
    hairlut_result result = hairlut_check_size("hairlut_model_desc", desc->size, sizeof *desc, message);
    if (result != HAIRLUT_OK)
        return result;
    if (desc->lobe_count < 1 || desc->lobe_count > HAIRLUT_MAX_LOBES)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "lobe_count is %d: expected 1 to %d", desc->lobe_count,
                            HAIRLUT_MAX_LOBES);
    if (!desc->lobes)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "lobes is NULL: expected %d descriptors", desc->lobe_count);
    result = hairlut_check_size("hairlut_lobe_desc", desc->lobes->size, sizeof *desc->lobes, message);
    for (int k = 0; k < desc->lobe_count && result == HAIRLUT_OK; ++k)
        result = validate_lobe(desc, k, message);
    return result == HAIRLUT_OK ? hairlut_validate_mixture(desc->mixture, desc->lobe_count, message) : result;
}

/* The tables of a model, each once, and the axis that was built from it. */
typedef struct table_list {
    const hairlut_table *tables[MOST_TABLES];
    hairlut_axis axes[MOST_TABLES];
    int count;
} table_list;

static int index_of(table_list *list, const hairlut_table *table)
{
    int k = 0;
    while (k < list->count && list->tables[k] != table)
        ++k;
    if (k == list->count)
        list->tables[list->count++] = table;
    return k;
}

static void list_tables(table_list *list, const hairlut_model_desc *desc)
{
    list->count = 0;
    for (int k = 0; k < desc->lobe_count; ++k) {
        index_of(list, lobe_at(desc, k)->theta);
        if (lobe_at(desc, k)->phi)
            index_of(list, lobe_at(desc, k)->phi);
    }
}

/* Numbers the axes by their rows. */
static void number_grids(table_list *list)
{
    for (int k = 0; k < list->count; ++k) {
        int first = 0;
        while (list->axes[first].row_origin != list->axes[k].row_origin ||
               list->axes[first].row_scale != list->axes[k].row_scale || list->axes[first].height != list->axes[k].height)
            ++first;
        list->axes[k].grid = first;
    }
}

static void build_lobe(hairlut_lobe *lobe, const hairlut_lobe_desc *desc, table_list *list)
{
    memset(lobe, 0, sizeof *lobe);
    lobe->theta = list->axes[index_of(list, desc->theta)];
    lobe->uniform = !desc->phi;
    if (desc->phi) {
        lobe->phi = list->axes[index_of(list, desc->phi)];
        lobe->azimuth = (int)desc->azimuth;
    }
    memcpy(lobe->name, desc->name, strlen(desc->name));
}

static const size_t line = HAIRLUT_LINE * sizeof(float);

/* One block: the struct, its lobes, the mixture, then the tables from the next cache line on. */
static size_t bytes_of(const hairlut_model_desc *desc, const table_list *list)
{
    size_t floats = hairlut_mixture_floats(desc->mixture, desc->lobe_count);
    for (int k = 0; k < list->count; ++k)
        floats += hairlut_table_floats(list->tables[k]);
    return sizeof(hairlut_model) + (size_t)desc->lobe_count * sizeof(hairlut_lobe) + line + floats * sizeof(float);
}

static void build_model(hairlut_model *model, const hairlut_model_desc *desc, table_list *list)
{
    hairlut_lobe *lobes = (hairlut_lobe *)(model + 1);
    float *mixture = (float *)(lobes + desc->lobe_count);
    float *next = mixture + hairlut_mixture_floats(desc->mixture, desc->lobe_count);
    next += (line - (uintptr_t)next % line) % line / sizeof(float);
    for (int k = 0; k < list->count; ++k)
        next = hairlut_build_axis(&list->axes[k], list->tables[k], next);
    number_grids(list);
    for (int k = 0; k < desc->lobe_count; ++k)
        build_lobe(&lobes[k], lobe_at(desc, k), list);
    hairlut_build_mixture(&model->mixture, desc->mixture, desc->lobe_count, mixture);
    model->lobe_count = desc->lobe_count;
    model->lobes = lobes;
    model->direct = hairlut_lobe_index(model, "direct");
    model->multiple = hairlut_lobe_index(model, "multiple");
}

hairlut_result hairlut_model_create(const hairlut_model_desc *desc, const hairlut_allocator *allocator, hairlut_model **out,
                                    char *message)
{
    if (!out)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "out is NULL");
    *out = NULL;
    hairlut_allocator a;
    hairlut_result result = validate_model(desc, message);
    if (result == HAIRLUT_OK)
        result = hairlut_choose_allocator(allocator, &a, message);
    if (result != HAIRLUT_OK)
        return result;
    table_list list;
    void *memory;
    list_tables(&list, desc);
    result = hairlut_allocate(&a, bytes_of(desc, &list), &memory, message);
    if (result != HAIRLUT_OK)
        return result;
    *out = memory;
    build_model(*out, desc, &list);
    (*out)->allocator = a;
    return HAIRLUT_OK;
}

void hairlut_free(hairlut_model *model)
{
    if (model && model->allocator.release) {
        const hairlut_allocator a = model->allocator;
        a.release(a.user, model);
    }
}

int hairlut_lobe_count(const hairlut_model *model)
{
    return model->lobe_count;
}

const char *hairlut_lobe_name(const hairlut_model *model, int lobe)
{
    return lobe >= 0 && lobe < model->lobe_count ? model->lobes[lobe].name : NULL;
}

int hairlut_lobe_index(const hairlut_model *model, const char *name)
{
    for (int k = 0; name && k < model->lobe_count; ++k)
        if (strcmp(model->lobes[k].name, name) == 0)
            return k;
    return -1;
}

void hairlut_table_size(const hairlut_model *model, int lobe, hairlut_angle angle, int *width, int *height)
{
    *width = *height = 0;
    if (lobe < 0 || lobe >= model->lobe_count || (angle == HAIRLUT_PHI && model->lobes[lobe].uniform))
        return;
    const hairlut_axis *axis = angle == HAIRLUT_PHI ? &model->lobes[lobe].phi : &model->lobes[lobe].theta;
    *width = axis->columns;
    *height = axis->height;
}
