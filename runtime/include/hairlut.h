/* hairlut: importance sampling of a hair shader's scattering lobes from lookup tables.
 *
 *     #include "hairlut.h"
 *
 *     const hairlut_model *hair = hairlut_builtin("fitted");
 *     hairlut_sample s = hairlut_sample_direct(hair, theta_r, phi_r, u_theta, u_phi);
 *     // light arrives from (s.theta_i, s.phi_i); weigh it by bsdf * cos(theta_i) / s.pdf_solid_angle
 *     float q = hairlut_pdf_direct(hair, theta_r, phi_r, s.theta_i, s.phi_i);     // == s.pdf_angle
 *
 * Angles are in radians. theta is the inclination from the plane normal to the fibre, in [-pi/2, pi/2]; phi is the
 * azimuth around the fibre. (theta_r, phi_r) is the known viewer direction, (theta_i, phi_i) the sampled incident one.
 *
 * Density. `pdf_angle` is per rad^2 in (theta_i, phi_i); `pdf_solid_angle` = pdf_angle / cos(theta_i), per steradian.
 * Both are the density of exactly what the library samples: the derivative of the interpolated inverse CDF, not the
 * formula of the lobe that was tabulated. An estimator that divides by it is unbiased for every table, coarse or fine.
 *
 * Rules for every function on the sampling path (sample, pdf, invert, mixture, components, the _n forms):
 *   - no finite input gives NaN or infinity. u outside [0,1] and theta_r outside its range are clamped; an azimuth of
 *     any finite size is reduced modulo 2 pi (beyond 2^24 rad a float holds no azimuth, and the result is merely valid).
 *   - NaN in any argument, or an infinite azimuth, gives a density of 0, with finite angles inside their ranges.
 *     An infinite theta_r or u is clamped like any other value outside its range.
 *   - theta_i outside [-pi/2, pi/2] has density 0.
 *   - no allocation, no global state, no errno. Arrays belong to the caller and are not kept.
 *
 * Threads and ownership, for every function of this header: the library has no state, so any function may run in any
 * number of threads at once, also on the same `const hairlut_model`; only hairlut_free needs the model for itself.
 * Strings that are returned, and compiled-in models, are static: never freed. What hairlut_model_create and hairlut_load
 * return belongs to the caller, until hairlut_free. What is passed in is only read while the call lasts, never kept.
 */
#ifndef HAIRLUT_H
#define HAIRLUT_H

#include <stddef.h>

#include "hairlut_export.h"
#include "hairlut_version.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- results -------------------------------------------------------------------------------------------------- */

typedef enum hairlut_result {
    HAIRLUT_OK = 0,
    HAIRLUT_ERROR_ARGUMENT,  /* a null pointer or a value that no call may pass */
    HAIRLUT_ERROR_MEMORY,    /* the allocator returned NULL */
    HAIRLUT_ERROR_FILE,      /* a file is missing, truncated or not an OpenEXR image */
    HAIRLUT_ERROR_ATTRIBUTE, /* a header attribute is missing or has an unexpected value */
    HAIRLUT_ERROR_VERSION,   /* the file is of a newer format than this library reads */
    HAIRLUT_ERROR_TABLE,     /* the texels are not a table: NaN, not increasing, outside the domain, too small */
    HAIRLUT_ERROR_UNSUPPORTED /* the file needs a feature (a compression) that the OpenEXR library in use lacks */
} hairlut_result;

/* A static string for any value of `result`; never NULL. */
HAIRLUT_API const char *hairlut_result_string(hairlut_result result);

/* ---- models --------------------------------------------------------------------------------------------------- */

typedef struct hairlut_model hairlut_model;

/* "printed" or "fitted": the tables compiled into the library. NULL for any other name. Nothing to free. */
HAIRLUT_API const hairlut_model *hairlut_builtin(const char *name);

typedef enum hairlut_warp {
    HAIRLUT_WARP_UNIFORM = 0, /* knots uniform in u: the baseline, only for comparisons */
    HAIRLUT_WARP_OCTAVES = 1  /* knots uniform in F(min(u,1-u) + e), F near a fourth root */
} hairlut_warp;

typedef enum hairlut_azimuth {
    HAIRLUT_AZIMUTH_DIFFERENCE = 0, /* the azimuth table holds phi_i - phi_r modulo 2 pi */
    HAIRLUT_AZIMUTH_SUM = 1         /* it holds phi_i + phi_r modulo 2 pi */
} hairlut_azimuth;

/* One table as it stands in a file (luts/FORMAT.md): row j belongs to theta_r = theta_r_min + j (theta_r_max -
 * theta_r_min)/(height-1); texels[j*width + i] is the angle whose cumulative probability is knot i. */
typedef struct hairlut_table {
    const float *texels;  /* width*height floats, row-major; along a row each is at least 1e-12 above the last */
    int width;            /* 4 to 4096 */
    int height;           /* 2 to 4096 */
    float theta_r_min;    /* rad, -2 pi <= theta_r_min < theta_r_max */
    float theta_r_max;    /* rad, <= 2 pi */
    float domain_min;     /* rad, -2 pi <= domain_min; the first texel of every row */
    float domain_max;     /* rad, <= 2 pi; the last texel of every row */
    hairlut_warp warp;
    float warp_e;         /* the parameter of octaves, 1e-12 to 1; ignored for the uniform warp */
    float cell_limit;     /* in [0, 0.95]: bound of a cell's curvature; 0 makes cells linear in u */
} hairlut_table;

typedef struct hairlut_model_desc {
    hairlut_table direct_theta;
    hairlut_table direct_phi;
    hairlut_table multiple_theta;
    hairlut_azimuth azimuth;
} hairlut_model_desc;

/* Memory for a model. A zeroed struct, or NULL where one is asked for, means malloc and free. `allocate` returns memory
 * aligned for any type, or NULL; `release` gets only what `allocate` returned. Both are called only inside
 * hairlut_model_create, hairlut_load and hairlut_free, from the calling thread. */
typedef struct hairlut_allocator {
    void *(*allocate)(void *user, size_t size);
    void (*release)(void *user, void *memory);
    void *user;
} hairlut_allocator;

enum { HAIRLUT_MESSAGE_SIZE = 512 };

/* Checks a table that did not come from this project's tools. HAIRLUT_OK, or an error; `message`, if not NULL, holds
 * HAIRLUT_MESSAGE_SIZE bytes and receives what is wrong, where, and what was expected. Reads width*height floats. */
HAIRLUT_API hairlut_result hairlut_validate(const hairlut_table *table, char *message);

/* Builds a model from three tables in memory. The texels are copied, into five to seven times their own memory in the order in
 * which samples read them: the caller may free them when this returns. Every table is validated first; theta tables must
 * lie within [-pi/2, pi/2], the azimuth table within [0, 2 pi]. On error *out is NULL and nothing stays allocated. Free with
 * hairlut_free. */
HAIRLUT_API hairlut_result hairlut_model_create(const hairlut_model_desc *desc, const hairlut_allocator *allocator,
                                                hairlut_model **out, char *message);

/* Releases a model made by hairlut_model_create or hairlut_load; NULL is allowed. No thread may be using it. */
HAIRLUT_API void hairlut_free(hairlut_model *model);

typedef enum hairlut_part { HAIRLUT_DIRECT_THETA = 0, HAIRLUT_DIRECT_PHI = 1, HAIRLUT_MULTIPLE_THETA = 2 } hairlut_part;

/* Columns and rows of one of a model's tables; `part` must be one of the three. */
HAIRLUT_API void hairlut_table_size(const hairlut_model *model, hairlut_part part, int *width, int *height);

/* ---- one direction -------------------------------------------------------------------------------------------- */

typedef struct hairlut_sample {
    float theta_i;         /* [-pi/2, pi/2] */
    float phi_i;           /* [-pi, pi) */
    float pdf_angle;       /* per rad^2 */
    float pdf_solid_angle; /* per sr */
} hairlut_sample;

/* Draws an incident direction for the viewer direction (theta_r, phi_r) from two numbers in [0,1). */
HAIRLUT_API hairlut_sample hairlut_sample_direct(const hairlut_model *model, float theta_r, float phi_r, float u_theta,
                                                 float u_phi);
HAIRLUT_API hairlut_sample hairlut_sample_multiple(const hairlut_model *model, float theta_r, float phi_r, float u_theta,
                                                   float u_phi);

/* Density, per rad^2, with which the function above draws (theta_i, phi_i). phi_i may be any finite azimuth. */
HAIRLUT_API float hairlut_pdf_direct(const hairlut_model *model, float theta_r, float phi_r, float theta_i, float phi_i);
HAIRLUT_API float hairlut_pdf_multiple(const hairlut_model *model, float theta_r, float phi_r, float theta_i, float phi_i);

/* The numbers u[0] = u_theta and u[1] = u_phi from which the sampling function draws (theta_i, phi_i). Directions
 * outside the domain give the nearer end's u; NaN gives 0. */
HAIRLUT_API void hairlut_invert_direct(const hairlut_model *model, float theta_r, float phi_r, float theta_i, float phi_i,
                                       float u[2]);
HAIRLUT_API void hairlut_invert_multiple(const hairlut_model *model, float theta_r, float phi_r, float theta_i,
                                         float phi_i, float u[2]);

/* per rad^2 to per sr: pdf_angle / cos(theta_i), finite also at theta_i = +-pi/2 */
HAIRLUT_API float hairlut_pdf_to_solid_angle(float pdf_angle, float theta_i);

/* ---- both lobes at once --------------------------------------------------------------------------------------- */

/* With probability direct_weight, clamped to [0,1], draws from the direct lobe (u_lobe < direct_weight), else from the
 * multiple lobe. The densities returned are the mixture's: direct_weight * direct + (1 - direct_weight) * multiple. */
HAIRLUT_API hairlut_sample hairlut_sample_mixture(const hairlut_model *model, float direct_weight, float theta_r,
                                                  float phi_r, float u_lobe, float u_theta, float u_phi);
HAIRLUT_API float hairlut_pdf_mixture(const hairlut_model *model, float direct_weight, float theta_r, float phi_r,
                                      float theta_i, float phi_i);

/* ---- any lobes of any models ---------------------------------------------------------------------------------- */

typedef enum hairlut_lobe { HAIRLUT_LOBE_DIRECT = 0, HAIRLUT_LOBE_MULTIPLE = 1 } hairlut_lobe;

/* One lobe of a mixture. The array of them is the caller's; it is read while the call lasts. */
typedef struct hairlut_component {
    const hairlut_model *model; /* never NULL, unless weight is 0 or negative: then it is not read */
    hairlut_lobe lobe;
    float weight; /* in any unit: lobes are drawn in proportion to their weights. Negative counts as 0 */
    float turn;   /* rad, any finite size: added to phi_i of what the lobe draws; it turns the lobe around the fibre */
} hairlut_component;

/* Draws from one of n lobes, chosen by u_lobe. The densities returned are the mixture's: the sum of weight * density
 * over the lobes, divided by the sum of the weights. The time grows with n. Where n <= 0, no weight is above 0, or one
 * is infinite or NaN, or the turn of a lobe with weight is, the density is 0. */
HAIRLUT_API hairlut_sample hairlut_sample_components(const hairlut_component *components, int n, float theta_r,
                                                     float phi_r, float u_lobe, float u_theta, float u_phi);
HAIRLUT_API float hairlut_pdf_components(const hairlut_component *components, int n, float theta_r, float phi_r,
                                         float theta_i, float phi_i);

/* ---- directions in a fibre frame ------------------------------------------------------------------------------ */

/* An orthonormal frame in world space: `tangent` along the fibre, theta is measured towards it;
 * phi is measured from `normal` towards `binormal`. */
typedef struct hairlut_frame {
    float tangent[3];
    float normal[3];
    float binormal[3];
} hairlut_frame;

/* theta = asin(w.tangent), phi = atan2(w.binormal, w.normal), from a unit vector w. On the pole, where w = +-tangent,
 * phi is 0. A vector of another length gives the same; zero, infinity or NaN gives theta = phi = 0. */
HAIRLUT_API void hairlut_angles(const hairlut_frame *frame, const float direction[3], float *theta, float *phi);

/* The unit vector of (theta, phi) in world space. theta is clamped to [-pi/2, pi/2], phi any; NaN gives some direction. */
HAIRLUT_API void hairlut_direction(const hairlut_frame *frame, float theta, float phi, float direction[3]);

/* ---- many directions: structure of arrays --------------------------------------------------------------------- */

/* As the functions above for i in [0,n). Every pointer addresses n floats of any alignment (64 bytes is fastest); n may be 0.
 * An output may be the same array as an input (in place, from the same first element), never overlap one otherwise. Results
 * equal those of the one-direction forms bit for bit, whichever kernel runs: portable C, AVX2, AVX-512 (from Ice Lake and
 * Zen 4 on) or NEON, chosen at run time. */
typedef struct hairlut_samples {
    float *theta_i;
    float *phi_i;
    float *pdf_angle;       /* may be NULL: not stored */
    float *pdf_solid_angle; /* may be NULL: not stored */
} hairlut_samples;

HAIRLUT_API void hairlut_sample_direct_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                                         const float *u_theta, const float *u_phi, hairlut_samples out);
HAIRLUT_API void hairlut_sample_multiple_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                                           const float *u_theta, const float *u_phi, hairlut_samples out);
HAIRLUT_API void hairlut_pdf_direct_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                                      const float *theta_i, const float *phi_i, float *pdf_angle);
HAIRLUT_API void hairlut_pdf_multiple_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                                        const float *theta_i, const float *phi_i, float *pdf_angle);
HAIRLUT_API void hairlut_sample_mixture_n(const hairlut_model *model, size_t n, const float *direct_weight,
                                          const float *theta_r, const float *phi_r, const float *u_lobe,
                                          const float *u_theta, const float *u_phi, hairlut_samples out);
HAIRLUT_API void hairlut_pdf_mixture_n(const hairlut_model *model, size_t n, const float *direct_weight,
                                       const float *theta_r, const float *phi_r, const float *theta_i,
                                       const float *phi_i, float *pdf_angle);

/* ---- files (library hairlut_exr) ------------------------------------------------------------------------------ */

/* Loads direct_theta.exr, direct_phi.exr and multiple_theta.exr from `directory` (luts/FORMAT.md says what is checked).
 * On error *out is NULL, nothing stays allocated, and `message`, if not NULL, holds HAIRLUT_MESSAGE_SIZE bytes and
 * receives the file, the attribute, what was expected and what to do. Free with hairlut_free.
 * OpenEXR takes its own temporary memory from malloc. Any number of threads may load at once. */
HAIRLUT_EXR_API hairlut_result hairlut_load(const char *directory, hairlut_model **out);
HAIRLUT_EXR_API hairlut_result hairlut_load_with(const char *directory, const hairlut_allocator *allocator,
                                                 hairlut_model **out, char *message);

#ifdef __cplusplus
}
#endif

#endif
