/* libFuzzer target: the input is the numbers of a table in memory, then its texels: as they are, or as the widths of
 * cells, so that many inputs pass validation. */
#include <string.h>

#include "check.h"

typedef struct reader {
    const uint8_t *data;
    size_t size;
} reader;

/* The next bytes, or zeros behind the end. */
static void take(reader *r, void *value, size_t size)
{
    memset(value, 0, size);
    const size_t count = size < r->size ? size : r->size;
    if (count)
        memcpy(value, r->data, count);
    r->data += count;
    r->size -= count;
}

static float take_float(reader *r)
{
    float value;
    take(r, &value, sizeof value);
    return value;
}

static uint8_t take_byte(reader *r)
{
    uint8_t value;
    take(r, &value, 1);
    return value;
}

/* A row of cells whose widths are the next bytes' powers of two, stretched over the domain. */
static void grow_row(reader *r, float *row, int width, float low, float high)
{
    double total = 0.0, sum = 0.0, widths[64];
    for (int i = 0; i + 1 < width; ++i)
        total += widths[i] = ldexp(1.0, -(take_byte(r) % 40));
    for (int i = 0; i < width; ++i) {
        row[i] = (float)(low + (high - low) * (sum / total));
        sum += widths[i];
    }
    row[0] = low;
    row[width - 1] = high;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const float phi[8] = {0.0f, 2.0f, 4.0f, 6.28318548f, 0.0f, 2.0f, 4.0f, 6.28318548f};
    static float texels[64 * 16];
    reader r = {data, size};
    hairlut_table t;
    const uint8_t flags = take_byte(&r);
    t.texels = texels;
    t.width = take_byte(&r) % 65;
    t.height = take_byte(&r) % 17;
    t.theta_r_min = flags & 1 ? take_float(&r) : -1.57079637f;
    t.theta_r_max = flags & 1 ? take_float(&r) : 1.57079637f;
    t.domain_min = flags & 2 ? take_float(&r) : -1.57079637f;
    t.domain_max = flags & 2 ? take_float(&r) : 1.57079637f;
    t.warp = flags & 4 ? (hairlut_warp)(take_byte(&r) % 3) : HAIRLUT_WARP_OCTAVES;
    t.warp_e = flags & 8 ? take_float(&r) : 3.8e-6f;
    t.cell_limit = flags & 16 ? take_float(&r) : 0.9f;
    const float theta_r = take_float(&r), phi_r = take_float(&r), u_theta = take_float(&r), u_phi = take_float(&r);
    for (int j = 0; j < t.height && t.width > 1; ++j) {
        if (flags & 32)
            take(&r, texels + j * t.width, sizeof(float) * (size_t)t.width);
        else
            grow_row(&r, texels + j * t.width, t.width, t.domain_min, t.domain_max);
    }
    const hairlut_table circle = {phi, 4, 2, -1.5f, 1.5f, phi[0], phi[3], HAIRLUT_WARP_OCTAVES, 1e-6f, 0.9f};
    const hairlut_model_desc desc = {t, circle, t, flags & 64 ? HAIRLUT_AZIMUTH_SUM : HAIRLUT_AZIMUTH_DIFFERENCE};
    hairlut_model *model;
    char message[HAIRLUT_MESSAGE_SIZE];
    const hairlut_result valid = hairlut_validate(&t, message), result = hairlut_model_create(&desc, NULL, &model, message);
    REQUIRE(valid == HAIRLUT_OK || result == valid);
    REQUIRE((result == HAIRLUT_OK) == (model != NULL));
    if (!model)
        return 0;
    check_model(model);
    check_direction(model, theta_r, phi_r, u_theta, u_phi);
    hairlut_free(model);
    return 0;
}
