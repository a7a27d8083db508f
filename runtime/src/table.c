/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables from memory: what one must fulfil, and the copy of it that is read. */
#include <math.h>

#include "angle.h"
#include "build.h"
#include "warp.h"

enum { MAX_SIDE = 4096, MAX_ROWS = 65536 /* of all nodes */, TEXEL = 2 /* floats: an angle and dx/du */ };

/* No cell is narrower: the product of two axes' densities and of 1/cos at the pole stays a float. */
static const float narrowest_cell = 1e-12f;
static const float least_slope = 1e-9f, largest_slope = 1e12f; /* rad per unit of u */

static hairlut_result validate_numbers(const hairlut_table *t, char *message)
{
    if (!t->texels)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "texels is NULL: expected width*height pairs of floats");
    if (t->width < 4 || t->height < 2 || t->width > MAX_SIDE || t->height > MAX_SIDE)
        return hairlut_fail(HAIRLUT_ERROR_TABLE, message,
                            "size is %dx%d: expected a width of 4 to %d and a height of 2 to %d", t->width, t->height,
                            (int)MAX_SIDE, (int)MAX_SIDE);
    if (!hairlut_within(t->theta_r_min, t->theta_r_max, -hairlut_two_pi, hairlut_two_pi) ||
        t->theta_r_max - t->theta_r_min < 1e-6f)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                            "theta_r_min %g, theta_r_max %g: expected increasing angles from -2 pi to 2 pi",
                            (double)t->theta_r_min, (double)t->theta_r_max);
    if (!hairlut_within(t->domain_min, t->domain_max, -hairlut_two_pi, hairlut_two_pi))
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                            "domain_min %g, domain_max %g: expected increasing angles from -2 pi to 2 pi",
                            (double)t->domain_min, (double)t->domain_max);
    if (t->warp != HAIRLUT_WARP_UNIFORM && t->warp != HAIRLUT_WARP_OCTAVES)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message,
                            "warp is %d: expected HAIRLUT_WARP_UNIFORM or HAIRLUT_WARP_OCTAVES", (int)t->warp);
    if (t->warp == HAIRLUT_WARP_OCTAVES && !(t->warp_e >= 1e-12f && t->warp_e <= 1.0f))
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "warp_e is %g: expected 1e-12 to 1", (double)t->warp_e);
    return hairlut_validate_axes(t->axes, t->axis_count, message);
}

/* Where row j of all stands, in a message. */
typedef struct row_name {
    char text[48];
} row_name;

static row_name name_row(const hairlut_table *t, int j)
{
    row_name name;
    if (t->axis_count > 0)
        snprintf(name.text, sizeof name.text, "node %d of the axes, row %d", j / t->height, j % t->height);
    else
        snprintf(name.text, sizeof name.text, "row %d", j);
    return name;
}

static hairlut_result validate_row(const hairlut_table *t, int j, char *message)
{
    const float *row = t->texels + (size_t)j * (size_t)t->width * TEXEL;
    const float first = row[0], last = row[(t->width - 1) * TEXEL];
    for (int i = 0; i + 1 < t->width; ++i)
        if (!(row[(i + 1) * TEXEL] - row[i * TEXEL] >= narrowest_cell))
            return hairlut_fail(HAIRLUT_ERROR_TABLE, message,
                                "%s, columns %d and %d: %.9g, %.9g: expected angles that increase by at least %g",
                                name_row(t, j).text, i, i + 1, (double)row[i * TEXEL], (double)row[(i + 1) * TEXEL],
                                (double)narrowest_cell);
    if (first != t->domain_min || last != t->domain_max)
        return hairlut_fail(HAIRLUT_ERROR_TABLE, message,
                            "%s runs from %.9g to %.9g: expected the whole domain, %.9g to %.9g", name_row(t, j).text,
                            (double)first, (double)last, (double)t->domain_min, (double)t->domain_max);
    for (int i = 0; i < t->width; ++i)
        if (!(row[i * TEXEL + 1] >= least_slope && row[i * TEXEL + 1] <= largest_slope))
            return hairlut_fail(HAIRLUT_ERROR_TABLE, message, "%s, column %d: dx/du is %.9g: expected %g to %g rad",
                                name_row(t, j).text, i, (double)row[i * TEXEL + 1], (double)least_slope,
                                (double)largest_slope);
    return HAIRLUT_OK;
}

hairlut_result hairlut_validate(const hairlut_table *table, char *message)
{
    if (!table)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "table is NULL");
    hairlut_result result =
        hairlut_check_size("hairlut_table", table->size, sizeof *table, sizeof(hairlut_table_2_0), message);
    if (result != HAIRLUT_OK)
        return result;
    const hairlut_table known = hairlut_known_table(table);
    result = validate_numbers(&known, message);
    if (result != HAIRLUT_OK)
        return result;
    const size_t nodes = hairlut_node_count(known.axes, known.axis_count);
    if (known.axis_count > 0 && nodes > (size_t)(MAX_ROWS / known.height))
        return hairlut_fail(HAIRLUT_ERROR_TABLE, message,
                            "%zu nodes of the axes, of %d rows each: expected at most %d rows in all", nodes, known.height,
                            (int)MAX_ROWS);
    for (int j = 0; result == HAIRLUT_OK && j < (int)nodes * known.height; ++j)
        result = validate_row(&known, j, message);
    return result;
}

/* A group of the texels of columns i, i + step and so on. */
static void store_group(float *stored, const float *row, const float *above, int width, int i, int step)
{
    const int size = HAIRLUT_GROUP_SIZE(width);
    for (int k = 0; k < size; ++k, i += step) {
        const int inner = i < width - 1;
        stored[k] = inner ? row[i * TEXEL] : HAIRLUT_NO_TEXEL;
        if (HAIRLUT_IS_SMALL(width))
            stored[size + k] = inner ? above[i * TEXEL] - row[i * TEXEL] : 0.0f;
    }
}

/* A row as internal.h lays it out. */
static void store_row(float *stored, const float *row, const float *above, int width)
{
    const int step = HAIRLUT_STEP(width), size = HAIRLUT_GROUP_SIZE(width);
    store_group(stored, row, above, width, step, step);
    for (int first = 0; first < HAIRLUT_WHOLE(width - 1, step); first += size)
        store_group(stored += HAIRLUT_LINE, row, above, width, first + 1, 1);
}

/* A row counted from one of its ends: m at its knots, and the texels. */
typedef struct row_view {
    const float *first;
    int step; /* floats from a texel to the next: TEXEL from the low end, -TEXEL from the high end */
    const double *knots;
} row_view;

/* D of one end of a cell: its slope in widths of the cell in m, bounded by the cell's width in x. */
static float bounded_slope(float slope, double h, float width)
{
    const float size = fabsf(width), d = (float)((double)slope * h);
    const float least = size / HAIRLUT_STEEPEST, most = size * HAIRLUT_STEEPEST;
    return copysignf(d < least ? least : d > most ? most : d, width);
}

static void store_cell(float *stored, const row_view *row, int k)
{
    const float *near_end = row->first + k * row->step, *far_end = near_end + row->step;
    const double h = row->knots[k + 1] - row->knots[k];
    const float width = far_end[0] - near_end[0];
    stored[0] = near_end[0];
    stored[1] = bounded_slope(near_end[1], h, width);
    stored[2] = width;
    stored[3] = bounded_slope(far_end[1], h, width);
}

/* The cells of row j of an axis; knots are those of its half, and two more. */
static void store_cells(const hairlut_axis *axis, float *cells, int j, const float *row, const double *knots)
{
    const row_view views[2] = {{row, TEXEL, knots}, {row + (axis->columns - 1) * TEXEL, -TEXEL, knots}};
    for (int end = 0; end < 2; ++end) {
        float *cell = cells + HAIRLUT_CELL * j + end * (axis->ends[1] - axis->ends[0]);
        for (int k = 0; k < HAIRLUT_HALF(axis->columns); ++k, cell += axis->pitch)
            store_cell(cell, &views[end], k);
    }
}

static void store_knots(float *stored, const double *knots, int count)
{
    for (int k = 0; k < count; ++k, stored += HAIRLUT_KNOT) {
        const double h = knots[k + 1] - knots[k];
        stored[0] = (float)knots[k];
        stored[1] = (float)(1.0 / h);
        stored[2] = (float)h * HAIRLUT_SCALE;
        stored[3] = 1.0f / stored[2];
    }
}

static void store_links(hairlut_link *links, const hairlut_axis *axis)
{
    for (int cell = 0; cell < axis->columns - 1; ++cell) {
        const int mirrored = axis->columns - 2 - cell, high = cell > mirrored, i = high ? mirrored : cell;
        links[cell].offset = (unsigned)(axis->ends[high] - axis->ends[0]) + (unsigned)(i * axis->pitch);
        links[cell].h = axis->knots[HAIRLUT_KNOT * i + 2];
    }
}

/* Floats in memory, whole cache lines */
static size_t rows_floats(const hairlut_table *t)
{
    return (size_t)HAIRLUT_STORED(t->width, t->height);
}

static size_t cells_floats(const hairlut_table *t)
{
    return (size_t)HAIRLUT_WHOLE(HAIRLUT_CELLS(t->width, t->height), HAIRLUT_LINE);
}

static size_t knots_floats(const hairlut_table *t)
{
    return (size_t)HAIRLUT_WHOLE(HAIRLUT_KNOT * HAIRLUT_HALF(t->width), HAIRLUT_LINE);
}

static size_t links_floats(const hairlut_table *t)
{
    return HAIRLUT_WHOLE((size_t)(t->width - 1) * sizeof(hairlut_link) / sizeof(float), HAIRLUT_LINE);
}

size_t hairlut_table_floats(const hairlut_table *t)
{
    return rows_floats(t) + cells_floats(t) + knots_floats(t) + links_floats(t);
}

static int rows_are_alike(const hairlut_table *t)
{
    const size_t row = (size_t)t->width * TEXEL;
    int alike = 1;
    for (int j = 1; j < t->height; ++j)
        alike &= memcmp(t->texels, t->texels + (size_t)j * row, row * sizeof *t->texels) == 0;
    return alike;
}

/* Whether blended texels increase from column to column at every theta_r as they are rounded. Then a search of a row as a whole
 * finds the cell that a search by blocks finds. A blend is of three roundings, of the change to the row above, of its part and of
 * the sum; what two neighbours lose together is less than the narrowest cell of a row. */
static int stays_sorted(const hairlut_table *t)
{
    const double low = t->domain_min, high = t->domain_max;
    const double lost = FLT_EPSILON * (2.0 * (high - low) + (high > -low ? high : -low));
    for (int j = 0; j < t->height; ++j) {
        const float *row = t->texels + (size_t)j * (size_t)t->width * TEXEL;
        for (int i = 0; i + 1 < t->width; ++i)
            if ((double)row[(i + 1) * TEXEL] - (double)row[i * TEXEL] < lost)
                return 0;
    }
    return 1;
}

/* The groups of a row that is searched as a whole. The last column is not stored. Those of nodes are blended once more. */
static int whole_groups(const hairlut_table *t)
{
    const int groups = HAIRLUT_WHOLE(t->width - 2, HAIRLUT_SMALL_GROUP) / HAIRLUT_SMALL_GROUP;
    const int few = groups >= HAIRLUT_LEAST_WHOLE && groups <= HAIRLUT_MOST_WHOLE;
    return few && t->axis_count == 0 && stays_sorted(t) ? groups : 0;
}

/* The fields of an axis that are numbers. */
static hairlut_axis describe(const hairlut_table *t, const hairlut_warp_scale *scale)
{
    const int octaves = t->warp == HAIRLUT_WARP_OCTAVES;
    const float k = (float)scale->k, f0 = (float)scale->f0;
    hairlut_axis axis;
    axis.rows = axis.ends[0] = axis.ends[1] = axis.knots = NULL;
    axis.links = NULL;
    axis.pitch = HAIRLUT_PITCH(t->height);
    axis.row_origin = t->theta_r_min;
    axis.row_scale = (float)((t->height - 1) / ((double)t->theta_r_max - (double)t->theta_r_min));
    axis.row_last = (float)(t->height - 1);
    axis.warp = (int)t->warp;
    axis.e = (float)scale->e;
    axis.scale = octaves ? HAIRLUT_SHIFT_SCALE / k : 1.0f / k;
    axis.origin = f0 * (1.0f / k);
    axis.low = t->domain_min;
    axis.high = t->domain_max;
    axis.columns = t->width;
    axis.height = t->height;
    axis.stride = HAIRLUT_STRIDE(t->width);
    axis.step = HAIRLUT_STEP(t->width);
    axis.groups = whole_groups(t);
    axis.grid = 0;
    axis.alike = rows_are_alike(t);
    return axis;
}

void hairlut_build_axis(hairlut_axis *axis, const hairlut_table *t, float *memory)
{
    float *rows = memory, *cells = rows + rows_floats(t), *columns = cells + cells_floats(t);
    hairlut_link *links = (hairlut_link *)(void *)(columns + knots_floats(t));
    const hairlut_warp_scale scale = hairlut_scale_warp(t->warp, t->warp_e, t->width);
    const int half = HAIRLUT_HALF(t->width);
    double knots[MAX_SIDE / 2 + 2]; /* of a half, one cell beyond its middle */
    *axis = describe(t, &scale);
    axis->rows = rows;
    axis->ends[0] = cells;
    axis->ends[1] = cells + (size_t)half * (size_t)axis->pitch;
    axis->knots = columns;
    axis->links = links;
    for (int k = 0; k <= half; ++k)
        knots[k] = hairlut_warp_u(t->warp, &scale, t->width, k);
    store_knots(columns, knots, half);
    store_links(links, axis);
    for (int j = 0; j <= t->height; ++j) {
        const float *row = t->texels + (size_t)(j < t->height ? j : t->height - 1) * (size_t)t->width * TEXEL;
        const float *above = j + 1 < t->height ? row + t->width * TEXEL : row;
        store_row(rows + (size_t)j * (size_t)axis->stride, row, above, t->width);
        store_cells(axis, cells, j, row, knots);
    }
}

/* All that is stored is linear in the texels but for the bounds of slopes, which are those of the nodes' own cells. */
static void blend_floats(float *blend, size_t count, const hairlut_spacing *nodes, const hairlut_corners *corners)
{
    const float *first = blend + (corners->node + 1) * nodes->pitch;
    for (size_t k = 0; k < count; ++k) {
        double sum = 0.0;
        for (int c = 0; c < nodes->count; ++c)
            sum += (double)corners->weight[c] * (double)first[(ptrdiff_t)k + nodes->corner[c]];
        if (blend[k] != HAIRLUT_NO_TEXEL)
            blend[k] = (float)sum;
    }
}

void hairlut_blend_axis(const hairlut_axis *axis, float *memory, const hairlut_spacing *nodes,
                        const hairlut_corners *corners)
{
    blend_floats(memory, (size_t)HAIRLUT_STORED(axis->columns, axis->height), nodes, corners);
    blend_floats(memory + (axis->ends[0] - axis->rows), (size_t)HAIRLUT_CELLS(axis->columns, axis->height), nodes, corners);
}
