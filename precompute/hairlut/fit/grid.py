# SPDX-License-Identifier: BSD-3-Clause
"""A grid of values as a hair: what lies between its points.

Along theta_i and around the fibre the logarithm of the values is a cubic between the points: exact for
exponential tails, and close for Gaussians. Between two theta_r the values at the same angle from the mirror
direction are blended, so that a highlight moves with it. Between two offsets nothing is known: a highlight
may be anywhere. The loss there is measured at offsets that were left out of the fit, whose neighbours are
twice as far away."""

from __future__ import annotations

import numpy as np

from ..lobes import HALF_PI, Array
from .hair import Hair
from .read import Grid
from .turning import TWO_PI

LEAST = 1e-12  # of the largest value: what a logarithm takes a zero for
BEND = 0.5  # how far, in the logarithm, a cubic may leave the two points that it lies between
NARROW = np.radians(0.5)  # range around a grid's only theta_r
ROWS = 12  # intervals of theta_r, at least


def of_grid(grid: Grid, per_steradian: bool) -> Hair:
    """The hair of a grid whose values are densities per steradian, or per rad^2 in (theta_i, phi)."""
    values = grid.value if grid.offset is not None else grid.value[None]
    surface = _Surface(grid, np.log(np.maximum(values, LEAST * values.max())), per_steradian)
    theta_r = grid.theta_r
    between = len(theta_r) - 1
    even = between > 0 and np.allclose(np.diff(theta_r), np.diff(theta_r).mean(), rtol=1e-3)
    offsets = grid.offset is not None and len(grid.offset) > 1
    return Hair(
        surface,
        offsets,
        offsets and bool(grid.offset[0] >= 0),
        (theta_r[0], theta_r[-1]) if between else (theta_r[0] - NARROW, theta_r[0] + NARROW),
        intervals=between * -(-ROWS // between) if even else ROWS,
        nodes=np.arcsin(grid.offset) if offsets else np.zeros(1),
    )


class _Surface:
    """density(theta_r, theta_i, phi, offset) of a grid."""

    def __init__(self, grid: Grid, log: Array, per_steradian: bool):
        self._theta_r, self._theta_i, self._per_steradian = grid.theta_r, grid.theta_i, per_steradian
        self._offset = np.zeros(1) if grid.offset is None else grid.offset
        around = [grid.phi[-2:] - TWO_PI, grid.phi, grid.phi[:2] + TWO_PI]
        self._phi = np.concatenate(around)
        self._log = np.concatenate([log[..., -2:], log, log[..., :2]], axis=-1)

    def __call__(self, theta_r: Array, theta_i: Array, phi: Array, offset: Array) -> Array:
        given = [np.asarray(x, float) for x in (theta_r, theta_i, phi, offset)]
        if (
            given[0].ndim == 0
            and given[1].ndim <= 2
            and given[1].size == given[1].shape[0]
            and given[2].ndim == 1
        ):
            return self._at(float(given[0]), given[1].ravel(), given[2], given[3])
        theta_r, theta_i, phi, offset = (x.ravel() for x in np.broadcast_arrays(*given))
        places, which = np.unique([theta_r, theta_i, phi], axis=1, return_inverse=True)
        values = np.empty(theta_r.size)
        for k, (t, i, p) in enumerate(places.T):  # each with all of its offsets at once
            at = np.flatnonzero(which.ravel() == k)
            values[at] = self._at(t, np.array([i]), np.array([p]), offset[at, None, None]).ravel()
        return values.reshape(np.broadcast_shapes(*(x.shape for x in given)))

    def _at(self, theta_r: float, theta_i: Array, phi: Array, offset: Array) -> Array:
        """(..., n, m) at theta_i (n,), phi (m,) and the grid's offsets nearest to offset (..., 1, 1)."""
        place = float(np.interp(theta_r, self._theta_r, np.arange(len(self._theta_r))))
        j = min(int(place), max(len(self._theta_r) - 2, 0))
        parts = ((j, 1 - (place - j)), (j + 1, place - j))
        nearest = abs(self._offset - np.reshape(offset, (-1, 1))).argmin(axis=1)
        used, which = np.unique(nearest, return_inverse=True)
        total = sum(
            share * self._row(row, used, theta_i + theta_r - self._theta_r[row], phi)
            for row, share in parts
            if share
        )
        if self._per_steradian:
            total = total * np.cos(theta_i)[:, None]
        return total[which].reshape(*np.shape(offset)[:-2], theta_i.size, phi.size)

    def _row(self, row: int, offsets: Array, theta_i: Array, phi: Array) -> Array:
        """(N, n, m) values of one of the grid's theta_r."""
        theta_i = np.clip(theta_i, -HALF_PI, HALF_PI)
        along = _cubic(self._theta_i, np.moveaxis(self._log[offsets, row], 1, -1), theta_i)  # (N, M, n)
        return np.exp(_cubic(self._phi, np.moveaxis(along, 1, -1), phi))


def _cubic(points: Array, values: Array, x: Array) -> Array:
    """(..., n) at x (n,) from values (..., P) at points (P,): Lagrange's cubic through the four points
    around, kept near the two that it lies between; beyond the ends the last value."""
    last = len(points) - 1
    x = np.clip(x, points[0], points[-1])
    i = np.clip(np.searchsorted(points, x, side="right") - 1, 0, max(last - 1, 0))
    taps = [np.clip(i + k, 0, last) for k in (-1, 0, 1, 2)]
    before, a, b, after = (points[t] for t in taps)
    before, after = np.where(i == 0, 2 * a - b, before), np.where(i == last - 1, 2 * b - a, after)
    at = before, a, b, after
    result = np.zeros((*values.shape[:-1], x.size))
    for k in range(4):
        weight = np.ones(x.size)
        for other in range(4):
            if other != k:
                weight = weight * (x - at[other]) / (at[k] - at[other])
        result += weight * values[..., taps[k]]
    low = np.minimum(values[..., taps[1]], values[..., taps[2]])
    high = np.maximum(values[..., taps[1]], values[..., taps[2]])
    return np.clip(result, low - BEND, high + BEND)
