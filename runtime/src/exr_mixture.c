/* SPDX-License-Identifier: BSD-3-Clause */
#include "exr_mixture.h"

#include "exr_digest.h"

enum { PER_LOBE = 2 /* channels: its share, its turn */, MOST_NODES = 1 << 18 };

/* ---- lobes ---------------------------------------------------------------------------------------------------- */

static int knows_lobe(const hairlut_exr_mixture *mixture, hairlut_exr_text name)
{
    for (int k = 0; k < mixture->lobe_count; ++k)
        if (hairlut_exr_equals(name, mixture->lobes[k].name))
            return 1;
    return 0;
}

static hairlut_result read_lobes(const hairlut_exr_file *file, hairlut_exr_mixture *out)
{
    static const char expected[] =
        "1 to 16 names that differ, each [a-z][a-z0-9_]* of at most 31 characters, a space between";
    hairlut_exr_text text, word;
    const hairlut_result result = hairlut_exr_string(file, "hairlut.lobes", &text);
    if (result != HAIRLUT_OK)
        return result;
    hairlut_exr_text rest = text;
    int more;
    do {
        more = hairlut_exr_word(&rest, &word);
        if (out->lobe_count == HAIRLUT_MAX_LOBES || !hairlut_exr_is_name(word) || knows_lobe(out, word))
            return hairlut_exr_fail_text(file, "hairlut.lobes", text, expected);
        hairlut_exr_keep(out->lobes[out->lobe_count++].name, word);
    } while (more);
    return HAIRLUT_OK;
}

/* "NAME_suffix DIGEST" at the beginning of *text, with the space behind it if there is one */
static int read_reference(hairlut_exr_text *text, const char *suffix, hairlut_exr_reference *out, int *more)
{
    hairlut_exr_text table, digest;
    if (!hairlut_exr_word(text, &table))
        return 0;
    *more = hairlut_exr_word(text, &digest);
    const size_t length = strlen(suffix);
    if (hairlut_exr_length(table) <= length || memcmp(table.end - length, suffix, length) != 0)
        return 0;
    const hairlut_exr_text name = {table.begin, table.end - length};
    if (!hairlut_exr_is_name(name) || hairlut_exr_length(digest) != 8 || !hairlut_exr_read_hex(digest.begin, &out->digest))
        return 0;
    hairlut_exr_keep(out->table, table);
    return 1;
}

/* Lobes that name one table agree on its digest. */
static int agrees(const hairlut_exr_mixture *mixture, const hairlut_exr_reference *reference)
{
    for (int k = 0; k < mixture->lobe_count; ++k) {
        const hairlut_exr_reference *others[] = {&mixture->lobes[k].theta, &mixture->lobes[k].phi};
        for (int n = 0; n < 2; ++n)
            if (strcmp(others[n]->table, reference->table) == 0 && others[n]->digest != reference->digest)
                return 0;
    }
    return 1;
}

static hairlut_result read_tables(const hairlut_exr_file *file, const hairlut_exr_mixture *mixture, hairlut_exr_lobe *lobe)
{
    char attribute[sizeof "hairlut.lobe." + HAIRLUT_NAME_SIZE];
    hairlut_exr_text text;
    snprintf(attribute, sizeof attribute, "hairlut.lobe.%s", lobe->name);
    const hairlut_result result = hairlut_exr_string(file, attribute, &text);
    if (result != HAIRLUT_OK)
        return result;
    hairlut_exr_text rest = text;
    int more = 0;
    if (!read_reference(&rest, "_theta", &lobe->theta, &more) ||
        (more && !read_reference(&rest, "_phi", &lobe->phi, &more)) || more)
        return hairlut_exr_fail_text(file, attribute, text,
                                     "'NAME_theta DIGEST' or 'NAME_theta DIGEST NAME_phi DIGEST', digests of 8 "
                                     "lower-case hexadecimal digits");
    if (!agrees(mixture, &lobe->theta) || !agrees(mixture, &lobe->phi))
        return hairlut_exr_fail_text(file, attribute, text, "the digests that other lobes give the same tables");
    return HAIRLUT_OK;
}

static hairlut_result check_channels(const hairlut_exr_file *file, const hairlut_exr_mixture *mixture,
                                     char names[][HAIRLUT_NAME_SIZE + 6], const char *pointers[])
{
    for (int k = 0; k < mixture->lobe_count; ++k) {
        snprintf(names[PER_LOBE * k], sizeof names[0], "%s.share", mixture->lobes[k].name);
        snprintf(names[PER_LOBE * k + 1], sizeof names[0], "%s.turn", mixture->lobes[k].name);
    }
    for (int k = 0; k < PER_LOBE * mixture->lobe_count; ++k)
        pointers[k] = names[k];
    return hairlut_exr_check_channels(file, pointers, PER_LOBE * mixture->lobe_count);
}

/* ---- axes ----------------------------------------------------------------------------------------------------- */

static hairlut_result read_mirrored(const hairlut_exr_file *file, int *mirrored)
{
    hairlut_exr_text text;
    const hairlut_result result = hairlut_exr_string(file, "hairlut.mirrored", &text);
    if (result != HAIRLUT_OK)
        return result;
    *mirrored = hairlut_exr_equals(text, "1");
    return *mirrored || hairlut_exr_equals(text, "0") ? HAIRLUT_OK
                                                      : hairlut_exr_fail_text(file, "hairlut.mirrored", text, "'0' or '1'");
}

/* `count` numbers, increasing, from low to high; nodes may be NULL to check them alone. */
static hairlut_result read_axis(const hairlut_exr_file *file, const char *attribute, int count, double low, double high,
                                float *nodes)
{
    hairlut_exr_text text;
    const hairlut_result result = hairlut_exr_string(file, attribute, &text);
    if (result != HAIRLUT_OK)
        return result;
    hairlut_exr_text rest = text;
    float before = 0.0f;
    for (int k = 0; k < count; ++k) {
        double number = 0.0;
        if ((k > 0 && !hairlut_exr_skip(&rest, " ")) || !hairlut_exr_number(&rest, &number))
            return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                    "%s holds %d numbers: expected %d, a space between; bake the model again", attribute, k,
                                    count);
        if (!(number >= low && number <= high) || (k > 0 && !((float)number > before)))
            return hairlut_exr_fail(
                file, HAIRLUT_ERROR_ATTRIBUTE,
                "%s, number %d is %.9g: expected increasing numbers from %.6g to %.6g; bake the model again", attribute, k,
                number, low, high);
        before = (float)number;
        if (nodes)
            nodes[k] = before;
    }
    if (rest.begin != rest.end)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                "%s holds more than %d numbers: expected as many as texels; bake the model again", attribute,
                                count);
    return HAIRLUT_OK;
}

static hairlut_result read_axes(const hairlut_exr_file *file, const hairlut_mixture_desc *desc, float *theta_r,
                                float *offset)
{
    const double largest_inclination = 1.571; /* more than pi/2 is in degrees */
    const hairlut_result result =
        read_axis(file, "hairlut.axis.theta_r", desc->theta_r_count, -largest_inclination, largest_inclination, theta_r);
    if (result != HAIRLUT_OK)
        return result;
    return read_axis(file, "hairlut.axis.offset", desc->offset_count, desc->mirrored ? 0.0 : -1.0, 1.0, offset);
}

static hairlut_result check_size(const hairlut_exr_file *file)
{
    const hairlut_result result = hairlut_exr_check_size(file, 1);
    if (result == HAIRLUT_OK && file->width * file->height > MOST_NODES)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_TABLE,
                                "size is %d x %d: expected at most %d nodes in all; bake the model again", file->width,
                                file->height, (int)MOST_NODES);
    return result;
}

/* ---- shares and turns ----------------------------------------------------------------------------------------- */

/* From texels whose channels stand together to arrays of one lobe after the other */
static void sort_channels(const float *texels, size_t nodes, int lobe_count, float *share, float *turn)
{
    const size_t channels = (size_t)(PER_LOBE * lobe_count);
    for (int k = 0; k < lobe_count; ++k)
        for (size_t node = 0; node < nodes; ++node) {
            share[(size_t)k * nodes + node] = texels[node * channels + (size_t)(PER_LOBE * k)];
            turn[(size_t)k * nodes + node] = texels[node * channels + (size_t)(PER_LOBE * k) + 1];
        }
}

/* The axes bound the size by the file's before memory for it is allocated. */
static hairlut_result read_nodes(const hairlut_exr_file *file, const char *const *channels,
                                 const hairlut_allocator *allocator, hairlut_exr_mixture *out)
{
    const size_t rows = (size_t)file->height, columns = (size_t)file->width, nodes = rows * columns;
    const size_t values = nodes * (size_t)(PER_LOBE * out->lobe_count); /* at most 2^23 */
    char detail[HAIRLUT_MESSAGE_SIZE];
    hairlut_result result = hairlut_allocate(allocator, (2 * values + rows + columns) * sizeof(float), &out->memory, detail);
    if (result != HAIRLUT_OK)
        return hairlut_exr_fail(file, result, "%.200s", detail);
    float *texels = out->memory, *share = texels + values, *turn = share + values / 2, *theta_r = turn + values / 2;
    uint32_t digest;
    (void)read_axes(file, &out->desc, theta_r, theta_r + out->desc.theta_r_count); /* it was checked before */
    result = hairlut_exr_pixels(file, channels, PER_LOBE * out->lobe_count, texels);
    if (result == HAIRLUT_OK)
        result = hairlut_exr_check_digest(file, texels, values, &digest);
    if (result != HAIRLUT_OK)
        return result;
    sort_channels(texels, nodes, out->lobe_count, share, turn);
    out->desc.theta_r = theta_r;
    out->desc.offset = theta_r + out->desc.theta_r_count;
    out->desc.share = share;
    out->desc.turn = turn;
    return HAIRLUT_OK;
}

static hairlut_result read_file(const hairlut_exr_file *file, const hairlut_allocator *allocator, hairlut_exr_mixture *out)
{
    char names[PER_LOBE * HAIRLUT_MAX_LOBES][HAIRLUT_NAME_SIZE + 6];
    const char *channels[PER_LOBE * HAIRLUT_MAX_LOBES];
    hairlut_result result = hairlut_exr_expect_format(file, 2, "the first with a mixture.exr");
    if (result == HAIRLUT_OK)
        result = read_lobes(file, out);
    if (result == HAIRLUT_OK)
        result = check_channels(file, out, names, channels);
    if (result == HAIRLUT_OK)
        result = check_size(file);
    if (result == HAIRLUT_OK)
        result = hairlut_exr_model(file, out->model);
    if (result == HAIRLUT_OK)
        result = hairlut_exr_expect(file, "hairlut.table", "mixture");
    if (result == HAIRLUT_OK)
        result = hairlut_exr_expect(file, "hairlut.unit", "rad");
    for (int k = 0; k < out->lobe_count && result == HAIRLUT_OK; ++k)
        result = read_tables(file, out, &out->lobes[k]);
    if (result == HAIRLUT_OK)
        result = hairlut_exr_read_mixture_axes(file, &out->parameters, &out->axes);
    if (result == HAIRLUT_OK)
        result = hairlut_exr_split_rows(file, &out->axes, 1, &out->desc.theta_r_count);
    if (result == HAIRLUT_OK)
        result = read_mirrored(file, &out->desc.mirrored);
    out->desc.size = sizeof out->desc;
    out->desc.offset_count = file->width;
    out->desc.axis_count = out->axes.count;
    out->desc.axes = out->axes.list;
    if (result == HAIRLUT_OK)
        result = read_axes(file, &out->desc, NULL, NULL);
    return result == HAIRLUT_OK ? read_nodes(file, channels, allocator, out) : result;
}

hairlut_result hairlut_exr_read_mixture(const char *path, const exr_context_initializer_t *source,
                                        const hairlut_allocator *allocator, hairlut_exr_mixture *out, char *message)
{
    hairlut_exr_file file;
    memset(out, 0, sizeof *out);
    hairlut_result result = hairlut_exr_open(&file, path, source, message);
    out->missing = file.missing;
    if (result == HAIRLUT_OK)
        result = read_file(&file, allocator, out);
    hairlut_exr_close(&file);
    return result;
}
