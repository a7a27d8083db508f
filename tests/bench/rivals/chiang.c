/* SPDX-License-Identifier: BSD-3-Clause
 * The hair BSDF of M. Chiang, B. Bitterli, C. Tappan and B. Burley, "A practical and controllable hair and fur model for
 * production path tracing" (Computer Graphics Forum 35, 2016), written from the paper: its sampler, and the sampler's density, for the
 * hair that `brown` is fitted to (precompute/examples/chiang2016.py). Absorption is one number, a channel of the three that a
 * renderer has.
 *
 * Lobe p = 0 is reflected (R), 1 transmitted (TT), 2 reflected inside once (TRT), 3 stands for all others. The density is
 * sum over p of P_p M_p(theta_r, theta_i) N_p(phi), P_p in proportion to the lobe's attenuation A_p. */
#include <math.h>

#include "how.h"
#include "rivals.h"

#define PI 3.14159265f

#define RIVAL_INLINE static inline __attribute__((always_inline))

enum { LOBES = 4 };

/* What does not depend on directions, as a renderer keeps it with the material. */
static const float eta = 1.55f, absorption = 0.6f;
static struct constants {
    float v[LOBES], inverse_v[LOBES], ends[LOBES], norm[LOBES]; /* of M_p: its variance, 1/v, exp(-2/v), its normalisation */
    float tilt_sin[LOBES], tilt_cos[LOBES];                     /* of the cuticle's scales, for each p */
    float s, inverse_s, below, inside; /* of N_p: its scale, and its CDF at -pi and from -pi to pi */
} hair;

static double power(double x, int n)
{
    return n ? x * power(x, n - 1) : 1.0;
}

__attribute__((constructor)) static void prepare(void)
{
    const double beta_m = 0.3, beta_n = 0.3, alpha = 2.0 * 3.14159265358979 / 180.0;
    const double root = 0.726 * beta_m + 0.812 * beta_m * beta_m + 3.7 * power(beta_m, 20); /* the paper's eq. 7 */
    const double v[LOBES] = {root * root, 0.25 * root * root, 4.0 * root * root, 4.0 * root * root};
    const double tilt[LOBES] = {-2.0 * alpha, alpha, 4.0 * alpha, 0.0};
    for (int p = 0; p < LOBES; ++p) {
        hair.v[p] = (float)v[p];
        hair.inverse_v[p] = (float)(1.0 / v[p]);
        hair.ends[p] = (float)exp(-2.0 / v[p]);
        hair.norm[p] = (float)(1.0 / (v[p] * (1.0 - exp(-2.0 / v[p]))));
        hair.tilt_sin[p] = (float)sin(tilt[p]);
        hair.tilt_cos[p] = (float)cos(tilt[p]);
    }
    const double s =
        sqrt(3.14159265358979 / 8.0) * (0.265 * beta_n + 1.194 * beta_n * beta_n + 5.372 * power(beta_n, 22)); /* eq. 8 */
    const double below = 1.0 / (1.0 + exp(3.14159265358979 / s));
    hair.s = (float)s;
    hair.inverse_s = (float)(1.0 / s);
    hair.below = (float)below;
    hair.inside = (float)(1.0 - 2.0 * below);
}

/* The viewer's side: what sampling and density share. */
typedef struct viewer {
    float sine[LOBES], cosine[LOBES]; /* of theta_r, tilted for each p */
    float centre[LOBES];              /* the azimuth, relative to phi_r, where lobe p has its peak */
    float chance[LOBES];              /* P_p */
} viewer;

/* Reflectance of a dielectric for light that comes from outside at a cosine c (Fresnel). */
static inline float fresnel(float c)
{
    const float refracted = sqrtf(1.0f - (1.0f - c * c) * (1.0f / (eta * eta)));
    const float parallel = (eta * c - refracted) / (eta * c + refracted),
                across = (c - eta * refracted) / (c + eta * refracted);
    return 0.5f * (parallel * parallel + across * across);
}

/* From the sine of an inclination; gcc vectorises no call of sinf and cosf of the same angle. */
static inline float cosine_of(float sine)
{
    return sqrtf(fmaxf(0.0f, 1.0f - sine * sine));
}

static inline viewer viewer_at(float theta_r, float h)
{
    const float sine = sinf(theta_r), cosine = cosine_of(sine);
    viewer at;
    for (int p = 0; p < LOBES; ++p) {
        at.sine[p] = sine * hair.tilt_cos[p] + cosine * hair.tilt_sin[p];
        at.cosine[p] = fabsf(cosine * hair.tilt_cos[p] - sine * hair.tilt_sin[p]);
    }
    /* the path inside the fibre: theta_t along it, gamma_t across it with the modified index of refraction */
    const float sine_t = sine * (1.0f / eta), cosine_t = sqrtf(1.0f - sine_t * sine_t);
    const float sine_gamma_t = h * cosine / sqrtf(eta * eta - sine * sine);
    const float cosine_gamma_t = sqrtf(1.0f - sine_gamma_t * sine_gamma_t);
    const float transmitted = expf(-2.0f * absorption * cosine_gamma_t / cosine_t);
    /* A_p: reflected, or let in, out, and reflected in between */
    const float f = fresnel(cosine * sqrtf(1.0f - h * h)), let = 1.0f - f;
    const float first = let * let * transmitted, again = f * transmitted;
    const float a[LOBES] = {f, first, first * again, first * again * again / (1.0f - again)};
    const float scale = 1.0f / (a[0] + a[1] + a[2] + a[3]);
    const float gamma_o = asinf(h), gamma_t = asinf(sine_gamma_t);
    for (int p = 0; p < LOBES; ++p) {
        at.chance[p] = scale * a[p];
        at.centre[p] = 2.0f * (float)p * gamma_t - 2.0f * gamma_o + (float)p * PI;
    }
    return at;
}

/* I_0(x) = exp(large(x) x) * this: the polynomials 9.8.1 and 9.8.2 of Abramowitz and Stegun. */
static inline int large(float x)
{
    return x > 3.75f;
}

static inline float bessel_small(float x)
{
    const float t = x * x * (1.0f / 14.0625f);
    return 1.0f +
           t * (3.5156229f + t * (3.0899424f + t * (1.2067492f + t * (0.2659732f + t * (0.0360768f + t * 0.0045813f)))));
}

static inline float bessel_large(float x)
{
    const float t = 3.75f / x;
    float p = -0.01647633f + t * 0.00392377f;
    p = 0.02635537f + t * p;
    p = -0.02057706f + t * p;
    p = 0.00916281f + t * p;
    p = -0.00157565f + t * p;
    p = 0.00225319f + t * p;
    p = 0.01328592f + t * p;
    return (0.39894228f + t * p) / sqrtf(x);
}

/* M_p(theta_r, theta_i) of d'Eon 2011, per unit of sin theta_i: csch(1/v)/(2v) exp(-sin sin/v) I_0(cos cos/v), written
 * so that nothing overflows for small v. */
static inline float longitudinal(int p, const viewer *at, float sine_i, float cosine_i)
{
    const float a = cosine_i * at->cosine[p] * hair.inverse_v[p], b = sine_i * at->sine[p] * hair.inverse_v[p];
#ifdef RIVAL_ARRAYS_WIDTH
    const float above = a > 3.75f ? a : 3.75f;
    const float series = large(a) ? bessel_large(above) : bessel_small(a);
#else
    const float series = large(a) ? bessel_large(a) : bessel_small(a);
#endif
    return hair.norm[p] * expf((large(a) ? a : 0.0f) - b - hair.inverse_v[p]) * series;
}

/* An azimuth in [-pi, pi), for arguments of a few turns */
static inline float wrapped(float phi)
{
    const float turns = phi * (0.5f / PI) + 8.5f;
    return phi - 2.0f * PI * (float)((int)turns - 8);
}

/* N_p: a logistic cut to one period around the peak. The last lobe is uniform. */
static inline float azimuthal(const viewer *at, int p, float relative)
{
    const float e = expf(-fabsf(wrapped(relative - at->centre[p])) * hair.inverse_s);
    return e / ((1.0f + e) * (1.0f + e)) * (hair.inverse_s / hair.inside);
}

/* Per steradian */
static inline float density(const viewer *at, float sine_i, float cosine_i, float relative)
{
    float sum = at->chance[3] * longitudinal(3, at, sine_i, cosine_i) * (0.5f / PI);
    for (int p = 0; p < 3; ++p)
        sum += at->chance[p] * longitudinal(p, at, sine_i, cosine_i) * azimuthal(at, p, relative);
    return sum;
}

typedef struct direction {
    float theta_i, phi_i, pdf_angle, pdf_solid_angle;
} direction;

RIVAL_INLINE direction draw(const viewer at, float phi_r, float u_lobe, float u_theta, float u_phi)
{
    /* lobe p in proportion to A_p; what is left of u_lobe is uniform within it */
    const float c1 = at.chance[0], c2 = c1 + at.chance[1], c3 = c2 + at.chance[2];
    const int p = (u_lobe >= c1) + (u_lobe >= c2) + (u_lobe >= c3);
#ifdef RIVAL_ARRAYS_WIDTH
#define PICK(x) (p == 0 ? (x)[0] : p == 1 ? (x)[1] : p == 2 ? (x)[2] : (x)[3])
#else
#define PICK(x) (x)[p]
#endif
    const float left = (u_lobe - (p == 0 ? 0.0f : p == 1 ? c1 : p == 2 ? c2 : c3)) / PICK(at.chance);
    /* M_p by d'Eon's method */
    const float v = PICK(hair.v), ends = PICK(hair.ends);
    const float along = 1.0f + v * logf(u_theta + (1.0f - u_theta) * ends),
                across = sqrtf(fmaxf(0.0f, 1.0f - along * along));
    float sine_i = across * cosf(2.0f * PI * u_phi) * PICK(at.cosine) - along * PICK(at.sine);
    sine_i = sine_i < 1.0f ? sine_i : 1.0f;
    sine_i = sine_i > -1.0f ? sine_i : -1.0f;
    const float cosine_i = cosine_of(sine_i);
    /* N_p by the logistic's inverse */
    float share = hair.below + left * hair.inside;
    share = share < 0.99999994f ? share : 0.99999994f;
    share = share > 1e-9f ? share : 1e-9f;
    const float bell = PICK(at.centre) + hair.s * logf(share / (1.0f - share));
    const float relative = p == 3 ? 2.0f * PI * left : bell;
    const float solid = density(&at, sine_i, cosine_i, relative);
    const direction drawn = {asinf(sine_i), wrapped(phi_r + relative), solid * cosine_i, solid};
    return drawn;
}

RIVAL_ONE static direction sample_hair(float theta_r, float phi_r, float h, float u_lobe, float u_theta, float u_phi)
{
    const viewer at = viewer_at(theta_r, h);
    return draw(at, phi_r, u_lobe, u_theta, u_phi);
}

RIVAL_INLINE float density_of(const viewer *at, float phi_r, float theta_i, float phi_i)
{
    const float sine_i = sinf(theta_i), cosine_i = cosine_of(sine_i);
    return cosine_i * density(at, sine_i, cosine_i, phi_i - phi_r);
}

RIVAL_ONE static float pdf_hair(float theta_r, float phi_r, float h, float theta_i, float phi_i)
{
    const viewer at = viewer_at(theta_r, h);
    return density_of(&at, phi_r, theta_i, phi_i);
}

static inline void put(const rival_arrays *all, size_t i, direction drawn)
{
    all->theta_i[i] = drawn.theta_i;
    all->phi_i[i] = drawn.phi_i;
    all->pdf_angle[i] = drawn.pdf_angle;
    all->pdf_solid_angle[i] = drawn.pdf_solid_angle;
}

#define SAMPLE(i) \
    put(&all, i, sample_hair(all.theta_r[i], all.phi_r[i], all.offset[i], all.u_lobe[i], all.u_theta[i], all.u_phi[i]))
#define DENSITY(i) \
    all.pdf_light[i] = pdf_hair(all.theta_r[i], all.phi_r[i], all.offset[i], all.theta_light[i], all.phi_light[i])

static void samples(const rival_arrays *arrays)
{
    const rival_arrays all = *arrays;
    RIVAL_EACH(i, all.n)
    SAMPLE(i);
}

static void densities(const rival_arrays *arrays)
{
    const rival_arrays all = *arrays;
    RIVAL_EACH(i, all.n)
    DENSITY(i);
}

static void vertex(const rival_arrays *arrays)
{
    const rival_arrays all = *arrays;
    RIVAL_EACH(i, all.n)
    {
        SAMPLE(i);
        DENSITY(i);
    }
}

#ifdef RIVAL_ARRAYS_WIDTH
#define HITS NULL /* one at a time only */
#else
/* A hit with four lights, the viewer's side computed once */
RIVAL_ONE static void hit(const rival_arrays *all, size_t i)
{
    const viewer at = viewer_at(all->theta_r[i], all->offset[i]);
    float sum = 0.0f;
    put(all, i, draw(at, all->phi_r[i], all->u_lobe[i], all->u_theta[i], all->u_phi[i]));
    for (size_t k = i; k < i + 4; ++k)
        sum += density_of(&at, all->phi_r[i], all->theta_light[k % all->n], all->phi_light[k % all->n]);
    all->pdf_light[i] = sum;
}

static void hits(const rival_arrays *all)
{
    for (size_t i = 0; i < all->n; ++i)
        hit(all, i);
}

#define HITS hits
#endif

const rival RIVAL_NAME(chiang)[] = {
    {"brown", "Chiang", RIVAL_HOW, NULL, NULL, NULL, NULL, samples, densities, vertex, HITS},
    {0},
};
