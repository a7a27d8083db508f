/* SPDX-License-Identifier: BSD-3-Clause
 * erf from SLEEF, a modern one of 1 ulp: for loops over arrays under the names that the vector function ABI gives it. */
#ifndef RIVALS_SLEEF_H
#define RIVALS_SLEEF_H

#include <immintrin.h>
#include <sleef.h>

#include "gaussian.h"

#ifdef RIVAL_ARRAYS_WIDTH
extern "C" __attribute__((simd("notinbranch"), const)) float rival_sleef_erf(float);
#endif

namespace {

struct Sleef {
#ifdef RIVAL_ARRAYS_WIDTH
    static float erf(float x) { return rival_sleef_erf(x); }
#else
    static float erf(float x) { return Sleef_erff_u10(x); }
#endif
    static float erf_inverse(float x) { return giles(x); }
};

} // namespace

#endif
