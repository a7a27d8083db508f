# SPDX-License-Identifier: BSD-3-Clause
"""Draws of a BSDF towards one viewer, at random offsets: what a sampler estimates the fibre's light from."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from report.hairscene import owndensity
from report.hairscene.nearfield import REACH, contrasted, direction


@dataclass(frozen=True)
class Draws:
    """N draws at random offsets: weight (N,) value over density, density (N,) per steradian, gamma (N,), wo
    (N, 3); seconds a draw took, Python's share of it included."""

    weight: np.ndarray
    density: np.ndarray
    gamma: np.ndarray
    wo: np.ndarray
    seconds: float

    def estimates(self) -> np.ndarray:
        """(2, N) single estimates of the light: constant radiance, then contrasted."""
        return np.stack([self.weight, self.weight * contrasted(self.wo)])


def draw(mi: Any, bsdf: Any, theta_r: float, count: int, seed: Sequence[int]) -> Draws:
    numbers = np.random.default_rng(seed).random((count, 4), dtype=np.float32)
    numbers[:, 3] = np.arcsin(math.sin(REACH) * (2 * numbers[:, 3] - 1))
    si, context, point = mi.SurfaceInteraction3f(), mi.BSDFContext(), mi.Point2f
    weight, density, wo = np.empty(count), np.empty(count), np.empty((count, 3))
    start = perf_counter()
    for n, (a, b, c, gamma) in enumerate(numbers.tolist()):
        si.wi = direction(mi, theta_r, gamma)
        sample, value = bsdf.sample(context, si, a, point(b, c))
        weight[n], density[n], w = sum(value) / 3, sample.pdf, sample.wo
        wo[n] = w.x, w.y, w.z
    return Draws(weight, density, numbers[:, 3], wo, (perf_counter() - start) / count)


def corrected(mi: Any, drawn: Draws, hair: dict, theta_r: float, own: float) -> Draws:
    """The draws with the density that they really have (owndensity.py), those of the atom without weight.

    own: share of the draws that are the engine's, by the BSDF hair.
    """
    bsdf, si, context = mi.load_dict({"type": "hair", **hair}), mi.SurfaceInteraction3f(), mi.BSDFContext()
    said = np.empty(len(drawn.wo))
    for n, (gamma, w) in enumerate(zip(drawn.gamma.tolist(), drawn.wo.tolist(), strict=True)):
        si.wi = direction(mi, theta_r, gamma)
        said[n] = bsdf.pdf(context, si, mi.Vector3f(*w))
    true = drawn.density + own * (owndensity.density(hair, theta_r, drawn.gamma, drawn.wo) - said)
    weight = np.where(owndensity.is_atom(drawn.wo), 0.0, drawn.weight * drawn.density / true)
    return Draws(weight, true, drawn.gamma, drawn.wo, drawn.seconds)
