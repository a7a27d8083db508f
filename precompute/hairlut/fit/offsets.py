"""Scattering that depends on the offset at which a fibre is hit: one distribution for each offset.

The offset is the distance of the ray from the fibre's axis in radii, the sine of the angle around the fibre
between the surface normal and the viewer. An npz file has the arrays of distribution.py, and besides

    offset  (N,)           increasing, within [-1, 1]
    value   (N, J, n, m)   for each offset a density over theta_r, theta_i and phi

phi is phi_i - phi_r, as there. Where no offset is below 0 the fibre is taken to be symmetric: at -offset the
azimuth is mirrored, phi becomes -phi.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from ..errors import HairlutError
from ..lobes import Array
from .distribution import Distribution, arrays_of, check_finite, grid_masses, normalised

NAMES = ("theta_r", "theta_i", "phi", "value")


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


def holds_offsets(path: Path) -> bool:
    """Whether the file is an npz with an array `offset`."""
    return path.suffix == ".npz" and path.is_file() and "offset" in arrays_of(path)


def read(path: Path, per_steradian: bool = False) -> OffsetData:
    """The data of such a file; HairlutError naming the file, the place and what was expected."""
    columns = arrays_of(path)
    check_finite(path, columns)
    if "value" not in columns:
        raise HairlutError(
            f"{path}: an array value is missing: expected densities (offset, theta_r, theta_i, phi)"
        )
    try:
        return of_grids(columns["offset"], *(columns[name] for name in NAMES), per_steradian=per_steradian)
    except HairlutError as error:
        raise HairlutError(f"{path}: {error}") from None


def of_grids(offset, theta_r, theta_i, phi, value, per_steradian: bool = False) -> OffsetData:
    """From values (N, J, n, m) at offset (N,) and the points that distribution.of_grid takes."""
    offset, value = np.asarray(offset, float), np.asarray(value, float)
    if offset.ndim != 1 or offset.size < 2 or not (np.diff(offset) > 0).all() or abs(offset).max() > 1:
        raise HairlutError(
            "offset: expected at least two increasing numbers within [-1, 1], distances from the fibre's "
            f"axis in radii; found {offset.size} of shape {offset.shape}"
        )
    if value.ndim != 4 or len(value) != offset.size:
        raise HairlutError(
            f"value has shape {value.shape}, expected four axes: {offset.size} offsets, theta_r, theta_i, phi"
        )
    at, light = [], []
    for h, of_offset in zip(offset, value, strict=True):
        try:
            angles, *edges, mass = grid_masses(theta_r, theta_i, phi, of_offset, per_steradian)
            at.append(normalised(angles, *edges, mass, np.full(angles.size, np.inf)))
        except HairlutError as error:
            raise HairlutError(f"offset {h:.4g}: {error}") from None
        light.append(mass.sum(axis=(1, 2)))
    return OffsetData(offset, tuple(at), np.array(light))


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
