# SPDX-License-Identifier: BSD-3-Clause
"""A mixture in the engine's arrays: shares and turns of the lobes at theta_r and an offset (mixture.py)."""

from __future__ import annotations

import drjit as dr
import mitsuba as mi
import numpy as np

from ..mixture import Mixture
from .arrays import Number, Records, last


class Mix:
    """Bilinear in theta_r and asin(offset), turns along the shorter arc."""

    def __init__(self, mixture: Mixture) -> None:
        self._lobes = len(mixture.lobes)
        self._mirrored = mixture.mirrored
        self._theta_r, self._angle = _Nodes(mixture.theta_r), _Nodes(np.arcsin(mixture.offset))
        values = np.stack([mixture.share / mixture.share.sum(axis=0), mixture.turn], -1)  # (K, J, N, 2)
        low_j, low_n = np.arange(self._theta_r.intervals), np.arange(self._angle.intervals)
        high_j, high_n = (
            np.minimum(low + 1, n - 1) for low, n in zip((low_j, low_n), values.shape[1:3], strict=True)
        )
        corners = [values[:, j][:, :, n] for j in (low_j, high_j) for n in (low_n, high_n)]
        self._corners = Records(np.concatenate(corners, -1).reshape(-1, 8))

    def at(self, theta_r: Number, offset: Number) -> tuple[list[Number], list[Number], Number]:
        """(share of each lobe, its turn, side): relative azimuth = side (azimuth of the table + turn)."""
        mirror = (offset < 0) & mi.Bool(self._mirrored)
        offset = dr.minimum(dr.maximum(offset, -1), 1)
        j, t = self._theta_r.at(theta_r)
        n, s = self._angle.at(dr.asin(dr.abs(offset) if self._mirrored else offset))
        shares, turns = [], []
        for k in range(self._lobes):
            a, a_turn, b, b_turn, c, c_turn, d, d_turn = self._corners[
                (k * self._theta_r.intervals + j) * self._angle.intervals + n
            ]
            shares.append((1 - s) * ((1 - t) * a + t * c) + s * ((1 - t) * b + t * d))
            turns.append(_shorter_arc(_shorter_arc(a_turn, c_turn, t), _shorter_arc(b_turn, d_turn, t), s))
        return shares, turns, dr.select(mirror, -1.0, 1.0)


class _Nodes:
    """Increasing numbers, and where x lies among them."""

    def __init__(self, nodes: np.ndarray) -> None:
        self.intervals = max(len(nodes) - 1, 1)
        low, high = (nodes[:-1], nodes[1:]) if len(nodes) > 1 else (nodes, nodes + 1)
        self._ends = Records(np.stack([low, 1 / (high - low)], -1))

    def at(self, x: Number) -> tuple[Number, Number]:
        """(interval, part of the way along it), x clamped to the nodes' range."""
        i = last(self.intervals, self.intervals, lambda i: self._ends[i][0] <= x)
        low, scale = self._ends[i]
        return i, dr.minimum(dr.maximum((x - low) * scale, 0), 1)


def wrap(angle: Number) -> Number:
    """The angle in [-pi, pi)."""
    return angle - dr.two_pi * dr.floor((angle + dr.pi) / dr.two_pi)


def _shorter_arc(a: Number, b: Number, t: Number) -> Number:
    return a + t * wrap(b - a)
