/* libFuzzer target: the input is the numbers of a table in memory, of a mixture, and of a draw, then the texels and the
 * mixture's grid: as they are, or as bytes of which sound ones are made, so that many inputs pass validation. */
#include <string.h>

#include "check.h"
#include "straight.h"

enum { MOST_WIDTH = 64, MOST_HEIGHT = 16, MOST_NODES = 6, MOST_LOBES = 4, GRID = MOST_LOBES * MOST_NODES * MOST_NODES };

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

/* A row of cells whose widths are the next bytes' powers of two, stretched over the domain, with slopes likewise. */
static void grow_row(reader *r, float *row, int width, float low, float high)
{
    double total = 0.0, sum = 0.0, widths[MOST_WIDTH];
    for (int i = 0; i + 1 < width; ++i)
        total += widths[i] = ldexp(1.0, -(take_byte(r) % 40));
    for (int i = 0; i < width; ++i) {
        row[2 * i] = i == 0 ? low : i == width - 1 ? high : (float)(low + (high - low) * (sum / total));
        row[2 * i + 1] = ldexpf(1.0f, take_byte(r) % 68 - 29);
        sum += widths[i];
    }
}

static hairlut_table take_table(reader *r, float *texels)
{
    const uint8_t flags = take_byte(r);
    hairlut_table t = {sizeof t, texels, take_byte(r) % (MOST_WIDTH + 1), take_byte(r) % (MOST_HEIGHT + 1), -1.57079637f, 1.57079637f,
                       -1.57079637f, 1.57079637f, HAIRLUT_WARP_OCTAVES, 3.8e-6f};
    if (flags & 1)
        t.theta_r_min = take_float(r), t.theta_r_max = take_float(r);
    if (flags & 2)
        t.domain_min = take_float(r), t.domain_max = take_float(r);
    if (flags & 4)
        t.warp = (hairlut_warp)(take_byte(r) % 3);
    if (flags & 8)
        t.warp_e = take_float(r);
    for (int j = 0; j < t.height && t.width > 1; ++j) {
        if (flags & 16)
            take(r, texels + 2 * j * t.width, 2 * sizeof(float) * (size_t)t.width);
        else
            grow_row(r, texels + 2 * j * t.width, t.width, t.domain_min, t.domain_max);
    }
    return t;
}

/* Increasing, unless they are taken as they are. */
static void take_nodes(reader *r, float *nodes, int count, int as_they_are)
{
    for (int k = 0; k < count; ++k)
        nodes[k] = as_they_are ? take_float(r) : (float)(16 * k + take_byte(r) % 16) / (16.0f * MOST_NODES);
}

typedef struct mixture {
    float theta_r[MOST_NODES], offset[MOST_NODES], share[GRID], turn[GRID];
} mixture;

static hairlut_mixture_desc take_mixture(reader *r, mixture *m, int lobe_count)
{
    const uint8_t flags = take_byte(r);
    hairlut_mixture_desc desc = {sizeof desc, take_byte(r) % (MOST_NODES + 1), take_byte(r) % (MOST_NODES + 1), m->theta_r, m->offset,
                                 m->share, m->turn, flags & 1 ? take_byte(r) : flags >> 7};
    take_nodes(r, m->theta_r, desc.theta_r_count, flags & 2);
    take_nodes(r, m->offset, desc.offset_count, flags & 4);
    for (int k = 0; k < lobe_count * desc.theta_r_count * desc.offset_count; ++k) {
        m->share[k] = flags & 8 ? take_float(r) : ldexpf(take_byte(r) % 4 ? 1.0f : 0.0f, take_byte(r) - 128);
        m->turn[k] = flags & 16 ? take_float(r) : (float)(take_byte(r) - 128) * 0.19f;
    }
    if (flags & 32)
        desc.share = NULL;
    if (flags & 64)
        desc.turn = NULL;
    return desc;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const names[MOST_LOBES] = {"direct", "multiple", "third", "fourth"};
    static float texels[2 * MOST_WIDTH * MOST_HEIGHT];
    static mixture storage;
    reader r = {data, size};
    draw_inputs in = {NULL, 0, 0, 0, 0, 0, 0};
    float shares[HAIRLUT_MAX_LOBES] = {0.0f};
    const uint8_t flags = take_byte(&r);
    const int lobe_count = 1 + flags % MOST_LOBES;
    take(&r, &in.theta_r, 6 * sizeof(float));
    for (int k = 0; k < lobe_count && flags & 4; ++k)
        shares[k] = take_float(&r);
    const hairlut_table table = take_table(&r, texels);
    const hairlut_mixture_desc mixed = take_mixture(&r, &storage, lobe_count);
    hairlut_lobe_desc lobes[MOST_LOBES];
    for (int k = 0; k < lobe_count; ++k) {
        const hairlut_lobe_desc lobe = {sizeof lobe, names[k], k % 2 ? &straight_theta : &table, k % 3 == 1 ? NULL : &straight_phi,
                                        flags & 8 ? HAIRLUT_AZIMUTH_SUM : HAIRLUT_AZIMUTH_DIFFERENCE};
        lobes[k] = lobe;
    }
    const hairlut_model_desc desc = {sizeof desc, lobe_count, lobes, flags & 16 ? NULL : &mixed};
    hairlut_model *model;
    char message[HAIRLUT_MESSAGE_SIZE];
    const hairlut_result valid = hairlut_validate(&table, message), result = hairlut_model_create(&desc, NULL, &model, message);
    REQUIRE(valid == HAIRLUT_OK || result == valid);
    REQUIRE((result == HAIRLUT_OK) == (model != NULL));
    if (!model)
        return 0;
    check_model(model);
    check_inputs(model, &in);
    in.shares = shares;
    check_hair(model, &in);
    hairlut_free(model);
    return 0;
}
