/* SPDX-License-Identifier: BSD-3-Clause */
/* The compression that a file's header names, read from its bytes. An OpenEXR library that does not know it puts another
 * in its place, and would decode what was never compressed so. */
#ifndef HAIRLUT_EXR_COMPRESSION_H
#define HAIRLUT_EXR_COMPRESSION_H

#include <openexr.h>

/* The number, 0 to 255; -1 where the bytes cannot be read or name none. `source` as in hairlut_exr_open. */
int hairlut_exr_named_compression(const char *path, const exr_context_initializer_t *source);

/* NONE, RLE, ZIPS, ZIP: without loss, old, and the least of decoders. */
int hairlut_exr_is_allowed(int compression);

/* "PIZ"; "a newer one" for a number that this library does not know. */
const char *hairlut_exr_compression_name(int compression);

#endif
