# SPDX-License-Identifier: BSD-3-Clause
"""Cumulative masses that are monotone cubics between knots, many rows at once: density and quantiles."""

from __future__ import annotations

import numpy as np

from .lobes import Array

STEPS = 80  # of Newton's method inside a bracket, halved where Newton leaves it; about six are needed
SETTLED = 1e-13  # part of a piece by which a quantile may still move


class Cubics:
    """R rows that rise from 0 to 1 over one interval, by a cubic between each two knots.

    x, u, slope: (R, K) knots in ascending order, the mass below each, and the density there. A row of fewer
    knots repeats its last one. Slopes above three times the mean density beside them are lowered to that,
    which keeps rows monotone (Fritsch and Carlson).
    """

    def __init__(self, x: Array, u: Array, slope: Array):
        self.x, self.u = x, u
        d, rise = np.diff(x), np.diff(u)
        self._last = (d > 0).sum(axis=1) - 1  # piece of each row
        self._first = np.arange(len(x)) * x.shape[1]
        secant = rise / np.where(d > 0, d, 1.0)
        secant = np.where(d > 0, secant, secant[np.arange(len(x)), self._last][:, None])
        bound = 3 * np.minimum(_padded(secant, 1, 0), _padded(secant, 0, 1))
        ends = np.minimum(slope, bound)
        a, b = d * ends[:, :-1], d * ends[:, 1:]
        parts = x[:, :-1], u[:, :-1], d, a, 3 * rise - 2 * a - b, a + b - 2 * rise
        self._pieces = np.stack([_padded(part, 0, 1) for part in parts], axis=2).reshape(-1, len(parts))
        self._x_key, self._u_key = self._key(self._place(x)), self._key(u / 2)

    def density(self, x: Array, row: Array) -> Array:
        """Per rad at x, clamped to the interval, in the rows row, broadcast against each other."""
        return _density(x, *self._piece(self._x_key, self._place(x), row))

    def density_between(self, x: Array, row: Array) -> Array:
        """The same for x (K, n) whose columns lie between two knots each, in the rows row (n,)."""
        middle = self._place(x[[0, -1]].mean(axis=0))
        return _density(x, *self._piece(self._x_key, middle, row))

    def quantile(self, u: Array, row: Array) -> Array:
        """The x below which the masses u in [0, 1] lie, in the rows row, broadcast against each other."""
        x0, u0, d, a, b, c = self._piece(self._u_key, u / 2, row)
        rest = u - u0
        low, high = np.zeros(rest.shape), np.ones(rest.shape)
        s = np.clip(rest / np.maximum(a + b + c, 1e-300), 0.0, 1.0)
        settled = np.zeros(rest.shape, bool)
        for _ in range(STEPS):
            excess = s * (a + s * (b + s * c)) - rest
            low, high = np.where(excess <= 0, s, low), np.where(excess >= 0, s, high)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = s - excess / (a + s * (2 * b + 3 * c * s))
            step = np.where((step >= low) & (step <= high), step, (low + high) / 2)
            s, moved = np.where(settled, s, step), abs(step - s)
            settled |= moved <= SETTLED  # each by itself, whatever others are looked for with it
            if settled.all():
                break
        return x0 + d * s

    def _place(self, x: Array) -> Array:
        """x as a number from 0 to 1/2, so that adding the row's number sorts the knots of all rows."""
        return (x - self.x[0, 0]) * (0.5 / (self.x[0, -1] - self.x[0, 0]))

    def _key(self, place: Array) -> Array:
        return (np.arange(len(place))[:, None] + place).ravel()

    def _piece(self, key: Array, place: Array, row: Array) -> Array:
        """(6, ...) low end, mass below it, width, coefficients of the pieces that contain these places."""
        first = self._first[row]
        i = np.searchsorted(key, row + place, side="right") - 1
        i = np.clip(i, first, first + self._last[row])
        return np.moveaxis(self._pieces[i], -1, 0)


def _density(x: Array, x0: Array, u0: Array, d: Array, a: Array, b: Array, c: Array) -> Array:
    s = np.clip((x - x0) / d, 0.0, 1.0)
    return (a + s * (2 * b + 3 * c * s)) / d


def _padded(values: Array, before: int, after: int) -> Array:
    """Values (R, n) with the first or last column repeated."""
    return np.pad(values, ((0, 0), (before, after)), mode="edge")
