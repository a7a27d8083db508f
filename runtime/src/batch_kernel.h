/* The kernels for one instruction set, written once. A file that includes this has included a simd_*.h, whose operations
 * work on LANES floats (real), 32-bit integers (whole) or truth values (mask):
 *
 *   smaller(a, b) = a < b ? a : b and larger(a, b) = a > b ? a : b, so that NaN in a gives b
 *   truncated(a)    towards zero; any integer where a has none
 *   imul(a, b)      of integers in [0, 2^15)
 *   every(m)        whether all lanes are true
 *   iwhere(m, a)    a in the lanes that are true, 0 in the others
 *   shifted(a)      the floats whose bits are those of a > 0 shifted right by two
 *   gather4(p, at, x)  lane l of x[k] = p[at[l] + k]
 *   HAIRLUT_COUNT(group, above, t, x, n)  may be defined: hairlut_count with wider vectors
 *   HAIRLUT_COUNTS(groups, above, at, t, x, n)  may be defined: lane l has the count of groups and above + at[l], t[l], x[l]
 *   HAIRLUT_CELLS_BY_AVX2  may be defined: then there is no gather4, and n of a count is 16
 *
 * Every formula repeats axis.h, angle.h and lobes.h operation by operation, without fused multiply-add: that makes the
 * results equal bit for bit. The work on a block is done in passes, each short enough that a processor has several vectors
 * of it under way: a single pass would wait for where to load from, then for the loads, then for quotients
 * (tests/bench/NOTES.md). A pass that writes outputs reads the inputs of no other vectors, and each before it writes there;
 * later passes read no inputs. That is what allows outputs in place of inputs. */
#ifndef HAIRLUT_BATCH_KERNEL_H
#define HAIRLUT_BATCH_KERNEL_H

#include "batch_arrays.h"
#include "batch_cells.h"
#include "lobes.h"

/* Sixteen lanes come with twice the registers: there, solid angles are found in the pass that has the angles. */
enum { SOLID_ANGLES_APART = LANES < 16 };

static inline real clamp(real x, real low, real high)
{
    return smaller(larger(x, low), high);
}

/* hairlut_axis_row */
static inline whole find_row(const hairlut_axis *axis, real theta_r, real *t)
{
    const real scaled = mul(sub(theta_r, all(axis->row_origin)), all(axis->row_scale));
    const real r = clamp(scaled, all(0.0f), all(axis->row_last));
    const whole j = truncated(r);
    *t = sub(r, converted(j));
    return j;
}

/* hairlut_axis_knot, but for the offset: the cell, counted from the nearer end */
static inline whole find_knot(const hairlut_axis *axis, real u, real *m)
{
    *m = larger(smaller(u, sub(all(1.0f), u)), all(0.0f));
    const real y = axis->warp == HAIRLUT_WARP_OCTAVES ? shifted(add(*m, all(axis->e))) : *m;
    return truncated(sub(mul(y, all(axis->scale)), all(axis->origin)));
}

/* *holds gets 1, or 0 where theta_r or u is not a number; NULL if nobody asks. A later pass had better not read those again:
 * arrays that begin at the same offset in a page, as big ones do, push each other out of the first-level cache. */
static inline void place(const hairlut_axis *axis, size_t n, const float *theta_r, const float *u, draws *q, float *holds)
{
    for (size_t s = 0; s < n; s += LANES) {
        real t, m;
        const real angle = load(theta_r + s), number = load(u + s);
        const whole j = find_row(axis, angle, &t), i = find_knot(axis, number, &m);
        istore(q->at + s, cell_offset(axis, j, i, greater(number, all(0.5f))));
        store(q->t + s, t);
        store(q->m + s, m);
        if (holds)
            store(holds + s, choose(numbers(angle, number), all(1.0f), all(0.0f)));
    }
}

/* hairlut_axis_sample, not moved into the domain, of samples s .. s+LANES-1 that were placed and fetched */
static inline real draw(const draws *q, size_t s, real *slope)
{
    const real d = load(q->m + s);
    const real bend = mul(load(q->t + s), d), mean_slope = sub(load(q->a + s), bend);
    *slope = magnitude(sub(mean_slope, bend));
    return add(load(q->x0 + s), mul(d, mean_slope));
}

/* hairlut_cell_slope, of angles s .. s+LANES-1 whose cells are found */
static inline real slope_at(const queries *q, size_t s)
{
    const real a = load(q->a + s), square = mul(a, a);
    const real here = sub(square, mul(mul(all(4.0f), load(q->t + s)), load(q->x + s)));
    return root(larger(here, mul(all(hairlut_least_square), square)));
}

/* Asks for x, moved into the domain: the search is for what a row holds, not for infinity. Returns whether the domain holds x. */
static inline mask ask(const hairlut_axis *axis, real theta_r, real x, queries *q, size_t s)
{
    const real low = all(axis->low), high = all(axis->high);
    real t;
    const whole j = find_row(axis, theta_r, &t);
    istore(q->j + s, j);
    istore(q->at + s, imul(j, iall(axis->stride)));
    store(q->t + s, t);
    store(q->x + s, clamp(x, low, high));
    return both(at_least(x, low), at_least(high, x));
}

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

/* hairlut_wrap_down */
static inline real wrap_down(real phi, float low)
{
    const real high = all(low + hairlut_two_pi);
    const real turned = sub(sub(phi, all(hairlut_two_pi_high)), all(hairlut_two_pi_low));
    const real r = choose(at_least(phi, high), turned, phi);
    return choose(greater(high, r), r, all(low));
}

/* hairlut_wrap_up */
static inline real wrap_up(real phi, float low)
{
    const real turned = add(add(phi, all(hairlut_two_pi_high)), all(hairlut_two_pi_low));
    const real r = choose(greater(all(low), phi), turned, phi);
    return choose(both(greater(r, all(low)), greater(all(low + hairlut_two_pi), r)), r, all(low));
}

/* hairlut_cos */
static inline real cosine(real theta)
{
    const real z = larger(add(sub(all(hairlut_half_pi_high), magnitude(theta)), all(hairlut_half_pi_low)),
                          all(-hairlut_half_pi_low));
    const real w = mul(z, z);
    const real low = add(all(hairlut_sine[0]), mul(all(hairlut_sine[1]), w));
    const real high = add(all(hairlut_sine[2]), mul(all(hairlut_sine[3]), w));
    return add(z, mul(mul(z, w), add(low, mul(mul(w, w), high))));
}

/* What hairlut_known asks of phi_r and b; of theta_r and u, place does. */
static inline mask known_phi(real phi_r, real b)
{
    return numbers(b, sub(phi_r, phi_r));
}

static inline void store_samples(const hairlut_axis *axis, hairlut_samples out, size_t s, real theta_i, real phi_i, real pdf,
                                 draws *q)
{
    if (SOLID_ANGLES_APART) {
        store(q->x0 + s, theta_i);
        store(q->a + s, pdf);
    } else if (out.pdf_solid_angle) {
        store(out.pdf_solid_angle + s, over(pdf, cosine(theta_i)));
    }
    store(out.theta_i + s, clamp(theta_i, all(axis->low), all(axis->high)));
    store(out.phi_i + s, phi_i);
    if (out.pdf_angle)
        store(out.pdf_angle + s, pdf);
}

/* hairlut_per_steradian, after store_samples */
static inline void store_solid_angles(size_t n, const draws *q, float *pdf_solid_angle)
{
    for (size_t s = 0; SOLID_ANGLES_APART && pdf_solid_angle && s < n; s += LANES)
        store(pdf_solid_angle + s, over(load(q->a + s), cosine(load(q->x0 + s))));
}

static inline void sample_direct_block(const hairlut_model *shared, size_t n, const float *const in[4], hairlut_samples out)
{
    const hairlut_model copy = *shared, *model = &copy; /* no output can change it: what a loop uses stays in registers */
    draws theta, phi;
    float holds[BLOCK];
    place(&model->direct_theta, n, in[0], in[2], &theta, holds);
    place(&model->direct_phi, n, in[0], in[3], &phi, NULL);
    fetch(&model->direct_theta, n, &theta);
    fetch(&model->direct_phi, n, &phi);
    for (size_t s = 0; s < n; s += LANES) {
        const real phi_r = load(in[1] + s);
        const mask valid = known_phi(phi_r, load(in[3] + s));
        real slope_theta, slope_phi;
        const real theta_i = draw(&theta, s, &slope_theta), relative = draw(&phi, s, &slope_phi);
        const real r = wrap(phi_r, -hairlut_pi);
        const real phi_i = model->azimuth == HAIRLUT_AZIMUTH_SUM ? sub(relative, r) : add(relative, r);
        store_samples(&model->direct_theta, out, s, theta_i, wrap_down(phi_i, -hairlut_pi),
                      choose(valid, over(load(holds + s), mul(slope_theta, slope_phi)), all(0.0f)), &theta);
    }
    store_solid_angles(n, &theta, out.pdf_solid_angle);
}

static inline void sample_multiple_block(const hairlut_model *shared, size_t n, const float *const in[4],
                                         hairlut_samples out)
{
    const hairlut_model copy = *shared, *model = &copy;
    draws theta;
    float holds[BLOCK];
    place(&model->multiple_theta, n, in[0], in[2], &theta, holds);
    fetch(&model->multiple_theta, n, &theta);
    for (size_t s = 0; s < n; s += LANES) {
        const real u_phi = load(in[3] + s);
        const mask valid = known_phi(load(in[1] + s), u_phi);
        const real turn = mul(all(hairlut_two_pi), clamp(u_phi, all(0.0f), all(1.0f)));
        const real phi = sub(turn, all(hairlut_pi));
        const real phi_i = choose(greater(all(hairlut_pi), phi), phi, all(-hairlut_pi));
        real slope;
        const real theta_i = draw(&theta, s, &slope);
        store_samples(&model->multiple_theta, out, s, theta_i, phi_i,
                      choose(valid, mul(load(holds + s), over(all(hairlut_inverse_two_pi), slope)), all(0.0f)), &theta);
    }
    store_solid_angles(n, &theta, out.pdf_solid_angle);
}

/* hairlut_relative_azimuth */
static inline real relative_azimuth(const hairlut_model *model, real phi_r, real phi_i)
{
    const real r = wrap(phi_r, -hairlut_pi), i = wrap(phi_i, -hairlut_pi);
    return wrap_up(model->azimuth == HAIRLUT_AZIMUTH_SUM ? add(i, r) : sub(i, r), 0.0f);
}

/* The density is 0 where an argument is not a number or an azimuth is infinite. */
static inline mask known_pdf(real theta_r, real phi_r, real theta_i, real phi_i)
{
    return both(both(numbers(theta_r, theta_i), known_phi(phi_r, phi_i)), at_least(all(FLT_MAX), magnitude(phi_i)));
}

static inline void pdf_direct_block(const hairlut_model *model, size_t n, const float *const in[4], float *out)
{
    queries theta, phi;
    float holds[BLOCK]; /* 1, or 0 where the density is 0 */
    for (size_t s = 0; s < n; s += LANES) {
        const real theta_r = load(in[0] + s), phi_r = load(in[1] + s), theta_i = load(in[2] + s), phi_i = load(in[3] + s);
        const mask in_theta = ask(&model->direct_theta, theta_r, theta_i, &theta, s);
        const mask in_phi = ask(&model->direct_phi, theta_r, relative_azimuth(model, phi_r, phi_i), &phi, s);
        const mask valid = both(both(in_theta, in_phi), known_pdf(theta_r, phi_r, theta_i, phi_i));
        store(holds + s, choose(valid, all(1.0f), all(0.0f)));
    }
    find_cells(&model->direct_theta, n, &theta);
    find_cells(&model->direct_phi, n, &phi);
    for (size_t s = 0; s < n; s += LANES)
        store(out + s, over(load(holds + s), mul(slope_at(&theta, s), slope_at(&phi, s))));
}

static inline void pdf_multiple_block(const hairlut_model *model, size_t n, const float *const in[4], float *out)
{
    queries theta;
    float holds[BLOCK]; /* the density in the azimuth, or 0 */
    for (size_t s = 0; s < n; s += LANES) {
        const real theta_r = load(in[0] + s), phi_r = load(in[1] + s), theta_i = load(in[2] + s), phi_i = load(in[3] + s);
        const mask in_theta = ask(&model->multiple_theta, theta_r, theta_i, &theta, s);
        const mask valid = both(in_theta, known_pdf(theta_r, phi_r, theta_i, phi_i));
        store(holds + s, choose(valid, all(hairlut_inverse_two_pi), all(0.0f)));
    }
    find_cells(&model->multiple_theta, n, &theta);
    for (size_t s = 0; s < n; s += LANES)
        store(out + s, over(load(holds + s), slope_at(&theta, s)));
}

static void sample_direct(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                          const float *u_theta, const float *u_phi, hairlut_samples out)
{
    const float *const in[4] = {theta_r, phi_r, u_theta, u_phi};
    sample_blocks(sample_direct_block, model, n, in, out);
}

static void sample_multiple(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                            const float *u_theta, const float *u_phi, hairlut_samples out)
{
    const float *const in[4] = {theta_r, phi_r, u_theta, u_phi};
    sample_blocks(sample_multiple_block, model, n, in, out);
}

static void pdf_direct(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                       const float *theta_i, const float *phi_i, float *pdf_angle)
{
    const float *const in[4] = {theta_r, phi_r, theta_i, phi_i};
    pdf_blocks(pdf_direct_block, model, n, in, pdf_angle);
}

static void pdf_multiple(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                         const float *theta_i, const float *phi_i, float *pdf_angle)
{
    const float *const in[4] = {theta_r, phi_r, theta_i, phi_i};
    pdf_blocks(pdf_multiple_block, model, n, in, pdf_angle);
}

#endif
