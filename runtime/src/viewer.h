/* SPDX-License-Identifier: BSD-3-Clause */
/* What a hairlut_viewer contains: all that calls at one hit have in common. */
#ifndef HAIRLUT_VIEWER_H
#define HAIRLUT_VIEWER_H

#include "internal.h"
#include "strand.h"

/* So many grids of nodes have room; of models of more, each call places the parameters again. */
enum { HAIRLUT_VIEWER_GRIDS = 8 };

/* No pointer to itself: a viewer may be copied. */
typedef struct hairlut_view {
    const hairlut_model *model;
    float theta_r, r; /* r: phi_r in [-pi, pi) */
    int known;        /* whether any direction has a density */
    int constant;     /* the mixture is the model's constant one, not: */
    hairlut_mix mix;
    int strand; /* whether there are parameters: */
    float parameters[HAIRLUT_MAX_PARAMETERS];
    hairlut_corners corners[HAIRLUT_VIEWER_GRIDS];
} hairlut_view;

typedef char hairlut_view_fits[sizeof(hairlut_view) <= sizeof(hairlut_viewer) ? 1 : -1];

#endif
