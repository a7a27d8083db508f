# SPDX-License-Identifier: BSD-3-Clause
"""How much of a box of hairs a budget of seconds lets a fit look at: the counts of its first round."""

from __future__ import annotations

from dataclasses import dataclass

from ..cells import AROUND, FINE, GAUSS, HARMONICS, PLACES
from ..effort import Pace
from ..promise import POINTS

FIRST_ROUND = 0.8  # of the budget
CHOICE = 400  # sweeps of a block while the number of lobes is chosen
SWEEP = 7.0  # steps of factor.py that a sweep of turned lobes takes as long as
SHARES = 20  # of a block whose shares and turns alone are fitted
PARTS = 1 / 6, 1 / 3, 1 / 2, 2 / 3, 5 / 6
"""Parts of the way through the rows at which dependences are found: grazing, hair is unlike elsewhere."""
MODES = 3.0  # times that lobes are followed along a parameter
TOGETHER = 3.0  # places that are fitted together
PAIRS = 48  # places, at most, at which an axis' part of the loss is measured
NODES = 8.0  # of a parameter
MIXED = 12.0  # of the mixture


@dataclass(frozen=True)
class BoxEffort:
    """rows: of theta_r; offset: of the mixture; fitted_offsets: by which shapes are fitted; theta_i: cells;
    most_phi: cells of the azimuth, at most; steps: values of a parameter along which lobes are followed;
    candidates: such values, at most, where steps are too far apart for the tolerance;
    sweeps: of a block's lobes; corners: of the box that are looked at; places: that are measured; nodes: of
    the mixture, all its parameters together; edge_azimuths: by which cells of theta_i are chosen;
    edges_of_phi: whether grazing viewers too choose the cells of the azimuth."""

    rows: int = 49
    offset: int = 25
    fitted_offsets: int = 9
    theta_i: int = 32
    most_phi: int = 384
    steps: int = 9
    candidates: int = 24
    sweeps: int = 24
    corners: int = 8
    places: int = 384
    nodes: int = 128
    edge_azimuths: int = AROUND
    edges_of_phi: bool = True


FULL = BoxEffort()
EFFORTS = (
    FULL,
    BoxEffort(25, 13, 9, 24, 192, 9, 24, 16, 8, 192, 64, AROUND // 2),
    BoxEffort(13, 9, 7, 24, 96, 5, 9, 12, 4, 96, 24, AROUND // 3, False),
    BoxEffort(13, 7, 5, 16, 64, 5, 7, 8, 2, 48, 12, AROUND // 4, False),
)
"""From full to least."""


def affordable(pace: Pace, parameters: int, offsets: bool, phi: int, budget: float) -> BoxEffort:
    """The largest effort whose first round fits its part of the budget, or the least; phi: cells of the
    azimuth at full effort."""
    return next(
        (e for e in EFFORTS if seconds(pace, e, parameters, offsets, phi) < FIRST_ROUND * budget), EFFORTS[-1]
    )


def seconds(pace: Pace, effort: BoxEffort, parameters: int, offsets: bool, phi: int) -> float:
    """What the first round will take, about."""
    cells = effort.theta_i * min(phi, effort.most_phi) * (effort.fitted_offsets if offsets else 1)
    along = parameters * effort.steps * MODES * len(PARTS) * TOGETHER
    shares = MIXED * effort.rows * (effort.offset / effort.fitted_offsets if offsets else 1)
    blocks = 2 * effort.corners + along + NODES * effort.rows * 2 + shares
    sweeps = 2 * effort.corners * CHOICE + (along + NODES * effort.rows * 2) * effort.sweeps + shares * SHARES
    edges = blocks * 3 * FINE * effort.edge_azimuths
    viewers = 3 if effort.edges_of_phi else 1
    of_phi = viewers * (effort.fitted_offsets / 2 if offsets else 1) * sum(PLACES) * HARMONICS
    of_phi *= 2 * effort.corners + along / len(PARTS) / 2 + NODES + MIXED
    measured = (effort.places + 4 * pairs(effort)) * (
        sum(PLACES) * HARMONICS + (4 if offsets else 1) * POINTS * 2 * phi
    )
    values = blocks * cells * GAUSS.size**2 + edges + of_phi + measured
    return cells * sweeps * SWEEP * pace.cell + values * pace.value


def pairs(effort: BoxEffort) -> int:
    """Places at which an axis' part of the loss is measured."""
    return min(PAIRS, effort.places // 2)
