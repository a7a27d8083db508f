# SPDX-License-Identifier: BSD-3-Clause
"""Sums of products: K inclinations times K azimuths that make up the light of one theta_r.

The light is a matrix p (n, C): n cells of theta_i, and C columns, a cell of the azimuth at an offset each.
It is to be drawn by q = theta azimuth, theta (n, K), azimuth (K, C). Multiplicative updates (Cichocki et al.
2008) make

    sum of p (p / q)^(POWER - 1)

least. They need no shape, keep every number positive, and cannot overflow: p / q is bounded. They start from
the K most different columns (successive projections: Araujo et al. 2001): where each product has a column of
its own, which hair has wherever highlights stand apart, those already are the answer.
"""

from __future__ import annotations

import numpy as np

from ..lobes import Array

POWER = 4
"""2 would make the relative variance least; 4 costs a little of it and cares for the largest weights, each of
them a firefly where a lamp stands."""
LARGEST = 1e4  # the largest p / q that counts: to the power of POWER it stays far from overflow
TINY = 1e-30
FILL = 1e-3
"""Share of each inclination that keeps the shape of all light, and of each azimuth that stays even: without
them a product has gaps where another has its peak, and a table spends its columns on them."""
WEAK = 1e-4  # columns of less than this part of the brightest one's light start nothing
ALONE = 60
"""Steps of the azimuths alone: with those that every product starts from, the brightest highlight would draw
all inclinations to its own."""
FIRST_STEPS = 150


def excess(p: Array, q: Array, largest: float = LARGEST) -> Array:
    """(p / q)^POWER, where p / q counts up to the largest."""
    ratio = np.maximum(q, TINY)
    np.divide(p, ratio, out=ratio)
    np.minimum(ratio, largest, out=ratio)
    ratio *= ratio
    ratio *= ratio
    return ratio


def variance(p: Array, q: Array, axis: int | tuple[int, ...] | None = None) -> Array:
    """Relative variance of estimating the light p with draws by q; neither has to be normalised."""
    square = (p * (p / np.maximum(q, TINY))).sum(axis=axis)
    return square * q.sum(axis=axis) / np.maximum(p.sum(axis=axis), TINY) ** 2 - 1


def products(p: Array, count: int, steps: int = FIRST_STEPS) -> tuple[Array, Array]:
    """(theta (n, count), azimuth (count, C)) of the light p (n, C); theta's columns sum to 1."""
    light = p.sum(axis=1, keepdims=True)
    theta = 0.98 * most_different(p, count) + 0.02 * light / light.sum()
    azimuth = np.tile(p.sum(axis=0) / count, (count, 1))
    theta, azimuth = update(p, theta, azimuth, ALONE, moving=False)
    return update(p, theta, azimuth, steps)


def most_different(p: Array, count: int) -> Array:
    """(n, count) columns of p, each of sum 1, whose span is the largest: by successive projections."""
    light = p.sum(axis=0)
    columns = p[:, light > WEAK * light.max()]
    columns = columns / columns.sum(axis=0)
    rest, chosen = columns.copy(), []
    for _ in range(count):
        length = np.einsum("nc,nc->c", rest, rest)
        chosen.append(int(length.argmax()))
        along = rest[:, chosen[-1]] / np.sqrt(max(length.max(), TINY))
        rest = rest - np.outer(along, along @ rest)
    return columns[:, chosen]


def update(p: Array, theta: Array, azimuth: Array, steps: int, moving: bool = True) -> tuple[Array, Array]:
    """Multiplicative updates of azimuth (K, C) and, if it is moving, of theta (n, K)."""
    light = p.sum(axis=1, keepdims=True) / p.sum()
    for _ in range(steps):
        e = excess(p, theta @ azimuth)
        gain = (e @ azimuth.T) / np.maximum(azimuth.sum(axis=1), TINY) if moving else None
        azimuth = azimuth * (theta.T @ e) ** (1 / POWER)
        if moving:
            theta = filled(theta * gain ** (1 / POWER), light)
        azimuth *= p.sum() / azimuth.sum()
    return theta, azimuth


def filled(theta: Array, light: Array) -> Array:
    """theta (n, K) with columns of sum 1, a little of each in the shape of all light (n, 1)."""
    return (1 - FILL) * theta / np.maximum(theta.sum(axis=0), TINY) + FILL * light
