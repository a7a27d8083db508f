/* SPDX-License-Identifier: BSD-3-Clause */
/* What the library takes from <math.h>, for compilers without the C library of the system they compile for. */
#pragma once
#define NAN __builtin_nanf("")
#define INFINITY __builtin_inff()
#define isunordered(a, b) __builtin_isunordered(a, b)
#define isfinite(a) __builtin_isfinite(a)
float sqrtf(float);
float fabsf(float);
float floorf(float);
float ldexpf(float, int);
float atan2f(float, float);
float sinf(float);
float cosf(float);
float copysignf(float, float);
float asinf(float);
double fabs(double);
double floor(double);
double ldexp(double, int);
double frexp(double, int *);
double sqrt(double);
double asin(double);
