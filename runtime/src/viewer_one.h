/* SPDX-License-Identifier: BSD-3-Clause */
/* Viewers: one.h and strand_one.h, with what a hit fixes computed once. */
#ifndef HAIRLUT_VIEWER_ONE_H
#define HAIRLUT_VIEWER_ONE_H

#include "strand_one.h"
#include "viewer.h"

/* The corners of a view; `own` has room for them where the view has none. */
HAIRLUT_INLINE const hairlut_corners *corners_of_view(const hairlut_view *view, hairlut_corners *own)
{
    if (view->model->strands->grid_count <= HAIRLUT_VIEWER_GRIDS)
        return view->corners;
    place_strand(view->model, view->parameters, own);
    return own;
}

HAIRLUT_INLINE hair hair_of_view(const hairlut_view *view)
{
    const hair h = {view->model, view->constant ? &view->model->mixture.mix : &view->mix, view->theta_r, view->r,
                    view->known};
    return h;
}

static void view_strand_one(hairlut_view *view, const hairlut_model *model, const float *parameters, const float *shares,
                            float theta_r, float offset)
{
    hairlut_corners own[HAIRLUT_MOST_GRIDS];
    const int few = model->strands->grid_count <= HAIRLUT_VIEWER_GRIDS;
    hairlut_corners *corners = few ? view->corners : own;
    view->known = place_strand(model, parameters, corners);
    for (int p = 0; p < model->strands->parameter_count; ++p)
        view->parameters[p] = parameters[p];
    mix_strand(model, corners, shares, theta_r, offset, &view->mix);
}

/* parameters: NULL where the model has none */
static void view_one(hairlut_view *view, const hairlut_model *model, const float *parameters, const float *shares,
                     float theta_r, float phi_r, float offset)
{
    const hairlut_mix *mix = &view->mix;
    view->model = model;
    view->strand = parameters != NULL;
    view->known = 1;
    if (parameters)
        view_strand_one(view, model, parameters, shares, theta_r, offset);
    else
        mix = hairlut_mixture_at(model, shares, theta_r, offset, &view->mix);
    const hair h = hair_of(model, mix, theta_r, phi_r, offset);
    view->constant = mix != &view->mix;
    view->theta_r = theta_r;
    view->r = h.r;
    view->known &= h.known;
}

static hairlut_sample sample_view_one(const hairlut_view *view, float u_lobe, float u_theta, float u_phi)
{
    hairlut_corners own[HAIRLUT_MOST_GRIDS];
    const hair h = hair_of_view(view);
    return view->strand ? sample_of_strand(&h, corners_of_view(view, own), u_lobe, u_theta, u_phi)
                        : sample_of_hair(&h, u_lobe, u_theta, u_phi);
}

static float pdf_view_one(const hairlut_view *view, float theta_i, float phi_i)
{
    hairlut_corners own[HAIRLUT_MOST_GRIDS];
    const hair h = hair_of_view(view);
    return view->strand ? pdf_of_strand(&h, corners_of_view(view, own), theta_i, phi_i) : pdf_of_hair(&h, theta_i, phi_i);
}

#define HAIRLUT_ONE                                                                   \
    {sample_lobe_one, pdf_lobe_one, sample_hair_one, pdf_hair_one, sample_strand_one, \
     pdf_strand_one,  view_one,     sample_view_one, pdf_view_one}

#endif
