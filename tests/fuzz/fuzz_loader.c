/* libFuzzer target: the input is a file of a model: a table, of either format, or a mixture. */
#include <openexr.h>
#include <string.h>

#include "check.h"
#include "exr_mixture.h"
#include "straight.h"

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

/* A model of the table. */
static void use_table(const hairlut_table *table, hairlut_azimuth azimuth, int is_azimuth)
{
    const hairlut_lobe_desc lobe = {sizeof lobe, "only", is_azimuth ? &straight_theta : table, is_azimuth ? table : &straight_phi, azimuth};
    const hairlut_model_desc desc = {sizeof desc, 1, &lobe, NULL};
    hairlut_model *model;
    if (hairlut_model_create(&desc, NULL, &model, NULL) != HAIRLUT_OK)
        return;
    check_model(model);
    hairlut_free(model);
}

/* A model of the mixture, whose tables are straight. */
static void use_mixture(const hairlut_exr_mixture *mixture)
{
    hairlut_lobe_desc lobes[HAIRLUT_MAX_LOBES];
    for (int k = 0; k < mixture->lobe_count; ++k) {
        const hairlut_lobe_desc lobe = {sizeof lobe, mixture->lobes[k].name, &straight_theta,
                                        mixture->lobes[k].phi.table[0] ? &straight_phi : NULL, HAIRLUT_AZIMUTH_DIFFERENCE};
        lobes[k] = lobe;
    }
    const hairlut_model_desc desc = {sizeof desc, mixture->lobe_count, lobes, &mixture->desc};
    hairlut_model *model;
    if (hairlut_model_create(&desc, NULL, &model, NULL) != HAIRLUT_OK)
        return;
    check_model(model);
    hairlut_free(model);
}

static void check_message(hairlut_result result, const char *message)
{
    if (result != HAIRLUT_OK)
        REQUIRE(memchr(message, '\0', HAIRLUT_MESSAGE_SIZE) && strncmp(message, "fuzz.exr: ", 10) == 0);
}

static void read_table(const blob *file, const exr_context_initializer_t *source, const hairlut_allocator *allocator)
{
    const int is_azimuth = mentions(file, "direct_phi"), format = mentions(file, "rational quadratic") ? 2 : 1;
    const hairlut_exr_kind kind = {is_azimuth ? "direct_phi" : "direct_theta", is_azimuth, format, "for the test"};
    hairlut_exr_table table;
    char message[HAIRLUT_MESSAGE_SIZE];
    memset(message, 'x', sizeof message);
    const hairlut_result result = hairlut_exr_read_table(&kind, "fuzz.exr", source, allocator, &table, message);
    check_message(result, message);
    if (result == HAIRLUT_OK)
        use_table(&table.table, table.azimuth, is_azimuth);
    hairlut_release(allocator, table.texels);
}

static void read_mixture(const exr_context_initializer_t *source, const hairlut_allocator *allocator)
{
    hairlut_exr_mixture mixture;
    char message[HAIRLUT_MESSAGE_SIZE];
    memset(message, 'x', sizeof message);
    const hairlut_result result = hairlut_exr_read_mixture("fuzz.exr", source, allocator, &mixture, message);
    check_message(result, message);
    if (result == HAIRLUT_OK)
        use_mixture(&mixture);
    hairlut_release(allocator, mixture.memory);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    blob file = {data, size};
    exr_context_initializer_t source = EXR_DEFAULT_CONTEXT_INITIALIZER;
    hairlut_allocator allocator;
    source.user_data = &file;
    source.read_fn = blob_read;
    source.size_fn = blob_size;
    hairlut_choose_allocator(NULL, &allocator, NULL);
    if (mentions(&file, "hairlut.lobes"))
        read_mixture(&source, &allocator);
    else
        read_table(&file, &source, &allocator);
    return 0;
}
