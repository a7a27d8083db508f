/* SPDX-License-Identifier: BSD-3-Clause */
/* OpenEXR files through OpenEXRCore: opening, what is checked before anything is decoded, attributes. */
#include "exr_file.h"

#include "exr_compression.h"
#include "exr_digest.h"
#include "exr_utf8.h"

hairlut_result hairlut_exr_fail(const hairlut_exr_file *file, hairlut_result result, const char *format, ...)
{
    if (file->message) {
        const int length = snprintf(file->message, HAIRLUT_MESSAGE_SIZE, "%s: ", file->name);
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(file->message + length, (size_t)(HAIRLUT_MESSAGE_SIZE - length), format, arguments);
        va_end(arguments);
    }
    return result;
}

/* The first 60 bytes of a text on one line. */
static void show(char shown[61], hairlut_exr_text text)
{
    size_t length = 0;
    for (; length < 60 && length < hairlut_exr_length(text); ++length)
        shown[length] = text.begin[length] >= ' ' && text.begin[length] <= '~' ? text.begin[length] : '?';
    shown[length] = '\0';
}

hairlut_result hairlut_exr_fail_text(const hairlut_exr_file *file, const char *attribute, hairlut_exr_text text,
                                     const char *expected)
{
    char shown[61];
    show(shown, text);
    return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE, "%s is '%s': expected %s; bake the model again", attribute, shown,
                            expected);
}

/* OpenEXR prints to stderr unless it is given somewhere else to report to; its codes say enough. */
static void ignore_report(exr_const_context_t context, exr_result_t code, const char *text)
{
    (void)context;
    (void)code;
    (void)text;
}

/* `what` says what was being read. */
static hairlut_result fail_exr(const hairlut_exr_file *file, exr_result_t code, const char *what)
{
    const char *reason = exr_get_default_error_message(code);
    if (code == EXR_ERR_OUT_OF_MEMORY)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_MEMORY, "%s: %s", what, reason);
    return hairlut_exr_fail(file, HAIRLUT_ERROR_FILE, "%s: %s: expected a whole OpenEXR image; bake the model again", what,
                            reason);
}

void hairlut_exr_name(hairlut_exr_file *file, const char *path, char *message)
{
    const size_t length = strlen(path), most = sizeof file->name - 1;
    memset(file, 0, sizeof *file);
    file->message = message;
    if (length <= most)
        memcpy(file->name, path, length + 1);
    else
        snprintf(file->name, sizeof file->name, "...%s", path + length - (most - 3));
}

/* ---- layout --------------------------------------------------------------------------------------------------- */

static hairlut_result check_compression(const hairlut_exr_file *file, int compression)
{
    if (hairlut_exr_is_allowed(compression))
        return HAIRLUT_OK;
    return hairlut_exr_fail(file, HAIRLUT_ERROR_UNSUPPORTED,
                            "compression is %s (number %d): expected NONE, RLE, ZIPS or ZIP; write it with ZIP",
                            hairlut_exr_compression_name(compression), compression);
}

static hairlut_result check_parts(const hairlut_exr_file *file)
{
    int parts = 0;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    exr_result_t code = exr_get_count(file->context, &parts);
    if (code == EXR_ERR_SUCCESS && parts != 1)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                "it has %d parts: expected one; write each table to its own file", parts);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_storage(file->context, 0, &storage);
    if (code != EXR_ERR_SUCCESS)
        return fail_exr(file, code, "header");
    if (storage != EXR_STORAGE_SCANLINE)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                "type is %s: expected scanlines; write it without tiles or deep data",
                                storage == EXR_STORAGE_TILED ? "tiled" : "deep");
    exr_compression_t compression = EXR_COMPRESSION_LAST_TYPE;
    code = exr_get_compression(file->context, 0, &compression);
    return code == EXR_ERR_SUCCESS ? check_compression(file, (int)compression) : fail_exr(file, code, "compression");
}

static hairlut_result check_windows(hairlut_exr_file *file)
{
    exr_attr_box2i_t data, display;
    exr_result_t code = exr_get_data_window(file->context, 0, &data);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_display_window(file->context, 0, &display);
    if (code != EXR_ERR_SUCCESS)
        return fail_exr(file, code, "dataWindow");
    if (data.min.x != 0 || data.min.y != 0)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                "dataWindow starts at (%d, %d): expected (0, 0); do not crop the file", data.min.x,
                                data.min.y);
    if (display.min.x != 0 || display.min.y != 0 || display.max.x != data.max.x || display.max.y != data.max.y)
        return hairlut_exr_fail(
            file, HAIRLUT_ERROR_ATTRIBUTE,
            "displayWindow is (%d, %d) to (%d, %d): expected the dataWindow, (0, 0) to (%d, %d); do not crop the file",
            display.min.x, display.min.y, display.max.x, display.max.y, data.max.x, data.max.y);
    file->width = data.max.x < HAIRLUT_EXR_LARGEST_SIDE ? data.max.x + 1 : HAIRLUT_EXR_LARGEST_SIDE + 1;
    file->height = data.max.y < HAIRLUT_EXR_MOST_ROWS ? data.max.y + 1 : HAIRLUT_EXR_MOST_ROWS + 1;
    return HAIRLUT_OK;
}

static hairlut_exr_text text_of(const char *begin, int32_t length)
{
    const hairlut_exr_text text = {begin, begin + length};
    return text;
}

static int is_text(const exr_attribute_t *attribute)
{
    return hairlut_exr_is_utf8(text_of(attribute->name, attribute->name_length)) &&
           (attribute->type != EXR_ATTR_STRING || attribute->string->length == 0 ||
            hairlut_exr_is_utf8(text_of(attribute->string->str, attribute->string->length)));
}

/* Also of attributes that this library does not read. */
static hairlut_result check_text(const hairlut_exr_file *file)
{
    int32_t count = 0;
    exr_result_t code = exr_get_attribute_count(file->context, 0, &count);
    for (int32_t k = 0; k < count; ++k) {
        const exr_attribute_t *attribute = NULL;
        code = exr_get_attribute_by_index(file->context, 0, EXR_ATTR_LIST_FILE_ORDER, k, &attribute);
        if (code != EXR_ERR_SUCCESS)
            break;
        if (!is_text(attribute))
            return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                    "attribute number %d: expected text in UTF-8, in an OpenEXR image; bake the model again",
                                    (int)k);
    }
    return code == EXR_ERR_SUCCESS ? HAIRLUT_OK : fail_exr(file, code, "header");
}

hairlut_result hairlut_exr_check_size(const hairlut_exr_file *file, int least_width)
{
    const int width = HAIRLUT_EXR_LARGEST_SIDE, height = HAIRLUT_EXR_MOST_ROWS, texels = HAIRLUT_EXR_MOST_TEXELS;
    if (file->width < least_width || file->width > width || file->height > height || file->width > texels / file->height)
        return hairlut_exr_fail(
            file, HAIRLUT_ERROR_TABLE,
            "size is %d x %d%s: expected %d to %d columns, at most %d rows and %d texels; bake the model "
            "again",
            file->width, file->height, file->width > width || file->height > height ? " or more" : "", least_width, width,
            height, texels);
    return HAIRLUT_OK;
}

hairlut_result hairlut_exr_open(hairlut_exr_file *file, const char *path, const exr_context_initializer_t *source,
                                char *message)
{
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    if (source)
        initializer = *source;
    initializer.error_handler_fn = ignore_report;
    hairlut_exr_name(file, path, message);
    const exr_result_t code = exr_start_read(&file->context, path, &initializer);
    file->missing = code == EXR_ERR_FILE_ACCESS;
    if (file->missing)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_FILE,
                                "cannot be opened: expected a file; check the directory, or bake the model");
    const int named = hairlut_exr_named_compression(path, source);
    hairlut_result result = named >= 0 ? check_compression(file, named) : HAIRLUT_OK;
    if (result != HAIRLUT_OK)
        return result;
    if (code != EXR_ERR_SUCCESS || named < 0)
        return fail_exr(file, code == EXR_ERR_SUCCESS ? EXR_ERR_READ_IO : code, "header");
    result = check_parts(file);
    if (result == HAIRLUT_OK)
        result = check_text(file);
    return result == HAIRLUT_OK ? check_windows(file) : result;
}

void hairlut_exr_close(hairlut_exr_file *file)
{
    if (file->context)
        exr_finish(&file->context);
}

/* ---- attributes ----------------------------------------------------------------------------------------------- */

static hairlut_result fail_attribute(const hairlut_exr_file *file, exr_result_t code, const char *attribute,
                                     const char *type)
{
    if (code == EXR_ERR_NO_ATTR_BY_NAME)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                "%s is missing: expected an attribute of type %s; bake the model again", attribute, type);
    return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE, "%s is not of type %s, as expected; bake the model again",
                            attribute, type);
}

int hairlut_exr_has(const hairlut_exr_file *file, const char *attribute)
{
    const exr_attribute_t *found = NULL;
    return exr_get_attribute_by_name(file->context, 0, attribute, &found) == EXR_ERR_SUCCESS;
}

int hairlut_exr_attribute(const hairlut_exr_file *file, int index, hairlut_exr_text *name)
{
    const exr_attribute_t *found = NULL;
    if (exr_get_attribute_by_index(file->context, 0, EXR_ATTR_LIST_FILE_ORDER, index, &found) != EXR_ERR_SUCCESS)
        return 0;
    *name = text_of(found->name, found->name_length);
    return 1;
}

hairlut_result hairlut_exr_int(const hairlut_exr_file *file, const char *attribute, int *value)
{
    int32_t stored = 0;
    const exr_result_t code = exr_attr_get_int(file->context, 0, attribute, &stored);
    if (code != EXR_ERR_SUCCESS)
        return fail_attribute(file, code, attribute, "int");
    *value = (int)stored;
    return HAIRLUT_OK;
}

hairlut_result hairlut_exr_string(const hairlut_exr_file *file, const char *attribute, hairlut_exr_text *value)
{
    int32_t length = 0;
    const char *begin = NULL;
    value->begin = value->end = "";
    const exr_result_t code = exr_attr_get_string(file->context, 0, attribute, &length, &begin);
    if (code != EXR_ERR_SUCCESS)
        return fail_attribute(file, code, attribute, "string");
    if (begin) {
        value->begin = begin;
        value->end = begin + length;
    }
    return HAIRLUT_OK;
}

hairlut_result hairlut_exr_expect(const hairlut_exr_file *file, const char *attribute, const char *word)
{
    hairlut_exr_text text;
    char expected[80];
    const hairlut_result result = hairlut_exr_string(file, attribute, &text);
    if (result != HAIRLUT_OK || hairlut_exr_equals(text, word))
        return result;
    snprintf(expected, sizeof expected, "'%s'", word);
    return hairlut_exr_fail_text(file, attribute, text, expected);
}

hairlut_result hairlut_exr_expect_format(const hairlut_exr_file *file, int format, const char *why)
{
    enum { NEWEST = 2 };
    int found = 0;
    const hairlut_result result = hairlut_exr_int(file, "hairlut.format", &found);
    if (result != HAIRLUT_OK || found == format)
        return result;
    if (found > NEWEST)
        return hairlut_exr_fail(
            file, HAIRLUT_ERROR_VERSION,
            "hairlut.format is %d: expected at most %d; use a newer hairlut library, or bake the model again", found,
            (int)NEWEST);
    return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE, "hairlut.format is %d: expected %d, %s; bake the model again",
                            found, format, why);
}

hairlut_result hairlut_exr_model(const hairlut_exr_file *file, char model[HAIRLUT_EXR_MODEL_SIZE])
{
    hairlut_exr_text text;
    const hairlut_result result = hairlut_exr_string(file, "hairlut.model", &text);
    if (result != HAIRLUT_OK)
        return result;
    int printable = 1;
    for (const char *c = text.begin; c < text.end; ++c)
        printable = printable && *c >= ' ' && *c <= '~';
    if (!printable || hairlut_exr_length(text) == 0 || hairlut_exr_length(text) >= HAIRLUT_EXR_MODEL_SIZE)
        return hairlut_exr_fail_text(file, "hairlut.model", text, "a name of 1 to 63 printable ASCII characters");
    hairlut_exr_keep(model, text);
    return HAIRLUT_OK;
}

hairlut_result hairlut_exr_check_digest(const hairlut_exr_file *file, const float *texels, size_t count, uint32_t *digest)
{
    hairlut_exr_text text;
    uint32_t named = 0;
    const hairlut_result result = hairlut_exr_string(file, "hairlut.digest", &text);
    if (result != HAIRLUT_OK)
        return result;
    hairlut_exr_text rest = text;
    if (!hairlut_exr_skip(&rest, "crc32 ") || hairlut_exr_length(rest) != 8 || !hairlut_exr_read_hex(rest.begin, &named))
        return hairlut_exr_fail_text(file, "hairlut.digest", text, "'crc32 ' and 8 lower-case hexadecimal digits");
    *digest = hairlut_exr_digest(texels, count);
    if (*digest != named)
        return hairlut_exr_fail(
            file, HAIRLUT_ERROR_ATTRIBUTE,
            "hairlut.digest is 'crc32 %08lx', but that of the texels is 'crc32 %08lx': expected texels as they were "
            "written, not turned, mirrored or changed; bake the model again",
            (unsigned long)named, (unsigned long)*digest);
    return HAIRLUT_OK;
}

/* ---- texels --------------------------------------------------------------------------------------------------- */

/* The place of a channel's name among the names; -1 if it is not one of them. */
static int place_of(const char *name, const char *const *names, int count)
{
    for (int k = 0; k < count; ++k)
        if (strcmp(name, names[k]) == 0)
            return k;
    return -1;
}

static hairlut_result check_channel(const hairlut_exr_file *file, const exr_attr_chlist_entry_t *channel)
{
    if (channel->pixel_type != EXR_PIXEL_FLOAT)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                "channel %.60s is %s: expected 32-bit float; do not convert the file", channel->name.str,
                                channel->pixel_type == EXR_PIXEL_HALF ? "half" : "uint");
    if (channel->x_sampling != 1 || channel->y_sampling != 1)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                "channel %.60s is sampled %d x %d: expected 1 x 1; do not convert the file",
                                channel->name.str, channel->x_sampling, channel->y_sampling);
    return HAIRLUT_OK;
}

hairlut_result hairlut_exr_check_channels(const hairlut_exr_file *file, const char *const *names, int count)
{
    const exr_attr_chlist_t *channels = NULL;
    const exr_result_t code = exr_get_channels(file->context, 0, &channels);
    if (code != EXR_ERR_SUCCESS)
        return fail_exr(file, code, "channels");
    uint32_t found = 0; /* a bit for each name */
    for (int k = 0; k < channels->num_channels; ++k) {
        const exr_attr_chlist_entry_t *channel = &channels->entries[k];
        const int place = place_of(channel->name.str, names, count);
        if (place < 0)
            return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                    "channels: there is one named '%.60s': expected %d, from '%s' on; "
                                    "do not repack the file",
                                    channel->name.str, count, names[0]);
        const hairlut_result result = check_channel(file, channel);
        if (result != HAIRLUT_OK)
            return result;
        found |= UINT32_C(1) << place;
    }
    for (int k = 0; k < count; ++k)
        if (!(found >> k & 1))
            return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                    "channels: there is none named '%s': expected %d, from '%s' on; "
                                    "do not repack the file",
                                    names[k], count, names[0]);
    return HAIRLUT_OK;
}

/* Where the texels of all rows go. */
typedef struct target {
    const char *const *names;
    int count;
    float *texels;
} target;

/* Aims the decoder at the texels of one chunk of rows. */
static exr_result_t aim(const hairlut_exr_file *file, exr_decode_pipeline_t *decoder, const exr_chunk_info_t *chunk,
                        int first, const target *to)
{
    exr_result_t code = first ? exr_decoding_initialize(file->context, 0, chunk, decoder)
                              : exr_decoding_update(file->context, 0, chunk, decoder);
    if (code != EXR_ERR_SUCCESS)
        return code;
    float *row = to->texels + (size_t)chunk->start_y * (size_t)file->width * (size_t)to->count;
    for (int k = 0; k < decoder->channel_count; ++k) {
        exr_coding_channel_info_t *channel = &decoder->channels[k];
        channel->decode_to_ptr = (uint8_t *)(row + place_of(channel->channel_name, to->names, to->count));
        channel->user_pixel_stride = (int32_t)sizeof(float) * to->count;
        channel->user_line_stride = (int32_t)sizeof(float) * to->count * file->width;
        channel->user_bytes_per_element = (int16_t)sizeof(float);
        channel->user_data_type = EXR_PIXEL_FLOAT;
    }
    return first ? exr_decoding_choose_default_routines(file->context, 0, decoder) : code;
}

hairlut_result hairlut_exr_pixels(const hairlut_exr_file *file, const char *const *names, int count, float *texels)
{
    const target to = {names, count, texels};
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    exr_result_t code = EXR_ERR_SUCCESS;
    for (int y = 0; y < file->height && code == EXR_ERR_SUCCESS;) {
        exr_chunk_info_t chunk;
        code = exr_read_scanline_chunk_info(file->context, 0, y, &chunk);
        if (code == EXR_ERR_SUCCESS &&
            (chunk.start_y != y || chunk.width != file->width || chunk.height < 1 || chunk.height > file->height - y))
            code = EXR_ERR_CORRUPT_CHUNK;
        if (code == EXR_ERR_SUCCESS)
            code = aim(file, &decoder, &chunk, y == 0, &to);
        if (code == EXR_ERR_SUCCESS)
            code = exr_decoding_run(file->context, 0, &decoder);
        y += code == EXR_ERR_SUCCESS ? chunk.height : 0;
    }
    exr_decoding_destroy(file->context, &decoder);
    return code == EXR_ERR_SUCCESS ? HAIRLUT_OK : fail_exr(file, code, "pixels");
}
