/* SPDX-License-Identifier: BSD-3-Clause */
/* The mixture for a block: mixture.h, operation by operation. */
#ifndef HAIRLUT_BATCH_MIXTURE_H
#define HAIRLUT_BATCH_MIXTURE_H

#include "batch_angle.h"
#include "batch_strand.h"
#include "mixture.h"

/* The caller's shares of a block: lobe k's from shares + k * stride on. NULL: the model's own. */
typedef struct given_shares {
    const float *shares;
    size_t stride;
} given_shares;

/* The mixtures of a block. Of arrays of lobes, as many are set as the model has. */
typedef struct mixture_block {
    float weight[HAIRLUT_MAX_LOBES][ROOM]; /* share / sum; where no density can be given, any number or NaN */
    float turn[HAIRLUT_MAX_LOBES][ROOM];   /* only set where a lobe of the model is turned */
    float side[ROOM];                      /* only set where the model is mirrored */
    int chosen[BLOCK];                     /* the lobe that is drawn */
    float valid[BLOCK];                    /* 1, or 0 where no density can be given */
    int all_valid;
    int constant;                 /* whether weights are the same everywhere, and not stored */
    int some[HAIRLUT_MAX_LOBES];  /* whether any of the block has a share of the lobe */
    int every[HAIRLUT_MAX_LOBES]; /* whether all have */
} mixture_block;

enum { FOUR = sizeof(hairlut_four) / sizeof(float) };

/* The four nodes around, as node[4] of mixture.h: offsets in floats, for strands from the first corner's; and the weights between. */
typedef struct grid_nodes {
    int at[4][LANES];
    real t, s;
} grid_nodes;

/* Offsets stay below 2^24 (hairlut_validate_mixture), where floats count exactly. `first` is where the grid begins. */
static inline void find_grid_nodes(const hairlut_model *model, real first, real theta_r, real arc, grid_nodes *c)
{
    const hairlut_mixture *m = &model->mixture;
    const int above = FOUR * m->above, beside = FOUR * m->beside;
    const real j = find_node(&m->theta_r, theta_r, &c->t), o = find_node(&m->arc, arc, &c->s);
    const whole low = truncated(add(first, add(mul(j, all((float)above)), mul(o, all((float)beside)))));
    istore(c->at[0], low);
    istore(c->at[1], iadd(low, iall(above)));
    istore(c->at[2], iadd(low, iall(beside)));
    istore(c->at[3], iadd(low, iall(above + beside)));
}

/* hairlut_blend_shares */
static inline real blend_shares(real a, real b, real t)
{
    return add(mul(sub(all(1.0f), t), a), mul(t, b));
}

/* hairlut_wrap_turns */
static inline real wrap_turns(real a)
{
    const real round = all(hairlut_whole_turns);
    return sub(a, sub(add(add(a, all(hairlut_turn_ties)), round), round));
}

/* hairlut_blend_turns */
static inline real blend_turns(real a, real b, real t)
{
    return add(a, mul(t, wrap_turns(sub(b, a))));
}

/* Four lobes at the four nodes; turns only where lobes are turned. */
typedef struct vector_fours {
    real share[4][4], turn[4][4];
    whole fixed[4][4]; /* turns as they are stored */
} vector_fours;

static inline void gather_turns(const hairlut_four *four, const int *at, whole turn[4])
{
    real bits[4];
    gather4((const float *)(const void *)four->turn, at, bits);
    for (int l = 0; l < 4; ++l)
        turn[l] = as_whole(bits[l]);
}

/* hairlut_read_fours */
static inline void read_fours(const hairlut_mixture *m, const grid_nodes *c, const hairlut_four *four, vector_fours *read)
{
    for (int n = 0; n < 4; ++n) {
        gather4(four->share, c->at[n], read->share[n]);
        if (!m->turned)
            continue;
        gather_turns(four, c->at[n], read->fixed[n]);
        for (int l = 0; l < 4; ++l)
            read->turn[n][l] = converted(read->fixed[n][l]);
    }
}

/* hairlut_blend_fours, of what was read at the first corner, with corner number k */
static inline void add_corner(const hairlut_model *model, const grid_nodes *c, const hairlut_four *four, real weight, int k,
                              vector_fours *sum)
{
    const hairlut_four *here = four + model->strands->mixture.corner[k];
    for (int n = 0; n < 4; ++n) {
        real share[4];
        whole turn[4];
        gather4(here->share, c->at[n], share);
        for (int l = 0; l < 4; ++l)
            sum->share[n][l] = add(sum->share[n][l], mul(weight, share[l]));
        if (!model->mixture.turns_vary)
            continue;
        gather_turns(here, c->at[n], turn);
        for (int l = 0; l < 4; ++l)
            sum->turn[n][l] = add(sum->turn[n][l], mul(weight, converted(isub(turn[l], sum->fixed[n][l]))));
    }
}

static inline void blend_fours(const hairlut_model *model, const real *weight, const grid_nodes *c, const hairlut_four *four,
                               vector_fours *blend)
{
    for (int n = 0; n < 4; ++n)
        for (int l = 0; l < 4; ++l)
            blend->share[n][l] = mul(weight[0], blend->share[n][l]);
    for (int k = 1; k < model->strands->mixture.count; ++k)
        add_corner(model, c, four, weight[k], k, blend);
}

/* hairlut_mixture_between for four lobes, from what stands at the four nodes */
static inline void blend_nodes(const hairlut_mixture *m, const grid_nodes *c, const vector_fours *fours, real share[4],
                               real turn[4])
{
    for (int l = 0; l < 4; ++l)
        share[l] = blend_shares(blend_shares(fours->share[0][l], fours->share[1][l], c->t),
                                blend_shares(fours->share[2][l], fours->share[3][l], c->t), c->s);
    for (int l = 0; m->turned && l < 4; ++l) {
        const real low = blend_turns(fours->turn[0][l], fours->turn[1][l], c->t);
        const real high = blend_turns(fours->turn[2][l], fours->turn[3][l], c->t);
        turn[l] = mul(all(hairlut_turn_radians), wrap_turns(blend_turns(low, high, c->s)));
    }
}

/* hairlut_mixture_given: the shares; returns their sum */
static inline real take_shares(int count, given_shares given, size_t s, real share[HAIRLUT_MAX_LOBES])
{
    real sum = all(0.0f), finite = all(0.0f);
    for (int k = 0; k < count; ++k) {
        const real x = load(given.shares + (size_t)k * given.stride + s);
        finite = add(finite, sub(x, x));
        share[k] = larger(x, all(0.0f));
        sum = add(sum, share[k]);
    }
    const real grown = choose(greater(all(hairlut_small_share), sum), all(hairlut_grow), all(1.0f));
    const real unit = choose(greater(sum, all(hairlut_large_share)), all(hairlut_shrink), grown);
    sum = all(0.0f);
    for (int k = 0; k < count; ++k)
        sum = add(sum, share[k] = mul(share[k], unit));
    return choose(at_least(finite, all(0.0f)), sum, all(0.0f));
}

/* hairlut_mixture_between; turns are stored. strands.values may be NULL. */
static inline void mix_between(const hairlut_model *model, given_strands strands, real theta_r, real h, mixture_block *m,
                               size_t s, real share[HAIRLUT_MAX_LOBES])
{
    const hairlut_mixture *mixture = &model->mixture;
    const hairlut_spacing *spacing = strands.values ? &model->strands->mixture : NULL;
    const int blended = spacing && spacing->count > 1;
    real turn[HAIRLUT_MAX_LOBES], weight[HAIRLUT_CORNERS], first = all(0.0f);
    grid_nodes nodes;
    if (blended) {
        strand_place place;
        find_strands(model->strands, spacing->grid, strands, s, &place);
        weigh_corners(place.t, model->strands->grids[spacing->grid].axis_count, weight);
        first = mul(add(place.node, all(1.0f)), all((float)(FOUR * spacing->pitch)));
    }
    find_grid_nodes(model, first, theta_r, arcsine(mixture->mirrored ? magnitude(h) : h), &nodes);
    for (int q = 0; q < mixture->four_count; ++q) {
        vector_fours fours;
        read_fours(mixture, &nodes, mixture->fours + q, &fours);
        if (blended)
            blend_fours(model, weight, &nodes, mixture->fours + q, &fours);
        blend_nodes(mixture, &nodes, &fours, share + 4 * q, turn + 4 * q);
    }
    for (int k = 0; mixture->turned && k < model->lobe_count; ++k)
        store(m->turn[k] + s, turn[k]);
}

/* hairlut_mixture_fill of samples s .. s+LANES-1, where that is not constant; the shares and, returned, their sum */
static inline real mix_at(const hairlut_model *model, given_strands strands, given_shares given, real theta_r, real offset,
                          mixture_block *m, size_t s, real share[HAIRLUT_MAX_LOBES])
{
    const real h = clamp(offset, all(-1.0f), all(1.0f));
    real sum = all(0.0f);
    mix_between(model, strands, theta_r, h, m, s, share);
    for (int k = 0; k < model->lobe_count; ++k)
        sum = add(sum, share[k]);
    if (given.shares)
        sum = take_shares(model->lobe_count, given, s, share);
    if (model->mixture.mirrored)
        store(m->side + s, choose(greater(all(0.0f), h), all(-1.0f), all(1.0f)));
    return sum;
}

/* The weights of those shares; `wanted`, whether the arguments have a density. */
static inline void store_weights(const hairlut_model *model, const real *share, real sum, mask wanted, mixture_block *m,
                                 size_t s)
{
    const mask valid = both(wanted, greater(sum, all(0.0f)));
    const real unit = over(all(1.0f), sum);
    for (int k = 0; k < model->lobe_count && !m->constant; ++k)
        store(m->weight[k] + s, mul(share[k], unit));
    store(m->valid + s, choose(valid, all(1.0f), all(0.0f)));
    m->all_valid &= every(valid);
}

/* hairlut_mixture_choose */
static inline void choose_lobes(const hairlut_model *model, const real *share, real sum, real u_lobe, mixture_block *m,
                                size_t s)
{
    const real target = mul(clamp(u_lobe, all(0.0f), all(1.0f)), sum);
    real below = all(0.0f), chosen = all(0.0f);
    for (int k = 0; k < model->lobe_count; ++k) {
        chosen = choose(both(at_least(target, below), greater(share[k], all(0.0f))), all((float)k), chosen);
        below = add(below, share[k]);
    }
    istore(m->chosen + s, truncated(chosen));
}

/* The weight of lobe k of samples s .. s+LANES-1 */
static inline real weight_at(const hairlut_model *model, const mixture_block *m, int k, size_t s)
{
    return m->constant ? all(model->mixture.mix.weight[k]) : load(m->weight[k] + s);
}

/* Before those of n samples are mixed: shares and turns that are the same for all. */
static inline void begin_mixtures(const hairlut_model *model, given_strands strands, given_shares given, size_t n,
                                  mixture_block *m, real share[HAIRLUT_MAX_LOBES])
{
    m->all_valid = 1;
    m->constant = model->mixture.constant && !given.shares && !strands.values;
    for (int k = 0; m->constant && k < model->lobe_count; ++k) {
        share[k] = all(model->mixture.mix.share[k]);
        for (size_t s = 0; model->mixture.turned && s < n; s += LANES)
            store(m->turn[k] + s, all(model->mixture.mix.turn[k]));
    }
}

/* Fills `some` and `every` once the weights of n samples are set. */
static inline void sum_up(const hairlut_model *model, size_t n, mixture_block *m)
{
    for (int k = 0; k < model->lobe_count; ++k) {
        real least = all(1.0f), most = all(0.0f);
        for (size_t s = 0; s < (m->constant ? LANES : n); s += LANES) {
            least = smaller(weight_at(model, m, k, s), least);
            most = larger(weight_at(model, m, k, s), most);
        }
        m->some[k] = !every(at_least(all(0.0f), most));
        m->every[k] = every(greater(least, all(0.0f)));
    }
}

#endif
