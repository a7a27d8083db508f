# SPDX-License-Identifier: BSD-3-Clause
"""Where numbers lie among nodes, and the corners around the parameters of a strand (axes.py), in the engine's
arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import drjit as dr
import numpy as np

from .arrays import Number, Records, last

Corner = tuple[Number, Number]  # number of a node among all of a grid, and its weight
ONE_CORNER: list[Corner] = [(0, 1.0)]


class Nodes:
    """Scales of increasing numbers, one behind another.

    first, intervals  of each scale: number of its first interval, and how many it has
    """

    def __init__(self, scales: Sequence[np.ndarray]) -> None:
        self.intervals = [max(len(nodes) - 1, 1) for nodes in scales]
        self.first = [sum(self.intervals[:k]) for k in range(len(scales))]
        ends = [(nodes[:-1], nodes[1:]) if len(nodes) > 1 else (nodes, nodes + 1) for nodes in scales]
        self._ends = Records(np.concatenate([np.stack([low, 1 / (high - low)], -1) for low, high in ends]))
        self._most = max(self.intervals)

    def at(self, first: Number, intervals: Number, x: Number) -> tuple[Number, Number]:
        """(interval, part of the way along it) on the scale of these intervals, x clamped to its range."""
        i = last(intervals, self._most, lambda i: self._ends[first + i][0] <= x)
        low, scale = self._ends[first + i]
        return i, dr.minimum(dr.maximum((x - low) * scale, 0), 1)


@dataclass(frozen=True)
class ParameterAxis:
    """An axis of a grid: its scale among Nodes, the value of its parameter, and nodes of the grid from one of
    its own to the next."""

    first: Number
    intervals: Number
    value: Number
    step: Number


def corners(nodes: Nodes, axes: Sequence[ParameterAxis]) -> list[Corner]:
    """The 2^d nodes around d values; that below them on every axis comes first."""
    found = ONE_CORNER
    for axis in axes:
        i, t = nodes.at(axis.first, axis.intervals, axis.value)
        sides = ((0, 1 - t), (1, t))
        found = [
            (node + (i + side) * axis.step, weight * part) for node, weight in found for side, part in sides
        ]
    return found


def steps(counts: Sequence[int]) -> list[int]:
    """Nodes of a grid from one of an axis to the next; the first axis is the slowest."""
    return [int(np.prod(counts[k + 1 :], dtype=int)) for k in range(len(counts))]


def blend(records: Records, first: Number, pitch: Number, around: Sequence[Corner]) -> list[Number]:
    """The numbers of record `first`, and of those `pitch` records further for each node, blended."""
    if around is ONE_CORNER:
        return records[first]
    rows = [(weight, records[first + node * pitch]) for node, weight in around]
    return [sum(weight * row[k] for weight, row in rows) for k in range(len(rows[0][1]))]
