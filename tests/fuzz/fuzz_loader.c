/* libFuzzer target: the input is a table file. */
#include <openexr.h>
#include <string.h>

#include "check.h"
#include "exr_table.h"

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

/* A model whose other tables are straight lines. */
static void use(const hairlut_exr_table *loaded, int is_azimuth)
{
    static const float theta[8] = {-1.57079637f, -0.5f, 0.5f, 1.57079637f, -1.57079637f, -0.5f, 0.5f, 1.57079637f};
    static const float phi[8] = {0.0f, 2.0f, 4.0f, 6.28318548f, 0.0f, 2.0f, 4.0f, 6.28318548f};
    const hairlut_table straight = {theta, 4, 2, -1.5f, 1.5f, theta[0], theta[3], HAIRLUT_WARP_OCTAVES, 1e-6f, 0.9f};
    const hairlut_table circle = {phi, 4, 2, -1.5f, 1.5f, phi[0], phi[3], HAIRLUT_WARP_UNIFORM, 0.0f, 0.0f};
    const hairlut_model_desc desc = {is_azimuth ? straight : loaded->table, is_azimuth ? loaded->table : circle,
                                     is_azimuth ? straight : loaded->table, loaded->azimuth};
    hairlut_model *model;
    char message[HAIRLUT_MESSAGE_SIZE];
    if (hairlut_model_create(&desc, NULL, &model, message) != HAIRLUT_OK)
        return;
    check_model(model);
    hairlut_free(model);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const hairlut_exr_kind theta = {"direct_theta", "theta_i", 0}, phi = {"direct_phi", "phi", 1};
    blob file = {data, size};
    exr_context_initializer_t source = EXR_DEFAULT_CONTEXT_INITIALIZER;
    source.user_data = &file;
    source.read_fn = blob_read;
    source.size_fn = blob_size;
    const int is_azimuth = mentions(&file, "direct_phi");
    hairlut_allocator allocator;
    hairlut_exr_table table;
    char message[HAIRLUT_MESSAGE_SIZE];
    memset(message, 'x', sizeof message);
    hairlut_choose_allocator(NULL, &allocator, message);
    const hairlut_result result = hairlut_exr_read_table(is_azimuth ? &phi : &theta, "fuzz.exr", &source, &allocator, &table,
                                                         message);
    if (result == HAIRLUT_OK)
        use(&table, is_azimuth);
    else
        REQUIRE(memchr(message, '\0', sizeof message) && strncmp(message, "fuzz.exr: ", 10) == 0);
    hairlut_release(&allocator, table.texels);
    return 0;
}
