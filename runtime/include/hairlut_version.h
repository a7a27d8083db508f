/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HAIRLUT_VERSION_H
#define HAIRLUT_VERSION_H

#include "hairlut_export.h"

#define HAIRLUT_VERSION_MAJOR 2
#define HAIRLUT_VERSION_MINOR 3
#define HAIRLUT_VERSION_PATCH 0
#define HAIRLUT_VERSION (HAIRLUT_VERSION_MAJOR * 10000 + HAIRLUT_VERSION_MINOR * 100 + HAIRLUT_VERSION_PATCH)

#ifdef __cplusplus
extern "C" {
#endif

/* HAIRLUT_VERSION of the library in use, to compare with the header's. */
HAIRLUT_API int hairlut_version(void);

#ifdef __cplusplus
}
#endif

#endif
