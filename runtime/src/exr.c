/* Models from the three table files of a directory. */
#include <string.h>

#include "exr_table.h"

enum { TABLES = 3 };

static const hairlut_exr_kind kinds[TABLES] = {
    {"direct_theta", "theta_i", 0},
    {"direct_phi", "phi", 1},
    {"multiple_theta", "theta_i", 0},
};

static hairlut_result read_named(const char *directory, const hairlut_exr_kind *kind, const hairlut_allocator *allocator,
                                 hairlut_exr_table *out, char *message)
{
    const size_t size = strlen(directory) + strlen(kind->table) + sizeof "/.exr";
    void *path;
    hairlut_result result = hairlut_allocate(allocator, size, &path, message);
    if (!path)
        return result;
    snprintf(path, size, "%s/%s.exr", directory, kind->table);
    result = hairlut_exr_read_table(kind, path, NULL, allocator, out, message);
    hairlut_release(allocator, path);
    return result;
}

static hairlut_result create(const char *directory, const hairlut_exr_table tables[TABLES], const hairlut_allocator *allocator,
                             hairlut_model **out, char *message)
{
    for (int k = 1; k < TABLES; ++k)
        if (strcmp(tables[k].model, tables[0].model) != 0)
            return hairlut_fail(HAIRLUT_ERROR_ATTRIBUTE, message,
                                "%.200s/%s.exr: hairlut.model is '%s': expected '%s', as in %s.exr beside it; bake the model again",
                                directory, kinds[k].table, tables[k].model, tables[0].model, kinds[0].table);
    const hairlut_lobe_desc lobes[2] = {
        {sizeof *lobes, "direct", &tables[0].table, &tables[1].table, tables[1].azimuth},
        {sizeof *lobes, "multiple", &tables[2].table, NULL, HAIRLUT_AZIMUTH_DIFFERENCE},
    };
    const hairlut_model_desc desc = {sizeof desc, 2, lobes, NULL};
    char detail[HAIRLUT_MESSAGE_SIZE];
    const hairlut_result result = hairlut_model_create(&desc, allocator, out, detail);
    if (result != HAIRLUT_OK)
        return hairlut_fail(result, message, "%.200s/%.290s", directory, detail);
    return result;
}

hairlut_result hairlut_load_with(const char *directory, const hairlut_allocator *allocator, hairlut_model **out, char *message)
{
    if (!out)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "out is NULL");
    *out = NULL;
    if (!directory)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "directory is NULL");
    hairlut_allocator a;
    hairlut_result result = hairlut_choose_allocator(allocator, &a, message);
    if (result != HAIRLUT_OK)
        return result;
    hairlut_exr_table tables[TABLES];
    memset(tables, 0, sizeof tables);
    for (int k = 0; k < TABLES && result == HAIRLUT_OK; ++k)
        result = read_named(directory, &kinds[k], &a, &tables[k], message);
    if (result == HAIRLUT_OK)
        result = create(directory, tables, &a, out, message);
    for (int k = 0; k < TABLES; ++k)
        hairlut_release(&a, tables[k].texels);
    return result;
}

hairlut_result hairlut_load(const char *directory, hairlut_model **out)
{
    return hairlut_load_with(directory, NULL, out, NULL);
}
