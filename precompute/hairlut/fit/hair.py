# SPDX-License-Identifier: BSD-3-Clause
"""A hair to be fitted: its light as a density, its symmetry and its ranges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..lobes import Array
from .cells import Density
from .turning import TWO_PI

MOST = np.radians(89.9)
"""The largest theta_r at which a hair is evaluated: at 90 degrees a fibre is not seen."""
RIM = 1 - 1e-4  # and the largest offset
DENSER = 1.25  # power by which nodes crowd at the rim
SAME = 1e-6  # relative difference of densities that are the same
PLACES = 512


@dataclass(frozen=True)
class Hair:
    """density: the light per rad^2 in (theta_i, phi), f cos(theta_i)^2. offsets: whether it depends on where
    the fibre is hit; mirrored: whether at -offset the azimuth is mirrored. theta_r: range of it, rad.
    intervals: what the number of theta_r's intervals is a multiple of. nodes: the only angles asin(offset)
    that are known."""

    density: Density
    offsets: bool
    mirrored: bool
    theta_r: tuple[float, float] = (-MOST, MOST)
    intervals: int = 12
    nodes: Array | None = None

    def angles(self, count: int) -> Array:
        """(count,) angles asin(offset) of nodes, denser towards the rim, where a fibre's reflectance rises
        steeply; 0 alone for a hair without offsets."""
        if self.nodes is not None:
            return self.nodes
        if not self.offsets:
            return np.zeros(1)
        x = np.linspace(0.0 if self.mirrored else -1.0, 1.0, count)
        return np.sign(x) * (1 - (1 - abs(x)) ** DENSER) * np.arcsin(RIM)

    def rows(self, count: int) -> Array:
        """(count,) even theta_r."""
        return np.linspace(*self.theta_r, count)

    def row_count(self, intervals: float) -> int:
        """Of at least so many intervals, which tables can share out."""
        return self.intervals * int(np.ceil(intervals / self.intervals - 1e-9)) + 1

    def offset_count(self, count: int) -> int:
        """Of nodes with so many from 0 to 1."""
        if self.nodes is not None:
            return len(self.nodes)
        if not self.offsets:
            return 1
        return count if self.mirrored else 2 * count - 1


def of_density(density: Density, offsets: bool) -> Hair:
    """The hair of a density, its symmetry found by trying."""
    random = np.random.default_rng(0)
    theta_r, theta_i = (random.uniform(-1.4, 1.4, PLACES) for _ in range(2))
    theta_i = np.where(random.random(PLACES) < 0.5, np.clip(-theta_r + 0.1 * theta_i, -1.5, 1.5), theta_i)
    phi, offset = random.uniform(0, TWO_PI, PLACES), random.uniform(0, RIM, PLACES)
    values = density(theta_r, theta_i, phi, offset)

    def same(other: Array) -> bool:
        return bool((abs(values - other) <= SAME * np.maximum(values, other) + 1e-300).all())

    depends = offsets and not (
        same(density(theta_r, theta_i, phi, -offset)) and same(density(theta_r, theta_i, phi, offset[::-1]))
    )
    mirrored = depends and same(density(theta_r, theta_i, TWO_PI - phi, -offset))
    return Hair(density, depends, mirrored)
