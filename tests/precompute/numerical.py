# SPDX-License-Identifier: BSD-3-Clause
"""What a bake computes before it rounds."""

from hairlut.integrate import integrate, rows_of_lobe
from hairlut.invert import invert


def quantiles(lobe, theta_r, m, upper):
    """(angles (R, K), log_mass (R,)) of the tails m, upper (K,), in double precision."""
    integral = integrate(rows_of_lobe(lobe, theta_r))
    return invert(integral, m, upper), integral.log_mass
