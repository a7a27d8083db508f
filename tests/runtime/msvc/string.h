/* SPDX-License-Identifier: BSD-3-Clause */
/* What the library takes from <string.h>, for compilers without the C library of the system they compile for. */
#pragma once
#include <stddef.h>
void *memcpy(void *, const void *, size_t);
void *memset(void *, int, size_t);
int memcmp(const void *, const void *, size_t);
size_t strlen(const char *);
int strcmp(const char *, const char *);
void *memchr(const void *, int, size_t);
