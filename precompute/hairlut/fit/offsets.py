"""Scattering that depends on the offset at which a fibre is hit: one distribution for each offset.

The offset is the distance of the ray from the fibre's axis in radii, the sine of the angle around the fibre
between the surface normal and the viewer. Where no offset is below 0 the fibre is taken to be symmetric: at
-offset the azimuth is mirrored, phi becomes -phi.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..errors import HairlutError
from ..lobes import Array
from .distribution import Distribution, grid_edges, grid_masses, normalised
from .read import Grid, checked_grid


@dataclass(frozen=True)
class OffsetData:
    """offset (N,); at: the distribution at each offset, all with the same theta_r and cells; light (N, J):
    how much the fibre scatters there, in any unit."""

    offset: Array
    at: tuple[Distribution, ...]
    light: Array

    @property
    def mirrored(self) -> bool:
        """Whether the other half of the fibre is this one's mirror image."""
        return bool(self.offset[0] >= 0)

    def mass_at(self, j: int) -> Array:
        """(N, n, m) masses of the cells for theta_r number j, as Distribution.mass."""
        return np.stack([d.mass[j] for d in self.at])

    def at_offsets(self, which) -> OffsetData:
        """The data of some offsets, picked as by an index of NumPy."""
        picked = np.arange(len(self.offset))[which]
        return OffsetData(self.offset[picked], tuple(self.at[o] for o in picked), self.light[picked])

    @cached_property
    def share(self) -> Array:
        """(N, J) share of the light for theta_r that comes off around each offset; its columns sum to 1."""
        middle = (self.offset[1:] + self.offset[:-1]) / 2
        width = np.diff(np.concatenate([self.offset[:1], middle, self.offset[-1:]]))
        share = width[:, None] * self.light
        return share / share.sum(axis=0)


def of_data(grid: Grid, per_steradian: bool = False) -> OffsetData:
    """The data of a grid with offsets; HairlutError where an offset has no light."""
    at, light = [], []
    for h, value in zip(grid.offset, grid.value, strict=True):
        mass = grid_masses(grid, value, per_steradian)
        try:
            at.append(normalised(grid.theta_r, *grid_edges(grid), mass, np.full(grid.theta_r.size, np.inf)))
        except HairlutError as error:
            raise HairlutError(f"offset {h:.4g}: {error}") from None
        light.append(mass.sum(axis=(1, 2)))
    return OffsetData(grid.offset, tuple(at), np.array(light))


def of_grids(offset, theta_r, theta_i, phi, value, per_steradian: bool = False) -> OffsetData:
    """From values (N, J, n, m) at offset (N,) and the points that distribution.of_grid takes."""
    return of_data(checked_grid(theta_r, theta_i, phi, value, offset), per_steradian)


def even_azimuth(data: OffsetData) -> OffsetData:
    """The data in as many cells of the azimuth, all of one width."""
    edges = data.at[0].phi_edges
    even = np.linspace(edges[0], edges[-1], edges.size)
    if np.allclose(edges, even, rtol=0, atol=1e-9):
        return data
    shared = np.minimum(edges[1:, None], even[1:]) - np.maximum(edges[:-1, None], even[:-1])
    part = np.maximum(shared, 0) / np.diff(edges)[:, None]
    at = tuple(replace(d, phi_edges=even, mass=d.mass @ part) for d in data.at)
    return OffsetData(data.offset, at, data.light)
