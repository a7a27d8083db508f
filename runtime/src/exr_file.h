/* SPDX-License-Identifier: BSD-3-Clause */
/* One OpenEXR file as this library needs it: a single part of scanlines, FLOAT channels, and text attributes
 * (luts/FORMAT.md). Every function returns HAIRLUT_OK or writes "file: what was found: what was expected; what to do" to
 * `message`. */
#ifndef HAIRLUT_EXR_FILE_H
#define HAIRLUT_EXR_FILE_H

#include <openexr.h>
#include <stdint.h>

#include "exr_text.h"
#include "hairlut.h"
#include "message.h"

enum {
    HAIRLUT_EXR_NAME_SIZE = 200,
    HAIRLUT_EXR_LARGEST_SIDE = 4096, /* columns, and rows of theta_r */
    HAIRLUT_EXR_MOST_ROWS = 65536,   /* of an image */
    HAIRLUT_EXR_MOST_TEXELS = 1 << 24,
    HAIRLUT_EXR_MODEL_SIZE = 64
};

typedef struct hairlut_exr_file {
    exr_context_t context;            /* NULL when closed */
    char name[HAIRLUT_EXR_NAME_SIZE]; /* for messages: the path, or its end */
    char *message;
    int missing; /* it could not be opened at all */
    int width, height;
} hairlut_exr_file;

/* A closed file of that path, for messages about it. Long paths keep their end: the file's name is there. */
void hairlut_exr_name(hairlut_exr_file *file, const char *path, char *message);

/* Opens the file and checks its layout, before anything is decoded: one part, scanlines, a compression without loss that
 * every OpenEXR library has, text in UTF-8, windows that start at (0, 0) and agree. `source` is NULL for a file on disk,
 * or has a read_fn that reads it from elsewhere. Close it whatever the result. */
hairlut_result hairlut_exr_open(hairlut_exr_file *file, const char *path, const exr_context_initializer_t *source,
                                char *message);
void hairlut_exr_close(hairlut_exr_file *file);

/* The image must have at least least_width columns, and at most HAIRLUT_EXR_LARGEST_SIDE, _MOST_ROWS and _MOST_TEXELS. */
hairlut_result hairlut_exr_check_size(const hairlut_exr_file *file, int least_width);

/* Whether the file has the attribute, of any type. */
int hairlut_exr_has(const hairlut_exr_file *file, const char *attribute);

/* The name of attribute `index`, which ends with a zero; 0 where there are not as many. */
int hairlut_exr_attribute(const hairlut_exr_file *file, int index, hairlut_exr_text *name);

hairlut_result hairlut_exr_int(const hairlut_exr_file *file, const char *attribute, int *value);
hairlut_result hairlut_exr_string(const hairlut_exr_file *file, const char *attribute, hairlut_exr_text *value);

/* The attribute must be `word`. */
hairlut_result hairlut_exr_expect(const hairlut_exr_file *file, const char *attribute, const char *word);

/* hairlut.format, which must be `format`; `why` follows in the message. */
hairlut_result hairlut_exr_expect_format(const hairlut_exr_file *file, int format, const char *why);

/* hairlut.model: a name of 1 to 63 printable characters. */
hairlut_result hairlut_exr_model(const hairlut_exr_file *file, char model[HAIRLUT_EXR_MODEL_SIZE]);

/* The file must have these channels, at most 32, and no others, each of 32-bit floats and not subsampled. */
hairlut_result hairlut_exr_check_channels(const hairlut_exr_file *file, const char *const *names, int count);

/* Fills width*height*count floats, row by row from the top, the channels of a texel together in the order of the names. */
hairlut_result hairlut_exr_pixels(const hairlut_exr_file *file, const char *const *names, int count, float *texels);

/* hairlut.digest must be that of `count` floats, as hairlut_exr_pixels orders them; *digest is it. */
hairlut_result hairlut_exr_check_digest(const hairlut_exr_file *file, const float *texels, size_t count, uint32_t *digest);

/* Writes the file's name, then the text. */
hairlut_result HAIRLUT_PRINTF(3, 4)
    hairlut_exr_fail(const hairlut_exr_file *file, hairlut_result result, const char *format, ...);

/* "attribute is 'text': expected ...; bake the model again", HAIRLUT_ERROR_ATTRIBUTE */
hairlut_result hairlut_exr_fail_text(const hairlut_exr_file *file, const char *attribute, hairlut_exr_text text,
                                     const char *expected);

#endif
