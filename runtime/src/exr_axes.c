/* SPDX-License-Identifier: BSD-3-Clause */
#include "exr_axes.h"

#include <math.h>

static const char mixture_axes[] = "theta_r offset", table_axes[] = "theta_r"; /* what the list of names ends with */

/* Numbers are of at most this size, and nodes this far apart, so that floats have gaps and their inverses. */
static const double largest = 1e30;
static const float narrowest = 1e-30f;

/* ---- names ---------------------------------------------------------------------------------------------------- */

static int is_reserved(hairlut_exr_text name)
{
    static const char *const words[] = {"theta_r", "theta_i", "phi", "phi_r", "phi_i", "offset", "u", "shares", "lobe"};
    for (size_t k = 0; k < sizeof words / sizeof words[0]; ++k)
        if (hairlut_exr_equals(name, words[k]))
            return 1;
    return 0;
}

static int index_of(const hairlut_exr_parameters *parameters, hairlut_exr_text name)
{
    for (int k = 0; k < parameters->count; ++k)
        if (hairlut_exr_equals(name, parameters->names[k]))
            return k;
    return -1;
}

static hairlut_result read_names(const hairlut_exr_file *file, hairlut_exr_parameters *out)
{
    static const char expected[] = "up to 8 names of parameters, each once, then 'theta_r offset', a space between";
    hairlut_exr_text text, word;
    const hairlut_result result = hairlut_exr_string(file, "hairlut.axes", &text);
    if (result != HAIRLUT_OK)
        return result;
    hairlut_exr_text rest = text;
    while (!hairlut_exr_equals(rest, mixture_axes)) {
        const int more = hairlut_exr_word(&rest, &word);
        if (!more || out->count == HAIRLUT_MAX_PARAMETERS || !hairlut_exr_is_name(word) || is_reserved(word) ||
            index_of(out, word) >= 0)
            return hairlut_exr_fail_text(file, "hairlut.axes", text, expected);
        hairlut_exr_keep(out->names[out->count++], word);
    }
    return HAIRLUT_OK;
}

/* ---- numbers -------------------------------------------------------------------------------------------------- */

/* "hairlut.axis.NAME" or "hairlut.parameter.NAME" */
typedef struct attribute_name {
    char text[sizeof "hairlut.parameter." + HAIRLUT_NAME_SIZE];
} attribute_name;

static attribute_name attribute_of(const char *kind, const char *parameter)
{
    attribute_name a;
    snprintf(a.text, sizeof a.text, "hairlut.%s.%s", kind, parameter);
    return a;
}

/* 1 to `most` numbers, one space between, each of at most `largest` in size; 0 where the text is something else. */
static int read_numbers(hairlut_exr_text text, int most, float *numbers)
{
    for (int count = 0; count < most;) {
        double number = 0.0;
        if (!hairlut_exr_number(&text, &number) || !(fabs(number) <= largest))
            return 0;
        numbers[count++] = (float)number;
        if (text.begin == text.end)
            return count;
        if (!hairlut_exr_skip(&text, " "))
            return 0;
    }
    return 0;
}

static int increases(const float *numbers, int count)
{
    for (int k = 1; k < count; ++k)
        if (!(numbers[k] - numbers[k - 1] >= narrowest))
            return 0;
    return 1;
}

static hairlut_result read_parameter(const hairlut_exr_file *file, const char *name, hairlut_parameter *out)
{
    const attribute_name a = attribute_of("parameter", name);
    hairlut_exr_text text;
    float numbers[3]; /* least, most, standard */
    const hairlut_result result = hairlut_exr_string(file, a.text, &text);
    if (result != HAIRLUT_OK)
        return result;
    if (read_numbers(text, 3, numbers) != 3 || !increases(numbers, 2) || !(numbers[2] >= numbers[0]) ||
        !(numbers[2] <= numbers[1]))
        return hairlut_exr_fail_text(file, a.text, text,
                                     "least, most and standard value: a range that increases and a number in it, of at most "
                                     "1e30 in size");
    const hairlut_parameter parameter = {sizeof parameter, name, numbers[0], numbers[1], numbers[2]};
    *out = parameter;
    return HAIRLUT_OK;
}

/* The nodes of one parameter, which become the next axis; none where they are its standard value alone and that is allowed. */
static hairlut_result read_axis(const hairlut_exr_file *file, const hairlut_exr_parameters *parameters, int index,
                                int may_be_standard, hairlut_exr_axes *out)
{
    const hairlut_parameter *parameter = &parameters->list[index];
    const attribute_name a = attribute_of("axis", parameter->name);
    hairlut_exr_text text;
    const hairlut_result result = hairlut_exr_string(file, a.text, &text);
    if (result != HAIRLUT_OK)
        return result;
    float nodes[HAIRLUT_EXR_MOST_NODES];
    const int count = read_numbers(text, HAIRLUT_EXR_MOST_NODES, nodes);
    if (count == 1 && may_be_standard && nodes[0] == parameter->standard)
        return HAIRLUT_OK;
    if (count < 2 || !increases(nodes, count) || nodes[0] != parameter->least || nodes[count - 1] != parameter->most) {
        char expected[160];
        snprintf(expected, sizeof expected, "2 to %d increasing numbers from %.9g to %.9g%s", HAIRLUT_EXR_MOST_NODES,
                 (double)parameter->least, (double)parameter->most, may_be_standard ? ", or the standard value" : "");
        return hairlut_exr_fail_text(file, a.text, text, expected);
    }
    if (out->count == HAIRLUT_MAX_AXES)
        return hairlut_exr_fail(
            file, HAIRLUT_ERROR_ATTRIBUTE,
            "hairlut.axes: the file depends on more than %d parameters: expected at most as many; bake the "
            "model again",
            (int)HAIRLUT_MAX_AXES);
    memcpy(out->nodes[out->count], nodes, sizeof nodes);
    const hairlut_parameter_nodes axis = {sizeof axis, index, count, out->nodes[out->count]};
    out->list[out->count++] = axis;
    out->blocks *= count;
    return HAIRLUT_OK;
}

/* ---- files ---------------------------------------------------------------------------------------------------- */

static int has_axis(const hairlut_exr_axes *axes, int parameter)
{
    for (int k = 0; k < axes->count; ++k)
        if (axes->list[k].parameter == parameter)
            return 1;
    return 0;
}

/* Refuses an attribute "prefix NAME" of a parameter that hairlut.axes lacks; axes: NULL where it has all of them. */
static hairlut_result refuse_others(const hairlut_exr_file *file, const char *prefix,
                                    const hairlut_exr_parameters *parameters, const hairlut_exr_axes *axes)
{
    hairlut_exr_text name;
    for (int k = 0; hairlut_exr_attribute(file, k, &name); ++k) {
        if (!hairlut_exr_skip(&name, prefix) || hairlut_exr_equals(name, "theta_r") || hairlut_exr_equals(name, "offset"))
            continue;
        const int index = index_of(parameters, name);
        if (index < 0 || (axes && !has_axis(axes, index))) {
            char what[80];
            snprintf(what, sizeof what, "hairlut.axes lacks NAME of an attribute %sNAME, which", prefix);
            return hairlut_exr_fail_text(file, what, name, "all such names");
        }
    }
    return HAIRLUT_OK;
}

hairlut_result hairlut_exr_read_mixture_axes(const hairlut_exr_file *file, hairlut_exr_parameters *parameters,
                                             hairlut_exr_axes *axes)
{
    parameters->count = axes->count = 0;
    axes->blocks = 1;
    hairlut_result result = read_names(file, parameters);
    if (result == HAIRLUT_OK)
        result = refuse_others(file, "hairlut.parameter.", parameters, NULL);
    if (result == HAIRLUT_OK)
        result = refuse_others(file, "hairlut.axis.", parameters, NULL);
    for (int k = 0; k < parameters->count && result == HAIRLUT_OK; ++k)
        result = read_parameter(file, parameters->names[k], &parameters->list[k]);
    for (int k = 0; k < parameters->count && result == HAIRLUT_OK; ++k)
        result = read_axis(file, parameters, k, 1, axes);
    return result;
}

/* The axes that hairlut.axes names before 'theta_r' */
static hairlut_result read_named_axes(const hairlut_exr_file *file, const hairlut_exr_parameters *parameters,
                                      hairlut_exr_axes *axes)
{
    hairlut_exr_text text, word;
    hairlut_result result = hairlut_exr_string(file, "hairlut.axes", &text);
    hairlut_exr_text rest = text;
    while (result == HAIRLUT_OK && !hairlut_exr_equals(rest, table_axes)) {
        const int more = hairlut_exr_word(&rest, &word), index = index_of(parameters, word);
        if (!more || index < 0 || has_axis(axes, index))
            return hairlut_exr_fail_text(file, "hairlut.axes", text,
                                         "up to 4 names of parameters in mixture.exr, each once, then 'theta_r', a space "
                                         "between");
        result = read_axis(file, parameters, index, 0, axes);
    }
    return result;
}

hairlut_result hairlut_exr_read_table_axes(const hairlut_exr_file *file, const hairlut_exr_parameters *parameters,
                                           hairlut_exr_axes *axes)
{
    axes->count = 0;
    axes->blocks = 1;
    const hairlut_result result =
        hairlut_exr_has(file, "hairlut.axes") ? read_named_axes(file, parameters, axes) : HAIRLUT_OK;
    return result == HAIRLUT_OK ? refuse_others(file, "hairlut.axis.", parameters, axes) : result;
}

hairlut_result hairlut_exr_split_rows(const hairlut_exr_file *file, const hairlut_exr_axes *axes, int least, int *height)
{
    const int most = HAIRLUT_EXR_LARGEST_SIDE;
    *height = file->height / axes->blocks;
    if (file->height % axes->blocks != 0)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_TABLE,
                                "it has %d rows: expected a multiple of the %d nodes of parameters; bake the model again",
                                file->height, axes->blocks);
    if (*height < least || *height > most)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_TABLE, "size is %d x %d%s: expected %d to %d rows; bake the model again",
                                file->width, *height, axes->count ? " for each node of parameters" : "", least, most);
    return HAIRLUT_OK;
}
