/* SPDX-License-Identifier: BSD-3-Clause */
/* hairlut: importance sampling of a hair's scattering from lookup tables.
 *
 *     #include "hairlut.h"
 *
 *     const hairlut_model *hair = hairlut_builtin("fitted");
 *     hairlut_sample s = hairlut_sample_hair(hair, NULL, theta_r, phi_r, offset, u_lobe, u_theta, u_phi);
 *     // light arrives from (s.theta_i, s.phi_i); weigh it by bsdf * cos(theta_i) / s.pdf_solid_angle
 *     float q = hairlut_pdf_hair(hair, NULL, theta_r, phi_r, offset, theta_i, phi_i);   // of any direction, per rad^2
 *
 * A model is a mixture of 1 to 16 lobes. A lobe is the product of a distribution of theta_i and one of the azimuth, each
 * tabulated over theta_r; without an azimuth table its azimuth is uniform. The mixture gives each lobe's share, and the angle
 * by which the lobe is turned around the fibre, over theta_r and the offset at which the fibre is hit.
 *
 * A model may depend on up to 8 named parameters of the hair, such as its roughness and its absorption: then it is one model for
 * all strands, the fibres of a groom, however they differ. Each call passes the parameters of its strand (hairlut_sample_strand,
 * hairlut_pdf_strand). For fixed parameters it is a model like any other. Every function without a `parameters` argument reads it at
 * its standard values.
 *
 * Angles are in radians. theta is the inclination from the plane normal to the fibre, in [-pi/2, pi/2]; phi is the
 * azimuth around the fibre. (theta_r, phi_r) is the known viewer direction, (theta_i, phi_i) the sampled incident one.
 * The offset is where the viewer's ray passes the fibre's axis, in radii, from -1 to 1. Its sign is that of Chiang (2016) and
 * pbrt: a fibre hit at h reflects from its surface to the relative azimuth -2 asin(h). Pass 0 where there is no offset.
 *
 * Density. `pdf_angle` is per rad^2 in (theta_i, phi_i); `pdf_solid_angle` = pdf_angle / cos(theta_i), per steradian.
 * Both are the density of exactly what the library samples: the derivative of the interpolated inverse CDF, not the
 * formula of the lobe that was tabulated. An estimator that divides by it is unbiased for every table, coarse or fine.
 *
 * Rules for every function on the sampling path (sample, pdf, invert, the _n forms):
 *   - no finite input gives NaN or infinity. u outside [0,1], an offset outside [-1,1] and theta_r outside its range are
 *     clamped; an azimuth of any finite size is reduced modulo 2 pi (beyond 2^24 rad a float resolves no azimuth, and the result
 *     is merely valid).
 *   - NaN in any argument, or an infinite azimuth, gives a density of 0, with finite angles inside their ranges.
 *     An infinite theta_r, offset or u is clamped like any other value outside its range.
 *   - theta_i outside [-pi/2, pi/2] has density 0.
 *   - no allocation, no global state, no errno. Arrays belong to the caller and are not kept.
 *
 * Compilers. These rules hold in a program of any flags, -ffast-math among them: the library's own sources are compiled without
 * (CMake sees to it; compiled by hand with it they are refused). NaN in a program that is compiled with -ffast-math is its own
 * affair. Float arithmetic must be done in float: on 32-bit x86 with SSE2.
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
    HAIRLUT_ERROR_TABLE, /* the texels are not a table: NaN, not increasing, outside the domain, too small; or not a mixture */
    HAIRLUT_ERROR_UNSUPPORTED /* the file needs a feature (a compression) that the OpenEXR library in use lacks */
} hairlut_result;

/* A static string for any value of `result`; never NULL. */
HAIRLUT_API const char *hairlut_result_string(hairlut_result result);

/* ---- models --------------------------------------------------------------------------------------------------- */

typedef struct hairlut_model hairlut_model;

enum {
    HAIRLUT_MAX_LOBES = 16,
    HAIRLUT_MAX_PARAMETERS = 8,
    HAIRLUT_MAX_AXES = 4,  /* parameters on which one table, or the mixture, depends */
    HAIRLUT_NAME_SIZE = 32 /* bytes of the name of a lobe or a parameter, with its end */
};

/* "printed", "fitted" or "brown": a model compiled into the library. NULL for any other name. Nothing to free. */
HAIRLUT_API const hairlut_model *hairlut_builtin(const char *name);

typedef enum hairlut_warp {
    HAIRLUT_WARP_UNIFORM = 0, /* knots uniform in u: the baseline, only for comparisons */
    HAIRLUT_WARP_OCTAVES = 1  /* knots uniform in F(min(u,1-u) + e), F near a fourth root */
} hairlut_warp;

typedef enum hairlut_azimuth {
    HAIRLUT_AZIMUTH_DIFFERENCE = 0, /* the azimuth table contains phi_i - phi_r modulo 2 pi */
    HAIRLUT_AZIMUTH_SUM = 1         /* it contains phi_i + phi_r modulo 2 pi */
} hairlut_azimuth;

/* The descriptors below begin with their size, which is the size of the struct as the caller's compiler knows it: a later
 * version can add fields at their ends without breaking a binary. The sizes of 2.0 are known: such descriptors have no parameters
 * and no axes. A size that this version does not know is refused. */

/* A parameter of the hair on which tables and the mixture may depend. Its name is [a-z][a-z0-9_]*, at most 31 characters, and none
 * of theta_r, theta_i, phi, phi_r, phi_i, offset, u, shares and lobe. */
typedef struct hairlut_parameter {
    size_t size;      /* sizeof(hairlut_parameter) */
    const char *name; /* no other parameter's */
    float least;      /* values are clamped to least .. most, which are 1e-30 or more apart, within [-1e30, 1e30] */
    float most;
    float standard; /* from least to most: the value where a caller gives none */
} hairlut_parameter;

/* An axis of a table or of the mixture: the values of a parameter at which it is tabulated. Between nodes, what is tabulated is
 * blended linearly in the parameter, over several axes multilinearly. */
typedef struct hairlut_parameter_nodes {
    size_t size;         /* sizeof(hairlut_parameter_nodes) */
    int parameter;       /* its number in the model; each at most once in a table or mixture */
    int count;           /* 2 to 64 */
    const float *values; /* increasing, by 1e-30 or more, from the parameter's least to its most, both exactly */
} hairlut_parameter_nodes;

/* One table as it stands in a file (luts/FORMAT.md). Row j belongs to theta_r = theta_r_min + j (theta_r_max - theta_r_min) /
 * (height - 1). Texel i of a row is a pair of floats: the angle x whose cumulative probability is knot i, and dx/du there.
 * Between knots x is the monotone rational quadratic of Gregory and Delbourgo (1982) through these values and slopes;
 * between rows, values and slopes are blended linearly in theta_r. */
typedef struct hairlut_table {
    size_t size;         /* sizeof(hairlut_table) */
    const float *texels; /* width*height pairs, row-major; along a row each angle is at least 1e-12 above the last */
    int width;           /* 4 to 4096 */
    int height;          /* 2 to 4096 */
    float theta_r_min;   /* rad, -2 pi <= theta_r_min < theta_r_max */
    float theta_r_max;   /* rad, <= 2 pi */
    float domain_min;    /* rad, -2 pi <= domain_min; the first angle of every row */
    float domain_max;    /* rad, <= 2 pi; the last angle of every row */
    hairlut_warp warp;
    float warp_e;   /* the parameter of octaves, 1e-12 to 1; ignored for the uniform warp */
    int axis_count; /* 0 to HAIRLUT_MAX_AXES: the parameters on which the table depends. Its texels are then those of one table
                       of `height` rows for each node of the axes, the first axis slowest; at most 65536 rows in all */
    const hairlut_parameter_nodes *axes; /* axis_count descriptors, each of the size that the first one states */
} hairlut_table;

/* A lobe: the product of two tables. Lobes that pass the same table pointers share the memory of those tables. */
typedef struct hairlut_lobe_desc {
    size_t size;                /* sizeof(hairlut_lobe_desc) */
    const char *name;           /* [a-z][a-z0-9_]*, at most 31 characters, no other lobe's */
    const hairlut_table *theta; /* theta_i: its domain lies within [-pi/2, pi/2] */
    const hairlut_table *phi;   /* the relative azimuth: its domain lies within [0, 2 pi]; NULL: uniform */
    hairlut_azimuth azimuth;    /* what phi contains; ignored where it is NULL */
} hairlut_lobe_desc;

/* Shares and turns at the nodes of a grid over theta_r and the offset. Both are linear in theta_r and in the asin of the offset
 * between nodes, and constant beyond them; turns are blended along the shorter arc. One node where nothing depends on an axis.
 * Lobe k's value at theta_r node j and offset node o stands at [(k*theta_r_count + j)*offset_count + o].
 *
 * A mixture over parameters has such a grid for each node p of its axes, the first axis slowest: lobe k's value stands at
 * [((k*nodes + p)*theta_r_count + j)*offset_count + o]. Shares, which sum to 1 at each node, and turns are blended over the
 * parameters first: turns as t0 + sum w_i wrap(t_i - t0), where t0 is that of the lower nodes, and wrap leads to [-pi, pi).
 * At most 2^18 nodes in all. */
typedef struct hairlut_mixture_desc {
    size_t size;          /* sizeof(hairlut_mixture_desc) */
    int theta_r_count;    /* 1 to 4096 */
    int offset_count;     /* 1 to 4096 */
    const float *theta_r; /* rad, increasing, within [-2 pi, 2 pi]; may be NULL for a single node */
    const float *offset;  /* increasing, within [-1, 1], or [0, 1] if mirrored; may be NULL for a single node */
    const float *share;   /* finite, not negative, at each node at least one above 0, in any unit; NULL: equal shares */
    const float *turn;    /* rad, of at most 8 pi in size; NULL: 0 */
    int mirrored;         /* 1: an offset -h has the shares and turns of h, and the azimuths drawn are negated; else 0 */
    int axis_count;       /* 0 to HAIRLUT_MAX_AXES: the parameters on which the mixture depends */
    const hairlut_parameter_nodes *axes; /* axis_count descriptors, each of the size that the first one states */
} hairlut_mixture_desc;

typedef struct hairlut_model_desc {
    size_t size;                         /* sizeof(hairlut_model_desc) */
    int lobe_count;                      /* 1 to HAIRLUT_MAX_LOBES */
    const hairlut_lobe_desc *lobes;      /* lobe_count descriptors, each of the size that the first one states */
    const hairlut_mixture_desc *mixture; /* NULL: equal shares, no turns */
    int parameter_count;                 /* 0 to HAIRLUT_MAX_PARAMETERS */
    const hairlut_parameter *parameters; /* parameter_count descriptors, each of the size that the first one states */
} hairlut_model_desc;

/* Memory for a model. A zeroed struct, or NULL in its place, means malloc and free. `allocate` returns memory
 * aligned for any type, or NULL; `release` gets only what `allocate` returned. Both are called only inside
 * hairlut_model_create, hairlut_load and hairlut_free, from the calling thread. */
typedef struct hairlut_allocator {
    void *(*allocate)(void *user, size_t size);
    void (*release)(void *user, void *memory);
    void *user;
} hairlut_allocator;

enum { HAIRLUT_MESSAGE_SIZE = 512 };

/* Checks a table that did not come from this project's tools. HAIRLUT_OK, or an error; `message`, if not NULL, has room for
 * HAIRLUT_MESSAGE_SIZE bytes and receives what is wrong, where, and what was expected. Slopes must be 1e-9 to 1e12 rad per unit
 * of u. Reads width*height pairs of floats, for each node of the table's axes. */
HAIRLUT_API hairlut_result hairlut_validate(const hairlut_table *table, char *message);

/* Builds a model from tables in memory, which are copied, into about four times their own memory in the order in which samples
 * read them: the caller may free everything when this returns. All of it is validated first. On error *out is NULL and
 * nothing stays allocated. Free with hairlut_free. */
HAIRLUT_API hairlut_result hairlut_model_create(const hairlut_model_desc *desc, const hairlut_allocator *allocator,
                                                hairlut_model **out, char *message);

/* Releases a model made by hairlut_model_create or hairlut_load; NULL is allowed. No thread may be using it. */
HAIRLUT_API void hairlut_free(hairlut_model *model);

HAIRLUT_API int hairlut_lobe_count(const hairlut_model *model);

/* The name of lobe 0 to count - 1, as long as the model lives; NULL for any other number. */
HAIRLUT_API const char *hairlut_lobe_name(const hairlut_model *model, int lobe);

/* The number of the lobe of that name; -1 if there is none. */
HAIRLUT_API int hairlut_lobe_index(const hairlut_model *model, const char *name);

typedef enum hairlut_angle { HAIRLUT_THETA = 0, HAIRLUT_PHI = 1 } hairlut_angle;

/* Columns and rows of one of a lobe's tables, for one node of its axes; 0 and 0 where there is none. */
HAIRLUT_API void hairlut_table_size(const hairlut_model *model, int lobe, hairlut_angle angle, int *width, int *height);

/* How many parameters of the hair the model depends on; 0 for compiled-in models. */
HAIRLUT_API int hairlut_parameter_count(const hairlut_model *model);

/* The name of parameter 0 to count - 1, as long as the model lives; NULL for any other number. */
HAIRLUT_API const char *hairlut_parameter_name(const hairlut_model *model, int parameter);

/* The number of the parameter of that name; -1 if there is none. */
HAIRLUT_API int hairlut_parameter_index(const hairlut_model *model, const char *name);

/* A parameter's range and standard value; each pointer may be NULL. Returns 1, or 0, leaving them alone, for a number that no
 * parameter has. */
HAIRLUT_API int hairlut_parameter_range(const hairlut_model *model, int parameter, float *least, float *most,
                                        float *standard);

/* ---- one direction -------------------------------------------------------------------------------------------- */

typedef struct hairlut_sample {
    float theta_i;         /* [-pi/2, pi/2] */
    float phi_i;           /* [-pi, pi) */
    float pdf_angle;       /* per rad^2 */
    float pdf_solid_angle; /* per sr */
} hairlut_sample;

/* The whole hair. Draws an incident direction for the viewer direction (theta_r, phi_r) from three numbers in [0,1): the lobe
 * by u_lobe, in proportion to the shares, then its angles. The densities returned are the mixture's.
 *
 * shares: NULL for the model's own, or one number a lobe, in any unit, for this call. A negative one counts as 0. Where none is
 * above 0, or one is infinite or NaN, the density is 0. A lobe without share is never drawn. */
HAIRLUT_API hairlut_sample hairlut_sample_hair(const hairlut_model *model, const float *shares, float theta_r, float phi_r,
                                               float offset, float u_lobe, float u_theta, float u_phi);

/* Density, per rad^2, with which the function above draws (theta_i, phi_i): the sum of share * density over the lobes, divided
 * by the sum of the shares. phi_i may be any finite azimuth. Equal to the density returned with a sample but for rounding. */
HAIRLUT_API float hairlut_pdf_hair(const hairlut_model *model, const float *shares, float theta_r, float phi_r, float offset,
                                   float theta_i, float phi_i);

/* The whole hair of one strand: the two functions above for a model over parameters. parameters: one number for each of the
 * model's, in their order, or NULL for the standard values. A number outside its parameter's range is clamped; NaN gives density 0,
 * with finite angles. A model without parameters reads none: this is then hairlut_sample_hair. The standard values passed as numbers
 * give what NULL gives but for rounding, about 1e-6 of a density: NULL reads tables that were blended before.
 *
 *     float strand[] = {beta_m, beta_n, absorption};       // the order of hairlut_parameter_name
 *     hairlut_sample s = hairlut_sample_strand(hair, strand, NULL, theta_r, phi_r, offset, u_lobe, u_theta, u_phi); */
HAIRLUT_API hairlut_sample hairlut_sample_strand(const hairlut_model *model, const float *parameters, const float *shares,
                                                 float theta_r, float phi_r, float offset, float u_lobe, float u_theta,
                                                 float u_phi);
HAIRLUT_API float hairlut_pdf_strand(const hairlut_model *model, const float *parameters, const float *shares, float theta_r,
                                     float phi_r, float offset, float theta_i, float phi_i);

/* ---- several calls at one hit ---------------------------------------------------------------------------------- */

/* A viewer: all that calls at one hit have in common, computed once, where a renderer draws from it and asks for the densities of
 * several directions that lights chose. Its functions give what hairlut_sample_strand and hairlut_pdf_strand give for the same
 * arguments, bit for bit, for models with and without parameters.
 *
 *     hairlut_viewer viewer;
 *     hairlut_viewer_at(&viewer, hair, NULL, NULL, theta_r, phi_r, offset);           // once a hit
 *     hairlut_sample s = hairlut_viewer_sample(&viewer, u_lobe, u_theta, u_phi);      // as often as needed
 *     float q = hairlut_viewer_pdf(&viewer, theta_i, phi_i);
 *
 * A viewer belongs to the caller, on the stack or anywhere, and may be copied and dropped; what it contains is private. `parameters`
 * and `shares` are read only by hairlut_viewer_at; the model has to outlive the viewer. A viewer of zeros, or that was never set, may
 * not be used. Any number of threads may use one viewer at once. */
enum { HAIRLUT_VIEWER_SIZE = 1024 }; /* bytes, in all of 2.x */
typedef struct hairlut_viewer {
    union {
        const void *pointer;
        double number;
        unsigned char bytes[HAIRLUT_VIEWER_SIZE];
    } contents;
} hairlut_viewer;

HAIRLUT_API void hairlut_viewer_at(hairlut_viewer *viewer, const hairlut_model *model, const float *parameters,
                                   const float *shares, float theta_r, float phi_r, float offset);
HAIRLUT_API hairlut_sample hairlut_viewer_sample(const hairlut_viewer *viewer, float u_lobe, float u_theta, float u_phi);
HAIRLUT_API float hairlut_viewer_pdf(const hairlut_viewer *viewer, float theta_i, float phi_i);

/* ---- one lobe -------------------------------------------------------------------------------------------------- */

/* One lobe by itself, not turned: lobe 0 to count - 1. Any other number gives density 0, with finite angles. */
HAIRLUT_API hairlut_sample hairlut_sample_lobe(const hairlut_model *model, int lobe, float theta_r, float phi_r,
                                               float u_theta, float u_phi);
HAIRLUT_API float hairlut_pdf_lobe(const hairlut_model *model, int lobe, float theta_r, float phi_r, float theta_i,
                                   float phi_i);

/* The numbers u[0] = u_theta and u[1] = u_phi from which hairlut_sample_lobe draws (theta_i, phi_i). Directions outside the
 * domain give the nearer end's u; NaN, or a lobe that there is not, gives 0. */
HAIRLUT_API void hairlut_invert_lobe(const hairlut_model *model, int lobe, float theta_r, float phi_r, float theta_i,
                                     float phi_i, float u[2]);

/* The lobes named "direct" and "multiple": the two parts of dual scattering. On a model without such a lobe: density 0. */
HAIRLUT_API hairlut_sample hairlut_sample_direct(const hairlut_model *model, float theta_r, float phi_r, float u_theta,
                                                 float u_phi);
HAIRLUT_API hairlut_sample hairlut_sample_multiple(const hairlut_model *model, float theta_r, float phi_r, float u_theta,
                                                   float u_phi);
HAIRLUT_API float hairlut_pdf_direct(const hairlut_model *model, float theta_r, float phi_r, float theta_i, float phi_i);
HAIRLUT_API float hairlut_pdf_multiple(const hairlut_model *model, float theta_r, float phi_r, float theta_i, float phi_i);

/* per rad^2 to per sr: pdf_angle / cos(theta_i), finite also at theta_i = +-pi/2 */
HAIRLUT_API float hairlut_pdf_to_solid_angle(float pdf_angle, float theta_i);

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
 * equal those of the one-direction forms bit for bit, whichever kernel runs: portable C, AVX2, AVX-512 or NEON,
 * chosen at run time.
 *
 * shares: NULL for the model's own, or lobe_count * n floats, those of lobe k from k * n on. offset: NULL for 0. */
typedef struct hairlut_samples {
    float *theta_i;
    float *phi_i;
    float *pdf_angle;       /* may be NULL: not stored */
    float *pdf_solid_angle; /* may be NULL: not stored */
} hairlut_samples;

HAIRLUT_API void hairlut_sample_hair_n(const hairlut_model *model, size_t n, const float *shares, const float *theta_r,
                                       const float *phi_r, const float *offset, const float *u_lobe, const float *u_theta,
                                       const float *u_phi, hairlut_samples out);
HAIRLUT_API void hairlut_pdf_hair_n(const hairlut_model *model, size_t n, const float *shares, const float *theta_r,
                                    const float *phi_r, const float *offset, const float *theta_i, const float *phi_i,
                                    float *pdf_angle);
/* parameters: NULL for the standard values, or parameter_count * n floats, those of parameter p from p * n on. */
HAIRLUT_API void hairlut_sample_strand_n(const hairlut_model *model, size_t n, const float *parameters, const float *shares,
                                         const float *theta_r, const float *phi_r, const float *offset, const float *u_lobe,
                                         const float *u_theta, const float *u_phi, hairlut_samples out);
HAIRLUT_API void hairlut_pdf_strand_n(const hairlut_model *model, size_t n, const float *parameters, const float *shares,
                                      const float *theta_r, const float *phi_r, const float *offset, const float *theta_i,
                                      const float *phi_i, float *pdf_angle);
HAIRLUT_API void hairlut_sample_lobe_n(const hairlut_model *model, int lobe, size_t n, const float *theta_r,
                                       const float *phi_r, const float *u_theta, const float *u_phi, hairlut_samples out);
HAIRLUT_API void hairlut_pdf_lobe_n(const hairlut_model *model, int lobe, size_t n, const float *theta_r, const float *phi_r,
                                    const float *theta_i, const float *phi_i, float *pdf_angle);
HAIRLUT_API void hairlut_sample_direct_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                                         const float *u_theta, const float *u_phi, hairlut_samples out);
HAIRLUT_API void hairlut_sample_multiple_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                                           const float *u_theta, const float *u_phi, hairlut_samples out);
HAIRLUT_API void hairlut_pdf_direct_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                                      const float *theta_i, const float *phi_i, float *pdf_angle);
HAIRLUT_API void hairlut_pdf_multiple_n(const hairlut_model *model, size_t n, const float *theta_r, const float *phi_r,
                                        const float *theta_i, const float *phi_i, float *pdf_angle);

/* ---- files (library hairlut_exr) ------------------------------------------------------------------------------ */

/* Loads the model of a directory: mixture.exr and the tables that it names (luts/FORMAT.md says what is checked), or the three
 * tables of format 1: lobes "direct" and "multiple" of equal shares.
 * On error *out is NULL, nothing stays allocated, and `message`, if not NULL, has room for HAIRLUT_MESSAGE_SIZE bytes and
 * receives the file, the attribute, what was expected and what to do. Free with hairlut_free.
 * OpenEXR takes its own temporary memory from malloc. Any number of threads may load at once. */
HAIRLUT_EXR_API hairlut_result hairlut_load(const char *directory, hairlut_model **out);
HAIRLUT_EXR_API hairlut_result hairlut_load_with(const char *directory, const hairlut_allocator *allocator,
                                                 hairlut_model **out, char *message);

#ifdef __cplusplus
}
#endif

#endif
