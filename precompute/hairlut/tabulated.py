"""A lobe known as masses of cells at some viewer angles: measured, simulated, or evaluated on a grid.

Along x, each row's cumulative mass at the cells' edges is joined by a monotone cubic, so that every cell
keeps its mass and the density is continuous. Between two rows the *quantiles* are blended, x(u) = (1-t)
x_j(u) + t x_{j+1}(u): a peak that moves with theta_r moves, where a blend of the densities would make two
peaks of it. A baked table blends its rows in the same way. The density of the blend is its derivative, 1/q
= (1-t)/p_j + t/p_{j+1}, each density taken at its own row's quantile. Outside the range of the rows the
nearest row holds.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

from .errors import HairlutError

FLOOR = 1e-4
"""Share of each row's mass that is spread evenly: where data have nothing, a renderer may have something."""

MERGE = 1e-4, 1e-8
"""Knots of a blended row that are closer than this part of the domain, or of the mass, are one."""


MAX_HEIGHT = 256


class TabulatedDensity:
    """log_density(x, theta_r) of rows of cell masses, and its breakpoints(theta_r).

    edges: (n+1,) increasing, rad; the first and last are the ends of the lobe's domain.
    theta_r: (J,) increasing, rad. mass: (J, n), not negative, any positive sum per row.
    """

    def __init__(self, edges, theta_r, mass, name: str = "tabulated lobe", floor: float = FLOOR):
        edges, theta_r, mass = (np.asarray(a, np.float64) for a in (edges, theta_r, mass))
        _check(edges, theta_r, mass, name)
        self.edges, self.theta_r = edges, theta_r
        even = np.diff(edges) / (edges[-1] - edges[0])
        share = (1 - floor) * mass / mass.sum(axis=1, keepdims=True) + floor * even
        self._u = np.concatenate([np.zeros((len(theta_r), 1)), np.cumsum(share, axis=1)], axis=1)
        self._u /= self._u[:, -1:]
        self._cubics = [PchipInterpolator(edges, u) for u in self._u]
        self._rows: dict[float, CubicHermiteSpline] = {}
        self._last: tuple[np.ndarray, _Joined] | None = None

    def __call__(self, x, theta_r):
        """Log-density at x and theta_r (rad, broadcast against each other); -inf outside the domain."""
        x, theta_r = np.asarray(x, np.float64), np.asarray(theta_r, np.float64)
        shape = np.broadcast_shapes(x.shape, theta_r.shape)
        angles, which = np.unique(theta_r, return_inverse=True)
        which = np.broadcast_to(which.reshape(theta_r.shape), shape)
        x = np.broadcast_to(x, shape)
        low, high = self.edges[0], self.edges[-1]
        density = np.maximum(self._joined(angles).slope(x, which), 1e-9 / (high - low))
        density = np.where((x < low) | (x > high), 0.0, density)
        with np.errstate(divide="ignore"):
            return np.log(density)

    def _joined(self, angles: np.ndarray) -> _Joined:
        """The rows at these theta_r, kept for as long as the same ones are asked for."""
        if self._last is None or not np.array_equal(self._last[0], angles):
            self._last = angles, _Joined([self.row(float(angle)) for angle in angles])
        return self._last[1]

    def breakpoints(self, theta_r) -> np.ndarray:
        """(R, B) knots of the rows at theta_r (R,), filled up with the domain's end."""
        knots = [self.row(float(angle)).x for angle in np.ravel(theta_r)]
        filled = np.full((len(knots), max(map(len, knots))), self.edges[-1])
        for row, x in zip(filled, knots, strict=True):
            row[: len(x)] = x
        return filled

    @property
    def own_height(self) -> int:
        """The least height of a table over all theta_r that has these rows; 0 above MAX_HEIGHT."""
        for height in range(2, MAX_HEIGHT + 1):
            at = (self.theta_r / np.pi + 0.5) * (height - 1)
            if (abs(at - np.rint(at)) < 1e-6 * height).all():
                return height
        return 0

    def row(self, theta_r: float) -> CubicHermiteSpline:
        """The cumulative mass of the row at theta_r as a piecewise cubic of x."""
        if theta_r not in self._rows:
            self._rows[theta_r] = self._blend(theta_r)
        return self._rows[theta_r]

    def _blend(self, theta_r: float):
        at = float(np.interp(theta_r, self.theta_r, np.arange(len(self.theta_r))))
        j, t = int(at), at - int(at)
        if t == 0.0:
            return self._cubics[j]
        u = np.union1d(self._u[j], self._u[j + 1])
        u = u[np.append(True, np.diff(u) > MERGE[1])]
        u[-1] = 1.0
        low, high = (_quantiles(self._cubics[k], self._u[k], self.edges, u) for k in (j, j + 1))
        x = (1 - t) * low + t * high
        x[0], x[-1] = self.edges[0], self.edges[-1]
        with np.errstate(divide="ignore"):  # a density of zero at an edge
            density = 1 / (
                (1 - t) / np.maximum(self._cubics[j](low, 1), 0)
                + t / np.maximum(self._cubics[j + 1](high, 1), 0)
            )
        kept = np.append(np.diff(x) > MERGE[0] * (x[-1] - x[0]), True)
        kept[0] = True
        return _monotone(x[kept], u[kept], density[kept])


class _Joined:
    """Cubics over one interval as a single one, so that points of many rows are looked up at once."""

    def __init__(self, rows: list[CubicHermiteSpline]):
        self._low, self._scale = rows[0].x[0], 0.5 / (rows[0].x[-1] - rows[0].x[0])
        self._x = np.concatenate([row.x for row in rows])
        ends = np.cumsum([row.x.size for row in rows])
        self._first, self._last = ends - [row.x.size for row in rows], ends - 2  # of the pieces of each row
        self._c = np.concatenate([np.append(row.c, row.c[:, -1:], axis=1) for row in rows], axis=1)
        self._key = self._place(self._x, np.repeat(np.arange(len(rows)), [row.x.size for row in rows]))

    def _place(self, x: np.ndarray, row: np.ndarray) -> np.ndarray:
        return row + (x - self._low) * self._scale

    def slope(self, x: np.ndarray, row: np.ndarray) -> np.ndarray:
        """The derivative at x of the cubics numbered row, of one shape."""
        i = np.searchsorted(self._key, self._place(x, row), side="right") - 1
        i = np.clip(i, self._first[row], self._last[row])
        d = x - self._x[i]
        return (3 * self._c[0, i] * d + 2 * self._c[1, i]) * d + self._c[2, i]


def _quantiles(cubic: PchipInterpolator, u_edges: np.ndarray, edges: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The angles below which the masses u lie; by bisection, as a cell's cubic may be flat at its ends."""
    cell = np.clip(np.searchsorted(u_edges, u, side="right") - 1, 0, len(edges) - 2)
    low, high = edges[cell], edges[cell + 1]
    for _ in range(52):
        middle = (low + high) / 2
        below = cubic(middle) < u
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return (low + high) / 2


def _monotone(x: np.ndarray, u: np.ndarray, density: np.ndarray) -> CubicHermiteSpline:
    """The cubic through (x, u) with these slopes, lowered where it would turn back (Fritsch and Carlson)."""
    secant = np.diff(u) / np.diff(x)
    bound = 3 * np.minimum(np.append(secant[0], secant), np.append(secant, secant[-1]))
    return CubicHermiteSpline(x, u, np.minimum(density, bound))


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
