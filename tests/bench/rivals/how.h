/* SPDX-License-Identifier: BSD-3-Clause
 * One call at a time, with the flags of the library or, RIVAL_NATIVE, with the compiler's fastest for this processor; or arrays
 * for the compiler to vectorise: RIVAL_ARRAYS_WIDTH is the vector width that it prefers. */
#ifndef RIVALS_HOW_H
#define RIVALS_HOW_H

#ifdef RIVAL_ARRAYS_WIDTH
#define RIVAL_ONE inline __attribute__((always_inline))
#define RIVAL_EACH(i, n) _Pragma("GCC ivdep") for (size_t i = 0; i < (n); ++i)
#define RIVAL_TEXT_(x) #x
#define RIVAL_TEXT(x) RIVAL_TEXT_(x)
#define RIVAL_HOW "arrays" RIVAL_TEXT(RIVAL_ARRAYS_WIDTH)
#define RIVAL_JOIN_(a, b) a##b
#define RIVAL_JOIN(a, b) RIVAL_JOIN_(a, b)
#define RIVAL_NAME(name) RIVAL_JOIN(name##_arrays, RIVAL_ARRAYS_WIDTH)
#else
#define RIVAL_ONE __attribute__((noinline))
#define RIVAL_EACH(i, n) for (size_t i = 0; i < (n); ++i)
#ifdef RIVAL_NATIVE
#define RIVAL_HOW "native"
#define RIVAL_NAME(name) name##_native
#else
#define RIVAL_HOW "one"
#define RIVAL_NAME(name) name##_one
#endif
#endif

#endif
