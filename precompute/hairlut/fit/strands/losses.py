# SPDX-License-Identifier: BSD-3-Clause
"""V and the largest weights of a baked model over parameters, at random parameters, viewers and offsets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...axes import Axis
from ...lobes import Array
from ...model import BakedModel
from .. import cells, promise
from .box import Box
from .firstround import pairs

OFFSETS = 4


@dataclass(frozen=True)
class Measured:
    """At P places: parameters (P, D) in the model's order, theta_r (P,), offset (P, N), and there V, the
    largest weight and the light (P, N)."""

    parameters: Array
    theta_r: Array
    offset: Array
    variance: Array
    weight: Array
    light: Array


def measured(
    box: Box,
    model: BakedModel,
    random: np.random.Generator,
    report: Callable[[float], None] = lambda share: None,
) -> Measured:
    """The losses at random places, each coordinate in even strata of its own."""
    places = _places(box, box.effort.places, random)
    return Measured(*places, *_at(box, model, *places, random, report))


def lost(box: Box, model: BakedModel, random: np.random.Generator) -> dict[str, float]:
    """V that blending between an axis' nodes costs, by axis: the mean of V at random places, less the mean
    where each is moved to the axis' nearest node. A parameter has that of the worst of its axes."""
    parameters, theta_r, offset = _places(box, pairs(box.effort), random)
    base = _at(box, model, parameters, theta_r, offset, random)[0].mean()
    found: dict[str, float] = {}
    names = [p.name for p in box.parameters]
    axes = {(axis.name, tuple(axis.nodes)): axis for axis in _axes(model)}
    for axis in axes.values():
        moved = parameters.copy()
        moved[:, names.index(axis.name)] = _nearest(axis.nodes, moved[:, names.index(axis.name)])
        there = _at(box, model, moved, theta_r, offset, random)[0].mean()
        found[axis.name] = max(found.get(axis.name, 0.0), float(base - there))
    viewers = np.unique([t for table in model.tables for t in table.theta_r])
    there = _at(box, model, parameters, _nearest(viewers, theta_r), offset, random)[0].mean()
    found["theta_r"] = float(base - there)
    if len(model.mixture.offset) > 1:
        nodes = model.mixture.offset
        nodes = np.unique(np.append(-nodes, nodes)) if model.mixture.mirrored else nodes
        there = _at(box, model, parameters, theta_r, _nearest(nodes, offset), random)[0].mean()
        found["offset"] = float(base - there)
    return found


def _axes(model: BakedModel) -> list[Axis]:
    return [*model.mixture.axes, *(axis for table in model.tables for axis in table.axes)]


def _nearest(nodes: Array, x: Array) -> Array:
    return nodes[abs(np.asarray(x)[..., None] - nodes).argmin(axis=-1)]


def _places(box: Box, count: int, random: np.random.Generator) -> tuple[Array, Array, Array]:
    def strata(low: float, high: float) -> Array:
        return low + (high - low) * (random.permutation(count) + random.random(count)) / count

    parameters = np.stack([strata(p.least, p.most) for p in box.parameters], axis=1)
    theta_r = strata(*box.hair.theta_r)
    if not box.hair.offsets:
        return parameters, theta_r, np.zeros((count, 1))
    offset = 2 * (np.arange(OFFSETS) + random.random((count, OFFSETS))) / OFFSETS - 1
    return parameters, theta_r, offset


def _at(
    box: Box,
    model: BakedModel,
    parameters: Array,
    theta_r: Array,
    offset: Array,
    random: np.random.Generator,
    report: Callable[[float], None] = lambda share: None,
) -> tuple[Array, Array, Array]:
    """(V, largest weight, light), each (P, N)."""
    found = []
    for i, (values, t, h) in enumerate(zip(parameters, theta_r, offset, strict=True)):
        report(i / len(theta_r))
        place = tuple(values.tolist())
        density = box.density_at(place)
        around = 2 * cells.phi_count(density, np.array([t]), h[:1])
        fixed = model.at(box.named(place))
        loss = promise.losses(fixed, density, np.array([t]), h[None], around, random)
        found.append((loss.variance[0], loss.weight[0], loss.light[0]))
    variance, weight, light = (np.array(part) for part in zip(*found, strict=True))
    return variance, weight, light
