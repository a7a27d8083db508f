/* SPDX-License-Identifier: BSD-3-Clause */
/* Models from descriptors in memory, and what they say about themselves. */
#include <stdint.h>
#include <string.h>

#include "allocator.h"
#include "angle.h"
#include "build.h"
#include "mixture.h"

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

int hairlut_is_name(const char *name)
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

static hairlut_result validate_table(const hairlut_model_desc *desc, const hairlut_lobe_desc *lobe, const char *angle,
                                     const hairlut_table *t, float low, float high, char *message)
{
    char detail[HAIRLUT_MESSAGE_SIZE], owner[HAIRLUT_NAME_SIZE + 8];
    const hairlut_result result = hairlut_validate(t, detail);
    if (result != HAIRLUT_OK)
        return hairlut_fail(result, message, "%s_%s: %.460s", lobe->name, angle, detail);
    if (!hairlut_within(t->domain_min, t->domain_max, low, high))
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                            "%s_%s: domain %.9g to %.9g: expected to lie within %.9g to %.9g", lobe->name, angle,
                            (double)t->domain_min, (double)t->domain_max, (double)low, (double)high);
    const hairlut_table known = hairlut_known_table(t);
    snprintf(owner, sizeof owner, "%s_%s", lobe->name, angle);
    return hairlut_match_axes(owner, known.axes, known.axis_count, desc, message);
}

static hairlut_result validate_lobe(const hairlut_model_desc *desc, int k, char *message)
{
    const hairlut_lobe_desc *lobe = lobe_at(desc, k);
    hairlut_result result = hairlut_check_size("hairlut_lobe_desc", lobe->size, desc->lobes->size, 0, message);
    if (result != HAIRLUT_OK)
        return result;
    if (!lobe->name || !hairlut_is_name(lobe->name))
        return hairlut_fail(
            HAIRLUT_ERROR_ARGUMENT, message, "lobe %d: name is %s%.40s%s: expected [a-z][a-z0-9_]*, at most %d characters",
            k, lobe->name ? "'" : "", lobe->name ? lobe->name : "NULL", lobe->name ? "'" : "", HAIRLUT_NAME_SIZE - 1);
    for (int l = 0; l < k; ++l)
        if (strcmp(lobe_at(desc, l)->name, lobe->name) == 0)
            return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                                "lobes %d and %d are both named '%s': expected names that differ", l, k, lobe->name);
    result = validate_table(desc, lobe, "theta", lobe->theta, -hairlut_half_pi_high, hairlut_half_pi_high, message);
    if (result == HAIRLUT_OK && lobe->phi)
        result = validate_table(desc, lobe, "phi", lobe->phi, 0.0f, hairlut_two_pi, message);
    if (result == HAIRLUT_OK && lobe->phi && lobe->azimuth != HAIRLUT_AZIMUTH_SUM &&
        lobe->azimuth != HAIRLUT_AZIMUTH_DIFFERENCE)
        result = hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                              "lobe %d: azimuth is %d: expected HAIRLUT_AZIMUTH_SUM or HAIRLUT_AZIMUTH_DIFFERENCE", k,
                              (int)lobe->azimuth);
    return result;
}

static hairlut_result validate_sizes(const hairlut_model_desc *desc, char *message)
{
    if (!desc)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "desc is NULL");
    const hairlut_result result =
        hairlut_check_size("hairlut_model_desc", desc->size, sizeof *desc, sizeof(hairlut_model_desc_2_0), message);
    if (result != HAIRLUT_OK || !desc->mixture)
        return result;
    return hairlut_check_size("hairlut_mixture_desc", desc->mixture->size, sizeof *desc->mixture,
                              sizeof(hairlut_mixture_desc_2_0), message);
}

static hairlut_result validate_lobes(const hairlut_model_desc *desc, char *message)
{
    if (desc->lobe_count < 1 || desc->lobe_count > HAIRLUT_MAX_LOBES)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "lobe_count is %d: expected 1 to %d", desc->lobe_count,
                            HAIRLUT_MAX_LOBES);
    if (!desc->lobes)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "lobes is NULL: expected %d descriptors", desc->lobe_count);
    hairlut_result result = hairlut_check_size("hairlut_lobe_desc", desc->lobes->size, sizeof *desc->lobes, 0, message);
    for (int k = 0; k < desc->lobe_count && result == HAIRLUT_OK; ++k)
        result = validate_lobe(desc, k, message);
    return result;
}

/* The descriptors of lobes and mixture are known ones. */
static hairlut_result validate_model(const hairlut_model_desc *desc, char *message)
{
    hairlut_result result = hairlut_validate_parameters(desc, message);
    if (result == HAIRLUT_OK)
        result = validate_lobes(desc, message);
    if (result == HAIRLUT_OK)
        result = hairlut_validate_mixture(desc->mixture, desc->lobe_count, message);
    return result == HAIRLUT_OK
               ? hairlut_match_axes("mixture", desc->mixture->axes, desc->mixture->axis_count, desc, message)
               : result;
}

/* The tables of a model, each once, the axis that was built from it, and its nodes. */
typedef struct table_list {
    const hairlut_table *given[HAIRLUT_MOST_TABLES];
    hairlut_table tables[HAIRLUT_MOST_TABLES];
    hairlut_axis axes[HAIRLUT_MOST_TABLES];
    hairlut_spacing nodes[HAIRLUT_MOST_TABLES];
    int count;
} table_list;

static int index_of(table_list *list, const hairlut_table *table)
{
    int k = 0;
    while (k < list->count && list->given[k] != table)
        ++k;
    if (k == list->count) {
        list->tables[k] = hairlut_known_table(table);
        list->given[k] = table;
        list->count = k + 1;
    }
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

static int same_rows(const hairlut_axis *a, const hairlut_axis *b)
{
    return a->row_origin == b->row_origin && a->row_scale == b->row_scale && a->height == b->height;
}

/* Numbers the axes by their rows. */
static void number_grids(table_list *list)
{
    int grids = 0;
    for (int k = 0; k < list->count; ++k) {
        int first = 0;
        while (!same_rows(&list->axes[first], &list->axes[k]))
            ++first;
        list->axes[k].grid = first < k ? list->axes[first].grid : grids++;
    }
}

static void build_lobe(hairlut_lobe *lobe, const hairlut_lobe_desc *desc, table_list *list)
{
    memset(lobe, 0, sizeof *lobe);
    lobe->theta = list->axes[index_of(list, desc->theta)];
    lobe->uniform = !desc->phi;
    if (desc->phi) {
        lobe->phi = list->axes[index_of(list, desc->phi)];
        lobe->sign = desc->azimuth == HAIRLUT_AZIMUTH_SUM ? 1.0f : -1.0f;
    }
    memcpy(lobe->name, desc->name, strlen(desc->name));
}

/* An axis of each grid. */
static void list_grid(hairlut_model *model, const hairlut_axis *axis)
{
    model->grids[axis->grid] = axis;
    if (axis->grid >= model->grid_count)
        model->grid_count = axis->grid + 1;
}

static void list_grids(hairlut_model *model, const hairlut_lobe *lobes, int lobe_count)
{
    model->grid_count = 0;
    for (int k = 0; k < lobe_count; ++k) {
        list_grid(model, &lobes[k].theta);
        if (!lobes[k].uniform)
            list_grid(model, &lobes[k].phi);
    }
}

static const size_t line = HAIRLUT_LINE * sizeof(float);

/* The next place that begins a cache line. */
static float *on_a_line(float *memory)
{
    return memory + (line - (uintptr_t)memory % line) % line / sizeof(float);
}

/* Tables of a table with axes: one for each node, and that of the standard values before them. */
static size_t tables_of(const hairlut_table *table)
{
    return table->axis_count > 0 ? hairlut_node_count(table->axes, table->axis_count) + 1 : 1;
}

/* One block: the struct, its strands, its lobes, the nodes of parameters, then from cache lines on the mixture and the tables. In
 * double, as a size_t of 32 bits may not have room for the nodes of many tables. */
static double bytes_of(const hairlut_model_desc *desc, const table_list *list)
{
    double floats = (double)hairlut_mixture_floats(desc->mixture, desc->lobe_count);
    if (desc->parameter_count > 0)
        floats += (double)sizeof(hairlut_strands) / sizeof(float) + (double)hairlut_strands_floats(desc);
    for (int k = 0; k < list->count; ++k)
        floats += (double)hairlut_table_floats(&list->tables[k]) * (double)tables_of(&list->tables[k]);
    return (double)(sizeof(hairlut_model) + (size_t)desc->lobe_count * sizeof(hairlut_lobe) + 2 * line) +
           floats * sizeof(float);
}

/* The axis of a table; with axes over parameters, those of its nodes, and their blend. Returns the end of what was filled. */
static float *build_table(table_list *list, int k, const hairlut_strands *strands, float *memory)
{
    const hairlut_table *table = &list->tables[k];
    const size_t floats = hairlut_table_floats(table), count = tables_of(table);
    const size_t texels = 2 * (size_t)table->width * (size_t)table->height;
    hairlut_table node = *table;
    int alike = 1;
    for (size_t p = 0; p + 1 < count; ++p) {
        node.texels = table->texels + p * texels;
        hairlut_build_axis(&list->axes[k], &node, memory + (p + 1) * floats);
        alike &= list->axes[k].alike;
    }
    hairlut_build_axis(&list->axes[k], table, memory);
    list->axes[k].alike &= alike;
    if (count > 1) {
        const hairlut_corners corners = hairlut_standard_corners(strands, list->nodes[k].grid);
        hairlut_blend_axis(&list->axes[k], memory, &list->nodes[k], &corners);
    }
    return memory + count * floats;
}

/* Parameters and grids of nodes. Returns the end of what was filled. */
static float *build_strands(hairlut_strands *strands, const hairlut_model_desc *desc, table_list *list, float *memory)
{
    float *next = hairlut_build_parameters(strands, desc, memory);
    for (int k = 0; k < list->count; ++k) {
        const hairlut_table *table = &list->tables[k];
        const int grid = hairlut_add_grid(strands, table->axes, table->axis_count, &next);
        strands->pairs &= table->axis_count <= 1;
        list->nodes[k] = hairlut_space(strands, grid, table->axis_count > 0 ? (ptrdiff_t)hairlut_table_floats(table) : 0);
    }
    const int grid = hairlut_add_grid(strands, desc->mixture->axes, desc->mixture->axis_count, &next);
    for (int k = 0; k < desc->lobe_count; ++k) {
        const hairlut_lobe_desc *lobe = lobe_at(desc, k);
        strands->theta[k].nodes = list->nodes[index_of(list, lobe->theta)];
        strands->phi[k].nodes = list->nodes[index_of(list, lobe->phi ? lobe->phi : lobe->theta)];
    }
    strands->mixture = hairlut_space(strands, grid, hairlut_mixture_pitch(desc->mixture, desc->lobe_count));
    return memory + hairlut_strands_floats(desc);
}

static void build_model(hairlut_model *model, const hairlut_model_desc *desc, table_list *list)
{
    hairlut_strands *strands = desc->parameter_count > 0 ? (hairlut_strands *)(model + 1) : NULL;
    hairlut_lobe *lobes = strands ? (hairlut_lobe *)(strands + 1) : (hairlut_lobe *)(model + 1);
    float *next = (float *)(lobes + desc->lobe_count), *mixture;
    hairlut_corners corners = hairlut_only_corner();
    hairlut_spacing nodes = {0, 1, 1, {0}};
    if (strands) {
        next = build_strands(strands, desc, list, next);
        nodes = hairlut_space(strands, strands->mixture.grid, 1);
        corners = hairlut_standard_corners(strands, nodes.grid);
    }
    mixture = on_a_line(next);
    next = on_a_line(mixture + hairlut_mixture_floats(desc->mixture, desc->lobe_count));
    for (int k = 0; k < list->count; ++k)
        next = build_table(list, k, strands, next);
    number_grids(list);
    for (int k = 0; k < desc->lobe_count; ++k)
        build_lobe(&lobes[k], lobe_at(desc, k), list);
    list_grids(model, lobes, desc->lobe_count);
    if (strands)
        hairlut_build_strand_tables(strands, lobes, desc->lobe_count);
    hairlut_build_mixture(&model->mixture, desc->mixture, desc->lobe_count, &nodes, &corners, mixture);
    model->strands = strands;
    model->lobe_count = desc->lobe_count;
    memset(&model->mixture.mix, 0, sizeof model->mixture.mix);
    if (model->mixture.constant)
        hairlut_mixture_standard(model, NULL, 0.0f, 0.0f, &model->mixture.mix);
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
    hairlut_result result = validate_sizes(desc, message);
    if (result != HAIRLUT_OK)
        return result;
    hairlut_model_desc known = hairlut_known_model(desc);
    const hairlut_mixture_desc mixture = hairlut_known_mixture(desc->mixture);
    known.mixture = &mixture;
    result = validate_model(&known, message);
    if (result == HAIRLUT_OK)
        result = hairlut_choose_allocator(allocator, &a, message);
    if (result != HAIRLUT_OK)
        return result;
    table_list list;
    void *memory;
    list_tables(&list, &known);
    const double bytes = bytes_of(&known, &list);
    if (bytes > (double)(SIZE_MAX / 4))
        return hairlut_fail(HAIRLUT_ERROR_MEMORY, message, "the model takes %.0f bytes: more than this system addresses",
                            bytes);
    result = hairlut_allocate(&a, (size_t)bytes, &memory, message);
    if (result != HAIRLUT_OK)
        return result;
    *out = memory;
    build_model(*out, &known, &list);
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
