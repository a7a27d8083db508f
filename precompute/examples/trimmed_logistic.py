# SPDX-License-Identifier: BSD-3-Clause
"""The trimmed logistic of Chiang et al. (2016), in azimuth.

    density(phi) = (1/s) e^(-z) / (1 + e^(-z))^2,   z = (phi - pi) / s,

cut to one period and normalised there. Its scale s follows from the azimuthal roughness b as the paper fits
it, s = sqrt(pi/8) (0.265 b + 1.194 b^2 + 5.372 b^22). Its inclination lobes are plain Gaussians here.
"""

import numpy as np

from hairlut.modelfile import density, gaussian

ROUGHNESS = 0.5
SCALE = np.sqrt(np.pi / 8) * (0.265 * ROUGHNESS + 1.194 * ROUGHNESS**2 + 5.372 * ROUGHNESS**22)


def log_logistic(phi, theta_r):
    z = np.abs(phi - np.pi + 0 * theta_r) / SCALE  # even in z; |z| keeps the exponential below 1
    return -z - 2 * np.log1p(np.exp(-z)) - np.log(SCALE)


LOBES = (
    gaussian("direct_theta", mean=lambda theta_r: -theta_r - np.radians(4), sigma=0.2),
    density(
        "direct_phi",
        log_density=log_logistic,
        formula=f"logistic of phi = phi_i - phi_r around pi, cut to one period, scale {SCALE:.9g}",
    ),
    gaussian("multiple_theta", mean=lambda theta_r: -theta_r, sigma=0.5),
)
