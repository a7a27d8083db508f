"""A hair as a family of models over the offset at which a fibre is hit.

At one offset a fibre's highlights are narrow in azimuth, and they stand elsewhere than at the next. Tables
have no axis for it. So each offset gets K models of its own, whose direct lobes are drawn from with weights:

    q(theta_i, phi | theta_r, offset) = sum over k of w_k(offset, theta_r) A_k(theta_i) B_k(phi)

The inclinations A_k(theta_i | theta_r) are those of all offsets together: where a highlight stands along
the fibre depends on theta_r, and only its strength and azimuth on the offset. Multiplicative updates find the
weights, A and B that make an alpha-divergence from the data least (Cichocki et al. 2008); no shape is
assumed. Between two offsets a renderer draws from the models of both, with weights linear in the offset's
angle asin(offset), by which highlights move.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .errors import HairlutError
from .fit import variance
from .lobes import Array
from .offsets import OffsetData
from .tabulated import FLOOR

LOBES = 2
"""Lobes at each offset: a third gains a hundredth of relative variance with the hairs of the report."""

MAX_LOBES = 8  # readers of a family reserve room for so many
STEPS = 200
POWER = 3
"""The mean over the light of (f/q)^(POWER - 1) is made least. 2 would make the relative variance least;
3 costs a little of it and halves the largest weights, each of them a firefly where a lamp stands."""

SHARPEST, BROADEST = 2.0, 0.5  # powers of the marginal from which the inclinations of the lobes start
FILL = 0.02
"""Share of each A_k that keeps the marginal's shape, and"""
EVEN = 0.005
"""share of each B_k that stays even: without them each lobe has gaps where another has its peak, and a table
spends its columns on them."""


@dataclass(frozen=True)
class Family:
    """weight (N, J, K), summing to 1 over K; theta (J, K, n) and phi (N, J, K, m): cells' masses, each row
    summing to 1."""

    data: OffsetData
    weight: Array
    theta: Array
    phi: Array

    def drawn(self) -> Array:
        """(N, J, n, m) masses of the cells that tables of this family draw, their floor included."""
        one = self.data.at[0]
        theta = (1 - FLOOR) * self.theta + FLOOR * np.diff(one.theta_edges) / np.pi
        phi = (1 - FLOOR) * self.phi + FLOOR * one.even
        return np.einsum("ojk,jkt,ojkp->ojtp", self.weight, theta, phi)

    def variance(self) -> Array:
        """(J,) relative variance of drawing directions where the offset is one of the data's: the mean over
        the light."""
        return self._mean(self.drawn())

    def variance_between(self) -> Array:
        """(J,) the same where each offset but the outermost is drawn from the models of its two neighbours:
        more than what offsets between those of the data lose, as the neighbours lie twice as far apart."""
        drawn, offset = self.drawn(), self.data.offset
        between = drawn.copy()
        for o in range(1, len(drawn) - 1):
            _, t = nearness(offset[[o - 1, o + 1]], offset[o])
            between[o] = (1 - t) * drawn[o - 1] + t * drawn[o + 1]
        return self._mean(between)

    def _mean(self, drawn: Array) -> Array:
        cost = [variance(one, cells) for one, cells in zip(self.data.at, drawn, strict=True)]
        return (self.data.share * cost).sum(axis=0)


def nearness(offset: Array, at: float) -> tuple[int, float]:
    """(o, t): a renderer draws at `at` from offset[o] with weight 1 - t and from offset[o+1] with weight t.
    Outside the range of offset (N,) the nearest end has all the weight."""
    angle = np.arcsin(offset)
    position = float(np.interp(np.arcsin(at), angle, np.arange(len(angle))))
    o = min(int(position), len(angle) - 2)
    return o, position - o


def fit_family(
    data: OffsetData, lobes: int = LOBES, report: Callable[[str, float], None] = lambda stage, share: None
) -> Family:
    """Fits `lobes` lobes for each offset. report(stage, share done) is called now and then."""
    if not 1 <= lobes <= MAX_LOBES:
        raise HairlutError(f"{lobes} lobes for each offset: expected 1 to {MAX_LOBES}")
    rows = []
    for j in range(data.light.shape[1]):
        report("fitting lobes for each offset", j / data.light.shape[1])
        rows.append(_fit_row(data.mass[:, j] * data.share[:, j, None, None], lobes, data.at[0].even))
    report("fitting lobes for each offset", 1.0)
    weight, theta, phi = (np.stack(part) for part in zip(*rows, strict=True))
    return Family(data, weight.swapaxes(0, 1), theta, phi.swapaxes(0, 1))


def _fit_row(mass: Array, lobes: int, even: Array) -> tuple[Array, Array, Array]:
    """(N, K) weights, (K, n) and (N, K, m) masses for one theta_r from joint masses (N, n, m) of sum 1."""
    offsets, _, places = mass.shape
    joint = mass.transpose(1, 0, 2).reshape(mass.shape[1], -1)
    marginal = joint.sum(axis=1)
    theta = marginal ** np.geomspace(SHARPEST, BROADEST, lobes)[:, None]
    theta /= theta.sum(axis=1, keepdims=True)
    rest = np.tile(joint.sum(axis=0) / lobes, (lobes, 1))
    for _ in range(STEPS):
        excess = (joint / np.maximum(theta.T @ rest, 1e-300)) ** POWER
        size = np.maximum(rest.sum(axis=1, keepdims=True), 1e-300)
        theta, rest = (
            theta * (rest @ excess.T / size) ** (1 / POWER),
            rest * (theta @ excess) ** (1 / POWER),
        )
        theta = (1 - FILL) * theta / theta.sum(axis=1, keepdims=True) + FILL * marginal
        rest /= rest.sum()
    phi = rest.reshape(lobes, offsets, places).swapaxes(0, 1)
    weight = phi.sum(axis=2)
    phi = (1 - EVEN) * phi / np.maximum(weight, 1e-300)[:, :, None] + EVEN * even
    return weight / weight.sum(axis=1, keepdims=True), theta, phi / phi.sum(axis=2, keepdims=True)
