# SPDX-License-Identifier: BSD-3-Clause
"""Masses of even cells around a circle, turned by an angle, and by how much one is another turned."""

from __future__ import annotations

import numpy as np

from ..lobes import Array

TWO_PI = 2 * np.pi
REACH = np.radians(20.0)
"""How far from where the last two offsets point a highlight is looked for at the next, and"""
FIRST_REACH = np.radians(60.0)
"""how far from the brightest offset at the one beside it."""
TRUST = 0.005
"""Where a lobe has this part of its greatest light, its place counts as much as where those two point."""


def turned(mass: Array, angle: Array) -> Array:
    """(..., m) masses turned by angle (...), rad: by cubics between the cells (Catmull and Rom), none below
    the lesser of the two cells that it lies between: beside a steep peak a cubic would fall to 0."""
    cells = mass.shape[-1]
    steps = np.asarray(angle) * (cells / TWO_PI)
    whole = np.floor(steps)
    t = (steps - whole).astype(mass.dtype)[..., None]
    before, low, high, after = _neighbours(mass, -whole.astype(int) % cells)
    result = (t * (2 * t - t * t - 1) / 2) * after
    result += (1 + t * t * (3 * t - 5) / 2) * high
    result += (t * (1 + t * (4 - 3 * t)) / 2) * low
    result += (t * t * (t - 1) / 2) * before
    return np.maximum(result, np.minimum(low, high), out=result)


def _neighbours(mass: Array, first: Array) -> tuple[Array, ...]:
    """Four views (..., m): the cells two before, one before, at and one after each, counted around the circle
    from the cell number first (...), of masses (..., m)."""
    m = mass.shape[-1]
    ring = np.concatenate([mass[..., -2:], mass, mass], axis=-1)
    whole = np.lib.stride_tricks.sliding_window_view(ring, m + 3, axis=-1)  # of each first cell
    lead = np.broadcast_shapes(mass.shape[:-1], first.shape)
    whole = np.broadcast_to(whole, (*lead, *whole.shape[-2:]))
    at = whole[(*np.ogrid[tuple(map(slice, lead))], np.broadcast_to(first, lead))]
    return tuple(at[..., k : k + m] for k in range(4))


def track(mass: Array, light: Array, shape: Array) -> Array:
    """(N,) angles by which shape (m,) is turned in each of mass (N, m), continuous along N: followed from
    where light (N,) is greatest. Where there is none, the angle goes on as it went before."""
    agreement = np.fft.irfft(np.fft.rfft(mass) * np.conj(np.fft.rfft(shape)), mass.shape[1])
    angle = np.zeros(len(mass))
    start = int(np.argmax(light))
    angle[start] = _peak(agreement[start], np.ones(mass.shape[1], bool))
    trust = light / np.maximum(light + TRUST * light[start], 1e-300)
    for step in (1, -1):
        for o in range(start + step, len(mass) if step > 0 else -1, step):
            last, before = o - step, o - 2 * step
            known = (before - start) * step >= 0
            expected = 2 * angle[last] - angle[before] if known else angle[last]
            angle[o] = _follow(agreement[o], expected, REACH if known else FIRST_REACH, trust[o])
    return angle


def _follow(agreement: Array, expected: float, reach: float, trust: float) -> float:
    """The angle within reach of expected at which the agreement (m,) is greatest, as far as it is trusted."""
    away = _wrapped(np.arange(agreement.size) * (TWO_PI / agreement.size) - expected)
    return expected + trust * _wrapped(_peak(agreement, abs(away) <= reach) - expected)


def _peak(agreement: Array, allowed: Array) -> float:
    """The angle of the greatest agreement (m,) among the cells allowed (m,), by a parabola through three."""
    if not allowed.any():
        allowed = np.ones_like(allowed)
    i = int(np.where(allowed, agreement, -np.inf).argmax())
    low, here, high = agreement[i - 1], agreement[i], agreement[(i + 1) % agreement.size]
    bend = low - 2 * here + high
    offset = (low - high) / (2 * bend) if bend < 0 and here >= max(low, high) else 0.0
    return (i + offset) * TWO_PI / agreement.size


def _wrapped(angle):
    return (angle + np.pi) % TWO_PI - np.pi
