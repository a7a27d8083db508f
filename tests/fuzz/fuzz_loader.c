/* SPDX-License-Identifier: BSD-3-Clause */
/* libFuzzer target: the input is a table file of either format, or a mixture.exr. */
#include <openexr.h>
#include <string.h>

#include "check.h"
#include "exr_mixture.h"

typedef struct blob {
    const uint8_t *data;
    size_t size;
} blob;

static int64_t blob_size(exr_const_context_t context, void *user)
{
    (void)context;
    return (int64_t)((const blob *)user)->size;
}

static int64_t blob_read(exr_const_context_t context, void *user, void *buffer, uint64_t size, uint64_t offset,
                         exr_stream_error_func_ptr_t report)
{
    const blob *b = user;
    (void)context;
    (void)report;
    if (offset >= b->size)
        return 0;
    const size_t rest = b->size - (size_t)offset, count = size < rest ? (size_t)size : rest;
    memcpy(buffer, b->data + offset, count);
    return (int64_t)count;
}

static int mentions(const blob *b, const char *word)
{
    const size_t length = strlen(word);
    for (size_t k = 0; k + length <= b->size; ++k)
        if (memcmp(b->data + k, word, length) == 0)
            return 1;
    return 0;
}

static const float theta[16] = {-1.57079637f, 1.0f, -0.5f, 1.0f, 0.5f, 1.0f, 1.57079637f, 1.0f,
                                -1.57079637f, 1.0f, -0.5f, 1.0f, 0.5f, 1.0f, 1.57079637f, 1.0f};
static const hairlut_table straight = {sizeof straight,      theta, 4, 2,   -1.5f, 1.5f, -1.57079637f, 1.57079637f,
                                       HAIRLUT_WARP_OCTAVES, 1e-6f, 0, NULL};

/* Those of the corpus' tables (tests/conformance/files.py) */
static const hairlut_exr_parameters parameters = {3,
                                                  {"beta_m", "absorption", "tilt"},
                                                  {{sizeof(hairlut_parameter), "beta_m", 0.1f, 0.9f, 0.3f},
                                                   {sizeof(hairlut_parameter), "absorption", 0.0f, 5.0f, 0.5f},
                                                   {sizeof(hairlut_parameter), "tilt", -4.0f, 4.0f, -1.0f}}};

/* A model of these lobes: tables that were accepted give one; a mixture's shares and turns are checked here. */
static void use(const hairlut_model_desc *desc, int is_mixture)
{
    hairlut_model *model;
    char message[HAIRLUT_MESSAGE_SIZE];
    const hairlut_result result = hairlut_model_create(desc, NULL, &model, message);
    REQUIRE(result == HAIRLUT_OK || (is_mixture && result == HAIRLUT_ERROR_TABLE));
    if (!model)
        return;
    check_model(model);
    hairlut_free(model);
}

static hairlut_result load_table(const blob *file, const exr_context_initializer_t *source,
                                 const hairlut_allocator *allocator, char *message)
{
    const int is_azimuth = mentions(file, "direct_phi");
    const hairlut_exr_kind kind = {is_azimuth ? "direct_phi" : "direct_theta", is_azimuth, mentions(file, "dxdu") ? 2 : 1,
                                   "as told", &parameters};
    static hairlut_exr_table table;
    const hairlut_result result = hairlut_exr_read_table(&kind, "fuzz.exr", source, allocator, &table, message);
    if (result == HAIRLUT_OK) {
        const hairlut_lobe_desc lobe = {sizeof lobe, "lobe", is_azimuth ? &straight : &table.table,
                                        is_azimuth ? &table.table : NULL, table.azimuth};
        const hairlut_model_desc desc = {sizeof desc, 1, &lobe, NULL, parameters.count, parameters.list};
        use(&desc, 0);
    }
    hairlut_release(allocator, table.texels);
    return result;
}

static hairlut_result load_mixture(const exr_context_initializer_t *source, const hairlut_allocator *allocator,
                                   char *message)
{
    static hairlut_exr_mixture mixture;
    const hairlut_result result = hairlut_exr_read_mixture("fuzz.exr", source, allocator, &mixture, message);
    hairlut_lobe_desc lobes[HAIRLUT_MAX_LOBES];
    for (int k = 0; k < mixture.lobe_count; ++k) {
        const hairlut_lobe_desc lobe = {sizeof lobe, mixture.lobes[k].name, &straight, NULL, HAIRLUT_AZIMUTH_SUM};
        lobes[k] = lobe;
    }
    if (result == HAIRLUT_OK) {
        const hairlut_model_desc desc = {sizeof desc,   mixture.lobe_count,       lobes,
                                         &mixture.desc, mixture.parameters.count, mixture.parameters.list};
        use(&desc, 1);
    }
    hairlut_release(allocator, mixture.memory);
    return result;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    blob file = {data, size};
    exr_context_initializer_t source = EXR_DEFAULT_CONTEXT_INITIALIZER;
    hairlut_allocator allocator;
    char message[HAIRLUT_MESSAGE_SIZE];
    source.user_data = &file;
    source.read_fn = blob_read;
    source.size_fn = blob_size;
    memset(message, 'x', sizeof message);
    hairlut_choose_allocator(NULL, &allocator, message);
    const hairlut_result result = mentions(&file, "hairlut.lobes") ? load_mixture(&source, &allocator, message)
                                                                   : load_table(&file, &source, &allocator, message);
    REQUIRE(result == HAIRLUT_OK || (memchr(message, '\0', sizeof message) && strncmp(message, "fuzz.exr: ", 10) == 0));
    return 0;
}
