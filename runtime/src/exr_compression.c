/* SPDX-License-Identifier: BSD-3-Clause */
#include "exr_compression.h"

#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#endif

/* A file on disk, or what a source reads. */
typedef struct stream {
    FILE *file;
    const exr_context_initializer_t *source;
} stream;

/* Up to `size` bytes from `offset` on; how many there were */
static size_t read_at(const stream *s, uint64_t offset, unsigned char *bytes, size_t size)
{
    if (s->source) {
        const int64_t count = s->source->read_fn(NULL, s->source->user_data, bytes, size, offset, NULL);
        return count > 0 ? (size_t)count : 0;
    }
    if (!s->file || offset > LONG_MAX || fseek(s->file, (long)offset, SEEK_SET) != 0)
        return 0;
    return fread(bytes, 1, size, s->file);
}

static uint32_t little_endian(const unsigned char *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

/* An attribute is a name and a type, each ended by a zero, four bytes of size, and as many of value; an empty name ends a
 * header. Names are at most 255 bytes. */
enum { HEADER_FROM = 8, NAME = 256, VALUE_SIZE = 4 };
static const unsigned char magic[4] = {0x76, 0x2f, 0x31, 0x01};

static int find_compression(const stream *s)
{
    unsigned char bytes[2 * NAME + VALUE_SIZE + 1];
    if (read_at(s, 0, bytes, sizeof magic) != sizeof magic || memcmp(bytes, magic, sizeof magic) != 0)
        return -1;
    for (uint64_t offset = HEADER_FROM;;) {
        memset(bytes, 0, sizeof bytes);
        const size_t count = read_at(s, offset, bytes, sizeof bytes);
        const unsigned char *name_end = memchr(bytes, 0, NAME);
        const unsigned char *type_end = name_end ? memchr(name_end + 1, 0, NAME) : NULL;
        if (!type_end || name_end == bytes || (size_t)(type_end - bytes) + 1 + VALUE_SIZE >= count)
            return -1;
        const unsigned char *value = type_end + 1 + VALUE_SIZE;
        if (strcmp((const char *)bytes, "compression") == 0)
            return value[0];
        offset += (uint64_t)(value - bytes) + little_endian(type_end + 1);
    }
}

/* Paths are UTF-8, as OpenEXR takes them: on Windows fopen takes another encoding. */
static FILE *open_file(const char *path)
{
#ifdef _WIN32
    wchar_t wide[2048];
    if (!MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, (int)(sizeof wide / sizeof *wide)))
        return NULL;
    return _wfopen(wide, L"rb");
#else
    return fopen(path, "rb");
#endif
}

int hairlut_exr_named_compression(const char *path, const exr_context_initializer_t *source)
{
    const stream s = {source ? NULL : open_file(path), source};
    const int compression = find_compression(&s);
    if (s.file)
        fclose(s.file);
    return compression;
}

int hairlut_exr_is_allowed(int compression)
{
    return compression == EXR_COMPRESSION_NONE || compression == EXR_COMPRESSION_RLE ||
           compression == EXR_COMPRESSION_ZIPS || compression == EXR_COMPRESSION_ZIP;
}

const char *hairlut_exr_compression_name(int compression)
{
    static const char *const names[] = {"NONE", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB"};
    return (size_t)compression < sizeof names / sizeof *names ? names[compression] : "a newer one";
}
