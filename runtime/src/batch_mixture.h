/* SPDX-License-Identifier: BSD-3-Clause */
/* The mixture for a block: mixture.h, operation by operation. */
#ifndef HAIRLUT_BATCH_MIXTURE_H
#define HAIRLUT_BATCH_MIXTURE_H

#include "batch_angle.h"
#include "batch_axis.h"
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

enum { COUNTED_NODES = 64 }; /* up to so many are counted for whole vectors, more are halved for single samples */

/* hairlut_mixture_node */
static inline real find_node(const float *nodes, int count, real x, real *t)
{
    float at[LANES], place[LANES];
    real j = all(0.0f);
    *t = all(0.0f);
    if (count == 1)
        return j;
    if (count <= COUNTED_NODES) {
        for (int k = 1; k < count - 1; ++k)
            j = add(j, choose(at_least(x, all(nodes[2 * k])), all(1.0f), all(0.0f)));
    } else {
        store(at, x);
        for (int l = 0; l < LANES; ++l)
            place[l] = (float)hairlut_mixture_node(nodes, count, at[l]).j;
        j = load(place);
    }
    int offset[LANES];
    real node[4];
    istore(offset, truncated(add(j, j)));
    gather4(nodes, offset, node);
    *t = clamp(mul(sub(x, node[0]), node[1]), all(0.0f), all(1.0f));
    return j;
}

/* The four corners around: offsets of the first lobe's floats at each, and the weights between. */
typedef struct grid_corners {
    int low[LANES], low_above[LANES], high[LANES], high_above[LANES];
    real t, s;
} grid_corners;

/* Offsets stay below 2^24 (hairlut_validate_mixture), where floats count exactly. */
static inline void find_corners(const hairlut_model *model, real theta_r, real arc, grid_corners *c)
{
    const hairlut_mixture *m = &model->mixture;
    const int node = HAIRLUT_CORNER * model->lobe_count, above = m->rows > 1 ? node * m->columns : 0;
    const int beside = m->columns > 1 ? node : 0;
    const real j = find_node(m->theta_r, m->rows, theta_r, &c->t), o = find_node(m->arc, m->columns, arc, &c->s);
    const whole low = truncated(add(mul(j, all((float)above)), mul(o, all((float)beside))));
    istore(c->low, low);
    istore(c->low_above, iadd(low, iall(above)));
    istore(c->high, iadd(low, iall(beside)));
    istore(c->high_above, iadd(low, iall(above + beside)));
}

/* hairlut_blend_shares, and hairlut_blend_turns where lobes are turned */
static inline real blend_corners(const hairlut_mixture *m, const grid_corners *c, int lobe, real *turn)
{
    const float *at = m->corners + HAIRLUT_CORNER * lobe;
    real low[4], low_above[4], high[4], high_above[4];
    const real t = c->t, s = c->s, t0 = sub(all(1.0f), t), s0 = sub(all(1.0f), s);
    gather4(at, c->low, low);
    gather4(at, c->low_above, low_above);
    gather4(at, c->high, high);
    gather4(at, c->high_above, high_above);
    if (m->turned) {
        const real from = add(low[1], mul(t, low[2])), to = add(high[1], mul(t, high[2]));
        *turn = wrap_near(add(from, mul(s, wrap_near(sub(to, from), -hairlut_pi))), -hairlut_pi);
    }
    const real from = add(mul(t0, low[0]), mul(t, low_above[0])), to = add(mul(t0, high[0]), mul(t, high_above[0]));
    return add(mul(s0, from), mul(s, to));
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

/* Whether a model's mixture has a single node. */
static inline int is_alone(const hairlut_model *model)
{
    return model->mixture.rows == 1 && model->mixture.columns == 1;
}

/* hairlut_mixture_fill of samples s .. s+LANES-1, where that is not constant; the shares and, returned, their sum */
static inline real mix_at(const hairlut_model *model, given_shares given, real theta_r, real offset, mixture_block *m,
                          size_t s, real share[HAIRLUT_MAX_LOBES])
{
    const hairlut_mixture *mixture = &model->mixture;
    const int count = model->lobe_count, alone = is_alone(model);
    const real h = clamp(offset, all(-1.0f), all(1.0f));
    real sum = all(0.0f);
    grid_corners c;
    if (!alone)
        find_corners(model, theta_r, arcsine(mixture->mirrored ? magnitude(h) : h), &c);
    for (int k = 0; k < count; ++k) {
        const float *corner = mixture->corners + HAIRLUT_CORNER * k;
        real turn = all(corner[1]);
        share[k] = alone ? all(corner[0]) : blend_corners(mixture, &c, k, &turn);
        sum = add(sum, share[k]);
        if (mixture->turned)
            store(m->turn[k] + s, turn);
    }
    if (given.shares)
        sum = take_shares(count, given, s, share);
    if (mixture->mirrored)
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
static inline void begin_mixtures(const hairlut_model *model, given_shares given, size_t n, mixture_block *m,
                                  real share[HAIRLUT_MAX_LOBES])
{
    m->all_valid = 1;
    m->constant = model->mixture.constant && !given.shares;
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
