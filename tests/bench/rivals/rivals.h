/* The rivals as functions over arrays of n: theta_r and u in, angle x and density out. `scalar` forms make one call of a
 * function a sample, as a renderer does; `vector` forms leave the loop to the compiler's fastest flags. */
#ifndef RIVALS_H
#define RIVALS_H

#include <stddef.h>

#include "lobe.h"

#ifdef __cplusplus
extern "C" {
#endif

void rival_fill_rows(rival_table table, rival_rows *rows);

#define RIVAL_ARRAYS size_t n, const float *theta_r, const float *u, float *x, float *pdf
void rival_analytic_scalar(rival_table table, RIVAL_ARRAYS);
void rival_hybrid_scalar(const rival_rows *rows, RIVAL_ARRAYS);
void rival_analytic_vector256(rival_table table, RIVAL_ARRAYS);
void rival_analytic_vector512(rival_table table, RIVAL_ARRAYS);
void rival_hybrid_vector256(const rival_rows *rows, RIVAL_ARRAYS);
void rival_hybrid_vector512(const rival_rows *rows, RIVAL_ARRAYS);
void rival_boost_scalar(rival_table table, RIVAL_ARRAYS);
void rival_mkl_vector(rival_table table, RIVAL_ARRAYS);

#ifdef __cplusplus
}
#endif

#endif
