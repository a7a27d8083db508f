# SPDX-License-Identifier: BSD-3-Clause
"""A lobe known as masses of cells at some viewer angles: measured, simulated, or evaluated on a grid.

Along x, each row's cumulative mass at the cells' edges is joined by a monotone cubic, so that every cell
keeps its mass and the density is continuous. Between two rows the *quantiles* are blended, x(u) = (1-t)
x_j(u) + t x_{j+1}(u): a peak that moves with theta_r moves, where a blend of the densities would make two
peaks of it. A baked table blends its rows in the same way. The density of the blend is its derivative, 1/q
= (1-t)/p_j + t/p_{j+1}, each density taken at its own row's quantile. Outside the range of the rows the
nearest row continues.
"""

from __future__ import annotations

import numpy as np

from .cubics import Cubics
from .errors import HairlutError
from .invert import ALL

FLOOR = 1e-4
"""Share of each row's mass that is uniform: where the data have no light, a renderer may have some."""

MERGE = 1e-4, 1e-8
"""Knots of a blended row that are closer than this part of the domain, or of the mass, are one."""

SAME = 1e-9  # of the distance of two rows: theta_r that differ only by rounding are one

MAX_HEIGHT = 256


class TabulatedDensity:
    """log_density(x, theta_r) of rows of cell masses, and its breakpoints(theta_r).

    edges: (n+1,) increasing, rad; the first and last are the ends of the lobe's domain.
    theta_r: (J,) increasing, rad. mass: (J, n), not negative, any positive sum per row.
    """

    def __init__(self, edges, theta_r, mass, name: str = "tabulated lobe", floor: float = FLOOR):
        from scipy.interpolate import PchipInterpolator  # slow to import

        edges, theta_r, mass = (np.asarray(a, np.float64) for a in (edges, theta_r, mass))
        _check(edges, theta_r, mass, name)
        self.edges, self.theta_r = edges, theta_r
        even = np.diff(edges) / (edges[-1] - edges[0])
        share = (1 - floor) * mass / mass.sum(axis=1, keepdims=True) + floor * even
        u = np.concatenate([np.zeros((len(theta_r), 1)), np.cumsum(share, axis=1)], axis=1)
        u /= u[:, -1:]
        slope = np.maximum(PchipInterpolator(edges, u, axis=1)(edges, 1), 0.0)
        self._own = Cubics(np.tile(edges, (len(theta_r), 1)), u, slope)
        self._slope = slope
        self._last: tuple[np.ndarray, Cubics] | None = None

    def __call__(self, x, theta_r):
        """Log-density at x and theta_r (rad, broadcast against each other); -inf outside the domain."""
        x, theta_r = np.asarray(x, np.float64), np.asarray(theta_r, np.float64)
        angles, which = np.unique(theta_r, return_inverse=True)
        which = which.reshape(theta_r.shape)
        low, high = self.edges[0], self.edges[-1]
        density = self.rows(angles).density(x, which)
        density = np.where((x < low) | (x > high), 0.0, density)
        with np.errstate(divide="ignore"):
            return np.log(density)

    def breakpoints(self, theta_r) -> np.ndarray:
        """(R, B) knots of the rows at theta_r (R,), filled up with the domain's end."""
        return self.rows(np.ravel(theta_r)).x

    @property
    def own_height(self) -> int:
        """The least height of a table over all theta_r that has these rows; 0 above MAX_HEIGHT."""
        for height in range(2, MAX_HEIGHT + 1):
            at = (self.theta_r / np.pi + 0.5) * (height - 1)
            if (abs(at - np.rint(at)) < 1e-6 * height).all():
                return height
        return 0

    def rows(self, theta_r: np.ndarray) -> Cubics:
        """The rows at theta_r (R,), cached while the calls are for the same theta_r."""
        if self._last is None or not np.array_equal(self._last[0], theta_r):
            self._last = np.array(theta_r), self._blended(theta_r)
        return self._last[1]

    def exact(self, theta_r: np.ndarray) -> ExactRows:
        """As exact.Exact, in closed form."""
        return ExactRows(theta_r, self.rows(theta_r))

    def _blended(self, theta_r: np.ndarray) -> Cubics:
        at = np.interp(theta_r, self.theta_r, np.arange(len(self.theta_r)))
        at = np.where(abs(at - np.rint(at)) < SAME, np.rint(at), at)
        j = at.astype(int)
        t = (at - j)[:, None]
        pairs, which = np.unique(j, return_inverse=True)
        u, low, high, dense_low, dense_high = (part[which] for part in self._pairs(pairs))
        with np.errstate(divide="ignore", invalid="ignore"):  # a density of zero at an edge
            slope = 1 / ((1 - t) / dense_low + t / dense_high)
        x = (1 - t) * low + t * high
        x[:, 0], x[:, -1] = self.edges[0], self.edges[-1]
        kept = np.diff(x, append=np.inf) > MERGE[0] * (self.edges[-1] - self.edges[0])
        kept[:, 0] = True
        x, u, slope = _only(kept, x, u, slope)
        given = np.broadcast_to(self.edges, (len(j), self.edges.size)), self._own.u[j], self._slope[j]
        own = (_widened(part, x) for part in given)
        return Cubics(*(np.where(t > 0, a, b) for a, b in zip((x, u, slope), own, strict=True)))

    def _pairs(self, j: np.ndarray) -> tuple[np.ndarray, ...]:
        """For the rows j (P,) and their successors: the masses at the knots of both, and there the quantiles
        and then the densities of the one and of the other, all (P, K)."""
        after = np.minimum(j + 1, len(self.theta_r) - 1)
        u = np.sort(np.concatenate([self._own.u[j], self._own.u[after]], axis=1), axis=1)
        (u,) = _only(np.diff(u, axis=1, prepend=-1) > MERGE[1], u)
        x = [self._own.quantile(u, row[:, None]) for row in (j, after)]
        return u, *x, *(self._own.density(q, row[:, None]) for q, row in zip(x, (j, after), strict=True))


class ExactRows:
    """The normalised density at theta_r (R,), with the methods of exact.Exact; no sums are needed."""

    def __init__(self, theta_r: np.ndarray, cubics: Cubics):
        self.theta_r, self._cubics = theta_r, cubics
        self.log_mass, self.knots = np.zeros(len(theta_r)), cubics.x

    def density(self, x: np.ndarray, row: np.ndarray) -> np.ndarray:
        return self._cubics.density_between(x, row)

    def features(self, row: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.zeros(len(row), int)

    def quantiles(self, m: np.ndarray, upper: np.ndarray, rows: slice | np.ndarray = ALL) -> np.ndarray:
        row = np.arange(len(self.theta_r))[rows]
        return self._cubics.quantile(np.where(upper, 1 - m, m), row[:, None])


def _only(kept: np.ndarray, *parts: np.ndarray) -> list[np.ndarray]:
    """The columns of each row that are kept, and the last one for those that are not, at the end."""
    order = np.argsort(~kept, axis=1, kind="stable")
    last = kept.shape[1] - 1
    order = np.where(np.arange(last + 1) < kept.sum(axis=1, keepdims=True), order, last)
    return [np.take_along_axis(part, order, axis=1) for part in parts]


def _widened(values: np.ndarray, like: np.ndarray) -> np.ndarray:
    return np.pad(values, ((0, 0), (0, like.shape[1] - values.shape[1])), mode="edge")


def _check(edges, theta_r, mass, name: str) -> None:
    if (
        edges.ndim != 1
        or theta_r.ndim != 1
        or mass.shape != (len(theta_r), len(edges) - 1)
        or not len(theta_r)
    ):
        raise HairlutError(
            f"{name}: mass has shape {mass.shape}, expected (number of theta_r, number of edges - 1) "
            f"= ({theta_r.size}, {edges.size - 1})"
        )
    for what, values in (("edges", edges), ("theta_r", theta_r)):
        if not (np.isfinite(values).all() and (np.diff(values) > 0).all()):
            raise HairlutError(f"{name}: {what} must be finite and increase strictly")
    for j, row in enumerate(mass):
        place = f"{name} at theta_r = {np.degrees(theta_r[j]):.4g} deg"
        if not np.isfinite(row).all():
            raise HairlutError(f"{place}: the mass of a cell is not a finite number")
        if (row < 0).any():
            raise HairlutError(f"{place}: negative density in cell {int(np.argmin(row))}")
        if row.sum() <= 0:
            raise HairlutError(f"{place}: no mass in the domain")
