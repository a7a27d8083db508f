# SPDX-License-Identifier: BSD-3-Clause
"""A baked model of draws: their lobes (draws.py) as tables, and over the offset where the draws have one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..lobes import HALF_PI, Array
from ..model import BakedModel
from . import draws as smoothing
from .cells import Cells
from .lobesfit import Row
from .read import Draws
from .refine import bake, fit_rows
from .turning import TWO_PI

NARROW = np.radians(0.5)  # range around the only theta_r
INTERVALS = 12  # of the tables' rows, at least
TABLE_LOSS = 1e-3
NODES = 9  # of the offset, where draws have more different ones
MOST_NODES = 17
MAX_LOBES = 4


@dataclass(frozen=True)
class Drawn:
    """A baked model; V of draws left out, and its standard error; apparent: what the cells alone would
    show."""

    model: BakedModel
    variance: float
    error: float
    apparent: float
    kernel: float
    pooled: float


def fit(data: Draws, name: str, lobes: int | None) -> Drawn:
    """Fits, bakes and cross-validates draws."""
    found = smoothing.fit(data, lobes)
    if data.offset is not None and np.ptp(data.offset) > 0:
        return _over_offsets(data, name, lobes, found)
    rows = [
        Row(theta.T, phi, share[None], np.zeros((1, len(share))))
        for theta, phi, share in zip(
            found.lobes.theta.swapaxes(0, 1), found.lobes.phi.swapaxes(0, 1), found.lobes.share.T, strict=True
        )
    ]
    model = _baked(found.counted.theta_r, np.zeros(1), rows, name, False)
    return Drawn(model, found.variance, found.error, found.apparent, found.choice.width, found.choice.reach)


def _baked(theta_r: Array, offset: Array, rows: list[Row], name: str, mirrored: bool) -> BakedModel:
    theta_r, rows = _even(theta_r, rows)
    edges = np.tile(np.linspace(-HALF_PI, HALF_PI, rows[0].theta.shape[0] + 1), (len(theta_r), 1))
    none = np.zeros((0,))
    return bake(Cells(theta_r, offset, edges, none, none), rows, name, mirrored, TABLE_LOSS)


def _even(theta_r: Array, rows: list[Row]) -> tuple[Array, list[Row]]:
    """Rows at even theta_r: between two, inclinations at the same angle from the mirror direction are
    blended."""
    if len(rows) == 1:
        return np.array([theta_r[0] - NARROW, theta_r[0] + NARROW]), rows * 2
    between = len(rows) - 1
    even = np.allclose(np.diff(theta_r), np.diff(theta_r).mean(), rtol=1e-3)
    intervals = between * -(-INTERVALS // between) if even else 3 * INTERVALS
    wanted = np.linspace(theta_r[0], theta_r[-1], intervals + 1)
    n = rows[0].theta.shape[0]
    middles = (np.arange(n) + 0.5) * (np.pi / n) - HALF_PI
    made = []
    for at in wanted:
        place = float(np.interp(at, theta_r, np.arange(len(rows))))
        j = min(int(place), between - 1)
        parts = [(rows[i], theta_r[i], t) for i, t in ((j, 1 - (place - j)), (j + 1, place - j)) if t > 1e-9]
        theta = sum(
            t * np.stack([np.interp(middles + at - here, middles, one) for one in row.theta.T], axis=1)
            for row, here, t in parts
        )
        phi, share, turn = (
            sum(t * getattr(row, name) for row, _, t in parts) for name in ("phi", "share", "turn")
        )
        made.append(Row(theta / theta.sum(axis=0), phi, share, turn))
    return wanted, made


# ---- draws with offsets


def _over_offsets(data: Draws, name: str, lobes: int | None, whole: smoothing.FromDraws) -> Drawn:
    """Lobes that turn with the offset, fitted to smoothed cells; how many, as half of the draws tell the
    other."""
    theta_r = whole.counted.theta_r
    offset = _nodes(data.offset)
    angle = np.arcsin(np.clip(offset, -1, 1))
    half = np.random.default_rng(1).permutation(data.theta_r.size) % 2
    parts = [_counts(data, theta_r, angle, half == k) for k in range(2)]
    counts = range(1, MAX_LOBES + 1) if lobes is None else (lobes,)
    best = None
    for count in counts:
        gains, costs = [], []
        for train, test in (parts, parts[::-1]):
            q = np.stack(
                [row.drawn() for row in _rows(train, theta_r, offset, angle, count, whole.choice.width)]
            )
            q = (1 - smoothing.FLOOR) * q + smoothing.FLOOR / q[0, 0].size
            gains.append((test * np.log(q)).sum())
            costs.append(_pairs(test, q))
        if best is not None and sum(gains) <= best[0] + np.sqrt(len(data.weight)):
            break
        best = sum(gains), count, costs
    _, count, costs = best
    both = parts[0] + parts[1]
    rows = _rows(both, theta_r, offset, angle, count, whole.choice.width)
    mass = both / np.maximum(both.sum(axis=(2, 3), keepdims=True), 1e-300)
    q = np.maximum(np.stack([row.drawn() for row in rows]), 1e-12)
    apparent = float(((mass**2 / q).sum(axis=(2, 3)) - 1).mean())
    model = _baked(theta_r, offset, rows, name, bool(offset[0] >= 0))
    error = abs(costs[0] - costs[1]) / 2
    return Drawn(model, float(np.mean(costs)), error, apparent, whole.choice.width, whole.choice.reach)


def _nodes(offset: Array) -> Array:
    different = np.unique(offset)
    if len(different) <= MOST_NODES:
        return different
    low, high = np.arcsin(different[[0, -1]])
    return np.sin(np.linspace(low, high, NODES if low >= 0 else 2 * NODES - 1))


def _counts(data: Draws, theta_r: Array, angle: Array, which: Array) -> Array:
    """(J, N, n, m) weights of the draws in cells of the nearest theta_r and offset."""
    t, i, p, w, h = (getattr(data, n)[which] for n in ("theta_r", "theta_i", "phi", "weight", "offset"))
    j = np.rint(np.interp(t, theta_r, np.arange(len(theta_r)))).astype(int)
    o = np.rint(np.interp(np.arcsin(h), angle, np.arange(len(angle)))).astype(int)
    i = np.clip(i + t - theta_r[j], -HALF_PI, HALF_PI)
    n, m = smoothing.THETA // 2, smoothing.PHI
    bins = (
        np.arange(len(theta_r) + 1) - 0.5,
        np.arange(len(angle) + 1) - 0.5,
        np.linspace(-HALF_PI, HALF_PI, n + 1),
        np.linspace(0, TWO_PI, m + 1),
    )
    return np.histogramdd((j, o, i, np.mod(p, TWO_PI)), bins=bins, weights=w)[0]


def _rows(count: Array, theta_r: Array, offset: Array, angle: Array, lobes: int, width: float) -> list[Row]:
    """Turning lobes of smoothed cells."""
    draws = max(float(np.median(count.sum(axis=(2, 3)))), 1.0)
    n, m = count.shape[2:]
    b = width * draws ** (-1 / 6)  # of a spread of one radian; two dimensions
    theta = (np.arange(n) + 0.5) * (np.pi / n)
    phi = (np.arange(m) + 0.5) * (TWO_PI / m)
    along = np.exp(-0.5 * ((theta[:, None] - theta) / max(0.25 * b, np.pi / n / 2)) ** 2)
    around = np.exp(-0.5 * (np.angle(np.exp(1j * (phi[:, None] - phi))) / max(0.5 * b, TWO_PI / m / 2)) ** 2)
    along /= along.sum(axis=1, keepdims=True)
    around /= around.sum(axis=1, keepdims=True)
    mass = along.T @ count @ around + 1e-6
    mass /= mass.sum(axis=(2, 3), keepdims=True)
    edges = np.tile(np.linspace(-HALF_PI, HALF_PI, n + 1), (len(theta_r), 1))
    light = np.ones(mass.shape[:2])
    return fit_rows(Cells(theta_r, offset, edges, mass.astype(np.float32), light), angle, lobes, True)


def _pairs(count: Array, q: Array) -> float:
    """V of counts (J, N, n, m) for draws by q, from pairs of draws in a cell."""
    n = count.sum(axis=(2, 3))
    pairs = n * (n - 1)
    found = (count * np.maximum(count - 1, 0) / q).sum(axis=(2, 3)) / np.maximum(pairs, 1e-300) - 1
    return float(np.average(found, weights=np.maximum(pairs, 0) + 1e-300))
