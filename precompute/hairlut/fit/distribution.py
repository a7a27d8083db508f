"""A scattering distribution as masses of cells, from a grid of values or from draws (read.py).

For each viewer inclination, mass[j, i, k] is the share of the light for theta_r[j] that comes from theta_i in
cell i and the relative azimuth phi in cell k. Every row sums to 1. The values of a grid are the density at
its points, per rad^2 in (theta_i, phi), or per steradian, which is cos(theta_i) times less.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import HairlutError
from ..lobes import HALF_PI, Array
from .read import Draws, Grid, checked_grid

TWO_PI = 2 * np.pi
ROWS = 19
CELLS = (64, 64)
FEW = 64  # so many different theta_r, or fewer, are rows of their own


@dataclass(frozen=True)
class Distribution:
    """theta_r (J,); theta_edges (n+1,) of theta_i, phi_edges (m+1,), rad; mass (J, n, m), each row summing
    to 1; samples (J,): how many draws a row stands on, infinite for a grid."""

    theta_r: Array
    theta_edges: Array
    phi_edges: Array
    mass: Array
    samples: Array

    @property
    def theta_middles(self) -> Array:
        """(n,) middles of the cells of theta_i."""
        return (self.theta_edges[1:] + self.theta_edges[:-1]) / 2

    @property
    def even(self) -> Array:
        """(m,) share of the circle of each cell of phi."""
        return np.diff(self.phi_edges) / TWO_PI

    @property
    def noise(self) -> Array:
        """(J,) relative variance that finite samples alone make the cells show."""
        return self.mass.shape[1] * self.mass.shape[2] / self.samples


def of_data(
    data: Grid | Draws, per_steradian: bool = False, rows: int = ROWS, cells: tuple[int, int] = CELLS
) -> Distribution:
    """The distribution of a grid without offsets, or of draws, gathered into rows and cells."""
    if isinstance(data, Draws):
        return of_samples(data.theta_r, data.theta_i, data.phi, data.weight, rows, cells)
    edges = grid_edges(data)
    mass = grid_masses(data, data.value, per_steradian)
    return normalised(data.theta_r, *edges, mass, np.full(data.theta_r.size, np.inf))


def of_grid(theta_r, theta_i, phi, value, per_steradian: bool = False) -> Distribution:
    """From values (J, n, m) at the points theta_r (J,), theta_i (n,), phi (m,), each increasing, rad."""
    return of_data(checked_grid(theta_r, theta_i, phi, value), per_steradian)


def grid_edges(grid: Grid) -> tuple[Array, Array]:
    """(theta_edges, phi_edges), rad, of the cells around a grid's points."""
    theta_i = grid.theta_i
    theta_edges = np.concatenate([[-HALF_PI], (theta_i[1:] + theta_i[:-1]) / 2, [HALF_PI]])
    return theta_edges, _periodic_edges(grid.phi)


def grid_masses(grid: Grid, value: Array, per_steradian: bool = False) -> Array:
    """(J, n, m) masses of a grid's cells, not normalised, for values (J, n, m) at its points."""
    theta_edges, phi_edges = grid_edges(grid)
    phi = grid.phi
    if phi_edges.size == phi.size + 2:  # the cell around phi = 0 is cut in two
        owner = (
            np.append(np.arange(phi.size), 0)
            if phi[0] < TWO_PI - phi[-1]
            else np.append(phi.size - 1, np.arange(phi.size))
        )
        value = value[:, :, owner]
    measure = np.diff(np.sin(theta_edges)) if per_steradian else np.diff(theta_edges)
    return value * measure[:, None] * np.diff(phi_edges)


def of_samples(
    theta_r, theta_i, phi, weight=None, rows: int = ROWS, cells: tuple[int, int] = CELLS
) -> Distribution:
    """From N draws, all (N,), rad.

    More than FEW different theta_r are gathered into `rows` rows; a draw moves to its row with theta_i +
    theta_r kept, as a highlight moves.
    """
    theta_r, theta_i, phi = (np.asarray(a, float).ravel() for a in (theta_r, theta_i, phi))
    weight = np.ones(theta_r.size) if weight is None else np.asarray(weight, float).ravel()
    if not theta_r.size == theta_i.size == phi.size == weight.size:
        raise HairlutError(
            f"columns of {theta_r.size}, {theta_i.size}, {phi.size}, {weight.size} samples: "
            "expected as many in each"
        )
    if (abs(theta_r) > HALF_PI + 1e-6).any() or (abs(theta_i) > HALF_PI + 1e-6).any():
        raise HairlutError(
            "theta_r or theta_i lies outside [-90, 90] deg: are the columns in degrees, named _deg?"
        )
    angles = np.unique(theta_r)
    if len(angles) > FEW:
        angles = np.linspace(angles[0], angles[-1], rows)
    j = np.clip(np.rint(np.interp(theta_r, angles, np.arange(len(angles)))).astype(int), 0, len(angles) - 1)
    theta_i = np.clip(theta_i + theta_r - angles[j], -HALF_PI, HALF_PI)
    edges = np.linspace(-HALF_PI, HALF_PI, cells[0] + 1), np.linspace(0, TWO_PI, cells[1] + 1)
    bins = (np.arange(len(angles) + 1) - 0.5, *edges)
    mass, _ = np.histogramdd((j, theta_i, np.mod(phi, TWO_PI)), bins=bins, weights=weight)
    count = np.bincount(j, minlength=len(angles)).astype(float)
    effective = np.bincount(j, weight, len(angles)) ** 2 / np.maximum(
        np.bincount(j, weight**2, len(angles)), 1e-300
    )
    kept = count > 0
    return normalised(angles[kept], *edges, mass[kept], effective[kept])


def normalised(theta_r, theta_edges, phi_edges, mass, samples) -> Distribution:
    """The masses (J, n, m) as a distribution; HairlutError where one is negative or a row has none."""
    for j, total in enumerate(mass.sum(axis=(1, 2))):
        if (mass[j] < 0).any():
            raise HairlutError(f"negative value at theta_r = {np.degrees(theta_r[j]):.4g} deg")
        if not total > 0:
            raise HairlutError(f"no mass at theta_r = {np.degrees(theta_r[j]):.4g} deg: leave this angle out")
    return Distribution(theta_r, theta_edges, phi_edges, mass / mass.sum(axis=(1, 2), keepdims=True), samples)


def _periodic_edges(phi: Array) -> Array:
    """Edges in [0, 2 pi] half-way between neighbours on the circle; one cell may be cut by phi = 0."""
    middle = (phi + np.append(phi[1:], phi[0] + TWO_PI)) / 2
    seam = np.mod(middle[-1], TWO_PI)
    inner = np.sort(np.append(middle[:-1], seam))
    if min(seam, TWO_PI - seam) < 1e-9:
        return np.concatenate([[0.0], middle[:-1], [TWO_PI]])
    return np.concatenate([[0.0], inner, [TWO_PI]])
