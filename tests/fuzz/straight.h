/* Tables of four columns and two rows whose angles are evenly spaced: what stands beside what is tested. */
#ifndef STRAIGHT_H
#define STRAIGHT_H

#include "hairlut.h"

#define ROW(low, a, b, high, slope) low, slope, a, slope, b, slope, high, slope

static const float straight_theta_texels[16] = {ROW(-1.57079637f, -0.5f, 0.5f, 1.57079637f, 3.0f), ROW(-1.57079637f, -0.5f, 0.5f, 1.57079637f, 3.0f)};
static const float straight_phi_texels[16] = {ROW(0.0f, 2.0f, 4.0f, 6.28318548f, 6.0f), ROW(0.0f, 2.0f, 4.0f, 6.28318548f, 6.0f)};

static const hairlut_table straight_theta = {sizeof(hairlut_table), straight_theta_texels, 4, 2, -1.5f, 1.5f, -1.57079637f, 1.57079637f,
                                             HAIRLUT_WARP_OCTAVES, 1e-6f};
static const hairlut_table straight_phi = {sizeof(hairlut_table), straight_phi_texels, 4, 2, -1.5f, 1.5f, 0.0f, 6.28318548f,
                                           HAIRLUT_WARP_UNIFORM, 0.0f};

#endif
