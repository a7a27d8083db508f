# SPDX-License-Identifier: BSD-3-Clause
"""Tables over nodes of parameters: one width and warp for all nodes, as few rows as the worst node allows."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from ... import interpolant
from ...axes import Axis
from ...errors import HairlutError
from ...lobes import Array
from ...model import BakedLobe
from ...table import Table
from ...warp import Warp
from .. import tables
from ..factor import variance
from ..smooth import SmoothRows
from ..tables import Need
from ..turning import TWO_PI
from .box import Box
from .dependence import Dependence
from .nodeshapes import NodeShapes, exact_phi, exact_theta
from .shapes import Shapes

EASE = 8.0  # times the loss, by which widths are estimated while nodes are chosen


@dataclass(frozen=True)
class _Node:
    """What a table is to have at a node."""

    exact: SmoothRows
    need: Need


def lobes(
    box: Box, name: str, theta: NodeShapes, phi: NodeShapes, loss: float, ease: float
) -> list[BakedLobe]:
    """The lobes of a model, each table losing at most `loss` of V at its nodes, times ease."""
    first = next(iter(theta.at.values()))
    baked = []
    for k in range(first.rows[0].phi.shape[0]):
        lobe = f"lobe{k}"
        inclinations = {
            index: _Node(exact_theta(one, k), Need(one.light[:, k], one.bright[:, k], loss).eased(ease))
            for index, one in theta.at.items()
        }
        azimuths = {
            index: _Node(exact_phi(one, k, first.theta_r), _need_of_phi(one, k, loss).eased(ease))
            for index, one in phi.at.items()
        }
        uniform = all(_uniform(one.phi[:, k], azimuths[index].need) for index, one in phi.at.items())
        baked.append(
            BakedLobe(
                lobe,
                _table(f"{lobe}_theta", name, inclinations, _axes(box, theta)),
                None if uniform else _table(f"{lobe}_phi", name, azimuths, _axes(box, phi)),
            )
        )
    return baked


def columns(found: Dependence, loss: float) -> tuple[int, int]:
    """(of all inclinations, of all azimuths) columns that tables of the shapes need which are known while
    nodes are chosen, where they lose somewhat more than `loss`."""
    some = [found.base, *(one for _, along in found.along.values() for one in (along[0], along[-1]))]
    theta = phi = 0
    for k in range(found.base.rows[0].phi.shape[0]):
        inclinations, azimuths = [], []
        for one in some:
            need = Need(one.light[:, k], one.bright[:, k], tables.FROM_WIDTH * loss)
            inclinations.append(_Node(exact_theta(one, k), need.eased(EASE)))
            need = replace(_need_of_phi(one, k, loss), loss=tables.FROM_WIDTH * loss)
            azimuths.append(_Node(exact_phi(one, k, one.theta_r), need.eased(EASE)))
        theta += _widest_enough("theta", "lobe", inclinations)[0].width
        phi += _widest_enough("lobe_phi", "lobe", azimuths)[0].width
    return theta, phi


def _need_of_phi(found: Shapes, lobe: int, loss: float) -> Need:
    light, bright = found.light[:, lobe], found.bright[:, lobe]
    if found.tied:  # two rows for all theta_r
        light, bright = np.full(2, light.max()), np.full(2, bright.min())
    return Need(light, bright, loss)


def _uniform(phi: Array, need: Need) -> bool:
    """Whether uniform draws lose no more for azimuths (J, m) than a table may."""
    return bool(need.importance.max() * variance(phi, np.ones(phi.shape), 1).max() <= need.loss)


def _axes(box: Box, found: NodeShapes) -> tuple[Axis, ...]:
    return tuple(Axis(box.parameters[p].name, v) for p, v in zip(found.axes, found.nodes, strict=True))


def _table(name: str, model: str, nodes: dict[tuple[int, ...], _Node], axes: tuple[Axis, ...]) -> Table:
    """The table with the axes that it needs."""
    order = [nodes[index] for index in product(*(range(len(axis.nodes)) for axis in axes))]
    from_width = [replace(n, need=replace(n.need, loss=tables.FROM_WIDTH * n.need.loss)) for n in order]
    best = _widest_enough(name, model, from_width)
    parts = _of_height(name, model, order, best[0].width, best[0].warp) or best
    for number in range(len(axes)):
        kept = _without(parts, order, axes, number)
        if kept:
            return _table(name, model, kept, axes[:number] + axes[number + 1 :])
    texels, slopes, log_mass = (
        np.concatenate([getattr(part, what) for part in parts]) for what in ("texels", "slopes", "log_mass")
    )
    return replace(parts[0], texels=texels, slopes=slopes, log_mass=log_mass, axes=axes)


def _without(
    parts: list[Table], order: list[_Node], axes: tuple[Axis, ...], number: int
) -> dict[tuple[int, ...], _Node] | None:
    """The nodes in the middle of an axis, if those draw what all do."""
    shape = tuple(len(axis.nodes) for axis in axes)
    kept = {}
    for at, index in enumerate(np.ndindex(shape)):
        middle = (*index[:number], shape[number] // 2, *index[number + 1 :])
        same = parts[int(np.ravel_multi_index(middle, shape))]
        if tables.part_lost(same, order[at].exact, order[at].need) > 1:
            return None
        if index == middle:
            kept[(*index[:number], *index[number + 1 :])] = order[at]
    return kept


def _widest_enough(name: str, model: str, order: list[_Node]) -> list[Table]:
    best: tuple[float, list[Table]] | None = None
    for width in tables.WIDTHS:
        for exponent in tables.EXPONENTS:
            warp = Warp("octaves", 2.0**exponent)
            lost, parts = _tried(name, model, order, width, warp, 1, best[0] if best else np.inf)
            if parts and (best is None or lost < best[0]):
                best = lost, parts
        if best and best[0] <= 1:
            break
    if best is None:
        raise HairlutError(f"{model}/{name}: its light is too narrow for a table of 32-bit floats")
    return best[1]


def _of_height(name: str, model: str, order: list[_Node], width: int, warp: Warp) -> list[Table] | None:
    """The tables of fewest rows that lose at most what is allowed."""
    last = len(order[0].exact.theta_r) - 1
    for step in (s for s in range(last, 1, -1) if last % s == 0):
        lost, parts = _tried(name, model, order, width, warp, step, 1.0)
        if parts and lost <= 1:
            return parts
    return None


def _tried(
    name: str, model: str, order: list[_Node], width: int, warp: Warp, step: int, most: float
) -> tuple[float, list[Table] | None]:
    """(the worst node's loss as a part of what is allowed, a table for each node), or no tables where it is
    above most."""
    worst, parts = 0.0, []
    for node in order:
        table = tables.table_of(name, model, node.exact, width, warp, step)
        if not table:
            return np.inf, None
        worst = max(worst, tables.part_lost(table, node.exact, node.need))
        if worst > most:
            return worst, None
        parts.append(table)
    return worst, parts


def masses(lobe: BakedLobe, theta_r: float, edges: Array, count: int) -> tuple[Array, Array]:
    """(n,), (m,) masses of the cells of theta_i between edges, and of `count` cells of the azimuth, that a
    lobe without axes draws at one theta_r."""
    theta = _cells(lobe.theta, theta_r, edges)
    if lobe.phi is None:
        return theta, np.full(count, 1 / count)
    return theta, _cells(lobe.phi, theta_r, np.linspace(0, TWO_PI, count + 1))


def _cells(table: Table, theta_r: float, edges: Array) -> Array:
    u = interpolant.invert(table, np.full(len(edges), theta_r), edges)
    u[0], u[-1] = 0.0, 1.0
    return np.maximum(np.diff(u), 1e-30)
