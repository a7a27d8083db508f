/* SPDX-License-Identifier: BSD-3-Clause */
/* What the sources require of the compiler. Bits that are equal on every processor, and tests for NaN, need IEEE arithmetic in
 * the type that is written. CMake sets the flags; a compilation by hand without them ends with an error here. */
#ifndef HAIRLUT_PLATFORM_H
#define HAIRLUT_PLATFORM_H

#include <float.h>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ > 0) || defined(_M_FP_FAST)
#error "hairlut: compile without -ffast-math, -Ofast or /fp:fast: NaN would pass unnoticed and arrays differ from calls"
#endif

/* 2: the x87 unit computes in 80 bits. 16: float is float, and only _Float16 is wider. */
#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 16
#error "hairlut: float arithmetic must be done in float: on 32-bit x86 add -msse2 -mfpmath=sse"
#endif
#if defined(_M_IX86) && _M_IX86_FP < 2
#error "hairlut: float arithmetic must be done in float: on 32-bit x86 add /arch:SSE2"
#endif

#if defined(__x86_64__) || defined(__i386__) || defined(_M_X64) || defined(_M_IX86)
#define HAIRLUT_X86 1
#elif defined(__aarch64__) || defined(_M_ARM64)
#define HAIRLUT_ARM64 1
#endif

#endif
