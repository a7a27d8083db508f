# SPDX-License-Identifier: BSD-3-Clause
"""The shapes of a hair's lobes at the nodes of the parameters on which they depend.

A parameter gets the fewest nodes between which blending quantiles is good enough (nodes.py). Shapes are
followed from node to node, from the anchor outwards."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ... import interpolant
from ...lobes import Array
from ...table import exact_knots
from ...warp import Warp
from .. import smooth, tables
from ..turning import TWO_PI
from . import nodes, shapes
from .box import Box, Place, with_value
from .dependence import Dependence
from .shapes import BOTH, THETA, Shapes

WIDTH, WARP = 64, Warp("octaves", 2.0**-11)  # of the tables by which nodes are chosen
SIZE_PART = 0.7  # of the textures' size that tables may take, about
TIME_PART = 0.4  # of the time left that shapes at nodes may take
MOST_DOUBLINGS = 16  # of what nodes may cost, for tables of this size in this time
ENOUGH_JOINED = 2  # places by which the shapes of all rows are fitted


@dataclass(frozen=True)
class NodeShapes:
    """Shapes at the nodes of some parameters. axes: the parameters' numbers; nodes: the values of each,
    increasing; at: the shapes, by the numbers of the nodes along the axes."""

    axes: tuple[int, ...]
    nodes: tuple[Array, ...]
    at: dict[tuple[int, ...], Shapes]


def exact_theta(found: Shapes, lobe: int) -> smooth.SmoothRows:
    """The inclinations of a lobe as smooth rows."""
    return smooth.rows(found.theta_r, found.edges, found.theta[:, :, lobe], False)


def exact_phi(found: Shapes, lobe: int, theta_r: Array) -> smooth.SmoothRows:
    """The azimuths of a lobe; one that all theta_r have in common as two rows, at the ends of theta_r."""
    phi = found.phi[:, lobe]
    if found.tied:
        theta_r, phi = theta_r[[0, -1]], phi[[0, 0]]
    edges = np.tile(np.linspace(0, TWO_PI, phi.shape[1] + 1), (len(phi), 1))
    return smooth.rows(theta_r, edges, phi, True)


def chosen(
    box: Box,
    found: Dependence,
    start: Shapes,
    columns: tuple[int, int],
    allowed: Mapping[str, float],
    size: float,
    most: float,
    report: Callable[[float], None],
) -> dict[int, tuple[Array, list[Shapes]]]:
    """The nodes of each parameter on which shapes depend, with the shapes there. allowed: V that blending
    between the nodes of a parameter may cost; more of it where there would be too many otherwise. columns: of
    all lobes' tables of inclinations and of azimuths; size: bytes of all textures; most: nodes of both."""
    result: dict[int, tuple[Array, list[Shapes]]] = {}
    rows = columns[0] * len(start.theta_r), columns[1] * (2 if start.tied else len(start.theta_r))
    for doublings in range(MOST_DOUBLINGS):
        result = _chosen(box, found, {name: v * 2**doublings for name, v in allowed.items()}, report)
        theta, phi = (math.prod(len(result[p][0]) for p in axes) for axes in (found.theta, found.phi))
        small = 8 * (theta * rows[0] + phi * rows[1]) <= SIZE_PART * size
        if (small and theta + phi <= most) or all(len(values) == 2 for values, _ in result.values()):
            break
    return result


def _chosen(
    box: Box, found: Dependence, allowed: Mapping[str, float], report: Callable[[float], None]
) -> dict[int, tuple[Array, list[Shapes]]]:
    result = {}
    for number, (p, (values, along)) in enumerate(found.along.items()):
        report(number / len(found.along))
        moving = p in found.theta, p in found.phi

        def beside(one: Shapes, value: float, p=p, moving=moving) -> Shapes:
            places = tuple(with_value(place, p, value) for place in one.places)
            return shapes.followed(box, one, places, moving)

        def loss_of(values: Array, along: list[Shapes], moving=moving) -> nodes.Loss:
            return _Blending(values, along, moving)

        name, most = box.parameters[p].name, box.effort.candidates
        result[p] = nodes.chosen(values, along, found.places[0][p], loss_of, beside, allowed[name], most)
    return result


class _Blending:
    """loss(i, j): V of what lies between two values, blended of the shapes at these, times the lobe's
    share; the largest of all lobes and theta_r."""

    def __init__(self, values: Array, along: list[Shapes], moving: tuple[bool, bool]):
        self._values, self._known = values, {}
        lobes = range(along[0].rows[0].phi.shape[0])
        self._exact = [_exact(one, k, moving) for one in along for k in lobes]
        self._knots = [[exact_knots(e, WIDTH, WARP) for e in part] for part in self._exact]
        self._light = [np.broadcast_to(one.light[:, k], len(one.theta_r)) for one in along for k in lobes]
        self._lobes = len(lobes)

    def __call__(self, i: int, j: int) -> float:
        if (i, j) not in self._known:
            self._known[i, j] = max(
                (self._at(i, j, c, k) for c in range(i + 1, j) for k in range(self._lobes)), default=0.0
            )
        return self._known[i, j]

    def _at(self, i: int, j: int, c: int, k: int) -> float:
        t = (self._values[c] - self._values[i]) / (self._values[j] - self._values[i])
        low, high, here = (self._knots[n * self._lobes + k] for n in (i, j, c))
        light = self._light[c * self._lobes + k]
        lost = 0.0
        for a, b, own, exact in zip(low, high, here, self._exact[c * self._lobes + k], strict=True):
            blend = [(1 - t) * x + t * y for x, y in zip(a, b, strict=True)]
            v = _variance(exact, *blend) - _variance(exact, *own)  # the width's loss is not the nodes'
            lost += float((v * (light if len(v) == len(light) else light.max())).max())
        return lost


def _exact(found: Shapes, lobe: int, moving: tuple[bool, bool]) -> list[smooth.SmoothRows]:
    kinds = [exact_theta(found, lobe)] if moving[0] else []
    return kinds + ([exact_phi(found, lobe, found.theta_r)] if moving[1] else [])


def _variance(exact: smooth.SmoothRows, x: Array, slopes: Array) -> Array:
    """(R,) V of tables with these knots."""
    read = interpolant.Cells(WARP.widths(WIDTH), x, slopes)
    weight = exact.density(read.angle(tables.NODES), np.arange(len(x))[:, None, None])
    weight = weight * read.slope(tables.NODES)
    return (((weight - 1) ** 2 @ tables.WEIGHTS) * read.h).sum(axis=1)


def start_of(box: Box, full: Shapes, found: Dependence) -> Shapes:
    """The shapes of all theta_r at the anchor, and at places that have the same. full: the anchor's own."""
    tied = found.base.tied
    start = full
    if tied:
        rows = [replace(row, phi=found.base.rows[0].phi) for row in full.rows]
        start = replace(full, rows=rows, blocks=[replace(b, phi=0) for b in full.blocks], tied=True)
    numbers = _some(len(found.places))
    places = tuple(found.places[i] for i in numbers)
    starts = shapes.starts_like(start, found.base, numbers)
    return shapes.joined(box, start, places, starts, THETA if tied else BOTH)


def at_nodes(
    box: Box,
    start: Shapes,
    found: Dependence,
    along: dict[int, tuple[Array, list[Shapes]]],
    report: Callable[[float], None],
) -> tuple[NodeShapes, NodeShapes]:
    """(inclinations, azimuths) at all nodes; start: the shapes of all theta_r at the anchor."""
    theta = _grid(box, start, found, found.theta, along, {}, lambda share: report(share * 0.8))
    common = _part(theta, found.phi, found.places[0])
    if set(found.phi) <= set(found.theta):
        return theta, common
    if start.tied:
        few = shapes.some(len(start.theta_r))
        common = replace(common, at={index: shapes.of_rows(one, few) for index, one in common.at.items()})
    known = {
        tuple(zip(common.axes, _values(common, index), strict=True)): one for index, one in common.at.items()
    }
    phi = _grid(box, start, found, found.phi, along, known, lambda share: report(0.8 + share * 0.2))
    return theta, phi


def _values(grid: NodeShapes, index: tuple[int, ...]) -> tuple[float, ...]:
    return tuple(float(v[i]) for v, i in zip(grid.nodes, index, strict=True))


def _some(places: int) -> list[int]:
    """Numbers of some of the places, the first among them."""
    return sorted({round(x) for x in np.linspace(0, places - 1, min(ENOUGH_JOINED, places))})


def _grid(
    box: Box,
    start: Shapes,
    found: Dependence,
    axes: tuple[int, ...],
    along: dict[int, tuple[Array, list[Shapes]]],
    known: dict[tuple[tuple[int, float], ...], Shapes],
    report: Callable[[float], None],
) -> NodeShapes:
    """The shapes at the product of the axes' nodes, each followed from the one before it: first along axes of
    inclinations and azimuths, then along those of one kind, where the other keeps what it has. known: shapes
    by the values of axes of both kinds."""
    values = [along[p][0] for p in axes]
    both = [a for a, p in enumerate(axes) if p in found.theta and p in found.phi]
    first = tuple(nodes.place_of(v, found.places[0][p]) for p, v in zip(axes, values, strict=True))
    done: dict[tuple[int, ...], Shapes] = {}
    order = nodes.from_place(first, tuple(len(v) for v in values))
    for number, index in enumerate(order):
        report(number / len(order))
        away = [a for a, i in enumerate(index) if i != first[a]]
        of_one_kind = [a for a in away if a not in both]
        if known and not of_one_kind:
            done[index] = known[tuple((axes[a], float(values[a][index[a]])) for a in both)]
            continue
        if not away:
            done[index] = start
            continue
        axis = max(of_one_kind or away)
        before = done[nodes.nearer(index, first, axis)]
        places = tuple(with_value(place, axes[axis], values[axis][index[axis]]) for place in before.places)
        moving = axes[axis] in found.theta, axes[axis] in found.phi
        done[index] = shapes.followed(box, before, places, moving)
    return NodeShapes(axes, tuple(values), done)


def _part(grid: NodeShapes, axes: tuple[int, ...], anchor: Place) -> NodeShapes:
    """The grid's part with some of its axes, the others at the anchor."""
    places = [int(np.argmin(abs(v - anchor[p]))) for p, v in zip(grid.axes, grid.nodes, strict=True)]
    kept = [a for a, p in enumerate(grid.axes) if p in axes]
    at = {
        tuple(index[a] for a in kept): one
        for index, one in grid.at.items()
        if all(index[a] == places[a] for a in range(len(index)) if a not in kept)
    }
    return NodeShapes(tuple(grid.axes[a] for a in kept), tuple(grid.nodes[a] for a in kept), at)
