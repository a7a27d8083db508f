/* Which symbols leave the shared library. Define HAIRLUT_STATIC when linking the static one on Windows. */
#ifndef HAIRLUT_EXPORT_H
#define HAIRLUT_EXPORT_H

#if defined(HAIRLUT_STATIC)
#define HAIRLUT_API
#elif defined(_WIN32)
#if defined(HAIRLUT_BUILDING)
#define HAIRLUT_API __declspec(dllexport)
#else
#define HAIRLUT_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define HAIRLUT_API __attribute__((visibility("default")))
#else
#define HAIRLUT_API
#endif

#endif
