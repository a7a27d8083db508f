/* Table files: attributes to numbers. */
#include "exr_table.h"

#include <math.h>
#include <string.h>

#include "number.h"
#include "warp.h"

enum { FORMAT = 1 };

static int equals(hairlut_exr_text text, const char *word)
{
    const size_t length = (size_t)(text.end - text.begin);
    return length == strlen(word) && memcmp(text.begin, word, length) == 0;
}

/* Removes `prefix`; 0 where the text does not start with it. */
static int skip(hairlut_exr_text *text, const char *prefix)
{
    const size_t length = strlen(prefix);
    if ((size_t)(text->end - text->begin) < length || memcmp(text->begin, prefix, length) != 0)
        return 0;
    text->begin += length;
    return 1;
}

/* "prefix NUMBER" and nothing behind it */
static int read_parameter(hairlut_exr_text text, const char *prefix, double *number)
{
    return skip(&text, prefix) && hairlut_read_number(&text.begin, text.end, number) && text.begin == text.end;
}

static hairlut_result fail_text(const hairlut_exr_file *file, const char *attribute, hairlut_exr_text text, const char *expected)
{
    const int shown = text.end - text.begin < 60 ? (int)(text.end - text.begin) : 60;
    return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE, "%s is '%.*s': expected %s; bake the table again", attribute, shown,
                            text.begin, expected);
}

/* The attribute must be `word`. */
static hairlut_result expect_word(const hairlut_exr_file *file, const char *attribute, const char *word)
{
    hairlut_exr_text text;
    char expected[80];
    const hairlut_result result = hairlut_exr_string(file, attribute, &text);
    if (result != HAIRLUT_OK || equals(text, word))
        return result;
    snprintf(expected, sizeof expected, "'%s'", word);
    return fail_text(file, attribute, text, expected);
}

static hairlut_result read_format(const hairlut_exr_file *file)
{
    int format = 0;
    const hairlut_result result = hairlut_exr_int(file, "hairlut.format", &format);
    if (result != HAIRLUT_OK || format == FORMAT)
        return result;
    if (format > FORMAT)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_VERSION,
                                "hairlut.format is %d: expected at most %d; use a newer hairlut library, or bake the table again",
                                format, (int)FORMAT);
    return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE, "hairlut.format is %d: expected %d; bake the table again", format,
                            (int)FORMAT);
}

static hairlut_result read_model(const hairlut_exr_file *file, char model[HAIRLUT_EXR_MODEL_SIZE])
{
    hairlut_exr_text text;
    const hairlut_result result = hairlut_exr_string(file, "hairlut.model", &text);
    if (result != HAIRLUT_OK)
        return result;
    const size_t length = (size_t)(text.end - text.begin);
    if (length == 0 || length >= HAIRLUT_EXR_MODEL_SIZE)
        return fail_text(file, "hairlut.model", text, "a name of 1 to 63 bytes");
    memcpy(model, text.begin, length);
    model[length] = '\0';
    return HAIRLUT_OK;
}

/* The file's own account of which table it is: a renamed file is refused here. */
static hairlut_result read_identity(const hairlut_exr_file *file, const hairlut_exr_kind *kind, hairlut_exr_table *out)
{
    hairlut_exr_text text;
    hairlut_result result = read_format(file);
    if (result == HAIRLUT_OK)
        result = read_model(file, out->model);
    if (result == HAIRLUT_OK)
        result = hairlut_exr_string(file, "hairlut.table", &text);
    if (result == HAIRLUT_OK && !equals(text, kind->table))
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                "hairlut.table is '%.*s': expected '%s', as the file's name says; give the file its own name back",
                                (int)(text.end - text.begin < 60 ? text.end - text.begin : 60), text.begin, kind->table);
    if (result == HAIRLUT_OK)
        result = expect_word(file, "hairlut.angle", kind->angle);
    return result == HAIRLUT_OK ? expect_word(file, "hairlut.unit", "rad") : result;
}

static hairlut_result read_azimuth(const hairlut_exr_file *file, const hairlut_exr_kind *kind, hairlut_azimuth *azimuth)
{
    hairlut_exr_text text;
    if (!kind->has_azimuth)
        return expect_word(file, "hairlut.azimuth", "none");
    const hairlut_result result = hairlut_exr_string(file, "hairlut.azimuth", &text);
    if (result != HAIRLUT_OK)
        return result;
    *azimuth = equals(text, "sum") ? HAIRLUT_AZIMUTH_SUM : HAIRLUT_AZIMUTH_DIFFERENCE;
    if (!equals(text, "sum") && !equals(text, "difference"))
        return fail_text(file, "hairlut.azimuth", text, "'sum' or 'difference'");
    return HAIRLUT_OK;
}

static hairlut_result read_warp(const hairlut_exr_file *file, hairlut_warp *warp, double *e)
{
    hairlut_exr_text text;
    const hairlut_result result = hairlut_exr_string(file, "hairlut.warp", &text);
    if (result != HAIRLUT_OK)
        return result;
    *warp = equals(text, "uniform") ? HAIRLUT_WARP_UNIFORM : HAIRLUT_WARP_OCTAVES;
    *e = 0.0;
    if (*warp == HAIRLUT_WARP_OCTAVES && !read_parameter(text, "octaves e=", e))
        return fail_text(file, "hairlut.warp", text, "'uniform' or 'octaves e=NUMBER'");
    if (*warp == HAIRLUT_WARP_OCTAVES && !(*e >= 1e-12 && *e <= 1.0))
        return fail_text(file, "hairlut.warp", text, "e from 1e-12 to 1");
    return HAIRLUT_OK;
}

/* Format 1 had a bound of a cell's curvature here, which slopes replace. */
static hairlut_result check_cell(const hairlut_exr_file *file)
{
    hairlut_exr_text text;
    double number = 0.0;
    const hairlut_result result = hairlut_exr_string(file, "hairlut.cell", &text);
    if (result != HAIRLUT_OK)
        return result;
    if (!equals(text, "linear") && !(read_parameter(text, "parabola limit=", &number) && number >= 0.0 && number <= 0.95))
        return fail_text(file, "hairlut.cell", text, "'linear' or 'parabola limit=NUMBER' with a number from 0 to 0.95");
    return HAIRLUT_OK;
}

/* Two numbers, increasing, of at most 7 (2 pi and a margin) in size. */
static hairlut_result read_pair(const hairlut_exr_file *file, const char *attribute, float *low, float *high)
{
    hairlut_exr_text text;
    double a = 0.0, b = 0.0;
    const hairlut_result result = hairlut_exr_string(file, attribute, &text);
    if (result != HAIRLUT_OK)
        return result;
    hairlut_exr_text rest = text;
    if (!hairlut_read_number(&rest.begin, rest.end, &a) || !skip(&rest, " ") || !read_parameter(rest, "", &b)
        || !(a >= -7.0 && a < b && b <= 7.0))
        return fail_text(file, attribute, text, "two increasing angles in radians");
    *low = (float)a;
    *high = (float)b;
    return HAIRLUT_OK;
}

/* The knots are in the file for readers that do not know the warp; here they guard against a warp that is not theirs. */
static hairlut_result check_knots(const hairlut_exr_file *file, hairlut_warp warp, double e)
{
    hairlut_exr_text text;
    const hairlut_result result = hairlut_exr_string(file, "hairlut.knots", &text);
    if (result != HAIRLUT_OK)
        return result;
    const hairlut_warp_scale scale = hairlut_scale_warp(warp, e, file->width);
    for (int i = 0; i < file->width; ++i) {
        const int upper = 2 * i > file->width - 1;
        const double m = hairlut_warp_u(warp, &scale, file->width, upper ? file->width - 1 - i : i);
        double u = 0.0;
        if ((i > 0 && !skip(&text, " ")) || !hairlut_read_number(&text.begin, text.end, &u))
            return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                    "hairlut.knots holds %d numbers: expected %d, separated by spaces; bake the table again", i,
                                    file->width);
        if (!(fabs((upper ? 1.0 - u : u) - m) <= 1e-6 * m + 1e-15))
            return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                    "hairlut.knots, column %d is %.17g: expected %.17g by hairlut.warp; bake the table again", i,
                                    u, upper ? 1.0 - m : m);
    }
    if (text.begin != text.end)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                "hairlut.knots holds more than %d numbers: expected one a column; bake the table again", file->width);
    return HAIRLUT_OK;
}

static hairlut_result read_header(const hairlut_exr_file *file, const hairlut_exr_kind *kind, hairlut_exr_table *out)
{
    hairlut_table *t = &out->table;
    double e = 0.0;
    hairlut_result result = read_identity(file, kind, out);
    if (result == HAIRLUT_OK)
        result = read_azimuth(file, kind, &out->azimuth);
    if (result == HAIRLUT_OK)
        result = read_warp(file, &t->warp, &e);
    if (result == HAIRLUT_OK)
        result = check_cell(file);
    if (result == HAIRLUT_OK)
        result = read_pair(file, "hairlut.theta_r_range", &t->theta_r_min, &t->theta_r_max);
    if (result == HAIRLUT_OK)
        result = read_pair(file, "hairlut.domain", &t->domain_min, &t->domain_max);
    if (result == HAIRLUT_OK)
        result = check_knots(file, t->warp, e);
    t->size = sizeof *t;
    t->warp_e = (float)e;
    t->width = file->width;
    t->height = file->height;
    return result;
}

/* dx/du at a knot between cells of D0, D1 in x and h0, h1 in u: the density there is that of both, blended linearly in x. */
static double inner_slope(double x0, double x, double x1, double h0, double h1)
{
    const double d0 = x - x0, d1 = x1 - x;
    return (d0 + d1) / (d1 * h0 / d0 + d0 * h1 / d1);
}

/* At an end of a row: a parabola's, from that at the next knot, but within a factor of 8 of the cell's mean slope. */
static double end_slope(double mean, double next)
{
    const double slope = 2.0 * mean - next;
    return slope < mean / 8.0 ? mean / 8.0 : slope > 8.0 * mean ? 8.0 * mean : slope;
}

/* Format 1 has angles alone: the slopes of a row by luts/FORMAT.md's rule. */
static void derive_slopes(const hairlut_table *t, float *row)
{
    const hairlut_warp_scale scale = hairlut_scale_warp(t->warp, t->warp_e, t->width);
    const int last = t->width - 1;
    double before = 0.0, h0 = 0.0;
    for (int i = 0; i < last; ++i) {
        /* both ends of a cell counted from the nearer end of the u axis: no cancellation */
        const int high = 2 * i >= last, near_end = high ? last - i - 1 : i;
        const double h = hairlut_warp_u(t->warp, &scale, t->width, near_end + 1) - hairlut_warp_u(t->warp, &scale, t->width, near_end);
        if (i > 0)
            row[2 * i + 1] = (float)inner_slope(before, (double)row[2 * i], (double)row[2 * i + 2], h0, h);
        if (i == 1)
            row[1] = (float)end_slope(((double)row[2] - (double)row[0]) / h0, (double)row[3]);
        if (i == last - 1)
            row[2 * last + 1] = (float)end_slope(((double)row[2 * last] - (double)row[2 * i]) / h, (double)row[2 * i + 1]);
        before = (double)row[2 * i];
        h0 = h;
    }
}

/* Reads angles into the second half of the texels, and makes pairs of them from the first on. Slopes of what is no table are not
 * used: hairlut_validate refuses its angles. */
static hairlut_result read_pairs(const hairlut_exr_file *file, const hairlut_table *t, float *texels)
{
    const size_t count = (size_t)t->width * (size_t)t->height;
    const hairlut_result result = hairlut_exr_pixels(file, texels + count);
    if (result != HAIRLUT_OK)
        return result;
    for (size_t k = 0; k < count; ++k)
        texels[2 * k] = texels[count + k];
    for (int j = 0; j < t->height; ++j)
        derive_slopes(t, texels + 2 * (size_t)t->width * (size_t)j);
    return HAIRLUT_OK;
}

/* The header is read before memory for the texels is asked for: the knots bound the width by the file's size. */
static hairlut_result read_texels(const hairlut_exr_file *file, const hairlut_allocator *allocator, hairlut_exr_table *out)
{
    const size_t size = 2 * (size_t)file->width * (size_t)file->height * sizeof(float);
    char detail[HAIRLUT_MESSAGE_SIZE];
    hairlut_result result = hairlut_allocate(allocator, size, &out->texels, detail);
    if (result != HAIRLUT_OK)
        return hairlut_exr_fail(file, result, "%.200s", detail);
    out->table.texels = out->texels;
    result = read_pairs(file, &out->table, out->texels);
    if (result != HAIRLUT_OK)
        return result;
    result = hairlut_validate(&out->table, detail);
    if (result != HAIRLUT_OK)
        return hairlut_exr_fail(file, result, "%.200s; bake the table again", detail);
    return result;
}

hairlut_result hairlut_exr_read_table(const hairlut_exr_kind *kind, const char *path, const exr_context_initializer_t *source,
                                      const hairlut_allocator *allocator, hairlut_exr_table *out, char *message)
{
    hairlut_exr_file file;
    memset(out, 0, sizeof *out);
    hairlut_result result = hairlut_exr_open(&file, path, source, message);
    if (result == HAIRLUT_OK)
        result = read_header(&file, kind, out);
    if (result == HAIRLUT_OK)
        result = read_texels(&file, allocator, out);
    hairlut_exr_close(&file);
    return result;
}
