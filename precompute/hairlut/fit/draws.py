# SPDX-License-Identifier: BSD-3-Clause
"""Draws of a hair's scattering as lobes: smoothed products, with no shape assumed.

Each lobe's inclinations and azimuths are histograms of the draws that it explains, smoothed by a Gaussian
kernel, and pooled over neighbouring theta_r in the angle from the mirror direction; which draws a lobe
explains follows from the lobes (Benaglia, Chauveau and Hunter 2009, for mixtures of products). How much is
smoothed and pooled, and how many lobes there are, is what makes draws that were left out most probable: a
lobe has to gain more than its noise.

What the lobes lose is measured on draws left out too. With n_c of n draws in the cell c, n_c (n_c - 1) / (n
(n - 1)) is right on average for the square of its mass, so that

    V = sum over c of n_c (n_c - 1) / (n (n - 1) q_c) - 1

has no noise of its own added, q being fitted to the other draws.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..lobes import HALF_PI, Array
from .read import Draws
from .turning import TWO_PI

THETA, PHI = 96, 72  # cells
FEW = 64  # so many different theta_r, or fewer, are rows of their own
ROWS = 19  # else
FOLDS = 4
STEPS = 60  # of expectation maximisation
WIDTHS = 0.4, 0.7, 1.0, 1.4  # of the kernel, in Silverman's
REACHES = 0.0, 1.0, 2.0, 1e3  # of pooling, in rows
MAX_LOBES = 4
SHARPEST, BROADEST = 2.0, 0.5  # powers of all inclinations from which the lobes' start
SURE = 2.0  # standard errors by which a lobe has to gain
FLOOR = 1e-3  # share of the light that is even: a draw left out may lie anywhere


@dataclass(frozen=True)
class Counted:
    """theta_r (J,); count (J, n, m) weights of the draws in even cells; draws (J,) how many there are,
    effectively."""

    theta_r: Array
    count: Array
    draws: Array


@dataclass(frozen=True)
class Smoothed:
    """theta (K, J, n) and phi (K, J, m) masses of sum 1; share (K, J) of sum 1 over K."""

    theta: Array
    phi: Array
    share: Array

    def drawn(self) -> Array:
        """(J, n, m) masses of the cells."""
        mass = np.einsum("kj,kjn,kjm->jnm", self.share, self.theta, self.phi, optimize=True)
        return (1 - FLOOR) * mass + FLOOR / mass[0].size


@dataclass(frozen=True)
class Choice:
    """width of the kernel, reach of the pooling, and how many lobes."""

    width: float
    reach: float
    lobes: int


@dataclass(frozen=True)
class FromDraws:
    """The lobes of all draws; V of those left out, its standard error, and what the cells alone would
    show."""

    counted: Counted
    lobes: Smoothed
    choice: Choice
    variance: float
    error: float
    apparent: float


def fit(draws: Draws, lobes: int | None) -> FromDraws:
    """The lobes of draws, whatever their offsets."""
    fold = np.random.default_rng(0).permutation(draws.theta_r.size) % FOLDS
    rows = _rows(draws.theta_r)
    parts = [_counted(draws, rows, fold == k) for k in range(FOLDS)]
    whole = _sum(parts)
    trains = [_sum([part for i, part in enumerate(parts) if i != k]) for k in range(FOLDS)]
    choice = _choice(trains, parts, lobes)
    squares = []
    for train, test in zip(trains, parts, strict=True):
        q = smoothed(train, choice).drawn()
        squares.append(_variance(test, q))
    found = smoothed(whole, choice)
    mass = whole.count / np.maximum(whole.count.sum(axis=(1, 2), keepdims=True), 1e-300)
    cost = (mass**2 / found.drawn()).sum(axis=(1, 2)) - 1
    return FromDraws(
        whole,
        found,
        choice,
        float(np.mean(squares)),
        float(np.std(squares, ddof=1) / np.sqrt(FOLDS)),
        float(np.average(cost, weights=whole.draws)),
    )


def smoothed(data: Counted, choice: Choice) -> Smoothed:
    """The lobes of the counts, by expectation maximisation with smoothing."""
    pool = _Pool(data, choice)
    every = pool.theta(data.count.sum(axis=2))
    around = pool.phi(data.count.sum(axis=1))
    powers = np.geomspace(SHARPEST, BROADEST, choice.lobes) if choice.lobes > 1 else np.ones(1)
    theta = np.stack([_normal(every**power) for power in powers])
    lobes = Smoothed(
        theta,
        np.broadcast_to(around, (choice.lobes, *around.shape)),
        np.full((choice.lobes, len(data.theta_r)), 1 / choice.lobes),
    )
    for _ in range(STEPS if choice.lobes > 1 else 0):
        lobes = _better(lobes, data, pool)
    return lobes


def _better(lobes: Smoothed, data: Counted, pool: _Pool) -> Smoothed:
    q = np.maximum(np.einsum("kj,kjn,kjm->jnm", lobes.share, lobes.theta, lobes.phi, optimize=True), 1e-300)
    ratio = data.count / q
    theta = lobes.share[..., None] * lobes.theta * np.einsum("jnm,kjm->kjn", ratio, lobes.phi, optimize=True)
    phi = lobes.share[..., None] * lobes.phi * np.einsum("jnm,kjn->kjm", ratio, lobes.theta, optimize=True)
    share = np.stack([pool.over_rows(one.sum(axis=1)) for one in theta])
    return Smoothed(
        np.stack([pool.theta(one) for one in theta]),
        np.stack([pool.phi(one) for one in phi]),
        share / np.maximum(share.sum(axis=0), 1e-300),
    )


class _Pool:
    """Smoothing along the angles and over theta_r."""

    def __init__(self, data: Counted, choice: Choice):
        theta_r = data.theta_r
        step = np.median(np.diff(theta_r)) if len(theta_r) > 1 else 1.0
        apart = (theta_r[:, None] - theta_r) / step
        reach = max(choice.reach, 1e-6)
        self._rows = np.exp(-0.5 * (apart / reach) ** 2)
        self._theta_r, self._width = theta_r, choice.width
        self._middles = (np.arange(THETA) + 0.5) * (np.pi / THETA) - HALF_PI
        self._draws = data.draws

    def over_rows(self, amount: Array) -> Array:
        """(J, ...) amounts, of each theta_r and of those near it."""
        return np.tensordot(self._rows, amount, 1)

    def theta(self, mass: Array) -> Array:
        """(J, n) masses of theta_i, pooled in the angle from the mirror direction, smoothed, of sum 1."""
        middles = self._middles
        pooled = np.zeros_like(mass)
        for j, at in enumerate(self._theta_r):
            for other in np.flatnonzero(self._rows[j] > 1e-3):
                moved = np.interp(middles + at - self._theta_r[other], middles, mass[other], left=0, right=0)
                pooled[j] += self._rows[j, other] * moved
        span = np.pi
        away = abs(middles[:, None] - middles)
        folded = np.minimum(abs(middles[:, None] + middles - span), abs(middles[:, None] + middles + span))
        result = []
        for row, draws in zip(pooled, self.over_rows(self._draws), strict=True):
            mean = row @ middles / max(row.sum(), 1e-300)
            spread = np.sqrt(max(row @ (middles - mean) ** 2 / max(row.sum(), 1e-300), 1e-6))
            b = self._bandwidth(spread, draws, np.pi / THETA)
            kernel = np.exp(-0.5 * (away / b) ** 2) + np.exp(-0.5 * (folded / b) ** 2)
            result.append(_normal(row @ (kernel / kernel.sum(axis=1, keepdims=True))))
        return np.array(result)

    def phi(self, mass: Array) -> Array:
        """(J, m) masses of the azimuth, pooled, smoothed around the circle, of sum 1."""
        pooled = self.over_rows(mass)
        middles = (np.arange(PHI) + 0.5) * (TWO_PI / PHI)
        away = abs(np.angle(np.exp(1j * (middles[:, None] - middles))))
        result = []
        for row, draws in zip(pooled, self.over_rows(self._draws), strict=True):
            length = abs(row @ np.exp(1j * middles)) / max(row.sum(), 1e-300)
            spread = np.sqrt(-2 * np.log(np.clip(length, 0.05, 1 - 1e-6)))
            b = self._bandwidth(spread, draws, TWO_PI / PHI)
            kernel = np.exp(-0.5 * (away / b) ** 2)
            result.append(_normal(row @ (kernel / kernel.sum(axis=1, keepdims=True))))
        return np.array(result)

    def _bandwidth(self, spread: float, draws: float, cell: float) -> float:
        return max(self._width * 1.06 * spread * max(draws, 1.0) ** -0.2, cell / 4)


def _choice(trains: list[Counted], tests: list[Counted], lobes: int | None) -> Choice:
    """What makes draws left out most probable."""

    def gains(choice: Choice) -> Array:
        parts = zip(trains, tests, strict=True)
        return np.array(
            [(test.count * np.log(smoothed(train, choice).drawn())).sum() for train, test in parts]
        )

    one = max((Choice(1.0, r, 1) for r in REACHES), key=lambda choice: gains(choice).sum())
    one = max((Choice(w, one.reach, 1) for w in WIDTHS), key=lambda choice: gains(choice).sum())
    if lobes:
        return Choice(one.width, one.reach, lobes)
    best, found = one, gains(one)
    for count in range(2, MAX_LOBES + 1):
        more = Choice(one.width, one.reach, count)
        here = gains(more)
        gain = here - found
        if gain.sum() <= SURE * gain.std(ddof=1) * np.sqrt(FOLDS):
            break
        best, found = more, here
    return best


def _variance(test: Counted, q: Array) -> float:
    """V of the counts for draws by q, the mean over theta_r, weighted by pairs."""
    n = test.draws
    pairs = np.maximum(n * (n - 1), 1e-300)
    scale = n / np.maximum(test.count.sum(axis=(1, 2)), 1e-300)
    count = test.count * scale[:, None, None]
    found = (count * np.maximum(count - 1, 0) / q).sum(axis=(1, 2)) / pairs - 1
    return float(np.average(found, weights=pairs))


def _rows(theta_r: Array) -> Array:
    angles = np.unique(theta_r)
    return angles if len(angles) <= FEW else np.linspace(angles[0], angles[-1], ROWS)


def _counted(draws: Draws, rows: Array, which: Array) -> Counted:
    """The draws in cells; each moves to its row with theta_i + theta_r kept, as a highlight moves."""
    theta_r, theta_i, phi, weight = (
        getattr(draws, n)[which] for n in ("theta_r", "theta_i", "phi", "weight")
    )
    j = np.clip(np.rint(np.interp(theta_r, rows, np.arange(len(rows)))).astype(int), 0, len(rows) - 1)
    theta_i = np.clip(theta_i + theta_r - rows[j], -HALF_PI, HALF_PI)
    bins = (
        np.arange(len(rows) + 1) - 0.5,
        np.linspace(-HALF_PI, HALF_PI, THETA + 1),
        np.linspace(0, TWO_PI, PHI + 1),
    )
    count, _ = np.histogramdd((j, theta_i, np.mod(phi, TWO_PI)), bins=bins, weights=weight)
    squares = np.bincount(j, weight**2, len(rows))
    return Counted(rows, count, np.bincount(j, weight, len(rows)) ** 2 / np.maximum(squares, 1e-300))


def _sum(parts: list[Counted]) -> Counted:
    return Counted(parts[0].theta_r, sum(part.count for part in parts), sum(part.draws for part in parts))


def _normal(mass: Array) -> Array:
    return mass / np.maximum(mass.sum(axis=-1, keepdims=True), 1e-300)
