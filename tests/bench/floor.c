/* SPDX-License-Identifier: BSD-3-Clause */
#include "floor.h"

#include <stddef.h>

#ifdef __AVX2__
#include "lobe.h"

/* The tables of `fitted`, whose rows are of the same theta_r, and the groups of a row of each. */
enum { DIRECT_THETA_GROUPS = 4, DIRECT_PHI_GROUPS = 4, MULTIPLE_THETA_GROUPS = 3 };
static hairlut_axis direct_theta, direct_phi, multiple_theta;
static float direct_weight, multiple_weight; /* their sum is 1 */

HAIRLUT_INLINE hairlut_found found_on(const hairlut_axis *axis, int groups, const hairlut_row *row, float given)
{
    const float x = hairlut_axis_inside(axis, given);
    const float *rows = axis->rows + (unsigned)row->j * (unsigned)axis->stride;
    const hairlut_link *link = axis->links + hairlut_axis_search_whole(rows, groups, row->t, x);
    const float *cell = axis->ends[0] + (link->offset + HAIRLUT_CELL * (unsigned)row->j);
    const hairlut_found found = {x, given, link->h, hairlut_axis_blend(row, cell)};
    return found;
}

HAIRLUT_INLINE void find_direct(const hairlut_row *row, float r, float theta_i, float i, hairlut_found found[2])
{
    found[0] = found_on(&direct_theta, DIRECT_THETA_GROUPS, row, theta_i);
    found[1] = found_on(&direct_phi, DIRECT_PHI_GROUPS, row, hairlut_wrap_near(i - r, 0.0f));
}

HAIRLUT_INLINE void find_multiple(const hairlut_row *row, float theta_i, hairlut_found found[2])
{
    found[0] = found_on(&multiple_theta, MULTIPLE_THETA_GROUPS, row, theta_i);
    found[1] = hairlut_find_uniform();
}

static float pdf(float theta_r, float phi_r, float theta_i, float phi_i)
{
    const float r = hairlut_wrap(phi_r, -hairlut_pi), i = hairlut_wrap(phi_i, -hairlut_pi);
    const hairlut_row row = hairlut_axis_row(&direct_theta, theta_r);
    hairlut_found found[4];
    find_direct(&row, r, theta_i, i, found);
    find_multiple(&row, theta_i, found + 2);
    const hairlut_quad density = hairlut_densities(found);
    return direct_weight * hairlut_quad_first(density) + multiple_weight * hairlut_quad_third(density);
}

static float pdf_direct(float theta_r, float phi_r, float theta_i, float phi_i)
{
    const float r = hairlut_wrap(phi_r, -hairlut_pi), i = hairlut_wrap(phi_i, -hairlut_pi);
    const hairlut_row row = hairlut_axis_row(&direct_theta, theta_r);
    hairlut_found found[2];
    find_direct(&row, r, theta_i, i, found);
    return hairlut_density(found);
}

static hairlut_sample sample(float theta_r, float phi_r, float u_lobe, float u_theta, float u_phi)
{
    const float r = hairlut_wrap(phi_r, -hairlut_pi);
    const hairlut_row row = hairlut_axis_row(&direct_theta, theta_r);
    hairlut_found other[2];
    if (u_lobe < direct_weight) {
        const hairlut_placed theta = hairlut_axis_find_place(&direct_theta, &row, u_theta),
                             phi = hairlut_axis_find_place(&direct_phi, &row, u_phi);
        const hairlut_drawn drawn = hairlut_draw_both(&theta, &phi);
        const float theta_i = hairlut_axis_inside(&direct_theta, drawn.theta);
        find_multiple(&row, theta_i, other);
        return hairlut_finish(theta_i, hairlut_wrap_near(drawn.phi + r, -hairlut_pi),
                              direct_weight * drawn.pdf + multiple_weight * hairlut_density(other));
    }
    const hairlut_placed theta = hairlut_axis_find_place(&multiple_theta, &row, u_theta);
    const hairlut_drawn drawn = hairlut_draw_uniform(&theta, u_phi);
    const float theta_i = hairlut_axis_inside(&multiple_theta, drawn.theta);
    find_direct(&row, r, theta_i, drawn.phi, other);
    return hairlut_finish(theta_i, drawn.phi, multiple_weight * drawn.pdf + direct_weight * hairlut_density(other));
}

static int is_fitted(const hairlut_model *model)
{
    const hairlut_lobe *direct = &model->lobes[0], *multiple = &model->lobes[1];
    return model->lobe_count == 2 && model->grid_count == 1 && model->mixture.constant && !model->mixture.turned &&
           !direct->uniform && multiple->uniform && direct->sign == -1.0f && direct->theta.groups == DIRECT_THETA_GROUPS &&
           direct->phi.groups == DIRECT_PHI_GROUPS && multiple->theta.groups == MULTIPLE_THETA_GROUPS;
}

const bench_floor *bench_floor_of(const hairlut_model *model)
{
    static const bench_floor calls = {sample, pdf, pdf_direct};
    if (!__builtin_cpu_supports("avx2") || !is_fitted(model))
        return NULL;
    direct_theta = model->lobes[0].theta;
    direct_phi = model->lobes[0].phi;
    multiple_theta = model->lobes[1].theta;
    direct_weight = model->mixture.mix.weight[0];
    multiple_weight = model->mixture.mix.weight[1];
    return &calls;
}
#else
const bench_floor *bench_floor_of(const hairlut_model *model)
{
    (void)model;
    return NULL;
}
#endif
