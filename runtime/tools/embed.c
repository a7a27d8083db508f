/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes models as C source, laid out ready to be read: embed DIRECTORY... > src/builtin_tables.c. Each model has its directory's
 * name. Arrays that are equal, in one model or in several, are written once. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "internal.h"

enum { MOST_ARRAYS = 8 * HAIRLUT_MAX_LOBES * 4 };

typedef struct written {
    const void *data;
    size_t bytes;
} written;

static written arrays[MOST_ARRAYS];
static int array_count;

/* A float that C reads back as it is. */
static void print_float(float x)
{
    char text[32];
    snprintf(text, sizeof text, "%.9g", (double)x);
    printf("%s%sf", text, strpbrk(text, ".e") ? "" : ".0");
}

/* The number of the array that equals this one, or -1 once this one is noted as the next. */
static int known_number(const void *data, size_t bytes)
{
    for (int k = 0; k < array_count; ++k)
        if (arrays[k].bytes == bytes && memcmp(arrays[k].data, data, bytes) == 0)
            return k;
    if (array_count == MOST_ARRAYS) {
        fprintf(stderr, "embed: more than %d arrays\n", (int)MOST_ARRAYS);
        exit(1);
    }
    arrays[array_count].data = data;
    arrays[array_count].bytes = bytes;
    return -1;
}

/* The number of an array of `count` floats, written if no equal one was. */
static int array_number(const float *data, size_t count, size_t line)
{
    const int known = known_number(data, count * sizeof *data);
    if (known >= 0)
        return known;
    printf("static const float HAIRLUT_LINE_ALIGNED array_%d[%zu] = {\n", array_count, count);
    for (size_t k = 0; k < count; ++k) {
        print_float(data[k]);
        fputs(k + 1 == count ? "};\n" : (k + 1) % line == 0 ? ",\n" : ",", stdout);
    }
    return array_count++;
}

static int links_of(const hairlut_axis *axis)
{
    const int count = axis->columns - 1, known = known_number(axis->links, (size_t)count * sizeof *axis->links);
    if (known >= 0)
        return known;
    printf("static const hairlut_link array_%d[%d] = {\n", array_count, count);
    for (int k = 0; k < count; ++k) {
        printf("{%d,", axis->links[k].offset);
        print_float(axis->links[k].h);
        fputs(k + 1 == count ? "}};\n" : (k + 1) % 6 == 0 ? "},\n" : "},", stdout);
    }
    return array_count++;
}

static int rows_of(const hairlut_axis *axis)
{
    return array_number(axis->rows, (size_t)HAIRLUT_STORED(axis->columns, axis->height), HAIRLUT_LINE);
}

static int cells_of(const hairlut_axis *axis)
{
    return array_number(axis->ends[0], (size_t)HAIRLUT_CELLS(axis->columns, axis->height), 3 * HAIRLUT_CELL);
}

static int knots_of(const hairlut_axis *axis)
{
    return array_number(axis->knots, (size_t)(HAIRLUT_KNOT * HAIRLUT_HALF(axis->columns)), 3 * HAIRLUT_KNOT);
}

static void print_number(const char *field, float x)
{
    printf(".%s = ", field);
    print_float(x);
    fputs(", ", stdout);
}

static void print_axis(const char *field, const hairlut_axis *axis)
{
    printf("     .%s = {.rows = array_%d, .ends = {array_%d, array_%d + %td}, .knots = array_%d, .links = array_%d,\n      ",
           field, rows_of(axis), cells_of(axis), cells_of(axis), axis->ends[1] - axis->ends[0], knots_of(axis),
           links_of(axis));
    print_number("row_origin", axis->row_origin);
    print_number("row_scale", axis->row_scale);
    print_number("row_last", axis->row_last);
    print_number("e", axis->e);
    print_number("scale", axis->scale);
    print_number("origin", axis->origin);
    print_number("low", axis->low);
    print_number("high", axis->high);
    printf("\n      .pitch = %d, .warp = %d, .columns = %d, .height = %d, .stride = %d, .step = %d, .groups = %d, .grid = "
           "%d},\n",
           axis->pitch, axis->warp, axis->columns, axis->height, axis->stride, axis->step, axis->groups, axis->grid);
}

/* The arrays of an axis come before the struct that names them. */
static void print_arrays(const hairlut_axis *axis)
{
    rows_of(axis);
    cells_of(axis);
    knots_of(axis);
    links_of(axis);
}

static void print_lobes(const char *name, const hairlut_model *model)
{
    for (int k = 0; k < model->lobe_count; ++k) {
        print_arrays(&model->lobes[k].theta);
        if (!model->lobes[k].uniform)
            print_arrays(&model->lobes[k].phi);
    }
    printf("static const hairlut_lobe lobes_%s[%d] = {\n", name, model->lobe_count);
    for (int k = 0; k < model->lobe_count; ++k) {
        const hairlut_lobe *lobe = &model->lobes[k];
        printf("    {.name = \"%s\", .uniform = %d, .sign = %.1ff,\n", lobe->name, lobe->uniform, (double)lobe->sign);
        print_axis("theta", &lobe->theta);
        if (!lobe->uniform)
            print_axis("phi", &lobe->phi);
        puts("    },");
    }
    puts("};");
}

static size_t four_count(const hairlut_model *model)
{
    const hairlut_mixture *m = &model->mixture;
    return (size_t)m->four_count * (size_t)m->theta_r.count * (size_t)m->arc.count;
}

static int fours_of(const hairlut_model *model)
{
    const hairlut_four *four = model->mixture.fours;
    const size_t count = four_count(model);
    const int known = known_number(four, count * sizeof *four);
    if (known >= 0)
        return known;
    printf("static const hairlut_four HAIRLUT_LINE_ALIGNED array_%d[%zu] = {\n", array_count, count);
    for (size_t k = 0; k < count; ++k) {
        fputs("{{", stdout);
        for (int l = 0; l < 4; ++l) {
            print_float(four[k].share[l]);
            fputs(l < 3 ? "," : "},{", stdout);
        }
        for (int l = 0; l < 4; ++l)
            printf(l < 3 ? "%" PRId32 "," : "%" PRId32, four[k].turn[l]);
        fputs(k + 1 == count ? "}}};\n" : "}},\n", stdout);
    }
    return array_count++;
}

static int nodes_of(const hairlut_nodes *nodes)
{
    return array_number(nodes->inner, (size_t)(8 * nodes->eights + 2 * nodes->count), HAIRLUT_LINE);
}

static void print_floats(const char *field, const float *x, int count)
{
    printf(".%s = {", field);
    for (int k = 0; k < count; ++k) {
        print_float(x[k]);
        fputs(k + 1 == count ? "}, " : ", ", stdout);
    }
}

/* What a constant mixture is everywhere; any other has none. */
static void print_mix(const hairlut_mix *mix, int lobe_count)
{
    printf("\n      .mix = {");
    print_floats("share", mix->share, lobe_count);
    print_floats("weight", mix->weight, lobe_count);
    print_floats("turn", mix->turn, lobe_count);
    print_number("sum", mix->sum);
    print_number("side", mix->side);
    printf(".lobes = {");
    for (int k = 0; k < lobe_count; ++k)
        printf("%d%s", mix->lobes[k], k + 1 == lobe_count ? "}, " : ", ");
    printf(".count = %d}", mix->count);
}

static void print_nodes(const char *field, const hairlut_nodes *nodes)
{
    const int number = nodes_of(nodes);
    printf(".%s = {.inner = array_%d, .pairs = array_%d + %d, .count = %d, .eights = %d, ", field, number, number,
           8 * nodes->eights, nodes->count, nodes->eights);
    print_number("last", nodes->last);
    fputs("}, ", stdout);
}

/* An axis of each grid of rows, as of lobes_NAME. */
static void print_grids(const char *name, const hairlut_model *model)
{
    printf("      .grid_count = %d, .grids = {", model->grid_count);
    for (int g = 0; g < model->grid_count; ++g) {
        int k = 0;
        while (model->grids[g] != &model->lobes[k].theta && model->grids[g] != &model->lobes[k].phi)
            ++k;
        printf("%s&lobes_%s[%d].%s", g ? ", " : "", name, k, model->grids[g] == &model->lobes[k].phi ? "phi" : "theta");
    }
    puts("},");
}

static void print_entry(const char *name, const hairlut_model *model)
{
    const hairlut_mixture *m = &model->mixture;
    printf("    {\"%s\", {.lobe_count = %d, .direct = %d, .multiple = %d, .lobes = lobes_%s,\n", name, model->lobe_count,
           model->direct, model->multiple, name);
    print_grids(name, model);
    printf("      .mixture = {.fours = array_%d, ", fours_of(model));
    print_nodes("theta_r", &m->theta_r);
    print_nodes("arc", &m->arc);
    printf("\n      .four_count = %d, .above = %d, .beside = %d, .mirrored = %d, .turned = %d, .constant = %d,",
           m->four_count, m->above, m->beside, m->mirrored, m->turned, m->constant);
    print_mix(&m->mix, model->lobe_count);
    puts("}}},");
}

/* The last part of a path. */
static const char *name_of(const char *directory)
{
    const char *slash = strrchr(directory, '/');
    return slash ? slash + 1 : directory;
}

int main(int argc, char **argv)
{
    hairlut_model **models = malloc((size_t)argc * sizeof *models);
    if (argc < 2 || !models) {
        fputs("use: embed DIRECTORY...\n", stderr);
        return 2;
    }
    for (int k = 1; k < argc; ++k) {
        char message[HAIRLUT_MESSAGE_SIZE];
        if (hairlut_load_with(argv[k], NULL, &models[k], message) != HAIRLUT_OK) {
            fprintf(stderr, "embed: %s\n", message);
            return 1;
        }
        if (hairlut_parameter_count(models[k]) > 0) {
            fprintf(
                stderr,
                "embed: %s: depends on the parameter %s: expected a model without parameters, as compiled-in models have "
                "none; write one with hairlut export %s --at NAME=VALUE --to exr --out FOLDER\n",
                argv[k], hairlut_parameter_name(models[k], 0), argv[k]);
            return 1;
        }
    }
    fputs("/* SPDX-License-Identifier: BSD-3-Clause */\n/* By runtime/tools/embed.c from", stdout);
    for (int k = 1; k < argc; ++k)
        printf(" %s", name_of(argv[k]));
    fputs("; not to be edited. */\n#include \"internal.h\"\n\n", stdout);
    for (int k = 1; k < argc; ++k) {
        fours_of(models[k]), nodes_of(&models[k]->mixture.theta_r), nodes_of(&models[k]->mixture.arc);
        print_lobes(name_of(argv[k]), models[k]);
    }
    printf("const hairlut_builtin_entry hairlut_builtin_entries[] = {\n");
    for (int k = 1; k < argc; ++k)
        print_entry(name_of(argv[k]), models[k]);
    printf("};\nconst int hairlut_builtin_count = %d;\n", argc - 1);
    for (int k = 1; k < argc; ++k)
        hairlut_free(models[k]);
    free(models);
    return fflush(stdout) != 0 || ferror(stdout);
}
