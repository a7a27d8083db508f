/* SPDX-License-Identifier: BSD-3-Clause */
/* Parameters and axes over them: what descriptors must fulfil, and what a model says about its parameters. */
#include <math.h>
#include <string.h>

#include "build.h"

enum { FEWEST_NODES = 2, MOST_NODES = 64 };

/* ---- descriptors of 2.0 --------------------------------------------------------------------------------------- */

hairlut_table hairlut_known_table(const hairlut_table *table)
{
    hairlut_table known;
    memcpy(&known, table, table->size);
    if (table->size < sizeof known) {
        known.axis_count = 0;
        known.axes = NULL;
    }
    return known;
}

hairlut_mixture_desc hairlut_known_mixture(const hairlut_mixture_desc *desc)
{
    hairlut_mixture_desc known = {sizeof known, 1, 1, NULL, NULL, NULL, NULL, 0, 0, NULL};
    if (desc)
        memcpy(&known, desc, desc->size);
    if (desc && desc->size < sizeof known) {
        known.axis_count = 0; /* 2.0's struct may end in padding at that place */
        known.axes = NULL;
    }
    return known;
}

hairlut_model_desc hairlut_known_model(const hairlut_model_desc *desc)
{
    hairlut_model_desc known;
    memcpy(&known, desc, desc->size);
    if (desc->size < sizeof known) {
        known.parameter_count = 0;
        known.parameters = NULL;
    }
    return known;
}

/* ---- parameters ----------------------------------------------------------------------------------------------- */

static const hairlut_parameter *parameter_at(const hairlut_model_desc *desc, int p)
{
    return (const hairlut_parameter *)((const char *)desc->parameters + (size_t)p * desc->parameters->size);
}

/* Arguments of the functions that take parameters by name. */
static int is_argument(const char *name)
{
    static const char *const arguments[] = {"theta_r", "theta_i", "phi", "phi_r", "phi_i", "offset", "u", "shares", "lobe"};
    for (size_t k = 0; k < sizeof arguments / sizeof *arguments; ++k)
        if (strcmp(name, arguments[k]) == 0)
            return 1;
    return 0;
}

static hairlut_result validate_name(const hairlut_model_desc *desc, int p, char *message)
{
    const char *name = parameter_at(desc, p)->name;
    if (!name)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "parameter %d: name is NULL: expected a word", p);
    if (!hairlut_is_name(name))
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                            "parameter %d: name is '%.40s': expected [a-z][a-z0-9_]*, at most %d characters", p, name,
                            HAIRLUT_NAME_SIZE - 1);
    if (is_argument(name))
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                            "parameter %d: name is '%s', an argument of sample and pdf: expected another", p, name);
    for (int q = 0; q < p; ++q)
        if (strcmp(parameter_at(desc, q)->name, name) == 0)
            return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                                "parameters %d and %d are both named '%s': expected names that differ", q, p, name);
    return HAIRLUT_OK;
}

static hairlut_result validate_parameter(const hairlut_model_desc *desc, int p, char *message)
{
    const hairlut_parameter *parameter = parameter_at(desc, p);
    hairlut_result result = hairlut_check_size("hairlut_parameter", parameter->size, desc->parameters->size, 0, message);
    if (result == HAIRLUT_OK)
        result = validate_name(desc, p, message);
    if (result != HAIRLUT_OK)
        return result;
    if (!hairlut_within(parameter->least, parameter->most, -hairlut_largest_value, hairlut_largest_value) ||
        !(parameter->most - parameter->least >= hairlut_narrowest_gap))
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                            "parameter '%s': least %.9g, most %.9g: expected increasing numbers from %g to %g",
                            parameter->name, (double)parameter->least, (double)parameter->most,
                            (double)-hairlut_largest_value, (double)hairlut_largest_value);
    if (!(parameter->standard >= parameter->least && parameter->standard <= parameter->most))
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "parameter '%s': standard %.9g: expected %.9g to %.9g",
                            parameter->name, (double)parameter->standard, (double)parameter->least, (double)parameter->most);
    return HAIRLUT_OK;
}

hairlut_result hairlut_validate_parameters(const hairlut_model_desc *desc, char *message)
{
    if (desc->parameter_count < 0 || desc->parameter_count > HAIRLUT_MAX_PARAMETERS)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "parameter_count is %d: expected 0 to %d",
                            desc->parameter_count, HAIRLUT_MAX_PARAMETERS);
    if (desc->parameter_count == 0)
        return HAIRLUT_OK;
    if (!desc->parameters)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "parameters is NULL: expected %d descriptors",
                            desc->parameter_count);
    hairlut_result result =
        hairlut_check_size("hairlut_parameter", desc->parameters->size, sizeof *desc->parameters, 0, message);
    for (int p = 0; p < desc->parameter_count && result == HAIRLUT_OK; ++p)
        result = validate_parameter(desc, p, message);
    return result;
}

/* ---- axes ----------------------------------------------------------------------------------------------------- */

static const hairlut_parameter_nodes *axis_at(const hairlut_parameter_nodes *axes, int a)
{
    return (const hairlut_parameter_nodes *)((const char *)axes + (size_t)a * axes->size);
}

size_t hairlut_node_count(const hairlut_parameter_nodes *axes, int axis_count)
{
    size_t nodes = 1;
    for (int a = 0; a < axis_count; ++a)
        nodes *= (size_t)axis_at(axes, a)->count;
    return nodes;
}

static hairlut_result validate_axis(const hairlut_parameter_nodes *axes, int a, char *message)
{
    const hairlut_parameter_nodes *axis = axis_at(axes, a);
    const hairlut_result result = hairlut_check_size("hairlut_parameter_nodes", axis->size, axes->size, 0, message);
    if (result != HAIRLUT_OK)
        return result;
    if (axis->parameter < 0 || axis->parameter >= HAIRLUT_MAX_PARAMETERS)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "axis %d: parameter is %d: expected 0 to %d", a,
                            axis->parameter, HAIRLUT_MAX_PARAMETERS - 1);
    for (int b = 0; b < a; ++b)
        if (axis_at(axes, b)->parameter == axis->parameter)
            return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                                "axes %d and %d are both of parameter %d: expected one axis of each", b, a, axis->parameter);
    if (axis->count < FEWEST_NODES || axis->count > MOST_NODES)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "axis %d (parameter %d): count is %d: expected %d to %d nodes",
                            a, axis->parameter, axis->count, (int)FEWEST_NODES, (int)MOST_NODES);
    if (!axis->values)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "axis %d (parameter %d): values is NULL: expected %d numbers",
                            a, axis->parameter, axis->count);
    for (int k = 0; k < axis->count; ++k)
        if (!(fabsf(axis->values[k]) <= hairlut_largest_value) ||
            (k > 0 && !(axis->values[k] - axis->values[k - 1] >= hairlut_narrowest_gap)))
            return hairlut_fail(HAIRLUT_ERROR_TABLE, message,
                                "axis %d (parameter %d), node %d is %.9g: expected increasing numbers from %g to %g", a,
                                axis->parameter, k, (double)axis->values[k], (double)-hairlut_largest_value,
                                (double)hairlut_largest_value);
    return HAIRLUT_OK;
}

hairlut_result hairlut_validate_axes(const hairlut_parameter_nodes *axes, int axis_count, char *message)
{
    if (axis_count < 0 || axis_count > HAIRLUT_MAX_AXES)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "axis_count is %d: expected 0 to %d", axis_count,
                            HAIRLUT_MAX_AXES);
    if (axis_count == 0)
        return HAIRLUT_OK;
    if (!axes)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "axes is NULL: expected %d descriptors", axis_count);
    hairlut_result result = hairlut_check_size("hairlut_parameter_nodes", axes->size, sizeof *axes, 0, message);
    for (int a = 0; a < axis_count && result == HAIRLUT_OK; ++a)
        result = validate_axis(axes, a, message);
    return result;
}

hairlut_result hairlut_match_axes(const char *owner, const hairlut_parameter_nodes *axes, int axis_count,
                                  const hairlut_model_desc *desc, char *message)
{
    for (int a = 0; a < axis_count; ++a) {
        const hairlut_parameter_nodes *axis = axis_at(axes, a);
        if (axis->parameter >= desc->parameter_count)
            return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                                "%s: axis %d: parameter is %d: expected one of the model's %d, from 0 on", owner, a,
                                axis->parameter, desc->parameter_count);
        const hairlut_parameter *parameter = parameter_at(desc, axis->parameter);
        const int last = axis->count - 1, is_low = axis->values[0] == parameter->least;
        if (!is_low || axis->values[last] != parameter->most)
            return hairlut_fail(HAIRLUT_ERROR_TABLE, message, "%s: axis '%s', node %d is %.9g: expected %.9g, its %s", owner,
                                parameter->name, is_low ? last : 0, (double)axis->values[is_low ? last : 0],
                                (double)(is_low ? parameter->most : parameter->least), is_low ? "most" : "least");
    }
    return HAIRLUT_OK;
}

/* ---- of models ------------------------------------------------------------------------------------------------ */

int hairlut_parameter_count(const hairlut_model *model)
{
    return model->strands ? model->strands->parameter_count : 0;
}

const char *hairlut_parameter_name(const hairlut_model *model, int parameter)
{
    return parameter >= 0 && parameter < hairlut_parameter_count(model) ? model->strands->names[parameter] : NULL;
}

int hairlut_parameter_index(const hairlut_model *model, const char *name)
{
    for (int p = 0; name && p < hairlut_parameter_count(model); ++p)
        if (strcmp(model->strands->names[p], name) == 0)
            return p;
    return -1;
}

int hairlut_parameter_range(const hairlut_model *model, int parameter, float *least, float *most, float *standard)
{
    if (parameter < 0 || parameter >= hairlut_parameter_count(model))
        return 0;
    const hairlut_strands *strands = model->strands;
    if (least)
        *least = strands->least[parameter];
    if (most)
        *most = strands->most[parameter];
    if (standard)
        *standard = strands->standard[parameter];
    return 1;
}
