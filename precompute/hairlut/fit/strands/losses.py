# SPDX-License-Identifier: BSD-3-Clause
"""V and the largest weights of a baked model over parameters, at random parameters, viewers and offsets.

Random places hardly ever lie at a corner of the box or at a grazing viewer, where hair is least like that
beside. So some places are there, and are told apart from the others: they are no part of an average."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np

from ...axes import Axis
from ...lobes import Array
from ...model import BakedModel
from .. import cells, promise
from .box import Box
from .firstround import pairs

OFFSETS = 4
EDGES = 4  # times as many random places as places at edges of the box
DARK = 1e-12  # part of the brightest place's light below which what a draw costs is no matter
GRAZING = 8 / 9  # of the largest theta_r, from which on a viewer is grazing


@dataclass(frozen=True)
class Places:
    """P places: parameters (P, D) in the model's order, theta_r (P,), offset (P, N)."""

    parameters: Array
    theta_r: Array
    offset: Array

    @property
    def count(self) -> int:
        return len(self.theta_r)


@dataclass(frozen=True)
class Measured(Places):
    """Places, and there V, the largest weight and the light (P, N)."""

    variance: Array
    weight: Array
    light: Array


def measured(
    box: Box,
    model: BakedModel,
    places: Places,
    random: np.random.Generator,
    report: Callable[[float], None] = lambda share: None,
) -> Measured:
    """The losses at places."""
    found = []
    for i, (values, t, h) in enumerate(zip(places.parameters, places.theta_r, places.offset, strict=True)):
        report(i / places.count)
        place = tuple(values.tolist())
        density = box.density_at(place)
        around = 2 * cells.phi_count(density, np.array([t]), h[:1])
        fixed = model.at(box.named(place))
        loss = promise.losses(fixed, density, np.array([t]), h[None], around, random)
        found.append((loss.variance[0], loss.weight[0], loss.light[0]))
    variance, weight, light = (np.array(part) for part in zip(*found, strict=True))
    dark = light <= DARK * light.max()
    variance[dark] = weight[dark] = 0.0
    return Measured(places.parameters, places.theta_r, places.offset, variance, weight, light)


def lost(box: Box, model: BakedModel, random: np.random.Generator) -> dict[str, float]:
    """V that blending between an axis' nodes costs, by axis, on average at random places."""
    return lost_at(box, model, random_places(box, pairs(box.effort), random), random)


def lost_at(box: Box, model: BakedModel, places: Places, random: np.random.Generator) -> dict[str, float]:
    """V that blending between an axis' nodes costs, by axis: the mean of V at places, less the mean where
    each is moved to the axis' nearest node. A parameter has that of the worst of its axes."""
    base = measured(box, model, places, random).variance.mean()
    found: dict[str, float] = {}
    names = [p.name for p in box.parameters]

    def lost_from(moved: Places) -> float:
        return float(base - measured(box, model, moved, random).variance.mean())

    axes = {(axis.name, tuple(axis.nodes)): axis for axis in _axes(model)}
    for axis in axes.values():
        moved = places.parameters.copy()
        moved[:, names.index(axis.name)] = _nearest(axis.nodes, moved[:, names.index(axis.name)])
        found[axis.name] = max(found.get(axis.name, 0.0), lost_from(replace(places, parameters=moved)))
    viewers = np.unique([t for table in model.tables for t in table.theta_r])
    found["theta_r"] = lost_from(replace(places, theta_r=_nearest(viewers, places.theta_r)))
    if len(model.mixture.offset) > 1:
        nodes = model.mixture.offset
        nodes = np.unique(np.append(-nodes, nodes)) if model.mixture.mirrored else nodes
        found["offset"] = lost_from(replace(places, offset=_nearest(nodes, places.offset)))
    return found


def worst(found: Measured) -> Places:
    """The place where V is largest."""
    i = int(found.variance.mean(axis=1).argmax())
    return Places(found.parameters[[i]], found.theta_r[[i]], found.offset[[i]])


def joined(first: Measured, second: Measured) -> Measured:
    """The places of both."""
    return Measured(
        *(np.concatenate([getattr(one, f.name) for one in (first, second)]) for f in fields(Measured))
    )


def _axes(model: BakedModel) -> list[Axis]:
    return [*model.mixture.axes, *(axis for table in model.tables for axis in table.axes)]


def _nearest(nodes: Array, x: Array) -> Array:
    return nodes[abs(np.asarray(x)[..., None] - nodes).argmin(axis=-1)]


def random_places(box: Box, count: int, random: np.random.Generator) -> Places:
    """Places anywhere, each coordinate in even strata of its own."""
    parameters = np.stack([_strata(p.least, p.most, count, random) for p in box.parameters], axis=1)
    return Places(parameters, _strata(*box.hair.theta_r, count, random), _offsets(box, count, random))


def edge_places(box: Box, count: int, random: np.random.Generator) -> Places:
    """A third of them corners of the box, a third such with grazing viewers, and a third with these where
    some parameters are at an end of their range."""
    anywhere = random_places(box, count, random)
    ends = np.array([(p.least, p.most) for p in box.parameters])
    corners = np.take_along_axis(ends.T, _bits(len(ends), count, random), axis=0)
    some = (np.arange(count) < 2 * count // 3)[:, None] | (random.random(corners.shape) < 0.5)
    low, high = box.hair.theta_r
    part = _strata(GRAZING, 1.0, count, random)
    grazing = (low + high) / 2 + np.where(np.arange(count) % 2, part, -part) * (high - low) / 2
    return Places(
        np.where(some, corners, anywhere.parameters),
        np.where(np.arange(count) < count // 3, anywhere.theta_r, grazing),
        anywhere.offset,
    )


def _bits(digits: int, count: int, random: np.random.Generator) -> Array:
    """(count, digits) of 0 and 1: all numbers of so many digits in turn, or random ones and their opposites,
    so that each digit is 0 as often as 1."""
    if 2**digits <= count:
        number = random.permutation(2**digits)[np.arange(count) % 2**digits]
        return (number[:, None] >> np.arange(digits)) & 1
    half = random.integers(0, 2, ((count + 1) // 2, digits))
    return np.stack([half, 1 - half], axis=1).reshape(-1, digits)[:count]


def _strata(low: float, high: float, count: int, random: np.random.Generator) -> Array:
    return low + (high - low) * (random.permutation(count) + random.random(count)) / count


def _offsets(box: Box, count: int, random: np.random.Generator) -> Array:
    if not box.hair.offsets:
        return np.zeros((count, 1))
    return 2 * (np.arange(OFFSETS) + random.random((count, OFFSETS))) / OFFSETS - 1
