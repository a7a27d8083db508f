# SPDX-License-Identifier: BSD-3-Clause
"""A mixture in the engine's arrays: shares and turns of the lobes at theta_r, an offset and the parameters of
the hair (mixture.py)."""

from __future__ import annotations

from collections.abc import Sequence

import drjit as dr
import mitsuba as mi
import numpy as np

from ..axes import Parameter, node_count
from ..mixture import Mixture
from .arrays import Number, Records
from .nodes import ONE_CORNER, Corner, Nodes, ParameterAxis, corners, steps


class Mix:
    """Blended over the nodes around the parameters, then bilinear in theta_r and asin(offset), turns along
    the shorter arc."""

    def __init__(self, mixture: Mixture, parameters: Sequence[Parameter] = ()) -> None:
        self._lobes = len(mixture.lobes)
        self._mirrored = mixture.mirrored
        self._nodes = Nodes(
            [mixture.theta_r, np.arcsin(mixture.offset), *(axis.nodes for axis in mixture.axes)]
        )
        names = [parameter.name for parameter in parameters]
        self._parameters = [names.index(axis.name) for axis in mixture.axes]
        self._steps = steps([len(axis.nodes) for axis in mixture.axes])
        values = np.stack([mixture.share / mixture.share.sum(axis=0), mixture.turn], -1)
        grid = len(mixture.theta_r), len(mixture.offset)
        values = values.reshape(self._lobes, node_count(mixture.axes), *grid, 2).swapaxes(0, 1)
        low_j, low_n = (np.arange(count) for count in self._nodes.intervals[:2])
        high_j, high_n = (np.minimum(low + 1, n - 1) for low, n in zip((low_j, low_n), grid, strict=True))
        around = [values[:, :, j][:, :, :, n] for j in (low_j, high_j) for n in (low_n, high_n)]
        self._around = Records(np.concatenate(around, -1).reshape(-1, 8))

    def at(
        self, theta_r: Number, offset: Number, values: Sequence[Number] = ()
    ) -> tuple[list[Number], list[Number], Number]:
        """(share of each lobe, its turn, side): relative azimuth = side (azimuth of the table + turn).
        values: of the model's parameters, in order."""
        mirror = (offset < 0) & mi.Bool(self._mirrored)
        offset = dr.minimum(dr.maximum(offset, -1), 1)
        (rows, columns), (_, arcs) = self._nodes.intervals[:2], self._nodes.first[:2]
        j, t = self._nodes.at(0, rows, theta_r)
        n, s = self._nodes.at(arcs, columns, dr.asin(dr.abs(offset) if self._mirrored else offset))
        shares, turns = [], []
        around = self._corners(values)
        for k in range(self._lobes):
            a, a_turn, b, b_turn, c, c_turn, d, d_turn = self._blend((k * rows + j) * columns + n, around)
            shares.append((1 - s) * ((1 - t) * a + t * c) + s * ((1 - t) * b + t * d))
            turns.append(_shorter_arc(_shorter_arc(a_turn, c_turn, t), _shorter_arc(b_turn, d_turn, t), s))
        return shares, turns, dr.select(mirror, -1.0, 1.0)

    def _corners(self, values: Sequence[Number]) -> list[Corner]:
        axes = zip(
            self._nodes.first[2:], self._nodes.intervals[2:], self._parameters, self._steps, strict=True
        )
        around = [ParameterAxis(first, count, values[p], step) for first, count, p, step in axes]
        return corners(self._nodes, around) if around else ONE_CORNER

    def _blend(self, record: Number, around: Sequence[Corner]) -> list[Number]:
        """(share, turn) four times: turns are blended along the shorter arcs from the first corner's."""
        if around is ONE_CORNER:
            return self._around[record]
        pitch = self._lobes * self._nodes.intervals[0] * self._nodes.intervals[1]
        rows = [(weight, self._around[record + node * pitch]) for node, weight in around]
        lowest = rows[0][1]
        shares = [sum(weight * row[k] for weight, row in rows) for k in (0, 2, 4, 6)]
        turns = [
            lowest[k] + sum(weight * wrap(row[k] - lowest[k]) for weight, row in rows[1:])
            for k in (1, 3, 5, 7)
        ]
        return [part for pair in zip(shares, turns, strict=True) for part in pair]


def wrap(angle: Number) -> Number:
    """The angle in [-pi, pi)."""
    return angle - dr.two_pi * dr.floor((angle + dr.pi) / dr.two_pi)


def _shorter_arc(a: Number, b: Number, t: Number) -> Number:
    return a + t * wrap(b - a)
