# SPDX-License-Identifier: BSD-3-Clause
"""A hair's light in cells: mean values of its density over cells of theta_i and the azimuth.

Each theta_r has cells of theta_i of its own, dense where its light is narrow: a highlight stands near the
mirror direction -theta_r, wherever that is. The azimuth has even cells, as highlights move all around the
fibre."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..lobes import HALF_PI, Array
from .turning import TWO_PI

Density = Callable[[Array, Array, Array, Array], Array]
"""density(theta_r, theta_i, phi, offset), broadcasting: the light per rad^2 in (theta_i, phi), in any
unit."""

GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3)  # two points a cell and axis, of equal weight
FINE = 1000  # points along theta_i, and
AROUND = 96  # around the fibre, at most, by which the cells of theta_i are chosen
MIXED = 0.2  # part of the cells that is even
STEEPNESS = 1 / 3  # cells are as dense as this power of the light: it follows a lobe into its tails
HARMONICS = 2048  # points around the fibre by which the number of the azimuth's cells is chosen
PLACES = 33, 9  # of theta_i, even and near the mirror direction, for that
CUTOFF = 2e-3  # harmonics weaker than this part of the mean are not resolved
MIN_PHI, MAX_PHI = 48, 384
GRAZING = np.radians(80.0)  # theta_r beyond which a highlight that misses the sphere leaves no light
CHUNK = 2_000_000  # values at once


@dataclass(frozen=True)
class Cells:
    """theta_r (J,); offset (N,); theta_edges (J, n+1) of theta_i, rad; mass (J, N, n, m) of the cells, of
    sum 1 for each theta_r and offset, also where f is 0 at all offsets; light (J, N): the sums before, rad^2
    times the density's unit."""

    theta_r: Array
    offset: Array
    theta_edges: Array
    mass: Array
    light: Array

    def dark(self) -> str | None:
        """Where f was 0 in all directions that were evaluated, in words: there is nothing to draw there.
        Grazing viewers may be without light."""
        lit = self.light.any(axis=1)
        if not lit.any():
            return "wherever it was evaluated"
        lit |= abs(self.theta_r) > GRAZING
        if lit.all():
            return None
        return f"in all directions tried at theta_r = {np.degrees(self.theta_r[np.argmin(lit)]):.4g} deg"


def of_density(density: Density, theta_r: Array, offset: Array, theta_edges: Array, count: int) -> Cells:
    """The cells of a density; count: cells of the azimuth."""
    mass = np.stack(
        [_of_row(density, at, offset, edges, count) for at, edges in zip(theta_r, theta_edges, strict=True)]
    )
    light = mass.sum(axis=(2, 3))
    mass /= np.maximum(light, 1e-300)[..., None, None]
    for j in np.flatnonzero(~light.any(axis=1)):  # a highlight that is beyond the pole: anything will do
        even = np.diff(np.sin(theta_edges[j]))[:, None] / (2 * count)
        mass[j] = np.broadcast_to(even, mass[j].shape)
    return Cells(theta_r, offset, theta_edges, mass.astype(np.float32), light)


def _of_row(density: Density, theta_r: float, offset: Array, edges: Array, count: int) -> Array:
    """(N, n, m) masses for one theta_r."""
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    theta_i = (middle[:, None] + half[:, None] * GAUSS).ravel()
    width = TWO_PI / count
    phi = ((np.arange(count) + 0.5)[:, None] * width + width / 2 * GAUSS).ravel()
    step = max(1, CHUNK // (theta_i.size * phi.size))
    parts = []
    for at in range(0, len(offset), step):
        values = density(theta_r, theta_i[:, None], phi, offset[at : at + step, None, None])
        values = np.broadcast_to(values, (len(offset[at : at + step]), theta_i.size, phi.size))
        means = values.reshape(len(values), len(middle), 2, count, 2).mean(axis=(2, 4))
        parts.append(means * (2 * half[:, None] * width))
    return np.concatenate(parts)


def theta_edges(density: Density, theta_r: Array, offset: Array, count: int, around: int = AROUND) -> Array:
    """(J, count+1) edges of cells of theta_i that resolve the light of each theta_r at some offsets and
    `around` azimuths."""
    fine = (np.arange(FINE) + 0.5) * (np.pi / FINE) - HALF_PI
    phi = np.arange(around) * (TWO_PI / around)
    between = np.linspace(-HALF_PI, HALF_PI, FINE + 1)
    edges = []
    for at in theta_r:
        wanted = np.zeros(FINE)
        for h in offset:
            values = np.broadcast_to(density(at, fine[:, None], phi, h), (FINE, around))
            for profile in (values.max(axis=1), values.mean(axis=1)):
                wanted += profile / max(profile.sum(), 1e-300)
        wanted **= STEEPNESS
        wanted = (1 - MIXED) * wanted / max(wanted.sum(), 1e-300) + MIXED / FINE
        below = np.concatenate([[0.0], np.cumsum(wanted)])
        edges.append(np.interp(np.linspace(0, below[-1], count + 1), below, between))
    return np.array(edges)


def phi_values(theta_r: Array, offset: Array) -> int:
    """How many values phi_count evaluates."""
    return len(theta_r) * len(offset) * sum(PLACES) * HARMONICS


def phi_count(density: Density, theta_r: Array, offset: Array) -> int:
    """As many cells of the azimuth as resolve the light's harmonics."""
    phi = np.arange(HARMONICS) * (TWO_PI / HARMONICS)
    theta_i = np.linspace(-1, 1, PLACES[0]) * (HALF_PI - 0.01)
    highest = 1
    for at in theta_r:
        near = np.clip(
            np.append(theta_i, -at + np.linspace(-0.1, 0.1, PLACES[1])), -HALF_PI + 1e-3, HALF_PI - 1e-3
        )
        for h in offset:
            values = np.broadcast_to(density(at, near[:, None], phi, h), (near.size, HARMONICS))
            strength = abs(np.fft.rfft(values.sum(axis=0)))
            if strength[0] > 0:
                highest = max(highest, int(np.flatnonzero(strength > CUTOFF * strength[0])[-1]))
    return int(np.clip(8 * np.ceil(2.1 * highest / 8), MIN_PHI, MAX_PHI))


def rebinned(mass: Array, old: Array, new: Array, moved: float = 0.0) -> Array:
    """(n', K) masses of sum 1 between the edges new (n'+1,) of those (n, K) between old (n+1,): their density
    at new's middles plus an angle."""
    middles = (new[1:] + new[:-1]) / 2 + moved
    density = mass / np.diff(old)[:, None]
    at = np.stack([np.interp(middles, (old[1:] + old[:-1]) / 2, one) for one in density.T], axis=1)
    at = ((at + 1e-30) * np.diff(new)[:, None]).astype(mass.dtype)
    return at / at.sum(axis=0)
