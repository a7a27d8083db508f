/* SPDX-License-Identifier: BSD-3-Clause */
/* Table files: attributes to numbers, and the texels that belong to them. */
#include "exr_table.h"

#include <math.h>

#include "exr_slopes.h"
#include "warp.h"

static const char *const channels[] = {"Y", "dxdu"};

/* Inclinations are at most pi/2 in size: more is a range in degrees. */
static const double half_pi = 1.5707963267948966, two_pi = 6.283185307179586, largest_inclination = 1.571;

/* The file's own account of which table it is: a renamed file is refused here. */
static hairlut_result read_identity(const hairlut_exr_file *file, const hairlut_exr_kind *kind, hairlut_exr_table *out)
{
    hairlut_result result = hairlut_exr_model(file, out->model);
    if (result == HAIRLUT_OK)
        result = hairlut_exr_expect(file, "hairlut.table", kind->table);
    if (result == HAIRLUT_OK)
        result = hairlut_exr_expect(file, "hairlut.angle", kind->is_azimuth ? "phi" : "theta_i");
    return result == HAIRLUT_OK ? hairlut_exr_expect(file, "hairlut.unit", "rad") : result;
}

static hairlut_result read_azimuth(const hairlut_exr_file *file, const hairlut_exr_kind *kind, hairlut_azimuth *azimuth)
{
    hairlut_exr_text text;
    if (!kind->is_azimuth)
        return hairlut_exr_expect(file, "hairlut.azimuth", "none");
    const hairlut_result result = hairlut_exr_string(file, "hairlut.azimuth", &text);
    if (result != HAIRLUT_OK)
        return result;
    *azimuth = hairlut_exr_equals(text, "sum") ? HAIRLUT_AZIMUTH_SUM : HAIRLUT_AZIMUTH_DIFFERENCE;
    if (!hairlut_exr_equals(text, "sum") && !hairlut_exr_equals(text, "difference"))
        return hairlut_exr_fail_text(file, "hairlut.azimuth", text, "'sum' or 'difference'");
    return HAIRLUT_OK;
}

static hairlut_result read_warp(const hairlut_exr_file *file, hairlut_warp *warp, double *e)
{
    hairlut_exr_text text;
    const hairlut_result result = hairlut_exr_string(file, "hairlut.warp", &text);
    if (result != HAIRLUT_OK)
        return result;
    *warp = hairlut_exr_equals(text, "uniform") ? HAIRLUT_WARP_UNIFORM : HAIRLUT_WARP_OCTAVES;
    *e = 0.0;
    if (*warp == HAIRLUT_WARP_OCTAVES && !hairlut_exr_parameter(text, "octaves e=", e))
        return hairlut_exr_fail_text(file, "hairlut.warp", text, "'uniform' or 'octaves e=NUMBER'");
    if (*warp == HAIRLUT_WARP_OCTAVES && !(*e >= 1e-12 && *e <= 1.0))
        return hairlut_exr_fail_text(file, "hairlut.warp", text, "e from 1e-12 to 1");
    return HAIRLUT_OK;
}

/* Format 1 had a bound of a cell's curvature here, which slopes replace. */
static hairlut_result check_cell(const hairlut_exr_file *file, int format)
{
    hairlut_exr_text text;
    double number = 0.0;
    if (format > 1)
        return hairlut_exr_expect(file, "hairlut.cell", "rational quadratic");
    const hairlut_result result = hairlut_exr_string(file, "hairlut.cell", &text);
    if (result == HAIRLUT_OK && !hairlut_exr_equals(text, "linear") &&
        !(hairlut_exr_parameter(text, "parabola limit=", &number) && number >= 0.0 && number <= 0.95))
        return hairlut_exr_fail_text(file, "hairlut.cell", text,
                                     "'linear' or 'parabola limit=NUMBER' with a number from 0 to 0.95");
    return result;
}

/* Two numbers, increasing, which lie between two others up to the rounding of a float. */
static hairlut_result read_pair(const hairlut_exr_file *file, const char *attribute, double least, double most, float *low,
                                float *high)
{
    hairlut_exr_text text;
    char expected[120];
    double a = 0.0, b = 0.0;
    const hairlut_result result = hairlut_exr_string(file, attribute, &text);
    if (result != HAIRLUT_OK)
        return result;
    hairlut_exr_text rest = text;
    snprintf(expected, sizeof expected, "two increasing angles in radians, a space between, from %.6g to %.6g", least, most);
    if (!hairlut_exr_number(&rest, &a) || !hairlut_exr_skip(&rest, " ") || !hairlut_exr_parameter(rest, "", &b) ||
        !(a < b) || !(a >= -10.0 && b <= 10.0))
        return hairlut_exr_fail_text(file, attribute, text, expected);
    *low = (float)a;
    *high = (float)b;
    if (!(*low >= (float)least && *high <= (float)most && *high - *low >= 1e-6f))
        return hairlut_exr_fail_text(file, attribute, text, expected);
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
        if ((i > 0 && !hairlut_exr_skip(&text, " ")) || !hairlut_exr_number(&text, &u))
            return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                    "hairlut.knots holds %d numbers: expected %d, a space between; bake the model again", i,
                                    file->width);
        if (!(fabs((upper ? 1.0 - u : u) - m) <= 1e-6 * m + 1e-15))
            return hairlut_exr_fail(
                file, HAIRLUT_ERROR_ATTRIBUTE,
                "hairlut.knots, column %d is %.17g: expected %.17g by hairlut.warp; bake the model again", i, u,
                upper ? 1.0 - m : m);
    }
    if (text.begin != text.end)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                "hairlut.knots holds more than %d numbers: expected one a column; bake the model again",
                                file->width);
    return HAIRLUT_OK;
}

static hairlut_result read_header(const hairlut_exr_file *file, const hairlut_exr_kind *kind, hairlut_exr_table *out)
{
    hairlut_table *t = &out->table;
    const int phi = kind->is_azimuth;
    double e = 0.0;
    hairlut_result result = hairlut_exr_expect_format(file, kind->format, kind->why);
    if (result == HAIRLUT_OK)
        result = hairlut_exr_check_channels(file, channels, kind->format);
    if (result == HAIRLUT_OK)
        result = hairlut_exr_check_size(file, 4);
    if (result == HAIRLUT_OK)
        result = hairlut_exr_read_table_axes(file, kind->parameters, &out->axes);
    if (result == HAIRLUT_OK)
        result = hairlut_exr_split_rows(file, &out->axes, 2, &t->height);
    if (result == HAIRLUT_OK)
        result = read_identity(file, kind, out);
    if (result == HAIRLUT_OK)
        result = read_azimuth(file, kind, &out->azimuth);
    if (result == HAIRLUT_OK)
        result = read_warp(file, &t->warp, &e);
    if (result == HAIRLUT_OK)
        result = check_cell(file, kind->format);
    if (result == HAIRLUT_OK)
        result = read_pair(file, "hairlut.theta_r_range", -largest_inclination, largest_inclination, &t->theta_r_min,
                           &t->theta_r_max);
    if (result == HAIRLUT_OK)
        result =
            read_pair(file, "hairlut.domain", phi ? 0.0 : -half_pi, phi ? two_pi : half_pi, &t->domain_min, &t->domain_max);
    if (result == HAIRLUT_OK)
        result = check_knots(file, t->warp, e);
    t->size = sizeof *t;
    t->warp_e = (float)e;
    t->width = file->width;
    t->axis_count = out->axes.count;
    t->axes = out->axes.list;
    return result;
}

/* Of format 1: reads angles into the second half of the texels, and makes pairs of them from the first on. */
static hairlut_result read_angles(const hairlut_exr_file *file, const hairlut_table *t, float *texels)
{
    const size_t count = (size_t)t->width * (size_t)t->height;
    const hairlut_result result = hairlut_exr_pixels(file, channels, 1, texels + count);
    if (result != HAIRLUT_OK)
        return result;
    for (size_t k = 0; k < count; ++k)
        texels[2 * k] = texels[count + k];
    hairlut_exr_derive_slopes(t, texels);
    return HAIRLUT_OK;
}

static hairlut_result read_pairs(const hairlut_exr_file *file, float *texels, uint32_t *digest)
{
    const hairlut_result result = hairlut_exr_pixels(file, channels, 2, texels);
    if (result != HAIRLUT_OK)
        return result;
    return hairlut_exr_check_digest(file, texels, 2 * (size_t)file->width * (size_t)file->height, digest);
}

/* The header is read before memory for the texels is allocated: the knots bound the width by the file's size. */
static hairlut_result read_texels(const hairlut_exr_file *file, const hairlut_exr_kind *kind,
                                  const hairlut_allocator *allocator, hairlut_exr_table *out)
{
    const size_t size = 2 * (size_t)file->width * (size_t)file->height * sizeof(float);
    char detail[HAIRLUT_MESSAGE_SIZE];
    hairlut_result result = hairlut_allocate(allocator, size, &out->texels, detail);
    if (result != HAIRLUT_OK)
        return hairlut_exr_fail(file, result, "%.200s", detail);
    out->table.texels = out->texels;
    result = kind->format == 1 ? read_angles(file, &out->table, out->texels) : read_pairs(file, out->texels, &out->digest);
    if (result != HAIRLUT_OK)
        return result;
    result = hairlut_validate(&out->table, detail);
    if (result != HAIRLUT_OK)
        return hairlut_exr_fail(file, result, "%.200s; bake the model again", detail);
    return result;
}

hairlut_result hairlut_exr_read_table(const hairlut_exr_kind *kind, const char *path,
                                      const exr_context_initializer_t *source, const hairlut_allocator *allocator,
                                      hairlut_exr_table *out, char *message)
{
    hairlut_exr_file file;
    memset(out, 0, sizeof *out);
    hairlut_result result = hairlut_exr_open(&file, path, source, message);
    out->missing = file.missing;
    if (result == HAIRLUT_OK)
        result = read_header(&file, kind, out);
    if (result == HAIRLUT_OK)
        result = read_texels(&file, kind, allocator, out);
    hairlut_exr_close(&file);
    return result;
}
