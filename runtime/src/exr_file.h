/* One OpenEXR file as this library needs it: a single-part scanline image of one FLOAT channel Y, and text attributes.
 * Every function returns HAIRLUT_OK or writes "file: what is wrong: what was expected; what to do" to `message`. */
#ifndef HAIRLUT_EXR_FILE_H
#define HAIRLUT_EXR_FILE_H

#include <openexr.h>

#include "hairlut.h"
#include "message.h"

enum { HAIRLUT_EXR_NAME_SIZE = 200 };

typedef struct hairlut_exr_file {
    exr_context_t context; /* NULL when closed */
    char name[HAIRLUT_EXR_NAME_SIZE]; /* for messages: the path, or its end */
    char *message;
    int width, height;
} hairlut_exr_file;

/* A text attribute; not terminated. */
typedef struct hairlut_exr_text {
    const char *begin, *end;
} hairlut_exr_text;

/* Opens the file and checks the image's layout. `source` is NULL for a file on disk, or reads it from elsewhere. Close it
 * whatever the result. */
hairlut_result hairlut_exr_open(hairlut_exr_file *file, const char *path, const exr_context_initializer_t *source,
                                char *message);
void hairlut_exr_close(hairlut_exr_file *file);

hairlut_result hairlut_exr_int(const hairlut_exr_file *file, const char *attribute, int *value);
hairlut_result hairlut_exr_string(const hairlut_exr_file *file, const char *attribute, hairlut_exr_text *value);

/* Fills width*height floats. */
hairlut_result hairlut_exr_pixels(const hairlut_exr_file *file, float *texels);

/* Writes the file's name, then the text. */
hairlut_result HAIRLUT_PRINTF(3, 4) hairlut_exr_fail(const hairlut_exr_file *file, hairlut_result result, const char *format, ...);

#endif
