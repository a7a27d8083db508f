"""Splits a distribution into what a model's tables can draw: a direct and a multiple part.

For each theta_r, a model draws from  w A(theta_i) B(phi) + (1 - w) C(theta_i) / (2 pi),  with one weight w.
Expectation maximisation finds the masses A, B, C and w that make the data most probable under it; no shape
is assumed. The distribution's own marginals are the special case w = 1. Where B never falls to zero and C
has the shape of A, several splits draw the same mixture; the search starts with B lowered by half of its
minimum, so that what does not depend on phi tends to C.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..lobes import DIRECT, LOBES, MULTIPLE, TABLES, Array
from ..tabulated import FLOOR
from .distribution import Distribution

PARTS = ("both", *LOBES)
MAX_STEPS = 400
ENOUGH = 1e-7  # gain of the mean log-likelihood in a step
NEGLIGIBLE = 0.01
START = 0.5  # of B's minimum is left to C at first
EVEN = 0.05
"""Share of B that stays even over the circle, and"""
FILL = 0.05
"""share of C that keeps the marginal's shape: without them each part takes what the other leaves, with gaps
that a table spends its columns on. They cost a few thousandths of relative variance."""


@dataclass(frozen=True)
class Split:
    """direct_weight in [0, 1]; direct_theta (J, n), direct_phi (J, m), multiple_theta (J, n): cells' masses,
    each row summing to 1."""

    direct_weight: float
    direct_theta: Array
    direct_phi: Array
    multiple_theta: Array

    def tables(self, data: Distribution) -> tuple[tuple[str, Array, Array], ...]:
        """(name, masses, edges of the cells) of each table."""
        edges = data.theta_edges, data.phi_edges, data.theta_edges
        return tuple((name, getattr(self, name), each) for name, each in zip(TABLES, edges, strict=True))

    def drawn(self, data: Distribution, floor: float = FLOOR) -> Array:
        """(J, n, m) masses of the cells that tables of this split draw, their floor included."""
        wide = np.diff(data.theta_edges) / np.pi
        theta, phi, multiple = (
            (1 - floor) * mass + floor * even
            for mass, even in (
                (self.direct_theta, wide),
                (self.direct_phi, data.even),
                (self.multiple_theta, wide),
            )
        )
        return mixture(self.direct_weight, theta, phi, multiple, data.even)


def mixture(direct_weight: float, theta: Array, phi: Array, multiple: Array, even: Array) -> Array:
    """(J, n, m) masses of cells that a model draws."""
    direct = theta[:, :, None] * phi[:, None, :]
    return direct_weight * direct + (1 - direct_weight) * multiple[:, :, None] * even


def marginals(data: Distribution) -> Split:
    """The distribution's own marginals in theta_i and in phi; the multiple part has the same inclinations."""
    theta = data.mass.sum(axis=2)
    return Split(1.0, theta, data.mass.sum(axis=1), theta)


def decompose(
    data: Distribution, lobes: str = "both", report: Callable[[float], None] = lambda share: None
) -> Split:
    """The most probable split. report(share) is called with the share of the work done."""
    whole = marginals(data)
    if lobes == DIRECT:
        return whole
    if lobes == MULTIPLE:
        flat = np.tile(data.even, (len(data.theta_r), 1))
        return Split(0.0, whole.direct_theta, flat, whole.direct_theta)
    split = _start(whole, data.even)
    last = -np.inf
    for step in range(MAX_STEPS):
        split, likelihood = _improve(split, data)
        report((step + 1) / MAX_STEPS)
        if likelihood - last < ENOUGH:
            break
        last = likelihood
    report(1.0)
    if split.direct_weight > 1 - NEGLIGIBLE:
        return whole
    return decompose(data, MULTIPLE) if split.direct_weight < NEGLIGIBLE else split


def _start(whole: Split, even: Array) -> Split:
    lowest = (whole.direct_phi / even).min(axis=1, keepdims=True)
    raised = whole.direct_phi - START * lowest * even
    weight = float(np.clip(raised.sum(axis=1).mean(), 0.05, 0.95))
    return Split(weight, whole.direct_theta, raised / raised.sum(axis=1, keepdims=True), whole.direct_theta)


def _improve(split: Split, data: Distribution) -> tuple[Split, float]:
    """One step of expectation maximisation, and the mean log-likelihood before it."""
    w = split.direct_weight
    direct = w * split.direct_theta[:, :, None] * split.direct_phi[:, None, :]
    drawn = direct + (1 - w) * split.multiple_theta[:, :, None] * data.even
    safe = np.maximum(drawn, 1e-300)
    likelihood = float((data.mass * np.log(safe)).sum() / len(data.theta_r))
    mine = data.mass * direct / safe
    theta, phi = mine.sum(axis=2), mine.sum(axis=1)
    rest = np.maximum(data.mass.sum(axis=2) - theta, 0)
    share = theta.sum(axis=1, keepdims=True)
    return Split(
        float(share.mean()),
        theta / np.maximum(share, 1e-300),
        (1 - EVEN) * phi / np.maximum(share, 1e-300) + EVEN * data.even,
        (1 - FILL) * rest / np.maximum(1 - share, 1e-300) + FILL * data.mass.sum(axis=2),
    ), likelihood
