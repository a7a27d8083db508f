# SPDX-License-Identifier: BSD-3-Clause
"""Which shapes of a hair's lobes depend on which parameter.

A parameter that changes only how much light a lobe has and where it is turned to needs no axis in its tables:
the same shapes then draw several of its values together, nearly as well as shapes of their own. For the
others, the lobes are followed from the anchor through the parameter's range, once with all shapes free, once
with the inclinations alone, once with the azimuths alone: a table gets the axis where fixed shapes lose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from . import shapes
from .box import Box, Place, with_value
from .shapes import BOTH, NEITHER, PHI, THETA, Shapes

JOINED = 0.4, 0.65, 1.0
"""Parts of the way along a parameter at which values are fitted together with the first."""
HOPELESS = 2.0  # V of shapes that are kept from the anchor, at which they are no start for that
SLACK = 0.004  # of V by which shapes that are fixed may lose


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
    """What depends on what, found at some theta_r of the anchor's shapes."""
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
        values = _from(box.steps(p, box.effort.steps), places[0][p])
        on, found = _least(box, base, p, values)
        on_theta += [p] * on[0]
        on_phi += [p] * on[1]
        along[p] = values, found
    return Dependence(tuple(on_theta), tuple(on_phi), places, base, along)


def _from(values: np.ndarray, start: float) -> np.ndarray:
    """Values from one end to the other, from the end at which the anchor is."""
    return values if start == values[0] else values[::-1]


def _together(box: Box, base: Shapes, parameter: int) -> Shapes | None:
    """The shapes that more values of a parameter have together, if these lose no more than each alone."""
    values = _from(box.steps(parameter, box.effort.steps), base.places[0][parameter])
    one = _one_place(base, 0)
    fixed = _followed(box, one, parameter, values, NEITHER, HOPELESS)
    if len(fixed) < len(values):
        return None
    numbers = [round(part * (len(values) - 1)) for part in JOINED]
    more = [fixed[i] for i in numbers]
    starts = [*base.rows, *(row for there in more for row in there.rows)]
    places = base.places + tuple(there.places[0] for there in more)
    together = shapes.joined(box, one, places, starts, BOTH)
    free = _followed(box, one, parameter, values, BOTH)
    for number, i in enumerate(numbers, len(base.places)):
        if _one_place(together, number).variance() > free[i].variance() + SLACK:
            return None
    return together


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
    tried = []
    for moving in (THETA, PHI):
        tried.append(_followed(box, base, parameter, values, moving, base.variance() + SLACK))
        if len(tried[-1]) == len(values):
            return moving, tried[-1]
    free = _followed(box, base, parameter, values, BOTH)
    for moving, found in zip((THETA, PHI), tried, strict=True):
        if all(one.variance() <= other.variance() + SLACK for one, other in zip(found, free, strict=False)):
            found = _followed(box, base, parameter, values, moving)
            if all(a.variance() <= b.variance() + SLACK for a, b in zip(found, free, strict=True)):
                return moving, found
    return BOTH, free


def _followed(
    box: Box,
    base: Shapes,
    parameter: int,
    values: np.ndarray,
    moving: tuple[bool, bool],
    allowed: float = np.inf,
) -> list[Shapes]:
    """The shapes at the values of a parameter, until V is larger than allowed."""
    found = [base]
    for value in values[1:]:
        places = tuple(with_value(place, parameter, value) for place in base.places)
        found.append(shapes.followed(box, found[-1], places, moving))
        if found[-1].variance() > allowed:
            break
    return found
