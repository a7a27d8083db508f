/* SPDX-License-Identifier: BSD-3-Clause */
/* Which symbols leave the shared libraries. Define HAIRLUT_STATIC when linking the static ones on Windows. */
#ifndef HAIRLUT_EXPORT_H
#define HAIRLUT_EXPORT_H

#if defined(HAIRLUT_STATIC)
#define HAIRLUT_EXPORT
#define HAIRLUT_IMPORT
#elif defined(_WIN32)
#define HAIRLUT_EXPORT __declspec(dllexport)
#define HAIRLUT_IMPORT __declspec(dllimport)
#elif defined(__GNUC__)
#define HAIRLUT_EXPORT __attribute__((visibility("default")))
#define HAIRLUT_IMPORT __attribute__((visibility("default")))
#else
#define HAIRLUT_EXPORT
#define HAIRLUT_IMPORT
#endif

#if defined(HAIRLUT_BUILDING) /* the library hairlut itself */
#define HAIRLUT_API HAIRLUT_EXPORT
#else
#define HAIRLUT_API HAIRLUT_IMPORT
#endif

#if defined(HAIRLUT_EXR_BUILDING) /* the library hairlut_exr itself */
#define HAIRLUT_EXR_API HAIRLUT_EXPORT
#else
#define HAIRLUT_EXR_API HAIRLUT_IMPORT
#endif

#endif
