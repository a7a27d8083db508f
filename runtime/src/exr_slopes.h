/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables of format 1 have angles alone: the slopes dx/du by luts/FORMAT.md's rule, in double, rounded once. */
#ifndef HAIRLUT_EXR_SLOPES_H
#define HAIRLUT_EXR_SLOPES_H

#include "hairlut.h"

/* width*height pairs of floats, whose first members are given, get their second ones. Angles that are no table give
 * slopes that are numbers all the same. */
void hairlut_exr_derive_slopes(const hairlut_table *table, float *texels);

#endif
