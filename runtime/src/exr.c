/* SPDX-License-Identifier: BSD-3-Clause */
/* Models from a directory: mixture.exr and the tables that it names, or the three tables of format 1. */
#include "exr_mixture.h"

enum { MOST_TABLES = 2 * HAIRLUT_MAX_LOBES };

/* A directory as far as it is read. */
typedef struct model_files {
    const char *directory;
    const hairlut_allocator *allocator;
    char *message;
    char *path; /* of the file that is read; path_size bytes */
    size_t path_size;
    int format;
    hairlut_exr_mixture mixture; /* its lobes also in format 1, which has no mixture.exr */
    const hairlut_exr_reference *references[MOST_TABLES];
    hairlut_exr_table tables[MOST_TABLES];
    int count;
} model_files;

static const char *set_path(model_files *files, const char *table)
{
    snprintf(files->path, files->path_size, "%s/%s.exr", files->directory, table);
    return files->path;
}

/* What a mixture.exr would say of a directory without one. */
static void describe_format_1(hairlut_exr_mixture *mixture)
{
    static const hairlut_exr_lobe direct = {"direct", {"direct_theta", 0}, {"direct_phi", 0}};
    static const hairlut_exr_lobe multiple = {"multiple", {"multiple_theta", 0}, {"", 0}};
    mixture->lobe_count = 2;
    mixture->lobes[0] = direct;
    mixture->lobes[1] = multiple;
}

/* Table k, just read, must belong to the directory. */
static hairlut_result check_member(model_files *files, int k)
{
    const hairlut_exr_table *table = &files->tables[k];
    const char *model = files->format == 1 ? files->tables[0].model : files->mixture.model;
    hairlut_exr_file file;
    hairlut_exr_name(&file, files->path, files->message);
    if (strcmp(table->model, model) != 0)
        return hairlut_exr_fail(&file, HAIRLUT_ERROR_ATTRIBUTE,
                                "hairlut.model is '%s': expected '%s', as in the files beside it; bake the model again",
                                table->model, model);
    if (files->format > 1 && table->digest != files->references[k]->digest)
        return hairlut_exr_fail(
            &file, HAIRLUT_ERROR_ATTRIBUTE,
            "hairlut.digest is 'crc32 %08lx': expected 'crc32 %08lx', as in mixture.exr beside it: the files are of "
            "different bakes; bake the model again",
            (unsigned long)table->digest, (unsigned long)files->references[k]->digest);
    return HAIRLUT_OK;
}

/* Reads a table unless it was read for another lobe. */
static hairlut_result read_table(model_files *files, const hairlut_exr_reference *reference, int is_azimuth)
{
    static const char *const why[] = {"as there is no mixture.exr beside it", "as in mixture.exr beside it"};
    const hairlut_exr_kind kind = {reference->table, is_azimuth, files->format, why[files->format - 1],
                                   &files->mixture.parameters};
    for (int k = 0; k < files->count; ++k)
        if (strcmp(files->references[k]->table, reference->table) == 0)
            return HAIRLUT_OK;
    const int k = files->count++;
    files->references[k] = reference;
    const hairlut_result result = hairlut_exr_read_table(&kind, set_path(files, reference->table), NULL, files->allocator,
                                                         &files->tables[k], files->message);
    return result == HAIRLUT_OK ? check_member(files, k) : result;
}

static hairlut_result read_tables(model_files *files)
{
    hairlut_result result = HAIRLUT_OK;
    for (int k = 0; k < files->mixture.lobe_count && result == HAIRLUT_OK; ++k) {
        const hairlut_exr_lobe *lobe = &files->mixture.lobes[k];
        result = read_table(files, &lobe->theta, 0);
        if (result == HAIRLUT_OK && lobe->phi.table[0])
            result = read_table(files, &lobe->phi, 1);
    }
    return result;
}

static hairlut_result read_files(model_files *files)
{
    char no_mixture[HAIRLUT_MESSAGE_SIZE] = "";
    hairlut_result result =
        hairlut_exr_read_mixture(set_path(files, "mixture"), NULL, files->allocator, &files->mixture, no_mixture);
    files->format = files->mixture.missing ? 1 : 2;
    if (files->format == 1)
        describe_format_1(&files->mixture);
    if (result == HAIRLUT_OK || files->format == 1)
        result = read_tables(files);
    else
        return hairlut_fail(result, files->message, "%s", no_mixture);
    if (files->format == 1 && files->tables[0].missing) /* neither format: the newer one's file is what is missing */
        return hairlut_fail(result, files->message, "%s", no_mixture);
    return result;
}

static const hairlut_exr_table *find_table(const model_files *files, const hairlut_exr_reference *reference)
{
    for (int k = 0; k < files->count; ++k)
        if (strcmp(files->references[k]->table, reference->table) == 0)
            return &files->tables[k];
    return NULL;
}

static hairlut_result create(model_files *files, hairlut_model **out)
{
    hairlut_lobe_desc lobes[HAIRLUT_MAX_LOBES];
    for (int k = 0; k < files->mixture.lobe_count; ++k) {
        const hairlut_exr_lobe *lobe = &files->mixture.lobes[k];
        const hairlut_exr_table *theta = find_table(files, &lobe->theta), *phi = find_table(files, &lobe->phi);
        const hairlut_lobe_desc desc = {sizeof desc, lobe->name, &theta->table, phi ? &phi->table : NULL,
                                        phi ? phi->azimuth : HAIRLUT_AZIMUTH_DIFFERENCE};
        lobes[k] = desc;
    }
    const hairlut_model_desc desc = {sizeof desc,
                                     files->mixture.lobe_count,
                                     lobes,
                                     files->format == 1 ? NULL : &files->mixture.desc,
                                     files->mixture.parameters.count,
                                     files->mixture.parameters.list};
    char detail[HAIRLUT_MESSAGE_SIZE];
    const hairlut_result result = hairlut_model_create(&desc, files->allocator, out, detail);
    if (result == HAIRLUT_OK)
        return result;
    hairlut_exr_file file; /* the tables are valid: it is the mixture, or memory */
    hairlut_exr_name(&file, set_path(files, "mixture"), files->message);
    return hairlut_exr_fail(&file, result, "%.250s; bake the model again", detail);
}

static hairlut_result load(const char *directory, const hairlut_allocator *allocator, hairlut_model **out, char *message)
{
    model_files files;
    void *path;
    memset(&files, 0, sizeof files);
    files.directory = directory;
    files.allocator = allocator;
    files.message = message;
    files.path_size = strlen(directory) + HAIRLUT_EXR_TABLE_NAME_SIZE + sizeof "/.exr";
    hairlut_result result = hairlut_allocate(allocator, files.path_size, &path, message);
    if (result != HAIRLUT_OK)
        return result;
    files.path = path;
    result = read_files(&files);
    if (result == HAIRLUT_OK)
        result = create(&files, out);
    for (int k = 0; k < files.count; ++k)
        hairlut_release(allocator, files.tables[k].texels);
    hairlut_release(allocator, files.mixture.memory);
    hairlut_release(allocator, path);
    return result;
}

hairlut_result hairlut_load_with(const char *directory, const hairlut_allocator *allocator, hairlut_model **out,
                                 char *message)
{
    if (!out)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "out is NULL");
    *out = NULL;
    if (!directory)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "directory is NULL");
    hairlut_allocator a;
    const hairlut_result result = hairlut_choose_allocator(allocator, &a, message);
    return result == HAIRLUT_OK ? load(directory, &a, out, message) : result;
}

hairlut_result hairlut_load(const char *directory, hairlut_model **out)
{
    return hairlut_load_with(directory, NULL, out, NULL);
}
