"""Finds the lobes of a family (family.py), for one theta_r after the other.

Multiplicative updates find products of inclination and azimuth, an azimuth for each offset, that make an
alpha-divergence from the data least (Cichocki et al. 2008); no shape is assumed. Between the updates each
lobe's azimuths are laid upon each other, and their mean, turned back, takes their places. That leaves every
lobe a highlight of its own, with one peak: what two highlights make together is no shape that turns.

The first theta_r starts from powers of its marginal, and any other from the lobes of its neighbour, moved
along with the mirror direction. So a lobe stays the same highlight over all theta_r, and tables may blend
their rows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..lobes import Array
from .offsets import OffsetData
from .turning import TWO_PI, track, turned

POWER = 4
"""The mean over the light of (f/q)^(POWER - 1) is made least. 2 would make the relative variance least;
4 costs a little of it and cares for the largest weights, each of them a firefly where a lamp stands."""

FIRST_STEPS, STEPS = 1500, 40  # of free updates, for the first theta_r and for any other
ROUNDS, BETWEEN = 4, 20  # of laying azimuths upon each other, and free updates between two of them
LAST_STEPS = 20  # of updates that leave the azimuths
SHARPEST, BROADEST = 2.0, 0.5  # powers of the marginal from which the inclinations of the lobes start
FRESH = 0.02  # of a neighbour's azimuths that is replaced by the new theta_r's own
FILL = 0.005
"""Share of each A_k that keeps the marginal's shape, and"""
EVEN = 0.005
"""share of each B_k that stays even: without them each lobe has gaps where another has its peak, and a table
spends its columns on them."""
LEAN = 1e-3  # part of the mean over all offsets in the shape of some: those may have no light
TINY = 1e-300


@dataclass(frozen=True)
class Row:
    """For one theta_r: theta (K, n) and phi (S, K, m) masses, each row summing to 1, the middle of phi's at
    pi; light (N, K) of each lobe at each offset; turn (N, K), rad, from phi to where the lobe stands."""

    theta: Array
    phi: Array
    light: Array
    turn: Array

    @property
    def weight(self) -> Array:
        """(N, K) shares of the lobes in the light of each offset."""
        total = self.light.sum(axis=1, keepdims=True)
        return np.where(total > 0, self.light / np.maximum(total, TINY), 1 / self.light.shape[1])


@dataclass(frozen=True)
class _Task:
    """The masses (n, N m) of one theta_r, of sum 1, and shape (N,), the number of each offset's shape."""

    joint: Array
    shape: Array

    @cached_property
    def marginal(self) -> Array:
        """(n,) masses of the inclinations."""
        return self.joint.sum(axis=1)

    def excess(self, theta: Array, azimuth: Array) -> Array:
        """(n, N m) the data over the product of theta (K, n) and azimuth (K, N m), to the power of POWER."""
        ratio = self.joint / np.maximum(theta.T @ azimuth, TINY)
        excess = ratio.copy()
        for _ in range(POWER - 1):  # many times faster than **
            excess *= ratio
        return excess

    def inclinations(self, theta: Array, azimuth: Array, excess: Array) -> Array:
        """(K, n) after one update, from azimuth (K, N m)."""
        size = np.maximum(azimuth.sum(axis=1, keepdims=True), TINY)
        theta = theta * (azimuth @ excess.T / size) ** (1 / POWER)
        return (1 - FILL) * theta / theta.sum(axis=1, keepdims=True) + FILL * self.marginal

    def azimuths(self, flat: Array) -> tuple[Array, Array]:
        """(N, K) light and (N, K, m) masses of sum 1 of the azimuths (K, N m)."""
        azimuth = flat.reshape(len(flat), len(self.shape), -1).swapaxes(0, 1)
        light = azimuth.sum(axis=2)
        return light, azimuth / np.maximum(light, TINY)[..., None]


def fit_rows(data: OffsetData, lobes: int, shape: Array, report: Callable[[str, float], None]) -> list[Row]:
    """The rows of all theta_r; shape (N,): the number, from 0, of the shape of each offset's azimuths."""
    theta_r, found = data.at[0].theta_r, {}
    middle = len(theta_r) // 2
    for j in sorted(range(len(theta_r)), key=lambda j: abs(j - middle)):
        report("fitting lobes over the offset", len(found) / len(theta_r))
        mass = data.mass_at(j) * data.share[:, j, None, None]
        task = _Task(mass.transpose(1, 0, 2).reshape(mass.shape[1], -1), shape)
        neighbour = j - np.sign(j - middle)
        moved = theta_r[neighbour] - theta_r[j]
        found[j] = _row(task, lobes, found.get(neighbour), data.at[0].theta_middles, moved)
    report("fitting lobes over the offset", 1.0)
    return [found[j] for j in range(len(theta_r))]


def _row(task: _Task, lobes: int, neighbour: Row | None, theta_i: Array, moved: float) -> Row:
    theta, azimuth = _start(task, lobes) if neighbour is None else _go_on(task, neighbour, theta_i, moved)
    theta, azimuth = _free(task, theta, azimuth, STEPS if neighbour else FIRST_STEPS)
    whole = _strongest(*task.azimuths(azimuth)) if neighbour is None else neighbour.phi.mean(axis=0)
    for last in [False] * (ROUNDS - 1) + [True]:
        light, each = task.azimuths(azimuth)
        turn = np.stack([track(each[:, k], light[:, k], whole[k]) for k in range(lobes)], axis=1)
        phi, whole = _shapes(task, light, turned(each, -turn))
        if not last:
            azimuth = _flat(light, turned(phi[task.shape], turn))
            theta, azimuth = _free(task, theta, azimuth, BETWEEN)
    theta, light = _weigh(task, theta, light, turned(phi[task.shape], turn))
    if neighbour is not None:
        turn += TWO_PI * np.rint((neighbour.turn - turn).mean(axis=0) / TWO_PI)
    return Row(theta, phi, light, turn)


def _start(task: _Task, lobes: int) -> tuple[Array, Array]:
    theta = task.marginal ** np.geomspace(SHARPEST, BROADEST, lobes)[:, None]
    return theta / theta.sum(axis=1, keepdims=True), np.tile(task.joint.sum(axis=0) / lobes, (lobes, 1))


def _go_on(task: _Task, row: Row, theta_i: Array, moved: float) -> tuple[Array, Array]:
    """A neighbour's lobes, at the theta_r of this task: its mirror direction is `moved` from theirs."""
    theta = np.stack([np.interp(theta_i - moved, theta_i, lobe) for lobe in row.theta])
    theta = (1 - FILL) * theta / theta.sum(axis=1, keepdims=True) + FILL * task.marginal
    azimuth = _flat(row.light, turned(row.phi[task.shape], row.turn))
    return theta, (1 - FRESH) * azimuth + FRESH / len(azimuth) * task.joint.sum(axis=0)


def _flat(light: Array, azimuth: Array) -> Array:
    """(K, N m) from light (N, K) and azimuth (N, K, m)."""
    return (light[..., None] * azimuth).swapaxes(0, 1).reshape(light.shape[1], -1)


def _free(task: _Task, theta: Array, azimuth: Array, steps: int) -> tuple[Array, Array]:
    """Updates of theta (K, n) and of the azimuths (K, N m), each free at each offset."""
    for _ in range(steps):
        excess = task.excess(theta, azimuth)
        theta, azimuth = (
            task.inclinations(theta, azimuth, excess),
            azimuth * (theta @ excess) ** (1 / POWER),
        )
        azimuth /= azimuth.sum()
    return theta, azimuth


def _weigh(task: _Task, theta: Array, light: Array, azimuth: Array) -> tuple[Array, Array]:
    """Updates of theta (K, n) and light (N, K) for azimuths (N, K, m) that stay."""
    for _ in range(LAST_STEPS):
        flat = _flat(light, azimuth)
        excess = task.excess(theta, flat)
        gain, _ = task.azimuths(flat * (theta @ excess))
        theta = task.inclinations(theta, flat, excess)
        light = light * (gain / np.maximum(light, TINY)) ** (1 / POWER)
        light /= light.sum()
    return theta, light


def _strongest(light: Array, each: Array) -> Array:
    """(K, m) the azimuths (N, K, m) where each lobe has most light, their mean direction turned to pi."""
    lobe = np.arange(light.shape[1])
    found = each[light.argmax(axis=0), lobe]
    middles = (np.arange(found.shape[1]) + 0.5) * (TWO_PI / found.shape[1])
    return turned(found, np.pi - np.angle(found @ np.exp(1j * middles)))


def _shapes(task: _Task, light: Array, laid: Array) -> tuple[Array, Array]:
    """(S, K, m) means of the azimuths (N, K, m) laid upon each other, and (K, m) of all, none of them 0."""
    mass = light[..., None] * laid
    parts = np.stack([mass[task.shape == s].sum(axis=0) for s in range(task.shape.max() + 1)])
    whole = parts.sum(axis=0)
    return _filled(parts + LEAN * whole), _filled(whole)


def _filled(mass: Array) -> Array:
    return (1 - EVEN) * mass / np.maximum(mass.sum(axis=-1, keepdims=True), TINY) + EVEN / mass.shape[-1]
