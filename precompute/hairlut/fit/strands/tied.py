# SPDX-License-Identifier: BSD-3-Clause
"""Lobes that share their shapes: the light of several viewers and parameter values at once.

A block is the light of one theta_r at one place in the box, at all offsets. Blocks that name the same key of
theta have the same inclinations, those that name the same key of phi the same azimuths; shares and turns are
each block's own. The updates are those of lobesfit.py: a shape's is the sum over its blocks.

Many sets of lobes draw the light of one hair equally well, in mixtures of each other. Only the set whose
shapes stay where a parameter changes the lobes' shares draws several, so that blocks together tell a hair's
lobes apart."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace

import numpy as np

from ...lobes import Array
from ..factor import POWER, excess, filled
from ..lobesfit import FAINT, LEAST_SHARE, Row, evened, stepped
from ..turning import turned

FRESH = 0.005  # part of an expected shape that is replaced by the light, or by an even azimuth


@dataclass(frozen=True)
class Block:
    """mass (N, n, m): cells of the light, of sum 1 at each offset; keys of its shapes."""

    mass: Array
    theta: Hashable
    phi: Hashable


class _Means:
    """Weighted means by key: of the sums of values, divided by those of weights."""

    def __init__(self) -> None:
        self._sums: dict[Hashable, tuple[Array, Array]] = {}

    def add(self, key: Hashable, value: Array, weight: Array | float) -> None:
        sums = self._sums.get(key, (0.0, 0.0))
        self._sums[key] = sums[0] + value, sums[1] + weight

    def all(self) -> dict[Hashable, Array]:
        return {key: value / weight for key, (value, weight) in self._sums.items()}


def improved(
    blocks: list[Block], rows: list[Row], angle: Array, sweeps: int, turning: bool, moving: tuple[bool, bool]
) -> list[Row]:
    """The blocks' rows after sweeps of updates. angle (N,): of the offsets around the fibre; moving: whether
    inclinations and azimuths do. A lobe without light keeps its shapes, and its turns where it has none."""
    lights = _lights(blocks)
    expected, rows = list(rows), list(rows)
    for sweep in range(sweeps):
        theta, phi = _Means(), _Means()
        for i, (block, row) in enumerate(zip(blocks, rows, strict=True)):
            if turning and sweep % 2:
                row = replace(row, turn=stepped(row, block.mass, angle, expected[i]))
            rows[i] = _updated(block, row, theta, phi, moving)
        rows = _moved(blocks, rows, expected, theta.all(), phi.all(), lights)
    return rows


def started(blocks: list[Block], rows: list[Row], moving: tuple[bool, bool]) -> list[Row]:
    """Rows as they are expected, with a little of the light in the shapes that move, so that these can."""
    lights = _lights(blocks)
    light, even = FRESH * moving[0], FRESH * moving[1]
    return [
        replace(
            row,
            theta=(1 - light) * row.theta + light * lights[block.theta],
            phi=(1 - even) * row.phi + even / row.phi.shape[1],
        )
        for block, row in zip(blocks, rows, strict=True)
    ]


def with_common_azimuths(blocks: list[Block], rows: list[Row]) -> list[Row]:
    """The rows with the mean azimuths of their keys, weighted by the lobes' light."""
    phi = _Means()
    for block, row in zip(blocks, rows, strict=True):
        share = row.share.mean(axis=0)[:, None]
        phi.add(block.phi, share * row.phi, share)
    means = phi.all()
    return [replace(row, phi=means[block.phi]) for block, row in zip(blocks, rows, strict=True)]


def variance(blocks: list[Block], rows: list[Row]) -> float:
    """Mean relative variance over the blocks."""
    return float(np.mean([row.variance(block.mass) for block, row in zip(blocks, rows, strict=True)]))


def _lights(blocks: list[Block]) -> dict[Hashable, Array]:
    """(n, 1) the mean light over theta_i of each key of theta."""
    means = _Means()
    for block in blocks:
        means.add(block.theta, block.mass.sum(axis=2).mean(axis=0)[:, None], 1.0)
    return means.all()


def _updated(block: Block, row: Row, theta: _Means, phi: _Means, moving: tuple[bool, bool]) -> Row:
    """The row with its shares updated; what its shapes gain is added to the means."""
    at = row.turned()
    azimuths = row.share[..., None] * at
    e = excess(block.mass, np.matmul(row.theta, azimuths))
    gain = np.matmul(row.theta.T, e)  # (N, K, m)
    if moving[0]:
        theta.add(
            block.theta,
            np.matmul(e, azimuths.transpose(0, 2, 1)).sum(axis=0),
            azimuths.sum(axis=(0, 2)),
        )
    if moving[1]:
        back = turned(gain, -row.turn) if row.turn.any() else gain  # turning back is turning's adjoint
        phi.add(block.phi, (row.share[..., None] * back).sum(axis=0), row.share.sum(axis=0)[:, None])
    share = np.maximum(row.share * np.einsum("okm,okm->ok", gain, at) ** (1 / POWER), LEAST_SHARE)
    return replace(row, share=share / share.sum(axis=1, keepdims=True))


def _moved(
    blocks: list[Block],
    rows: list[Row],
    expected: list[Row],
    theta: dict[Hashable, Array],
    phi: dict[Hashable, Array],
    lights: dict[Hashable, Array],
) -> list[Row]:
    """The rows with the shapes that the gains of their keys make of theirs."""
    light = _Means()
    for block, row in zip(blocks, rows, strict=True):
        light.add(("theta", block.theta), row.share.mean(axis=0), 1.0)
        light.add(("phi", block.phi), row.share.mean(axis=0), 1.0)
    known = {key: share / (share + FAINT) for key, share in light.all().items()}
    made: dict[Hashable, Array] = {}
    for block, row, before in zip(blocks, rows, expected, strict=True):
        key = "theta", block.theta
        if block.theta in theta and key not in made:
            shape = filled(row.theta * theta[block.theta] ** (1 / POWER), lights[block.theta])
            made[key] = known[key] * shape + (1 - known[key]) * before.theta
        key = "phi", block.phi
        if block.phi in phi and key not in made:
            shape, part = row.phi * np.maximum(phi[block.phi], 0) ** (1 / POWER), known[key][:, None]
            made[key] = part * evened(shape) + (1 - part) * before.phi
    return [
        replace(
            row,
            theta=made.get(("theta", block.theta), row.theta),
            phi=made.get(("phi", block.phi), row.phi),
        )
        for block, row in zip(blocks, rows, strict=True)
    ]
