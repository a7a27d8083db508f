/* SPDX-License-Identifier: BSD-3-Clause */
/* Text in an OpenEXR header is UTF-8 (RFC 3629). What is not would be read by some tools and refused by others. */
#ifndef HAIRLUT_EXR_UTF8_H
#define HAIRLUT_EXR_UTF8_H

#include "exr_text.h"

/* The bytes of the character at `c`, which ends before `end`; 0 if it is none. Each row of the table in RFC 3629, section
 * 4, bounds the first byte and the second. */
static inline int hairlut_exr_character(const unsigned char *c, const unsigned char *end)
{
    static const struct {
        unsigned char first, last, low, high, size;
    } rows[] = {{0x00, 0x7f, 0x00, 0x00, 1}, {0xc2, 0xdf, 0x80, 0xbf, 2}, {0xe0, 0xe0, 0xa0, 0xbf, 3},
                {0xe1, 0xec, 0x80, 0xbf, 3}, {0xed, 0xed, 0x80, 0x9f, 3}, {0xee, 0xef, 0x80, 0xbf, 3},
                {0xf0, 0xf0, 0x90, 0xbf, 4}, {0xf1, 0xf3, 0x80, 0xbf, 4}, {0xf4, 0xf4, 0x80, 0x8f, 4}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; ++k) {
        if (*c < rows[k].first || *c > rows[k].last)
            continue;
        if (end - c < rows[k].size || (rows[k].size > 1 && (c[1] < rows[k].low || c[1] > rows[k].high)))
            return 0;
        for (int n = 2; n < rows[k].size; ++n)
            if (c[n] < 0x80 || c[n] > 0xbf)
                return 0;
        return rows[k].size;
    }
    return 0;
}

static inline int hairlut_exr_is_utf8(hairlut_exr_text text)
{
    const unsigned char *c = (const unsigned char *)text.begin, *end = (const unsigned char *)text.end;
    while (c < end) {
        const int size = hairlut_exr_character(c, end);
        if (size == 0)
            return 0;
        c += size;
    }
    return 1;
}

#endif
