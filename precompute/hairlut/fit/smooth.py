# SPDX-License-Identifier: BSD-3-Clause
"""Smooth rows from the masses of cells: what tables are made from.

Each row's cumulative mass is a monotone cubic between the cells' edges, so every cell keeps its mass. The
density at an edge comes from the cells' mean densities, by a cubic in their logarithms through the four
cells around it: exact for exponential tails, and close for Gaussians."""

from __future__ import annotations

import numpy as np

from ..cubics import Cubics
from ..lobes import Array
from ..tabulated import ExactRows

FLOOR = 1e-4
"""Share of each row's mass that is spread evenly: where the cells have nothing, a renderer may have
something."""
BEND = 1.0  # how far, in the logarithm, the cubic may leave the two cells beside an edge


class SmoothRows(ExactRows):
    """The rows, evaluated anywhere."""

    def density(self, x: Array, row: Array) -> Array:
        """Per rad at x in the rows row, broadcast against each other."""
        return self._cubics.density(x, row)


def rows(theta_r: Array, edges: Array, mass: Array, periodic: bool) -> SmoothRows:
    """The rows of masses (J, n) between edges (J, n+1), at theta_r (J,)."""
    width = np.diff(edges)
    even = width / (edges[:, -1:] - edges[:, :1])
    share = (1 - FLOOR) * mass / mass.sum(axis=1, keepdims=True) + FLOOR * even
    u = np.concatenate([np.zeros((len(mass), 1)), np.cumsum(share, axis=1)], axis=1)
    u /= u[:, -1:]
    return SmoothRows(
        theta_r, Cubics(np.ascontiguousarray(edges), u, _at_edges(edges, share / width, periodic))
    )


def _at_edges(edges: Array, density: Array, periodic: bool) -> Array:
    """(J, n+1) densities at the edges from the mean densities (J, n) of the cells."""
    middle = (edges[:, 1:] + edges[:, :-1]) / 2
    if periodic:
        span = edges[:, -1:] - edges[:, :1]
        middle = np.concatenate([middle[:, -2:] - span, middle, middle[:, :2] + span], axis=1)
        density = np.concatenate([density[:, -2:], density, density[:, :2]], axis=1)
    else:
        middle = np.concatenate([_beyond(middle, 0), middle, _beyond(middle, -1)], axis=1)
        density = np.concatenate([density[:, [0, 0]], density, density[:, [-1, -1]]], axis=1)
    log = np.log(density)
    n = edges.shape[1]
    x = [middle[:, k : k + n] - edges for k in range(4)]
    y = [log[:, k : k + n] for k in range(4)]
    value = np.zeros(edges.shape)
    for k in range(4):  # Lagrange's cubic at the edge
        term = y[k]
        for other in range(4):
            if other != k:
                term = term * (-x[other]) / (x[k] - x[other])
        value += term
    low, high = np.minimum(y[1], y[2]), np.maximum(y[1], y[2])
    return np.exp(np.clip(value, low - BEND, high + BEND))


def _beyond(middle: Array, end: int) -> Array:
    """(J, 2) two cells' middles beyond an end, as far apart as the last two before it."""
    step = middle[:, [1]] - middle[:, [0]] if end == 0 else middle[:, [-1]] - middle[:, [-2]]
    last = middle[:, [end]]
    return np.concatenate(
        [last - 2 * step, last - step] if end == 0 else [last + step, last + 2 * step], axis=1
    )
