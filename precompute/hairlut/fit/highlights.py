# SPDX-License-Identifier: BSD-3-Clause
"""Highlights in the azimuths of products: each moves around the fibre in its own way.

Where one highlight's inclination is nearly a mixture of two others', the products of factor.py have parts of
several highlights each. Those are separated by how they move over the offset: each product's azimuths are
peeled, highlight by highlight, and parts of different products that move together are one lobe.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..lobes import Array
from .turning import TWO_PI, track, turned

MOST = 3  # highlights in a product
LEAST = 0.02  # part of a product's light below which no further highlight is peeled
FOOT = 0.02  # of its peak, where a highlight ends, or
VALLEY = 0.3  # below which it ends where the next one begins
TINY = 1e-30


@dataclass(frozen=True)
class Highlight:
    """theta (n,) of sum 1; light (N, m) at each offset; turn (N,) of its peak, from pi; its width, rad."""

    theta: Array
    light: Array
    turn: Array
    width: float

    @property
    def strength(self) -> float:
        return float(self.light.sum())


def highlights(theta: Array, azimuths: Array) -> list[Highlight]:
    """The highlights of products theta (n, K), azimuths (N, K, m), the strongest first."""
    found: list[Highlight] = []
    for k in range(theta.shape[1]):
        for one in _peeled(theta[:, k], azimuths[:, k]):
            same = next((i for i, other in enumerate(found) if _together(one, other)), None)
            if same is None:
                found.append(one)
            else:
                found[same] = _joined(found[same], one)
    return sorted(found, key=lambda one: -one.strength)


def _peeled(theta: Array, rest: Array) -> list[Highlight]:
    parts, whole = [], rest.sum()
    for last in [False] * (MOST - 1) + [True]:
        light = np.maximum(rest.sum(axis=1), TINY)
        if light.sum() < LEAST * whole and parts:
            break
        each = rest / light[:, None]
        shape, width = _window(each[light.argmax()])
        turn = track(each, light, shape)
        alike = turned(rest, -turn)
        window = shape > 0
        mean = np.where(window, (light[:, None] * alike).sum(axis=0), 0.0)
        mean /= max(mean.sum(), TINY)
        amount = (alike * mean).sum(axis=1) / max((mean * mean).sum(), TINY)
        part = rest if last else np.minimum(rest, turned(mean[None], turn) * amount[:, None])
        parts.append(Highlight(theta, part, turn, width))
        rest = rest - part
    return parts


def _window(azimuth: Array) -> tuple[Array, float]:
    """(the peak of azimuth (m,) alone, turned to pi, and its width at half of its height, rad)."""
    m = azimuth.size
    middle = m // 2
    peak = np.roll(azimuth, middle - int(azimuth.argmax()))
    inside = np.zeros(m, bool)
    inside[middle] = True
    for step in (1, -1):
        lowest = peak[middle]
        for i in range(1, middle):
            value = peak[middle + step * i]
            if value < FOOT * peak[middle] or (lowest < VALLEY * peak[middle] and value > 1.05 * lowest):
                break
            lowest = min(lowest, value)
            inside[middle + step * i] = True
    width = float((inside & (peak > peak[middle] / 2)).sum()) * TWO_PI / m
    return np.where(inside, peak, 0.0), width


def _together(a: Highlight, b: Highlight) -> bool:
    """Whether two parts stand at the same places, where both have light."""
    weight = np.minimum(a.light.sum(axis=1) / a.strength, b.light.sum(axis=1) / b.strength)
    away = np.angle(np.exp(1j * (a.turn - b.turn)))
    return bool((weight * away**2).sum() < weight.sum() * (min(a.width, b.width) / 2) ** 2)


def _joined(a: Highlight, b: Highlight) -> Highlight:
    share = a.strength / (a.strength + b.strength)
    theta = share * a.theta + (1 - share) * b.theta
    return Highlight(theta, a.light + b.light, a.turn if share > 0.5 else b.turn, max(a.width, b.width))
