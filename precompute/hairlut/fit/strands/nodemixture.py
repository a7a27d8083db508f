# SPDX-License-Identifier: BSD-3-Clause
"""Shares and turns of lobes whose shapes are known, over the parameters, theta_r and the offset.

They are fitted to the hair with what the baked tables draw, at candidate nodes. Each axis keeps the fewest of
them from which blending gives the others well enough (nodes.py), measured by a bound of V: for shares s_k
blended as q_k and turns that are off by d_k,

    V <= sum over k of (s_k - q_k)^2 / q_k + q_k d_k^2 I_k,   I_k = integral of B_k'^2 / B_k dphi,

by the convexity of (p - q)^2 / q, and to second order in d_k."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from time import perf_counter

import numpy as np

from ...axes import Axis
from ...lobes import Array
from ...mixture import Mixture, wrap
from ...model import BakedLobe
from .. import cells
from ..lobesfit import MENDED, SAME_SWEEPS, Row, improved, same_shapes
from ..turning import TWO_PI
from . import nodes, nodetables
from .box import Box, Place, with_value
from .shapes import Shapes

MOST_PHI = 144  # cells of phi: shapes are known, and cells need not resolve them
FEW_OFFSETS = 13  # by which dependences are found
VIEWERS = np.array([-0.96, -0.7, -0.35, 0.0, 0.35, 0.7, 0.96])  # parts of the largest theta_r
GRAZING = np.array([15.0, 1.0, 1.0, 1.0, 1.0, 1.0, 15.0])
"""How many times as much may be lost there: few viewers are grazing."""
LED, SHARES = 0.01, 4  # rad of turns that differ, and sweeps of the shares for other turns
BETWEEN = 1 / 16  # of the loss at twice the distance of offsets: it falls with the fourth power
SURE = 0.01  # V that blending between offsets may add before another start is tried
UNSURE = 1.5  # times V with the best shares, at which others count as worse
WORST = 3.0  # times the mean that may be lost at one theta_r
FADED = 0.25
"""Part of its share beside below which a lobe takes its turn from there: on its own it would turn to where
another lobe's tails lack light, and between the two it would be turned away from its own."""
STEEP, STEP = np.radians(74.0), np.radians(2.5)
"""theta_r beyond which Fresnel's reflectance makes shares and turns steep, and about how far nodes are apart
there."""
SIZE_PART, THINNED = 0.5, 3
"""Of the textures' size that the mixture may take, about, and how much smaller fewer theta_r and offsets make
it."""
MOST_DOUBLINGS = 6  # of what nodes may cost, for a mixture of this size


@dataclass(frozen=True)
class Mixed:
    """Shares and turns (J, N, K) at one place; variance (J,): V, the mean over the offsets."""

    share: Array
    turn: Array
    variance: Array


class Fitting:
    """Fits shares and turns at places, for theta_r (J,) and the angles (N,) of offsets. between (J,): which
    theta_r start from what blending gives there, and keep it where it is good enough."""

    def __init__(
        self,
        box: Box,
        lobes: list[BakedLobe],
        theta_r: Array,
        angle: Array,
        turning: bool,
        between: Array | None = None,
    ):
        self._box, self._lobes, self._theta_r, self._angle = box, lobes, theta_r, angle
        self._turning = turning
        self._between = np.zeros(len(theta_r), bool) if between is None else between
        self._known: dict[Place, Mixed] = {}

    @property
    def count(self) -> int:
        """Of places that were fitted."""
        return len(self._known)

    def at(self, place: Place, start: Mixed) -> Mixed:
        """The shares and turns at a place, from those of a place beside."""
        if place not in self._known:
            self._known[place] = self._fitted(place, start, False)
        return self._known[place]

    def fixed(self, place: Place, start: Mixed) -> Mixed:
        """V at a place with given shares and turns."""
        return self._fitted(place, start, True)

    def _fitted(self, place: Place, start: Mixed, fixed: bool) -> Mixed:
        box, offset = self._box, np.sin(self._angle)
        density, named = box.density_at(place), box.named(place)
        some = offset[np.unique([0, len(offset) // 2, max(len(offset) - 2, 0)])]
        edges = cells.theta_edges(density, self._theta_r, some, box.effort.theta_i, box.effort.edge_azimuths)
        viewers = self._theta_r[np.unique([0, len(self._theta_r) // 2, len(self._theta_r) - 1])]
        m = min(cells.phi_count(density, viewers, offset[:-1][::6]), MOST_PHI, box.effort.most_phi)
        lobes = [BakedLobe(x.name, x.theta.at(named), x.phi and x.phi.at(named)) for x in self._lobes]
        rows: dict[int, Row] = {}
        variance = np.zeros(len(self._theta_r))
        for j in self._order():
            theta_r, before = self._theta_r[j], self._before(rows, j)
            mass = cells.of_density(density, self._theta_r[[j]], offset, edges[[j]], m).mass[0]
            parts = [nodetables.masses(x, theta_r, edges[j], m) for x in lobes]
            theta, phi = np.stack([a for a, _ in parts], axis=1), np.stack([b for _, b in parts])
            row = Row(theta, phi, start.share[j], start.turn[j])
            if not fixed and self._between[j]:
                blend = replace(row, **self._blended(rows, j))
                for begin in (blend, row):
                    blend = _better(blend, same_shapes(begin, mass, self._angle, self._turning), mass)
                row = blend
            elif not fixed:
                row = self._steadier(same_shapes(row, mass, self._angle, self._turning), before, mass)
                if self._turning:
                    beside = [(start.share[j], start.turn[j])]
                    beside += [(before.share, before.turn)] if before else []
                    row = self._led(row, beside, mass)
            rows[j], variance[j] = row, row.variance(mass)
        return Mixed(
            np.stack([rows[j].share for j in range(len(rows))]),
            np.stack([rows[j].turn for j in range(len(rows))]),
            variance,
        )

    def _order(self) -> list[int]:
        """The numbers of theta_r from the middle outwards, those between others last."""
        count = len(self._theta_r)
        return sorted(range(count), key=lambda j: (bool(self._between[j]), abs(j - count // 2)))

    def _before(self, rows: Mapping[int, Row], j: int) -> Row | None:
        """The row next to one on the side of the middle."""
        middle = len(self._theta_r) // 2
        inwards = range(j - 1, middle - 1, -1) if j > middle else range(j + 1, middle + 1)
        return next((rows[i] for i in inwards if i in rows), None)

    def _blended(self, rows: Mapping[int, Row], j: int) -> dict[str, Array]:
        """Shares and turns between those of the next rows that are known on both sides."""
        low = max(i for i in range(j) if not self._between[i])
        high = min(i for i in range(j, len(self._theta_r)) if not self._between[i])
        t = (self._theta_r[j] - self._theta_r[low]) / (self._theta_r[high] - self._theta_r[low])
        a, b = rows[low], rows[high]
        share, turn = (1 - t) * a.share + t * b.share, a.turn + t * wrap(b.turn - a.turn)
        return {"share": share.astype(a.share.dtype), "turn": turn.astype(a.turn.dtype)}

    def _steadier(self, row: Row, before: Row | None, mass: Array) -> Row:
        """The row, or one with the shares and turns of the row before it, nearer to the middle, as a start,
        if that is better between offsets too: at grazing theta_r all inclinations look alike, and at some
        offsets lobes may have changed places."""
        if before is None or not self._turning or len(self._angle) < 3:
            return row
        start = replace(row, share=before.share, turn=before.turn)
        if _unsteady(row, mass, self._angle) < UNSURE * row.variance(mass) + SURE:
            return row
        other = improved(start, mass, self._angle, SAME_SWEEPS, True, start, shapes=False, largest=MENDED)
        return min(row, other, key=lambda one: _unsteady(one, mass, self._angle))

    def _led(self, row: Row, beside: Sequence[tuple[Array, Array]], mass: Array) -> Row:
        """The row whose faded lobes have the turns that they have beside, (share, turn) each, with the shares
        that then are best; or the row itself if that costs much: beside, turns may really be others."""
        turn = row.turn
        for share, other in beside:
            trust = 1 / (1 + (FADED * share / row.share) ** 4)
            turn = other + trust * wrap(turn - other)
        if np.allclose(turn, row.turn, atol=LED):
            return row
        led = replace(row, turn=turn.astype(row.turn.dtype))
        led = improved(led, mass, self._angle, SHARES, False, shapes=False, largest=MENDED)
        return _better(led, row, mass)


def _better(steady: Row, other: Row, mass: Array) -> Row:
    """A row that is steady, unless another one is much better."""
    return steady if steady.variance(mass) < UNSURE * other.variance(mass) + SURE else other


def _unsteady(row: Row, mass: Array, angle: Array) -> float:
    """V at the offsets, and about what blending between them adds: of every other offset, without its own."""
    t = ((angle[1:-1] - angle[:-2]) / (angle[2:] - angle[:-2]))[:, None]
    share = (1 - t) * row.share[:-2] + t * row.share[2:]
    turn = row.turn[:-2] + t * wrap(row.turn[2:] - row.turn[:-2])
    between = Row(row.theta, row.phi, share.astype(row.share.dtype), turn.astype(row.turn.dtype))
    return row.variance(mass) + BETWEEN * between.variance(mass[1:-1])


def of_shapes(found: Shapes, theta_r: Array, angle: Array) -> Mixed:
    """The shares and turns of the shapes' first place at other theta_r and offsets."""
    rows = found.rows[: len(found.theta_r)]
    parts = []
    for values in (np.stack([r.share for r in rows]), np.unwrap(np.stack([r.turn for r in rows]), axis=0)):
        parts.append(_along(found.theta_r, _along(found.angle, values, angle, 1), theta_r, 0))
    return Mixed(*parts, np.zeros(len(theta_r)))


def _along(nodes_at: Array, values: Array, at: Array, axis: int) -> Array:
    """Values on an axis of nodes, blended at other places."""
    x = np.interp(at, nodes_at, np.arange(len(nodes_at)))
    i = np.clip(x.astype(int), 0, max(len(nodes_at) - 2, 0))
    t = np.expand_dims(x - i, tuple(range(1, values.ndim - axis)))
    after = np.minimum(i + 1, len(nodes_at) - 1)
    return (1 - t) * np.take(values, i, axis) + t * np.take(values, after, axis)


def viewers(theta_r: Array) -> Array:
    """The nodes (J,) of theta_r at which shares and turns are fitted: those of tables, and more beyond STEEP,
    where they change fast."""
    found = [theta_r[:1]]
    for low, high in pairwise(theta_r):
        steep = (abs(np.array([low, high])) > STEEP).all()
        parts = max(1, round((high - low) / STEP)) if steep else 1
        found.append(np.append(np.linspace(low, high, parts + 1)[1:-1], high))
    return np.concatenate(found)


def depends(box: Box, lobes: list[BakedLobe], start: Shapes, slack: float) -> dict[int, float]:
    """The parameters on which shares or turns depend, along each from the anchor, and V that each costs a
    mixture without its axis."""
    anchor = start.places[0]
    low, high = box.hair.theta_r
    theta_r = (low + high) / 2 + VIEWERS * (high - low) / 2
    angle = box.hair.angles(min(FEW_OFFSETS, box.effort.offset))
    fitting = Fitting(box, lobes, theta_r, angle, start.turning)
    first = fitting.at(anchor, of_shapes(start, theta_r, angle))
    found = {}
    for p in range(len(box.parameters)):
        values, lost = box.steps(p, 5, anchor[p]), 0.0

        def beside(one: Mixed, value: float, p=p) -> Mixed:
            return fitting.at(with_value(anchor, p, value), one)

        along = nodes.outwards(values, anchor[p], first, beside)
        for value, here in zip(values, along, strict=True):
            same = fitting.fixed(with_value(anchor, p, float(value)), first)
            lost = max(lost, ((same.variance - UNSURE * here.variance) / GRAZING).max())
        if lost > slack:
            found[p] = lost
    return found


def mixture(
    box: Box,
    lobes: list[BakedLobe],
    start: Shapes,
    anchor: Place,
    axes: tuple[int, ...],
    theta_r: Array,
    angle: Array,
    allowed: Mapping[str, float],
    size: float,
    last: float,
    report: Callable[[float], None],
) -> Mixture:
    """The mixture of baked lobes over the parameters axes, the others as at the anchor, with as many nodes as
    size, bytes of all textures, and last, the time by perf_counter when it should be done, allow."""
    between = ~np.isin(theta_r, start.theta_r)
    fitting = Fitting(box, lobes, theta_r, angle, start.turning, between)
    began = perf_counter()
    first = fitting.at(anchor, of_shapes(start, theta_r, angle))
    bend, kept = _bends(lobes), {}
    for doublings in range(MOST_DOUBLINGS):
        for number, p in enumerate(axes):
            report(0.3 * number / len(axes))
            most = allowed[box.parameters[p].name] * 2**doublings
            kept[p] = _nodes_along(box, fitting, first, anchor, p, bend, most)
        count = np.prod([len(kept[p][0]) for p in axes])
        taken = 8 * len(lobes) * count * len(theta_r) * len(angle) / THINNED
        late = perf_counter() + count * (perf_counter() - began) / fitting.count > last
        if taken <= SIZE_PART * size and count <= box.effort.nodes and not late:
            break
    values = [kept[p][0] for p in axes]
    at_anchor = tuple(nodes.place_of(v, anchor[p]) for p, v in zip(axes, values, strict=True))
    done: dict[tuple[int, ...], Mixed] = {}
    order = nodes.from_place(at_anchor, tuple(len(v) for v in values))
    for number, index in enumerate(order):
        report(0.3 + 0.7 * number / len(order))
        away = [a for a, i in enumerate(index) if i != at_anchor[a]]
        place = anchor
        for p, v, i in zip(axes, values, index, strict=True):
            place = with_value(place, p, float(v[i]))
        done[index] = fitting.at(place, done[nodes.nearer(index, at_anchor, away[-1])]) if away else first
    return _assembled(box, lobes, axes, values, done, theta_r, angle, allowed)


def _nodes_along(
    box: Box, fitting: Fitting, first: Mixed, anchor: Place, p: int, bend: Array, allowed: float
) -> tuple[Array, list[Mixed]]:
    """The nodes of one parameter, the anchor's value among them, and what is there."""

    def beside(one: Mixed, value: float) -> Mixed:
        return fitting.at(with_value(anchor, p, value), one)

    values = box.steps(p, box.effort.steps, anchor[p])
    along = nodes.outwards(values, anchor[p], first, beside)
    most = box.effort.candidates

    def loss_of(values: Array, along: list[Mixed]) -> _Loss:
        return _Loss(values, along, bend)

    return nodes.chosen(values, along, anchor[p], loss_of, beside, allowed, most)


class _Loss:
    """loss(i, j): the bound of V between two values of a parameter."""

    def __init__(self, values: Array, along: list[Mixed], bend: Array):
        self._values, self._along, self._bend = values, along, bend

    def __call__(self, i: int, j: int) -> float:
        low, high, worst = self._along[i], self._along[j], 0.0
        for c in range(i + 1, j):
            t = (self._values[c] - self._values[i]) / (self._values[j] - self._values[i])
            here = self._along[c]
            worst = max(worst, _of_viewers(_bound(low, high, t, here, self._bend).mean(axis=1)))
        return worst


def _of_viewers(lost: Array) -> float:
    """Of V by theta_r what counts: the mean, or a part of the largest."""
    return float(max(lost.mean(), lost.max() / WORST))


def _bound(low: Mixed, high: Mixed, t: Array | float, here: Mixed, bend: Array) -> Array:
    share = (1 - t) * low.share + t * high.share
    turn = low.turn + t * wrap(high.turn - low.turn)
    return bound(here.share, here.turn, share, turn, bend)


def bound(share: Array, turn: Array, drawn: Array, drawn_turn: Array, bend: Array) -> Array:
    """(...) the bound of V of shares and turns (..., K) that are drawn with others; bend (K,): I_k."""
    off = wrap(turn - drawn_turn)
    chi = (share - drawn) ** 2 / np.maximum(drawn, 1e-9)
    return (chi + np.minimum(share, drawn) * np.minimum(off**2 * bend, 4.0)).sum(axis=-1)


def _bends(lobes: list[BakedLobe]) -> Array:
    """(K,) the largest integral of B'^2 / B of each lobe's azimuths over their nodes."""
    return np.array([0.0 if lobe.phi is None else _bend_of(lobe.phi) for lobe in lobes])


def _bend_of(table) -> float:
    m = 512
    edges = np.linspace(0, TWO_PI, m + 1)
    worst = 0.0
    names = [axis.name for axis in table.axes]
    for values in product(*([axis.nodes[0], axis.nodes[-1]] for axis in table.axes)):
        fixed = table.at(dict(zip(names, values, strict=True)))
        mass = nodetables._cells(fixed, 0.0, edges) * m / TWO_PI
        slope = (np.roll(mass, -1) - np.roll(mass, 1)) / (2 * TWO_PI / m)
        worst = max(worst, float((slope**2 / mass).sum() * TWO_PI / m))
    return worst


def _assembled(
    box: Box,
    lobes: list[BakedLobe],
    axes: tuple[int, ...],
    values: list[Array],
    done: dict[tuple[int, ...], Mixed],
    theta_r: Array,
    angle: Array,
    allowed: Mapping[str, float],
) -> Mixture:
    """The mixture with as few theta_r and offsets as lose little."""
    shape, bend = tuple(len(v) for v in values), _bends(lobes)
    share = np.stack([done[index].share for index in np.ndindex(shape)])  # (nodes, J, N, K)
    turn = np.stack([done[index].turn for index in np.ndindex(shape)])
    offsets = _fewest(share, turn, 2, angle, bend, allowed["offset"])
    share, turn, angle = share[:, :, offsets], turn[:, :, offsets], angle[offsets]
    viewers = _fewest(share, turn, 1, theta_r, bend, allowed["theta_r"])
    share, turn, theta_r = share[:, viewers], turn[:, viewers], theta_r[viewers]
    share, turn = (np.moveaxis(part.reshape(*shape, *part.shape[1:]), -1, 0) for part in (share, turn))
    named = tuple(Axis(box.parameters[p].name, v) for p, v in zip(axes, values, strict=True))
    return Mixture(
        tuple(one.name for one in lobes),
        theta_r,
        np.sin(angle),
        share,
        wrap(turn),
        box.hair.mirrored,
        named,
    )


def _fewest(share: Array, turn: Array, axis: int, places: Array, bend: Array, allowed: float) -> list[int]:
    """The fewest of an axis' places from which the others are blended well enough: on average over the
    offsets, at the worst theta_r and node."""
    if len(places) < 3:
        return list(range(len(places)))
    share, turn = np.moveaxis(share, axis, 0), np.moveaxis(turn, axis, 0)

    def loss(i: int, j: int) -> float:
        t = ((places[i + 1 : j] - places[i]) / (places[j] - places[i]))[:, None, None, None]
        drawn = (1 - t) * share[i] + t * share[j]
        drawn_turn = turn[i] + t * wrap(turn[j] - turn[i])
        lost = bound(share[i + 1 : j], turn[i + 1 : j], drawn, drawn_turn, bend)
        if axis == 2:  # (places, nodes, theta_r)
            return max(map(_of_viewers, lost.sum(axis=0) / len(places)))
        return float(lost.mean(axis=2).max() / WORST)  # (places, nodes, offsets)

    return nodes.fewest(len(places), loss, allowed)
