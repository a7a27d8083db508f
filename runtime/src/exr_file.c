/* OpenEXR files through OpenEXRCore. */
#include "exr_file.h"

#include <string.h>

enum { LARGEST_SIDE = 4096 };

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
    if (code == EXR_ERR_FEATURE_NOT_IMPLEMENTED)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_UNSUPPORTED, "%s: %s; write it with ZIP compression", what, reason);
    return hairlut_exr_fail(file, HAIRLUT_ERROR_FILE, "%s: %s; expected an OpenEXR image, bake the table again", what, reason);
}

/* Long paths keep their end: the file's name is there. */
static void keep_name(hairlut_exr_file *file, const char *path)
{
    const size_t length = strlen(path), most = sizeof file->name - 1;
    if (length <= most)
        memcpy(file->name, path, length + 1);
    else
        snprintf(file->name, sizeof file->name, "...%s", path + length - (most - 3));
}

static hairlut_result check_layout(const hairlut_exr_file *file)
{
    int parts = 0;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    const exr_attr_chlist_t *channels = NULL;
    exr_result_t code = exr_get_count(file->context, &parts);
    if (code == EXR_ERR_SUCCESS && parts != 1)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE, "it has %d parts: expected 1; write each table to its own file",
                                parts);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_storage(file->context, 0, &storage);
    if (code == EXR_ERR_SUCCESS && storage != EXR_STORAGE_SCANLINE)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE, "type: expected a scanline image; write it without tiles or deep data");
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_channels(file->context, 0, &channels);
    if (code != EXR_ERR_SUCCESS)
        return fail_exr(file, code, "header");
    const exr_attr_chlist_entry_t *y = channels->entries;
    if (channels->num_channels != 1 || strcmp(y->name.str, "Y") != 0 || y->pixel_type != EXR_PIXEL_FLOAT
        || y->x_sampling != 1 || y->y_sampling != 1)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                "channels: expected one 32-bit FLOAT channel named Y; do not convert or repack the file");
    return HAIRLUT_OK;
}

static hairlut_result check_windows(hairlut_exr_file *file)
{
    exr_attr_box2i_t data, display;
    exr_result_t code = exr_get_data_window(file->context, 0, &data);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_display_window(file->context, 0, &display);
    if (code != EXR_ERR_SUCCESS)
        return fail_exr(file, code, "dataWindow");
    if (data.min.x != 0 || data.min.y != 0 || display.min.x != 0 || display.min.y != 0)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE,
                                "dataWindow, displayWindow: expected both to start at (0, 0); do not crop the file");
    if (data.max.x < 3 || data.max.y < 1 || data.max.x >= LARGEST_SIDE || data.max.y >= LARGEST_SIDE)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_TABLE, "dataWindow ends at (%d, %d): expected 4 x 2 to %d x %d texels",
                                data.max.x, data.max.y, (int)LARGEST_SIDE, (int)LARGEST_SIDE);
    file->width = data.max.x + 1;
    file->height = data.max.y + 1;
    return HAIRLUT_OK;
}

hairlut_result hairlut_exr_open(hairlut_exr_file *file, const char *path, const exr_context_initializer_t *source,
                                char *message)
{
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    if (source)
        initializer = *source;
    initializer.error_handler_fn = ignore_report;
    file->context = NULL;
    file->message = message;
    keep_name(file, path);
    const exr_result_t code = exr_start_read(&file->context, path, &initializer);
    if (code == EXR_ERR_FILE_ACCESS)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_FILE, "cannot be opened; check the directory, or bake the tables");
    if (code != EXR_ERR_SUCCESS)
        return fail_exr(file, code, "header");
    const hairlut_result result = check_layout(file);
    return result == HAIRLUT_OK ? check_windows(file) : result;
}

void hairlut_exr_close(hairlut_exr_file *file)
{
    if (file->context)
        exr_finish(&file->context);
}

static hairlut_result fail_attribute(const hairlut_exr_file *file, exr_result_t code, const char *attribute, const char *type)
{
    if (code == EXR_ERR_NO_ATTR_BY_NAME)
        return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE, "%s is missing: expected a %s attribute; bake the table again",
                                attribute, type);
    return hairlut_exr_fail(file, HAIRLUT_ERROR_ATTRIBUTE, "%s is not a %s: %s; bake the table again", attribute, type,
                            exr_get_default_error_message(code));
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
    const exr_result_t code = exr_attr_get_string(file->context, 0, attribute, &length, &begin);
    if (code != EXR_ERR_SUCCESS)
        return fail_attribute(file, code, attribute, "string");
    value->begin = begin ? begin : "";
    value->end = value->begin + length;
    return HAIRLUT_OK;
}

/* Aims the decoder at the texels of one chunk of rows. */
static exr_result_t aim(const hairlut_exr_file *file, exr_decode_pipeline_t *decoder, const exr_chunk_info_t *chunk, int first,
                        float *texels)
{
    exr_result_t code = first ? exr_decoding_initialize(file->context, 0, chunk, decoder)
                              : exr_decoding_update(file->context, 0, chunk, decoder);
    if (code != EXR_ERR_SUCCESS)
        return code;
    exr_coding_channel_info_t *channel = decoder->channels;
    channel->decode_to_ptr = (uint8_t *)(texels + (size_t)chunk->start_y * (size_t)file->width);
    channel->user_pixel_stride = (int32_t)sizeof(float);
    channel->user_line_stride = (int32_t)sizeof(float) * file->width;
    channel->user_bytes_per_element = (int16_t)sizeof(float);
    channel->user_data_type = EXR_PIXEL_FLOAT;
    return first ? exr_decoding_choose_default_routines(file->context, 0, decoder) : code;
}

hairlut_result hairlut_exr_pixels(const hairlut_exr_file *file, float *texels)
{
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    exr_result_t code = EXR_ERR_SUCCESS;
    for (int y = 0; y < file->height && code == EXR_ERR_SUCCESS;) {
        exr_chunk_info_t chunk;
        code = exr_read_scanline_chunk_info(file->context, 0, y, &chunk);
        if (code == EXR_ERR_SUCCESS && (chunk.start_y != y || chunk.width != file->width || chunk.height < 1
                                        || chunk.height > file->height - y))
            code = EXR_ERR_CORRUPT_CHUNK;
        if (code == EXR_ERR_SUCCESS)
            code = aim(file, &decoder, &chunk, y == 0, texels);
        if (code == EXR_ERR_SUCCESS)
            code = exr_decoding_run(file->context, 0, &decoder);
        y += code == EXR_ERR_SUCCESS ? chunk.height : 0;
    }
    exr_decoding_destroy(file->context, &decoder);
    return code == EXR_ERR_SUCCESS ? HAIRLUT_OK : fail_exr(file, code, "pixels");
}
