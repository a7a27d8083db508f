/* The kernels for one instruction set, written once. A file that includes this has included a simd_*.h, whose operations
 * work on LANES floats (real), 32-bit integers (whole) or truth values (mask):
 *
 *   smaller(a, b) = a < b ? a : b and larger(a, b) = a > b ? a : b, so that NaN in a gives b
 *   truncated(a)    towards zero; any integer where a has none
 *   imul(a, b)      of integers in [0, 2^15)
 *   gather4(p, at, x)  lane l of x[k] = p[at[l] + k]
 *   count(a, stride, t, x, n)  if HAIRLUT_SEARCH is defined: hairlut_count with wider vectors; n <= 16, 16 floats are read
 *
 * Every formula repeats axis.h, angle.h and lobes.h operation by operation, without fused multiply-add: that makes the
 * results equal bit for bit. The work on a block is done in passes, because a single one would wait for the square roots,
 * then for the loads (tests/bench/NOTES.md). In a pass, all inputs of a vector are read before its outputs are written,
 * which is what allows outputs in place of inputs. */
#ifndef HAIRLUT_BATCH_KERNEL_H
#define HAIRLUT_BATCH_KERNEL_H

#include "lobes.h"

#ifndef HAIRLUT_SEARCH
static inline int count(const float *a, int stride, float t, float x, int n)
{
    return hairlut_count(a, stride, t, x, n);
}
#endif

enum { BLOCK = 128 }; /* samples a pass */

/* Where the samples of a block read an axis: the offset of the cell's first texel, and hairlut_knot. */
typedef struct places {
    int at[BLOCK];
    float t[BLOCK];
    float f[BLOCK];
    float du[BLOCK];
} places;

/* Where the directions of a block are looked up: the offset of the row, the cell as far as it is found, and the angle. */
typedef struct queries {
    int row[BLOCK];
    int cell[BLOCK];
    float t[BLOCK];
    float x[BLOCK];
} queries;

typedef struct cells {
    real x0, d, c;
} cells;

static inline real clamp(real x, real low, real high)
{
    return smaller(larger(x, low), high);
}

static inline real blend_width(real a, real b, real s, real t)
{
    return add(mul(s, a), mul(t, b));
}

/* hairlut_axis_rows: the offset of the row below theta_r, and t */
static inline whole find_rows(const hairlut_axis *axis, real theta_r, real *t)
{
    const real scaled = mul(sub(theta_r, all(axis->row_origin)), all(axis->row_scale));
    const real r = clamp(scaled, all(0.0f), all(axis->row_last));
    const whole j = ismaller(truncated(r), iall(axis->height - 2));
    *t = sub(r, converted(j));
    return imul(j, iall(axis->stride));
}

/* hairlut_axis_du */
static inline real du_dcolumn(const hairlut_axis *axis, real y)
{
    return axis->warp == HAIRLUT_WARP_QUARTIC ? mul(all(axis->du), mul(y, mul(y, y))) : all(axis->du);
}

/* hairlut_axis_knot, whose fold is a subtraction here */
static inline whole find_knot(const hairlut_axis *axis, real u, real *f, real *du)
{
    const real m = larger(smaller(u, sub(all(1.0f), u)), all(0.0f));
    const real y = axis->warp == HAIRLUT_WARP_QUARTIC ? root(root(add(m, all(axis->e)))) : m;
    const real c = mul(sub(y, all(axis->f0)), all(axis->inverse_k));
    const mask upper = greater(u, all(0.5f));
    const whole i = truncated(c);
    const real part = sub(c, converted(i));
    *f = choose(upper, sub(all(1.0f), part), part);
    *du = du_dcolumn(axis, y);
    return ichoose(upper, isub(iall(axis->columns - 2), i), i);
}

static inline void place(const hairlut_axis *axis, size_t n, const float *theta_r, const float *u, places *p)
{
    for (size_t s = 0; s < n; s += LANES) {
        real t, f, du;
        const whole row = find_rows(axis, load(theta_r + s), &t);
        istore(p->at + s, iadd(row, find_knot(axis, load(u + s), &f, &du)));
        store(p->t + s, t);
        store(p->f + s, f);
        store(p->du + s, du);
    }
}

/* hairlut_axis_cell */
static inline cells load_cells(const hairlut_axis *axis, const int *at, real t)
{
    real a[4], b[4];
    gather4(axis->rows, at, a);
    gather4(axis->rows + axis->stride, at, b);
    const real s = sub(all(1.0f), t);
    const real before = blend_width(sub(a[1], a[0]), sub(b[1], b[0]), s, t);
    const real after = blend_width(sub(a[3], a[2]), sub(b[3], b[2]), s, t);
    cells cell;
    cell.x0 = add(a[1], mul(t, sub(b[1], a[1])));
    cell.d = blend_width(sub(a[2], a[1]), sub(b[2], b[1]), s, t);
    const real bound = mul(all(axis->limit), cell.d);
    cell.c = clamp(mul(all(0.25f), sub(before, after)), sub(all(-0.0f), bound), bound);
    return cell;
}

/* hairlut_axis_sample at the places of samples s .. s+LANES-1 */
static inline real draw(const hairlut_axis *axis, const places *p, size_t s, real *pdf)
{
    const real f = load(p->f + s);
    const cells cell = load_cells(axis, p->at + s, load(p->t + s));
    const real x = add(cell.x0, mul(f, add(cell.d, mul(cell.c, sub(all(1.0f), f)))));
    const real slope = add(cell.d, mul(cell.c, sub(all(1.0f), mul(all(2.0f), f))));
    *pdf = over(load(p->du + s), slope);
    return smaller(x, all(axis->high));
}

/* hairlut_axis_find up to the pivots: the first cell after the last pivot that is at most x */
static inline void find_blocks(const hairlut_axis *axis, size_t n, queries *q)
{
    for (size_t k = 0; k < n; ++k)
        q->cell[k] = axis->step * count(axis->rows + q->row[k] - HAIRLUT_PIVOTS, axis->stride, q->t[k], q->x[k],
                                        HAIRLUT_PIVOTS);
}

/* The rest of hairlut_axis_find, one query at a time. */
static inline void find_in_blocks(const hairlut_axis *axis, size_t n, queries *q)
{
    for (size_t k = 0; k < n; ++k) {
        const float *row = axis->rows + q->row[k];
        int size = axis->columns - 1 - q->cell[k];
        size = size < axis->step ? size : axis->step;
        const int first = hairlut_halve(row, axis->stride, q->t[k], q->x[k], q->cell[k], &size);
        q->cell[k] = first + count(row + first + 2, axis->stride, q->t[k], q->x[k], size - 1);
    }
}

/* The same for blocks of at most four cells, whose three inner texels one load brings. */
static inline void find_in_small_blocks(const hairlut_axis *axis, size_t n, queries *q)
{
    for (size_t s = 0; s < n; s += LANES) {
        const whole first = iload(q->cell + s);
        const whole size = ismaller(isub(iall(axis->columns - 1), first), iall(axis->step));
        const real inner = converted(isub(size, iall(1))), t = load(q->t + s), x = load(q->x + s);
        int at[LANES];
        real a[4], b[4];
        istore(at, iadd(first, iload(q->row + s)));
        gather4(axis->rows + 2, at, a);
        gather4(axis->rows + 2 + axis->stride, at, b);
        whole cell = first;
        for (int k = 0; k < 3; ++k) {
            const mask below = at_least(x, add(a[k], mul(t, sub(b[k], a[k]))));
            cell = ichoose(both(below, greater(inner, all((float)k))), iadd(cell, iall(1)), cell);
        }
        istore(q->cell + s, cell);
    }
}

static inline void find_cells(const hairlut_axis *axis, size_t n, queries *q)
{
    find_blocks(axis, n, q);
    if (axis->step <= 4)
        find_in_small_blocks(axis, n, q);
    else
        find_in_blocks(axis, n, q);
}

static inline void ask_rows(const hairlut_axis *axis, size_t n, const float *theta_r, queries *q)
{
    for (size_t s = 0; s < n; s += LANES) {
        real t;
        istore(q->row + s, find_rows(axis, load(theta_r + s), &t));
        store(q->t + s, t);
    }
}

/* hairlut_cell_solve and the end of hairlut_axis_pdf */
static inline real density(const hairlut_axis *axis, const queries *q, size_t s)
{
    const real x = load(q->x + s), one = all(1.0f);
    const whole i = iload(q->cell + s);
    int at[LANES];
    istore(at, iadd(iload(q->row + s), i));
    const cells cell = load_cells(axis, at, load(q->t + s));
    const real d = clamp(sub(x, cell.x0), all(0.0f), cell.d);
    const real bend = magnitude(cell.c), flat = sub(cell.d, bend);
    const real away = choose(greater(cell.c, all(0.0f)), sub(cell.d, d), d);
    const real slope = root(add(mul(flat, flat), mul(mul(all(4.0f), bend), away)));
    const real f = smaller(over(mul(all(2.0f), d), add(add(cell.d, cell.c), slope)), one);
    const real low = add(converted(i), f);
    const real high = add(converted(isub(iall(axis->columns - 2), i)), sub(one, f));
    const real y = add(all(axis->f0), mul(all(axis->k), smaller(low, high)));
    const real pdf = over(du_dcolumn(axis, y), slope);
    return choose(both(at_least(x, all(axis->low)), at_least(all(axis->high), x)), pdf, all(0.0f));
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
    const real x = mul(sub(phi, all(low)), all(hairlut_inverse_two_pi));
    const real towards_zero = choose(greater(all(8388608.0f), magnitude(x)), converted(truncated(x)), x);
    return less_turns(phi, sub(towards_zero, choose(greater(towards_zero, x), all(1.0f), all(0.0f))), low);
}

/* hairlut_wrap_once */
static inline real wrap_once(real phi, float low)
{
    const real above = choose(at_least(phi, all(low + hairlut_two_pi)), all(1.0f), all(0.0f));
    return less_turns(phi, choose(greater(all(low), phi), all(-1.0f), above), low);
}

/* hairlut_cos */
static inline real cosine(real theta)
{
    const real z = larger(add(sub(all(hairlut_half_pi_high), magnitude(theta)), all(hairlut_half_pi_low)),
                          all(-hairlut_half_pi_low));
    const real w = mul(z, z);
    real p = all(hairlut_sine[0]);
    for (int k = 1; k < HAIRLUT_SINE_TERMS; ++k)
        p = add(all(hairlut_sine[k]), mul(w, p));
    return mul(z, p);
}

/* hairlut_known */
static inline mask known(real theta_r, real phi_r, real a, real b)
{
    return both(both(numbers(theta_r, a), numbers(b, b)), at_least(all(FLT_MAX), magnitude(phi_r)));
}

static inline void store_samples(hairlut_samples out, size_t s, real theta_i, real phi_i, real pdf)
{
    store(out.theta_i + s, theta_i);
    store(out.phi_i + s, phi_i);
    if (out.pdf_angle)
        store(out.pdf_angle + s, pdf);
    if (out.pdf_solid_angle)
        store(out.pdf_solid_angle + s, over(pdf, cosine(theta_i)));
}

static inline void sample_direct_block(const hairlut_model *model, size_t n, const float *const in[4], hairlut_samples out)
{
    places theta, phi;
    place(&model->direct_theta, n, in[0], in[2], &theta);
    place(&model->direct_phi, n, in[0], in[3], &phi);
    for (size_t s = 0; s < n; s += LANES) {
        const real phi_r = load(in[1] + s);
        const mask valid = known(load(in[0] + s), phi_r, load(in[2] + s), load(in[3] + s));
        real pdf_theta, pdf_phi;
        const real theta_i = draw(&model->direct_theta, &theta, s, &pdf_theta);
        const real relative = draw(&model->direct_phi, &phi, s, &pdf_phi);
        const real r = wrap(phi_r, -hairlut_pi);
        const real phi_i = model->azimuth == HAIRLUT_AZIMUTH_SUM ? sub(relative, r) : add(relative, r);
        store_samples(out, s, theta_i, wrap_once(phi_i, -hairlut_pi), choose(valid, mul(pdf_theta, pdf_phi), all(0.0f)));
    }
}

static inline void sample_multiple_block(const hairlut_model *model, size_t n, const float *const in[4],
                                         hairlut_samples out)
{
    places theta;
    place(&model->multiple_theta, n, in[0], in[2], &theta);
    for (size_t s = 0; s < n; s += LANES) {
        const real u_phi = load(in[3] + s);
        const mask valid = known(load(in[0] + s), load(in[1] + s), load(in[2] + s), u_phi);
        const real turn = mul(all(hairlut_two_pi), clamp(u_phi, all(0.0f), all(1.0f)));
        const real phi_i = wrap_once(sub(turn, all(hairlut_pi)), -hairlut_pi);
        real pdf;
        const real theta_i = draw(&model->multiple_theta, &theta, s, &pdf);
        store_samples(out, s, theta_i, phi_i, choose(valid, mul(pdf, all(hairlut_inverse_two_pi)), all(0.0f)));
    }
}

/* hairlut_relative_azimuth */
static inline real relative_azimuth(const hairlut_model *model, real phi_r, real phi_i)
{
    const real r = wrap(phi_r, -hairlut_pi), i = wrap(phi_i, -hairlut_pi);
    return wrap_once(model->azimuth == HAIRLUT_AZIMUTH_SUM ? add(i, r) : sub(i, r), 0.0f);
}

/* density 0 where an argument is not a number or an azimuth is infinite */
static inline real where_known(const float *const in[4], size_t s, real pdf)
{
    const real phi_i = load(in[3] + s);
    const mask finite = at_least(all(FLT_MAX), magnitude(phi_i));
    return choose(both(finite, known(load(in[0] + s), load(in[1] + s), load(in[2] + s), phi_i)), pdf, all(0.0f));
}

static inline void pdf_direct_block(const hairlut_model *model, size_t n, const float *const in[4], float *out)
{
    queries theta, phi;
    ask_rows(&model->direct_theta, n, in[0], &theta);
    ask_rows(&model->direct_phi, n, in[0], &phi);
    for (size_t s = 0; s < n; s += LANES) {
        store(theta.x + s, load(in[2] + s));
        store(phi.x + s, relative_azimuth(model, load(in[1] + s), load(in[3] + s)));
    }
    find_cells(&model->direct_theta, n, &theta);
    find_cells(&model->direct_phi, n, &phi);
    for (size_t s = 0; s < n; s += LANES) {
        const real pdf = mul(density(&model->direct_theta, &theta, s), density(&model->direct_phi, &phi, s));
        store(out + s, where_known(in, s, pdf));
    }
}

static inline void pdf_multiple_block(const hairlut_model *model, size_t n, const float *const in[4], float *out)
{
    queries theta;
    ask_rows(&model->multiple_theta, n, in[0], &theta);
    for (size_t s = 0; s < n; s += LANES)
        store(theta.x + s, load(in[2] + s));
    find_cells(&model->multiple_theta, n, &theta);
    for (size_t s = 0; s < n; s += LANES) {
        const real pdf = density(&model->multiple_theta, &theta, s);
        store(out + s, where_known(in, s, mul(pdf, all(hairlut_inverse_two_pi))));
    }
}

/* How many of the n samples left a block takes: a multiple of LANES, 0 when fewer than LANES are left. */
static inline size_t block_size(size_t n)
{
    const size_t whole_vectors = n - n % LANES;
    return whole_vectors < BLOCK ? whole_vectors : BLOCK;
}

/* The last n < LANES inputs, filled up with zeros. */
static inline void pad(float padded[4][LANES], const float *const in[4], size_t n)
{
    for (int k = 0; k < 4; ++k)
        for (size_t l = 0; l < LANES; ++l)
            padded[k][l] = l < n ? in[k][l] : 0.0f;
}

static inline void copy(float *to, const float *from, size_t n)
{
    for (size_t l = 0; to && l < n; ++l)
        to[l] = from[l];
}

typedef void (*sample_block)(const hairlut_model *, size_t, const float *const[4], hairlut_samples);
typedef void (*pdf_block)(const hairlut_model *, size_t, const float *const[4], float *);

static inline void sample_blocks(sample_block block, const hairlut_model *model, size_t n, const float *const in[4],
                                 hairlut_samples out)
{
    size_t s = 0;
    for (size_t m; (m = block_size(n - s)) > 0; s += m) {
        const float *const here[4] = {in[0] + s, in[1] + s, in[2] + s, in[3] + s};
        const hairlut_samples there = {out.theta_i + s, out.phi_i + s, out.pdf_angle ? out.pdf_angle + s : NULL,
                                       out.pdf_solid_angle ? out.pdf_solid_angle + s : NULL};
        block(model, m, here, there);
    }
    if (s < n) {
        float padded[4][LANES], result[4][LANES];
        const float *const rest[4] = {in[0] + s, in[1] + s, in[2] + s, in[3] + s};
        const float *const here[4] = {padded[0], padded[1], padded[2], padded[3]};
        const hairlut_samples there = {result[0], result[1], result[2], result[3]};
        pad(padded, rest, n - s);
        block(model, LANES, here, there);
        copy(out.theta_i + s, result[0], n - s);
        copy(out.phi_i + s, result[1], n - s);
        copy(out.pdf_angle ? out.pdf_angle + s : NULL, result[2], n - s);
        copy(out.pdf_solid_angle ? out.pdf_solid_angle + s : NULL, result[3], n - s);
    }
}

static inline void pdf_blocks(pdf_block block, const hairlut_model *model, size_t n, const float *const in[4], float *out)
{
    size_t s = 0;
    for (size_t m; (m = block_size(n - s)) > 0; s += m) {
        const float *const here[4] = {in[0] + s, in[1] + s, in[2] + s, in[3] + s};
        block(model, m, here, out + s);
    }
    if (s < n) {
        float padded[4][LANES], result[LANES];
        const float *const rest[4] = {in[0] + s, in[1] + s, in[2] + s, in[3] + s};
        const float *const here[4] = {padded[0], padded[1], padded[2], padded[3]};
        pad(padded, rest, n - s);
        block(model, LANES, here, result);
        copy(out + s, result, n - s);
    }
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
