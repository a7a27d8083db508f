# SPDX-License-Identifier: BSD-3-Clause
"""The fewest nodes of an axis between which blending is good enough."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from ...lobes import Array

T = TypeVar("T")
Loss = Callable[[int, int], float]
TOO_FAR = 8.0
"""Times what is allowed, below which halving a gap is enough: the loss falls with its fourth power."""


def fewest(count: int, loss: Loss, allowed: float) -> list[int]:
    """Which of `count` candidates along an axis become nodes: as few as possible, the first and the last
    among them, with loss(i, j) <= allowed between neighbouring nodes i and j; of sets of that size the one
    whose largest loss is least. loss(i, j): of the candidates between i and j, the largest loss where they
    are blended from those two."""
    best: list[tuple[int, float, int]] = [(0, 0.0, -1)]  # by candidate: nodes before it, their loss, the last
    for j in range(1, count):
        options = []
        for i in range(j - 1, -1, -1):
            lost = loss(i, j) if j > i + 1 else 0.0
            if lost > 4 * allowed:
                break
            if lost <= allowed:
                options.append((best[i][0] + 1, max(best[i][1], lost), i))
        best.append(min(options))
    chosen = [count - 1]
    while chosen[-1]:
        chosen.append(best[chosen[-1]][2])
    return chosen[::-1]


def outwards(values: Array, start: float, first: T, beside: Callable[[T, float], T]) -> list[T]:
    """The fit at each of the values (n,): `first` at the value `start`, and from there on both ways each by
    beside(fit, value) from its neighbour's."""
    at = place_of(values, start)
    up, down = [first], [first]
    for value in values[at + 1 :]:
        up.append(beside(up[-1], float(value)))
    for value in values[:at][::-1]:
        down.append(beside(down[-1], float(value)))
    return down[:0:-1] + up


def place_of(values: Array, value: float) -> int:
    """The number of a value."""
    return int(abs(np.asarray(values) - value).argmin())


def from_place(first: tuple[int, ...], shape: tuple[int, ...]) -> list[tuple[int, ...]]:
    """All indices of an array of a shape, those nearest to the first one first."""

    def distance(index: tuple[int, ...]) -> int:
        return sum(abs(i - f) for i, f in zip(index, first, strict=True))

    return sorted(np.ndindex(shape), key=distance)


def nearer(index: tuple[int, ...], first: tuple[int, ...], axis: int) -> tuple[int, ...]:
    """The index that is one nearer to the first along an axis."""
    step = 1 if index[axis] > first[axis] else -1
    return (*index[:axis], index[axis] - step, *index[axis + 1 :])


def chosen(
    values: Array,
    along: list[T],
    kept: float,
    loss_of: Callable[[Array, list[T]], Loss],
    beside: Callable[[T, float], T],
    allowed: float,
    most: int,
) -> tuple[Array, list[T]]:
    """The fewest nodes of an axis, the value `kept` among them, and the fit at each. values (n,): candidates;
    along: the fit at each; loss_of: the loss that `fewest` takes, of candidates and fits; beside(fit, value):
    a fit at a value that starts from a neighbour's. Where candidates are too far apart, more are fitted
    between them, up to `most` in all."""
    values, along = list(values), list(along)
    while True:
        loss = loss_of(np.array(values), along)
        wide = [i for i in range(1, len(values) - 1) if loss(i - 1, i + 1) > TOO_FAR * allowed]
        gaps = sorted({gap for i in wide for gap in (i - 1, i)}, reverse=True)
        if not gaps or len(values) + len(gaps) > most:
            break
        for gap in gaps:
            value = (values[gap] + values[gap + 1]) / 2
            along.insert(gap + 1, beside(along[gap], value))
            values.insert(gap + 1, value)
    at = place_of(np.array(values), kept)
    below = fewest(at + 1, loss, allowed)
    above = fewest(len(values) - at, lambda i, j: loss(at + i, at + j), allowed)
    numbers = below + [at + i for i in above[1:]]
    return np.array([values[i] for i in numbers]), [along[i] for i in numbers]
