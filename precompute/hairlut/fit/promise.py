# SPDX-License-Identifier: BSD-3-Clause
"""What a baked model's draws cost, measured at viewers, offsets and directions that it was not fitted to.

With p the light at one theta_r and offset, normalised, and q the density of the baked textures,

    V = integral of (p - q)^2 / q.

Viewers, offsets and azimuths are random in even strata. The inclinations are random in strata of a density
of their own, which covers the whole sphere and is dense where a table is. So the sum is right on average
whatever the light is, and independent repetitions say how well it is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import interpolant
from ..lobes import HALF_PI, Array
from ..model import BakedModel
from ..table import Table
from .cells import Density
from .turning import TWO_PI

BRIGHT = 1e-4
"""Weights count where f or f cos(theta_i) is above this part of its peak, at the same theta_r and offset:
some f grow without bound at the poles."""
POINTS = 96  # of theta_i
POLE = 1e-6  # rad from the poles, where f is not evaluated
EVEN = 0.3  # share of them that is even over the sphere


@dataclass(frozen=True)
class Losses:
    """At R viewers theta_r (R,) and N offsets each, (R, N): variance V, largest weight, and share: of all
    light for this theta_r, what an offset scatters."""

    theta_r: Array
    offset: Array
    variance: Array
    weight: Array
    light: Array


def losses(
    model: BakedModel,
    density: Density,
    theta_r: Array,
    offset: Array,
    around: int,
    random: np.random.Generator,
) -> Losses:
    """At viewers theta_r (R,) and offsets (R, N), with `around` azimuths."""
    found = [_at(model, density, t, h, around, random) for t, h in zip(theta_r, offset, strict=True)]
    variance, weight, light = (np.array(part) for part in zip(*found, strict=True))
    return Losses(theta_r, offset, variance, weight, light)


def _at(model, density, theta_r, offset, around, random) -> tuple[Array, Array, Array]:
    tables = [lobe.theta for lobe in model.lobes]
    theta_i, size = _inclinations(tables, theta_r, random)
    width = TWO_PI / around
    phi = (np.arange(around) + random.random()) * width
    p = np.broadcast_to(
        density(theta_r, theta_i[:, None], phi, offset[:, None, None]), (len(offset), theta_i.size, around)
    )
    q = drawn(model, theta_r, offset, theta_i, phi)
    measure = (size * width)[:, None]
    light = (p * measure).sum(axis=(1, 2))
    p = p * ((q * measure).sum(axis=(1, 2)) / np.maximum(light, 1e-300))[:, None, None]
    variance = ((p - q) ** 2 / np.maximum(q, 1e-300) * measure).sum(axis=(1, 2))
    variance = np.where(light > 0, variance, 0.0)
    cosine = np.cos(theta_i[:, None])
    bright = _bright(p / cosine) | _bright(p / cosine**2)
    weight = np.where(bright, p / np.maximum(q, 1e-300), 0.0).max(axis=(1, 2))
    return variance, weight, light


def _bright(f: Array) -> Array:
    """Where f (N, n, m) is not negligible."""
    return f > BRIGHT * f.max(axis=(1, 2), keepdims=True)


def drawn(model: BakedModel, theta_r: float, offset: Array, theta_i: Array, phi: Array) -> Array:
    """(N, n, m) the model's density at one theta_r, offsets (N,), theta_i (n,) and relative azimuths (m,)."""
    share, turn, side = model.mixture.at(np.full(len(offset), theta_r), offset)
    inclination = np.stack([pdf(lobe.theta, theta_r, theta_i) for lobe in model.lobes], axis=1)
    azimuth = np.full((len(offset), len(model.lobes), phi.size), 1 / TWO_PI)
    for k, lobe in enumerate(model.lobes):
        if lobe.phi is not None:
            x = np.mod(side[:, None] * phi - turn[k][:, None], TWO_PI)
            azimuth[:, k] = pdf(lobe.phi, theta_r, x.ravel()).reshape(x.shape)
    return np.matmul(inclination, share.T[..., None] * azimuth)


def pdf(table: Table, theta_r: float, x: Array) -> Array:
    """(n,) the density of a table at one theta_r and many angles x (n,)."""
    read = interpolant.cells(table, np.array([theta_r]))
    i = np.clip(np.searchsorted(read.x[0], x, side="right") - 1, 0, table.width - 2)
    return 1 / read.locate(0, i, x)[1]


def _inclinations(tables: list[Table], theta_r: float, random: np.random.Generator) -> tuple[Array, Array]:
    """(theta_i (n,), the angle that each stands for): random in strata that are dense where a table draws."""
    knots = np.concatenate([interpolant.cells(table, np.array([theta_r])).x[0] for table in tables])
    knots = np.unique(np.concatenate([np.sort(knots)[:: max(1, knots.size // 64)], [-HALF_PI, HALF_PI]]))
    share = (1 - EVEN) / (knots.size - 1) + EVEN * np.diff(knots) / np.pi
    below = np.concatenate([[0.0], np.cumsum(share)])
    u = (np.arange(POINTS) + random.random(POINTS)) / POINTS
    i = np.clip(np.searchsorted(below, u * below[-1], side="right") - 1, 0, knots.size - 2)
    theta_i = np.clip(np.interp(u * below[-1], below, knots), -HALF_PI + POLE, HALF_PI - POLE)
    return theta_i, np.diff(knots)[i] / share[i] * below[-1] / POINTS
