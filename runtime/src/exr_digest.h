/* SPDX-License-Identifier: BSD-3-Clause */
/* The digest of texels: CRC-32 of ISO 3309, as in zlib, polynomial 0xedb88320 with the lowest bit first. */
#ifndef HAIRLUT_EXR_DIGEST_H
#define HAIRLUT_EXR_DIGEST_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* The remainder after four more bits. */
static inline uint32_t hairlut_crc32_nibble(uint32_t crc)
{
    static const uint32_t remainders[16] = {0x00000000, 0x1db71064, 0x3b6e20c8, 0x26d930ac, 0x76dc4190, 0x6b6b51f4,
                                            0x4db26158, 0x5005713c, 0xedb88320, 0xf00f9344, 0xd6d6a3e8, 0xcb61b38c,
                                            0x9b64c2b0, 0x86d3d2d4, 0xa00ae278, 0xbdbdf21c};
    return crc >> 4 ^ remainders[crc & 15];
}

/* Of floats as they stand in a file, the lowest byte first. */
static inline uint32_t hairlut_exr_digest(const float *values, size_t count)
{
    uint32_t crc = UINT32_MAX;
    for (size_t k = 0; k < count; ++k) {
        uint32_t bits;
        memcpy(&bits, &values[k], sizeof bits);
        crc ^= bits; /* four bytes at once: each meets the remainder only when it has been shifted down to it */
        for (int nibble = 0; nibble < 8; ++nibble)
            crc = hairlut_crc32_nibble(crc);
    }
    return ~crc;
}

/* Eight lower-case hexadecimal digits; 0 where they are not that. */
static inline int hairlut_exr_read_hex(const char *digits, uint32_t *value)
{
    *value = 0;
    for (int k = 0; k < 8; ++k) {
        const char c = digits[k];
        if (!((c >= '0' && c <= '9') || (c >= 'a' && c <= 'f')))
            return 0;
        *value = *value << 4 | (uint32_t)(c <= '9' ? c - '0' : c - 'a' + 10);
    }
    return 1;
}

#endif
