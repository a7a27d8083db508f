# SPDX-License-Identifier: BSD-3-Clause
"""A hair with named parameters, each with a range: the box of all its parameter values.

A place in the box is a tuple of values, one a parameter, in the order of the parameters."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from ...axes import Parameter
from ...lobes import Array
from .. import cells
from ..cells import Cells, Density
from ..hair import Hair, of_density
from .firstround import FULL, BoxEffort

Place = tuple[float, ...]
KNOWN = 96  # sets of cells that are kept: lobes are followed along a parameter several times
RATIO = 4.0  # of the ends of a range from which on steps along it are equal factors


@dataclass(frozen=True)
class Box:
    """density: of (theta_r, theta_i, phi, offset, **parameters) per rad^2. hair: its symmetry and ranges at
    all places, with the density at the standard one. effort: how much of it a fit looks at. known: cells that
    were evaluated last."""

    density: Callable[..., Array]
    parameters: tuple[Parameter, ...]
    hair: Hair
    effort: BoxEffort = FULL
    known: OrderedDict[Hashable, Cells] = field(default_factory=OrderedDict, compare=False, repr=False)

    @property
    def standard(self) -> Place:
        return tuple(p.standard for p in self.parameters)

    @property
    def middle(self) -> Place:
        return tuple((p.least + p.most) / 2 for p in self.parameters)

    def named(self, place: Place) -> dict[str, float]:
        return {p.name: value for p, value in zip(self.parameters, place, strict=True)}

    def density_at(self, place: Place) -> Density:
        """The density with fixed parameters."""
        named = self.named(place)
        return lambda theta_r, theta_i, phi, offset: self.density(theta_r, theta_i, phi, offset, **named)

    def mean_density(self, places: list[Place]) -> Density:
        """The mean of the densities at several places."""
        each = [self.density_at(place) for place in places]
        return lambda *at: sum(density(*at) for density in each) / len(each)

    def cells_at(self, place: Place, theta_r: Array, offset: Array, edges: Array, count: int) -> Cells:
        """The light at a place (cells.of_density)."""
        key = place, theta_r.tobytes(), offset.tobytes(), edges.tobytes(), count
        if key not in self.known:
            self.known[key] = cells.of_density(self.density_at(place), theta_r, offset, edges, count)
        self.known.move_to_end(key)
        while len(self.known) > KNOWN:
            self.known.popitem(last=False)
        return self.known[key]

    def corners(self) -> list[Place]:
        """Corners of the box: all of them, or some that have every parameter at both ends."""
        ends = [(p.least, p.most) for p in self.parameters]
        most = self.effort.corners
        if 2 ** len(ends) <= most:
            return list(product(*ends))
        random = np.random.default_rng(0)
        bits = [*random.integers(0, 2, (most // 2, len(ends)))]
        return [
            tuple(end[b] for end, b in zip(ends, row, strict=True))
            for half in bits
            for row in (half, 1 - half)
        ]

    def steps(self, parameter: int, count: int, through: float) -> Array:
        """(count,) values of one parameter from least to most, `through` among them: by equal factors where
        its range is wide."""
        p = self.parameters[parameter]
        if p.least > 0 and p.most > RATIO * p.least:
            values = np.geomspace(p.least, p.most, count)
        else:
            values = np.linspace(p.least, p.most, count)
        values[[0, -1]] = p.least, p.most
        if p.least < through < p.most:
            values[1 + abs(values[1:-1] - through).argmin()] = through
        return values


def with_value(place: Place, parameter: int, value: float) -> Place:
    """The place with another value of one parameter."""
    return (*place[:parameter], float(value), *place[parameter + 1 :])


def of_parameters(density: Callable[..., Array], parameters: tuple[Parameter, ...], offsets: bool) -> Box:
    """The box of a density with parameters, its symmetry found by trying at standard values and corners."""
    standard = {p.name: p.standard for p in parameters}
    hair = of_density(lambda *at: density(*at, **standard), offsets)
    box = Box(density, parameters, hair)
    others = [of_density(box.density_at(place), offsets) for place in box.corners()]
    depends = hair.offsets or any(other.offsets for other in others)
    mirrored = depends and all(other.mirrored or not other.offsets for other in [hair, *others])
    return replace(box, hair=replace(hair, offsets=depends, mirrored=mirrored))


def by_name(names: tuple[str, ...], values: Mapping[str, float]) -> Place:
    return tuple(float(values[name]) for name in names)
