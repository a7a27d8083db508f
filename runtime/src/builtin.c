/* SPDX-License-Identifier: BSD-3-Clause */
/* Models compiled into the library. */
#include <string.h>

#include "internal.h"

const hairlut_model *hairlut_builtin(const char *name)
{
    for (int i = 0; name && i < hairlut_builtin_count; ++i)
        if (strcmp(name, hairlut_builtin_entries[i].name) == 0)
            return &hairlut_builtin_entries[i].model;
    return NULL;
}
