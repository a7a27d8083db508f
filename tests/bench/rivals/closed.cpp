/* SPDX-License-Identifier: BSD-3-Clause
 * The closed form of `fitted` and its variants. Built for one call at a time, with the flags of the library, and for arrays:
 * RIVAL_ARRAYS_WIDTH is the vector width that the compiler prefers, 256 or 512. */
#include "loops.h"

#ifdef HAVE_SLEEF
#include "sleef.h"
#endif

#if !defined(RIVAL_ARRAYS_WIDTH) && !defined(RIVAL_NATIVE)
#define RIVAL_LIBRARIES
#include "box_muller.h"
#ifdef HAVE_BOOST
#include "boost.h"
#endif
#endif

extern "C" const rival RIVAL_NAME(rivals)[] = {
    calls<Hair<Computed<Gaussian<Libm>>, Gaussian<Libm>>>("plain"),
    calls<Hair<Tabulated<Gaussian<Libm>>, Gaussian<Libm>>>("hybrid"),
    calls<Hair<Computed<Logistic>, Logistic>>("logistic"),
    calls<Hair<Tabulated<Logistic>, Logistic>>("logistic hybrid"),
#if defined(HAVE_SLEEF) && !defined(RIVAL_NATIVE)
    calls<Hair<Computed<Gaussian<Sleef>>, Gaussian<Sleef>>>("SLEEF"),
#endif
#ifdef RIVAL_LIBRARIES
#ifdef HAVE_BOOST
    calls<Hair<Computed<Gaussian<Boost>>, Gaussian<Boost>>>("Boost"),
#endif
    box_muller_calls(),
#endif
    {},
};
