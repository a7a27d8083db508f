/* SPDX-License-Identifier: BSD-3-Clause */
/* What the library takes from <stdlib.h>, for compilers without the C library of the system they compile for. */
#pragma once
#include <stddef.h>
void *malloc(size_t);
void free(void *);
void *calloc(size_t, size_t);
