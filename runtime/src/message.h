/* SPDX-License-Identifier: BSD-3-Clause */
/* Error text: one line into a caller's buffer of HAIRLUT_MESSAGE_SIZE bytes, or nowhere. */
#ifndef HAIRLUT_MESSAGE_H
#define HAIRLUT_MESSAGE_H

#include <stdarg.h>
#include <stdio.h>

#include "hairlut.h"
#include "platform.h"

#if defined(__GNUC__)
#define HAIRLUT_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define HAIRLUT_PRINTF(text, first)
#endif

/* Writes the text, cut to the buffer, and returns `result` for the caller to return. */
static inline hairlut_result HAIRLUT_PRINTF(3, 4) hairlut_fail(hairlut_result result, char *message, const char *format, ...)
{
    if (message) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(message, HAIRLUT_MESSAGE_SIZE, format, arguments);
        va_end(arguments);
    }
    return result;
}

#endif
