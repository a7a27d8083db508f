# SPDX-License-Identifier: BSD-3-Clause
"""The azimuth lobe in the incident azimuth phi_i itself, over a grid of phi_r.

The density of direct_phi depends on phi_i and phi_r only through the relative azimuth, so every phi_r gives
the same row, shifted. That is why phi_r has no axis in a texture; here it is computed instead of assumed.
"""

import numpy as np

from hairlut.integrate import Rows, integrate, rows_of_lobe
from hairlut.invert import invert
from hairlut.lobes import SUM, Array, Lobe

PERIOD = 2 * np.pi


def cut(lobe: Lobe, phi_r: Array) -> Array:
    """The phi_i at which the relative azimuth is 0, where the lobe is cut."""
    return -phi_r if lobe.azimuth == SUM else phi_r


def rows_of_phi_r(lobe: Lobe, theta_r: float, phi_r: Array) -> Rows:
    """The density of phi_i over the period that starts at the cut, a row for each phi_r (P,)."""
    relative = rows_of_lobe(lobe, np.full(len(phi_r), theta_r))
    start = cut(lobe, phi_r)
    return Rows(
        log_density=lambda x, row: relative.log_density(np.mod(x - start[row][:, None], PERIOD), row),
        low=relative.low + start,
        high=relative.high + start,
        breakpoints=relative.breakpoints + start[:, None],
        label=lambda row: f"{relative.label(row)}, phi_r = {phi_r[row]:.9g} rad",
    )


def quantiles_of_phi_i(lobe: Lobe, theta_r: float, phi_r: Array, m: Array, upper: Array) -> Array:
    """(P, K) angles phi_i of the tails m, upper (K,) as in invert.invert, for each phi_r (P,)."""
    return invert(integrate(rows_of_phi_r(lobe, theta_r, np.asarray(phi_r, float))), m, upper)


def largest_shift_error(lobe: Lobe, theta_r: Array, phi_r: Array, m: Array, upper: Array) -> float:
    """Largest difference, rad, between the rows of all phi_r (P,), shifted back, and the row of the
    texture."""
    phi_r = np.asarray(phi_r, float)
    texture = invert(integrate(rows_of_lobe(lobe, theta_r)), m, upper)
    worst = 0.0
    for theta, row in zip(theta_r, texture, strict=True):
        back = quantiles_of_phi_i(lobe, theta, phi_r, m, upper) - cut(lobe, phi_r)[:, None]
        worst = max(worst, float(abs(back - row).max()))
    return worst
