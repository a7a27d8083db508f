/* SPDX-License-Identifier: BSD-3-Clause */
/* Text attributes, read word by word. None ends with a zero. */
#ifndef HAIRLUT_EXR_TEXT_H
#define HAIRLUT_EXR_TEXT_H

#include <string.h>

#include "hairlut.h"
#include "number.h"

typedef struct hairlut_exr_text {
    const char *begin, *end;
} hairlut_exr_text;

static inline size_t hairlut_exr_length(hairlut_exr_text text)
{
    return (size_t)(text.end - text.begin);
}

static inline int hairlut_exr_equals(hairlut_exr_text text, const char *word)
{
    const size_t length = hairlut_exr_length(text);
    return length == strlen(word) && memcmp(text.begin, word, length) == 0;
}

/* Removes `prefix`; 0 where the text does not start with it. */
static inline int hairlut_exr_skip(hairlut_exr_text *text, const char *prefix)
{
    const size_t length = strlen(prefix);
    if (hairlut_exr_length(*text) < length || memcmp(text->begin, prefix, length) != 0)
        return 0;
    text->begin += length;
    return 1;
}

/* Removes a number; 0 where none stands. */
static inline int hairlut_exr_number(hairlut_exr_text *text, double *number)
{
    return hairlut_read_number(&text->begin, text->end, number);
}

/* "prefix NUMBER" and nothing behind it */
static inline int hairlut_exr_parameter(hairlut_exr_text text, const char *prefix, double *number)
{
    return hairlut_exr_skip(&text, prefix) && hairlut_exr_number(&text, number) && text.begin == text.end;
}

/* Removes the text up to the next space, and that space; 0 where no space followed, and so no word does. */
static inline int hairlut_exr_word(hairlut_exr_text *text, hairlut_exr_text *word)
{
    word->begin = word->end = text->begin;
    while (word->end < text->end && *word->end != ' ')
        ++word->end;
    const int more = word->end < text->end;
    text->begin = word->end + more;
    return more;
}

/* A lobe's name, [a-z][a-z0-9_]*, of at most 31 bytes. */
static inline int hairlut_exr_is_name(hairlut_exr_text text)
{
    for (const char *c = text.begin; c < text.end; ++c) {
        const int letter = *c >= 'a' && *c <= 'z';
        if (!letter && (c == text.begin || !(hairlut_is_digit(*c) || *c == '_')))
            return 0;
    }
    return hairlut_exr_length(text) >= 1 && hairlut_exr_length(text) < HAIRLUT_NAME_SIZE;
}

/* Copies the text, which is shorter than the array, and ends it. */
static inline void hairlut_exr_keep(char *to, hairlut_exr_text text)
{
    memcpy(to, text.begin, hairlut_exr_length(text));
    to[hairlut_exr_length(text)] = '\0';
}

#endif
