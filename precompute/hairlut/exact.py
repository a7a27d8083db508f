# SPDX-License-Identifier: BSD-3-Clause
"""The exact lobe at some viewer inclinations: what a table is made from, and measured against."""

from functools import partial

import numpy as np

from .integrate import Integral, integrate, rows_of_lobe
from .invert import ALL, invert
from .lobes import Array, Lobe


class Exact:
    """The normalised lobe at theta_r (R,), by integration.

    log_mass  (R,) logarithm of the lobe's mass inside its domain
    knots     (R, K) angles between which the density is smooth, if they are known
    """

    def __init__(self, lobe: Lobe, theta_r: Array):
        self.lobe = lobe
        self.theta_r = theta_r
        self.integral: Integral = integrate(rows_of_lobe(lobe, theta_r))
        self.log_mass = self.integral.log_mass
        self.knots = np.empty((len(theta_r), 0))
        (low, high), edges = lobe.domain, self.integral.edges
        self._edges = (np.arange(len(edges))[:, None] + (edges - low) / (high - low) / 2).ravel()

    def density(self, x: Array, row: Array) -> Array:
        """(K, n) density at x (K, n), per rad, in the rows row (n,); a column of x lies between two knots."""
        inside = np.clip(x, *self.lobe.domain)  # a texel may round to just outside
        return np.exp(self.integral.rows.log_density(inside.T, row).T - self.log_mass[row])

    def features(self, row: Array, a: Array, b: Array) -> Array:
        """(n,) edges between a and b (n,) of the panels by which the rows row (n,) were integrated: many
        where the density varies fast."""
        low, high = self.lobe.domain
        return np.searchsorted(self._edges, row + (b - low) / (high - low) / 2) - np.searchsorted(
            self._edges, row + (a - low) / (high - low) / 2
        )

    def quantiles(self, m: Array, upper: Array, rows: slice | Array = ALL) -> Array:
        """Angles of the tails m, upper (K,) in these rows; an array of shape (number of rows, K)."""
        return invert(self.integral, m, upper, rows)


def exact_at(lobe: Lobe, theta_r: Array) -> Exact:
    """The normalised lobe at theta_r (R,): its own closed form, or by integration if it has none."""
    return (lobe.exact or partial(Exact, lobe))(theta_r)
