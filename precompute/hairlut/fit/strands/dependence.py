# SPDX-License-Identifier: BSD-3-Clause
"""Which shapes of a hair's lobes depend on which parameter.

A parameter that changes only how much light a lobe has, or by what angle it is turned, needs no axis in the
lobe's tables: one set of shapes then fits several of its values together, nearly as well as a set for each.
For the others, the lobes are followed from the anchor through the parameter's range, once with all shapes
free, once with only the inclinations free, once with only the azimuths: a table gets the axis where it
costs V to keep the shapes fixed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from . import shapes
from .box import Box, Place, with_value
from .nodes import outwards, place_of
from .shapes import BOTH, NEITHER, PHI, THETA, Shapes

JOINED = 4  # values of a parameter that are fitted together with the anchor's
PATIENCE = 4  # times as many sweeps as usual until lobes that one place mixes are told apart by several
HOPELESS = 2.0  # V above which the anchor's shapes are no start for values fitted together
SLACK, MOST_SLACK = 0.004, 0.01  # of V that fixed shapes may cost, and those of several values at one of them


@dataclass(frozen=True)
class Dependence:
    """Numbers of the parameters on which inclinations and azimuths depend. places: the anchor, and others
    that have the same shapes. base: the shapes there, of some theta_r. along: by parameter, the shapes at
    each of its values, with the places' other values."""

    theta: tuple[int, ...]
    phi: tuple[int, ...]
    places: tuple[Place, ...]
    base: Shapes
    along: dict[int, tuple[np.ndarray, list[Shapes]]]


def dependence(box: Box, anchor: Shapes, report: Callable[[float], None]) -> Dependence:
    """Which shapes depend on which parameter; anchor: the shapes there, of a few theta_r."""
    base, count = anchor, len(box.parameters)
    places = anchor.places
    kept = []
    for p in range(count):
        report(p / (2 * count))
        together = _together(box, base, p)
        if together:
            base, places = together, together.places
            kept.append(p)
    on_theta, on_phi, along = [], [], {}
    for p in (p for p in range(count) if p not in kept):
        report(0.5 + p / (2 * count))
        values = box.steps(p, box.effort.steps, places[0][p])
        on, found = _least(box, base, p, values)
        on_theta += [p] * on[0]
        on_phi += [p] * on[1]
        along[p] = values, found
    return Dependence(tuple(on_theta), tuple(on_phi), places, base, along)


def _together(box: Box, base: Shapes, parameter: int) -> Shapes | None:
    """The shapes that more values of a parameter have together, if these lose little more than each alone."""
    start = base.places[0][parameter]
    values = box.steps(parameter, box.effort.steps, start)
    one = _one_place(base, 0)
    fixed = _followed(box, one, parameter, values, NEITHER, HOPELESS)
    if fixed is None:
        return None
    numbers = sorted(set(np.linspace(0, len(values) - 1, JOINED).round().astype(int).tolist()))
    numbers = [i for i in numbers if i != place_of(values, start)]
    more = [fixed[i] for i in numbers]
    starts = [*base.rows, *(row for there in more for row in there.rows)]
    places = base.places + tuple(there.places[0] for there in more)
    together = shapes.joined(box, one, places, starts, BOTH)
    free = _followed(box, one, parameter, values, BOTH) or []
    for _ in range(PATIENCE):
        alone = [_one_place(together, len(base.places) + n).variance() for n in range(len(numbers))]
        more = np.array(alone) - [free[i].variance() for i in numbers]
        if more.mean() <= SLACK and more.max() <= MOST_SLACK:
            return together
        together = together.improved(box.effort.sweeps, BOTH, base.turning)
    return None


def _one_place(found: Shapes, number: int) -> Shapes:
    """The shapes of one of the places alone."""
    part = slice(number * len(found.theta_r), (number + 1) * len(found.theta_r))
    return replace(
        found, places=found.places[number : number + 1], blocks=found.blocks[part], rows=found.rows[part]
    )


def _least(
    box: Box, base: Shapes, parameter: int, values: np.ndarray
) -> tuple[tuple[bool, bool], list[Shapes]]:
    """(which of inclinations and azimuths have to move along a parameter, their shapes)"""
    for moving in (THETA, PHI):
        found = _followed(box, base, parameter, values, moving, base.variance() + SLACK)
        if found:
            return moving, found
    free = _followed(box, base, parameter, values, BOTH) or []
    most = max(one.variance() for one in free) + SLACK
    for moving in (THETA, PHI):
        found = _followed(box, base, parameter, values, moving, most) or []
        if found and all(a.variance() <= b.variance() + SLACK for a, b in zip(found, free, strict=True)):
            return moving, found
    return BOTH, free


class _TooFar(Exception):
    pass


def _followed(
    box: Box,
    base: Shapes,
    parameter: int,
    values: np.ndarray,
    moving: tuple[bool, bool],
    allowed: float = np.inf,
) -> list[Shapes] | None:
    """The shapes at the values of a parameter, or None if V is larger than allowed at one of them."""

    def beside(one: Shapes, value: float) -> Shapes:
        places = tuple(with_value(place, parameter, value) for place in one.places)
        there = shapes.followed(box, one, places, moving)
        if there.variance() > allowed:
            raise _TooFar
        return there

    try:
        return outwards(values, base.places[0][parameter], base, beside)
    except _TooFar:
        return None
