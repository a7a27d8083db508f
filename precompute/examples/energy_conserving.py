# SPDX-License-Identifier: BSD-3-Clause
"""The energy-conserving longitudinal lobe of d'Eon et al. (2011).

With the variance v and both angles measured from the normal plane, light leaves towards theta_r from
theta_i with

    M(theta_i, theta_r) = csch(1/v) / (2 v) exp(-sin theta_i sin theta_r / v) I0(cos theta_i cos theta_r / v),

and M cos(theta_i) d theta_i integrates to 1 over [-pi/2, pi/2] for every theta_r. There is no closed
inverse in theta_i alone. I0 overflows from 1/v = 700 on; its scaled form i0e does not.
"""

import numpy as np
from scipy.special import i0e

from hairlut.modelfile import density

LOGISTIC_SCALE = 0.12
NARROW, BROAD = 0.15**2, 0.45**2


def log_longitudinal(theta_i, theta_r, v):
    bessel = np.cos(theta_i) * np.cos(theta_r) / v
    # log csch(1/v) = log 2 - 1/v - log(1 - exp(-2/v))
    csch = np.log(2.0) - 1 / v - np.log1p(-np.exp(-2 / v))
    even = csch - np.log(2 * v) - np.sin(theta_i) * np.sin(theta_r) / v + np.log(i0e(bessel)) + bessel
    return even + np.log(np.cos(theta_i))


def log_azimuthal(phi, theta_r):
    """A logistic around pi, the shape of trimmed_logistic.py."""
    z = np.abs(phi - np.pi + 0 * theta_r) / LOGISTIC_SCALE
    return -z - 2 * np.log1p(np.exp(-z))


LOBES = (
    density(
        "direct_theta",
        log_density=lambda theta_i, theta_r: log_longitudinal(theta_i, theta_r, NARROW),
        formula=f"energy-conserving longitudinal lobe, v = {NARROW:.6g}",
    ),
    density(
        "direct_phi",
        log_density=log_azimuthal,
        formula=f"logistic of phi = phi_i - phi_r around pi, scale {LOGISTIC_SCALE}",
    ),
    density(
        "multiple_theta",
        log_density=lambda theta_i, theta_r: log_longitudinal(theta_i, theta_r, BROAD),
        formula=f"energy-conserving longitudinal lobe, v = {BROAD:.6g}",
    ),
)
