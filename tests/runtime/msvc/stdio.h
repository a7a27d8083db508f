/* SPDX-License-Identifier: BSD-3-Clause */
/* What the library takes from <stdio.h>, for compilers without the C library of the system they compile for. */
#pragma once
#include <stddef.h>
#include <stdarg.h>
int snprintf(char *, size_t, const char *, ...);
int vsnprintf(char *, size_t, const char *, va_list);
