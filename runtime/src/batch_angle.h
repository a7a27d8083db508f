/* SPDX-License-Identifier: BSD-3-Clause */
/* angle.h in vectors, operation by operation. */
#ifndef HAIRLUT_BATCH_ANGLE_H
#define HAIRLUT_BATCH_ANGLE_H

#include "angle.h"

/* phi less n turns; low where that is not in [low, low + 2 pi) */
static inline real less_turns(real phi, real n, float low)
{
    const real r = sub(sub(phi, mul(n, all(hairlut_two_pi_high))), mul(n, all(hairlut_two_pi_low)));
    return choose(both(at_least(r, all(low)), greater(all(low + hairlut_two_pi), r)), r, all(low));
}

/* hairlut_wrap */
static inline real wrap(real phi, float low)
{
    const mask inside = both(at_least(phi, all(low)), greater(all(low + hairlut_two_pi), phi));
    if (every(inside))
        return phi;
    const real x = mul(sub(phi, all(low)), all(hairlut_inverse_two_pi));
    const real towards_zero = choose(greater(all(8388608.0f), magnitude(x)), converted(truncated(x)), x);
    const real turns = sub(towards_zero, choose(greater(towards_zero, x), all(1.0f), all(0.0f)));
    return choose(inside, phi, less_turns(phi, turns, low));
}

/* hairlut_wrap_near */
static inline real wrap_near(real phi, float low)
{
    const real turns = add(mul(sub(phi, all(low)), all(hairlut_inverse_two_pi)), all(hairlut_half_down));
    const real n = sub(add(turns, all(hairlut_integers)), all(hairlut_integers));
    return wrap(sub(sub(phi, mul(n, all(hairlut_two_pi_high))), mul(n, all(hairlut_two_pi_low))), low);
}

/* hairlut_cos */
static inline real cosine(real theta)
{
    const real z =
        larger(add(sub(all(hairlut_half_pi_high), magnitude(theta)), all(hairlut_half_pi_low)), all(-hairlut_half_pi_low));
    const real w = mul(z, z);
    const real low = add(all(hairlut_sine[0]), mul(all(hairlut_sine[1]), w));
    const real high = add(all(hairlut_sine[2]), mul(all(hairlut_sine[3]), w));
    return add(z, mul(mul(z, w), add(low, mul(mul(w, w), high))));
}

/* hairlut_asin */
static inline real arcsine(real h)
{
    const real a = magnitude(h);
    const mask large = greater(a, all(0.5f));
    const real z = choose(large, mul(all(0.5f), sub(all(1.0f), a)), mul(a, a)), r = choose(large, root(z), a);
    const real p = add(all(hairlut_arcsine[3]), mul(z, all(hairlut_arcsine[4])));
    const real q =
        add(all(hairlut_arcsine[0]), mul(z, add(all(hairlut_arcsine[1]), mul(z, add(all(hairlut_arcsine[2]), mul(z, p))))));
    const real y = add(r, mul(mul(r, z), q));
    const real size = choose(large, sub(all(hairlut_half_pi_high), mul(all(2.0f), y)), y);
    return choose(greater(all(0.0f), h), sub(all(0.0f), size), size);
}

#endif
