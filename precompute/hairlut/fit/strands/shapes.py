# SPDX-License-Identifier: BSD-3-Clause
"""The shapes of a hair's lobes at places in its box of parameters.

At the anchor, a corner that needs as many lobes as any, they are found from nothing. From there they are
followed from place to place, each starting from those of the place before, so that a lobe stays the same one
over the whole box, and tables may blend its quantiles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ...errors import HairlutError
from ...lobes import Array
from ...mixture import wrap
from .. import cells
from ..lobesfit import Row, first_row, one_more
from ..refine import GAIN, MAX_LOBES, PART, bright_parts, fit_rows
from ..turning import TWO_PI
from . import tied
from .box import Box, Place
from .firstround import PARTS
from .tied import Block

JOINT = 24  # sweeps of rows that get the same azimuths
BOTH, THETA, PHI, NEITHER = (True, True), (True, False), (False, True), (False, False)


@dataclass(frozen=True)
class Shapes:
    """The lobes of R viewers theta_r (R,) at some places that have the same shapes: blocks and rows in the
    order of the places, then of theta_r. edges (R, n+1): of the cells of theta_i, rad. tied: whether the
    azimuths are those of all theta_r."""

    places: tuple[Place, ...]
    theta_r: Array
    angle: Array
    edges: Array
    blocks: list[Block]
    rows: list[Row]
    tied: bool

    @property
    def theta(self) -> Array:
        """(R, n, K) masses."""
        return np.stack([row.theta for row in self.rows[: len(self.theta_r)]])

    @property
    def phi(self) -> Array:
        """(R, K, m) masses."""
        return np.stack([row.phi for row in self.rows[: len(self.theta_r)]])

    @property
    def light(self) -> Array:
        """(R, K) each lobe's largest share among the places, the mean over the offsets."""
        share = np.stack([row.share.mean(axis=0) for row in self.rows])
        return share.reshape(len(self.places), len(self.theta_r), -1).max(axis=0)

    @property
    def bright(self) -> Array:
        """(R, K) the part of each lobe's own peak above which its weights count at some place."""
        count = len(self.theta_r)
        parts = [self.rows[i : i + count] for i in range(0, len(self.rows), count)]
        return np.min([bright_parts(self.edges, rows).T for rows in parts], axis=0)

    @property
    def turning(self) -> bool:
        return any(row.turn.any() for row in self.rows)

    def variance(self) -> float:
        return tied.variance(self.blocks, self.rows)

    def improved(self, sweeps: int, moving: tuple[bool, bool], turning: bool) -> Shapes:
        rows = tied.improved(self.blocks, self.rows, self.angle, sweeps, turning, moving)
        return replace(self, rows=rows)


def anchor_of(box: Box, lobes: int | None, report: Callable[[float], None]) -> tuple[Place, int]:
    """(the place from which lobes are followed, how many): the corner that needs most, of equal ones that
    which loses most with one fewer; or a place inside, where corners lack a lobe whose share ends at 0."""
    places = [*box.corners(), box.standard, box.middle]
    found = []
    for at, place in enumerate(places):
        report(at / len(places))
        found.append((*_needed(box, place, lobes), place))
    corner, richest = max(found[:-2], key=_most), max(found, key=_most)
    count, _, place = corner if corner[0] == richest[0] else richest
    return place, count


def _most(needed: tuple[int, float, Place]) -> tuple[int, float]:
    return needed[:2]


def _needed(box: Box, place: Place, lobes: int | None) -> tuple[int, float]:
    """(lobes that gain at a place, V with one fewer)."""
    angle = box.hair.angles(box.effort.fitted_offsets)
    viewers = box.hair.rows(13)[[4, 8]]
    edges = _edges(box, (place,), viewers, angle)
    blocks = _blocks(box, (place,), viewers, angle, edges, False)
    rows: list[Row | None] = [None] * len(blocks)
    reached: list[float] = []
    for _ in range(lobes or MAX_LOBES):
        rows = [one_more(r, b.mass, angle, box.hair.offsets) for r, b in zip(rows, blocks, strict=True)]
        reached.append(tied.variance(blocks, rows))
        if reached[-1] < GAIN or (len(reached) > 2 and min(reached[-2:]) > min(reached[:-2]) - GAIN):
            break
    least = min(reached)
    count = next(k for k, v in enumerate(reached) if v <= least + max(GAIN, PART * least))
    return lobes or count + 1, reached[count - 1] if count else np.inf


def at_anchor(
    box: Box, place: Place, count: int, turning: bool, rows: int, report: Callable[[float], None]
) -> Shapes:
    """The lobes of so many rows of theta_r at one place, from nothing."""
    angle, theta_r = box.hair.angles(box.effort.fitted_offsets), box.hair.rows(rows)
    edges = _edges(box, (place,), theta_r, angle)
    viewers = theta_r[list(some(rows))]
    m = min(cells.phi_count(box.density_at(place), viewers, np.sin(angle)), box.effort.most_phi)
    data = cells.of_density(box.density_at(place), theta_r, np.sin(angle), edges, m)
    _check_light(box, place, data)
    fitted = fit_rows(data, angle, count, turning, report)
    blocks = [Block(mass, j, j) for j, mass in enumerate(data.mass)]
    return Shapes((place,), theta_r, angle, edges, blocks, fitted, False)


def turns(box: Box, place: Place, count: int) -> bool:
    """Whether the lobes lose more where they may not turn."""
    angle, theta_r = box.hair.angles(box.effort.fitted_offsets), box.hair.rows(3)[1:2]
    edges = _edges(box, (place,), theta_r, angle)
    mass = _blocks(box, (place,), theta_r, angle, edges, False)[0].mass
    free, fixed = (first_row(mass, angle, count, turning).variance(mass) for turning in (True, False))
    return fixed > free + GAIN


def some(rows: int) -> tuple[int, ...]:
    """Numbers of the rows by which dependences are found."""
    return tuple(round((rows - 1) * part) for part in PARTS)


def of_rows(shapes: Shapes, kept: tuple[int, ...]) -> Shapes:
    """The shapes of some of the rows."""
    numbers = [p * len(shapes.theta_r) + j for p in range(len(shapes.places)) for j in kept]
    return replace(
        shapes,
        theta_r=shapes.theta_r[list(kept)],
        edges=shapes.edges[list(kept)],
        blocks=[shapes.blocks[i] for i in numbers],
        rows=[shapes.rows[i] for i in numbers],
    )


def with_common_azimuths(shapes: Shapes) -> Shapes:
    """The shapes with one azimuth for all theta_r, fitted to them."""
    blocks = [replace(block, phi=0) for block in shapes.blocks]
    rows = tied.with_common_azimuths(blocks, shapes.rows)
    there = replace(shapes, blocks=blocks, rows=rows, tied=True)
    return there.improved(JOINT, BOTH, shapes.turning)


def followed(box: Box, before: Shapes, places: tuple[Place, ...], moving: tuple[bool, bool]) -> Shapes:
    """The shapes at other places, as many as before, that start from those before."""
    edges = _edges(box, places, before.theta_r, before.angle)
    blocks = _blocks(box, places, before.theta_r, before.angle, edges, before.tied)
    m = blocks[0].mass.shape[2]
    count = len(before.theta_r)
    rows = [
        replace(
            row,
            theta=cells.rebinned(row.theta, before.edges[i % count], edges[i % count]),
            phi=around(row.phi, m),
        )
        for i, row in enumerate(before.rows)
    ]
    there = replace(
        before, places=places, edges=edges, blocks=blocks, rows=tied.started(blocks, rows, moving)
    )
    return there.improved(box.effort.sweeps, moving, before.turning)


def joined(
    box: Box, first: Shapes, places: tuple[Place, ...], starts: list[Row], moving: tuple[bool, bool]
) -> Shapes:
    """The shapes that places have together: they start from those at the first of them, `first`; shares and
    turns from starts, in the order of the places, then of theta_r."""
    edges = _edges(box, places, first.theta_r, first.angle)
    blocks = _blocks(box, places, first.theta_r, first.angle, edges, first.tied)
    m, count = blocks[0].mass.shape[2], len(first.theta_r)
    known = [
        (cells.rebinned(row.theta, first.edges[j], edges[j]), around(row.phi, m))
        for j, row in enumerate(first.rows[:count])
    ]
    rows = [
        replace(start, theta=known[i % count][0], phi=known[i % count][1]) for i, start in enumerate(starts)
    ]
    there = replace(first, places=places, edges=edges, blocks=blocks, rows=rows)
    return there.improved(box.effort.sweeps, moving, first.turning)


def starts_like(first: Shapes, like: Shapes, numbers: list[int]) -> list[Row]:
    """Rows whose shares and turns are those of `first`, changed as they change from the first place of
    `like`, which has other theta_r, to its places of these numbers."""
    count = len(like.theta_r)
    found = []
    for number in numbers:
        there, anchor = like.rows[number * count : (number + 1) * count], like.rows[:count]
        share = np.stack([a.share / b.share for a, b in zip(there, anchor, strict=True)])
        turn = np.stack([wrap(a.turn - b.turn) for a, b in zip(there, anchor, strict=True)])
        for theta_r, row in zip(first.theta_r, first.rows, strict=True):
            x = np.interp(theta_r, like.theta_r, np.arange(count))
            i = min(int(x), count - 2)
            t = x - i
            changed = row.share * ((1 - t) * share[i] + t * share[i + 1])
            found.append(
                replace(
                    row,
                    share=(changed / changed.sum(axis=1, keepdims=True)).astype(row.share.dtype),
                    turn=(row.turn + (1 - t) * turn[i] + t * turn[i + 1]).astype(row.turn.dtype),
                )
            )
    return found


def _edges(box: Box, places: tuple[Place, ...], theta_r: Array, angle: Array) -> Array:
    offset = np.sin(angle[np.unique([0, len(angle) // 2, max(len(angle) - 2, 0)])])
    density = box.mean_density(sorted({places[0], places[-1]}))
    return cells.theta_edges(density, theta_r, offset, box.effort.theta_i, box.effort.edge_azimuths)


def _blocks(
    box: Box, places: tuple[Place, ...], theta_r: Array, angle: Array, edges: Array, tied_rows: bool
) -> list[Block]:
    offset = np.sin(angle)
    m = max(_phi_count(box, place, theta_r, offset) for place in places)
    each = [box.cells_at(place, theta_r, offset, edges, m) for place in places]
    for place, data in zip(places, each, strict=True):
        _check_light(box, place, data)
    return [Block(mass, j, 0 if tied_rows else j) for data in each for j, mass in enumerate(data.mass)]


def _phi_count(box: Box, place: Place, theta_r: Array, offset: Array) -> int:
    """Cells of the azimuth at a place; all that there may be where even the middle needs these."""
    viewers = theta_r[np.unique([len(theta_r) // 2, 0, len(theta_r) - 1])]
    some, density, most = offset[:-1][::2] if len(offset) > 1 else offset, box.density_at(place), 0
    for at in (viewers[1:2], viewers[::2]):
        most = max(most, cells.phi_count(density, at, some))
        if most >= box.effort.most_phi or not box.effort.edges_of_phi:
            break
    return min(most, box.effort.most_phi)


def _check_light(box: Box, place: Place, data: cells.Cells) -> None:
    """Refuses a place without light: there is nothing to draw, and no lobe to follow to the next place."""
    if dark := data.dark():
        values = ", ".join(f"{name} = {value:.6g}" for name, value in box.named(place).items())
        raise HairlutError(
            f"f is 0 {dark}, {values}: expected some light for each theta_r: narrow the range of a parameter "
            "in PARAMETERS, or let f be above 0 there"
        )


def around(phi: Array, m: int) -> Array:
    """(K, m) masses of even cells around the fibre of those of another number."""
    if phi.shape[1] == m:
        return phi
    below = np.concatenate([np.zeros((len(phi), 1)), np.cumsum(phi, axis=1)], axis=1)
    old, new = (np.linspace(0, TWO_PI, count + 1) for count in (phi.shape[1], m))
    return np.diff(np.stack([np.interp(new, old, one) for one in below]), axis=1).astype(phi.dtype)
