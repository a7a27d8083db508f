# SPDX-License-Identifier: BSD-3-Clause
"""How much of a hair a budget of seconds lets a fit look at.

Almost all of a fit's time goes into evaluating the hair and into steps of its lobes over cells. Both are
timed first, on little of each, and the counts of the first round follow: those of a coarser EFFORTS where
the budget asks for it. Refining starts from there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from . import promise
from .cells import AROUND, FINE, GAUSS, MIN_PHI
from .factor import update
from .hair import Hair

FIRST_ROUND = 0.4  # of the budget; the rest is for refining and for the last measurement
STEPS = 60  # of a row's lobes, over its cells, all kinds together
STEPS_OF_CHOICE = 1500  # of a row's lobes while their number is chosen
ENOUGH = 0.01  # s that a timing takes, at least
MOST = 500_000  # values that it evaluates, at most, about
LOBES = 3  # in what is timed


@dataclass(frozen=True)
class Effort:
    """Counts of a fit's first round: intervals of theta_r, at least; offsets from 0 to 1; cells of theta_i;
    the part of the cells of phi that the azimuth wants; offsets and azimuths by which cells of theta_i are
    chosen; viewers and offsets each that are measured, repetitions of the last measurement, and its azimuths
    for each cell of phi."""

    intervals: int
    offset: int
    theta_i: int
    phi: float
    edge_offsets: int
    edge_azimuths: int
    viewers: int
    measured_offsets: int
    repeats: int
    around: int


EFFORTS = (
    Effort(36, 11, 32, 1.0, 3, AROUND, 24, 8, 4, 2),
    Effort(24, 9, 24, 0.8, 3, AROUND // 2, 16, 6, 3, 2),
    Effort(12, 9, 24, 0.6, 2, AROUND // 3, 12, 6, 2, 2),
    Effort(12, 7, 16, 0.4, 1, AROUND // 4, 12, 4, 2, 1),
    Effort(12, 5, 16, 0.25, 1, AROUND // 4, 8, 2, 2, 1),
)
"""From full to least."""


@dataclass(frozen=True)
class Pace:
    """Seconds per value of the hair, and per cell and step of its lobes."""

    value: float
    cell: float


def pace(hair: Hair) -> Pace:
    """As timed on this hair and machine."""
    random = np.random.default_rng(0)
    p, theta, azimuth = (random.random(shape, np.float32) for shape in ((32, 640), (32, LOBES), (LOBES, 640)))
    cell = min(_timed(lambda: update(p, theta, azimuth, 10)) for _ in range(3)) / (10 * p.size)
    n, taken = 4, 0.0
    while taken < ENOUGH and 4 * n * n < MOST:
        n *= 2
        at = 0.3, np.linspace(-1.4, 1.4, n)[:, None], np.linspace(0.0, 6.2, 4 * n)
        taken = _timed(lambda at=at: hair.density(*at, 0.3 if hair.offsets else 0.0))
    return Pace(taken / (4 * n * n), cell)


def _timed(work: Callable[[], object]) -> float:
    start = perf_counter()
    work()
    return perf_counter() - start


def affordable(hair: Hair, pace: Pace, phi: int, budget: float) -> Effort:
    """The largest effort whose first round fits its part of the budget, or the least; phi: cells of the
    azimuth at full effort."""
    return next((one for one in EFFORTS if seconds(hair, pace, one, phi) < FIRST_ROUND * budget), EFFORTS[-1])


def phi_cells(effort: Effort, phi: int) -> int:
    """Cells of phi, in eights, where the azimuth wants so many."""
    return 8 * int(np.ceil(max(effort.phi * phi, MIN_PHI) / 8))


def seconds(hair: Hair, pace: Pace, effort: Effort, phi: int) -> float:
    """What the first round will take, about."""
    rows, phi = hair.row_count(effort.intervals), phi_cells(effort, phi)
    offsets = hair.offset_count(effort.offset)
    cells = offsets * effort.theta_i * phi
    edges = FINE * min(effort.edge_offsets, offsets) * effort.edge_azimuths
    measured = effort.viewers * min(effort.measured_offsets, offsets) * promise.POINTS * effort.around * phi
    values = (rows + 4) * (cells * GAUSS.size**2 + edges) + (2 + effort.repeats) * measured
    return values * pace.value + (rows * STEPS + 3 * STEPS_OF_CHOICE) * cells * pace.cell
