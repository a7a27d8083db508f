# SPDX-License-Identifier: BSD-3-Clause
"""A Gaussian in azimuth that is wrapped around the circle, where the built-in one is cut to one period.

The wrapped density is the sum of the Gaussian over all periods. Its ends meet: it has no step where the cut
one stops short of zero, at phi = 0. Five periods leave out less than 1e-40 of the mass at these widths.
"""

import numpy as np

from hairlut.modelfile import density, gaussian

PERIODS = 2 * np.pi * np.arange(-2, 3)


def sigma(theta_r):
    return theta_r**4 / 4 + 0.59


def log_wrapped(phi, theta_r):
    z = (phi[..., None] - np.pi + PERIODS) / sigma(theta_r)[..., None]
    return np.logaddexp.reduce(-0.5 * z * z, axis=-1)


LOBES = (
    gaussian("direct_theta", mean=lambda theta_r: np.radians(3 * theta_r - 2) - theta_r, sigma=0.29),
    density(
        "direct_phi",
        log_density=log_wrapped,
        formula="wrapped Gaussian of phi = phi_i - phi_r; mean = pi; sigma = theta_r^4 / 4 + 0.59",
    ),
    gaussian(
        "multiple_theta",
        mean=lambda theta_r: np.radians(33.5 * np.sin(1.25 * theta_r) - 1) - theta_r,
        sigma=lambda theta_r: theta_r**4 / 20 + 0.49,
    ),
)
