/* SPDX-License-Identifier: BSD-3-Clause */
/* The caller's memory hooks, or malloc and free. */
#ifndef HAIRLUT_ALLOCATOR_H
#define HAIRLUT_ALLOCATOR_H

#include <stdlib.h>

#include "message.h"

static inline void *hairlut_malloc(void *user, size_t size)
{
    (void)user;
    return malloc(size);
}

static inline void hairlut_malloc_release(void *user, void *memory)
{
    (void)user;
    free(memory);
}

/* `requested` may be NULL or zeroed; half a pair of hooks is an error. */
static inline hairlut_result hairlut_choose_allocator(const hairlut_allocator *requested, hairlut_allocator *chosen,
                                                      char *message)
{
    const hairlut_allocator standard = {hairlut_malloc, hairlut_malloc_release, NULL};
    *chosen = requested && (requested->allocate || requested->release) ? *requested : standard;
    if (!chosen->allocate || !chosen->release)
        return hairlut_fail(HAIRLUT_ERROR_ARGUMENT, message, "allocator: expected both allocate and release, or neither");
    return HAIRLUT_OK;
}

static inline hairlut_result hairlut_allocate(const hairlut_allocator *allocator, size_t size, void **memory, char *message)
{
    *memory = allocator->allocate(allocator->user, size);
    if (!*memory)
        return hairlut_fail(HAIRLUT_ERROR_MEMORY, message, "the allocator returned NULL for %zu bytes", size);
    return HAIRLUT_OK;
}

static inline void hairlut_release(const hairlut_allocator *allocator, void *memory)
{
    if (memory)
        allocator->release(allocator->user, memory);
}

#endif
