# SPDX-License-Identifier: BSD-3-Clause
"""A hair BSDF as a function of where its fibre is hit: values on grids, and its light by quadrature.

A fibre is hit at an offset sin(gamma) in [-1, 1] from its axis; gamma is the viewer's azimuth, measured from
the surface normal.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

REACH = math.asin(0.998)  # of gamma: nearer to the rim the engine's hair has only its mirror highlight
LIT = 1e-4
POINTS = (128, 144, 64)  # of theta_i, phi and gamma, of the reference
FEWER = (96, 108, 48)  # the same, to see how exact that is


def direction(mi: Any, theta: float, phi: float):
    """Local direction: the fibre along y, phi from z (the surface normal) towards x."""
    return mi.Vector3f(math.cos(theta) * math.sin(phi), math.sin(theta), math.cos(theta) * math.cos(phi))


def midpoints(low: float, high: float, count: int) -> np.ndarray:
    """(count,) middles of equal cells."""
    return low + (np.arange(count) + 0.5) / count * (high - low)


def evaluate(mi: Any, bsdf: Any, theta_r, theta_i, phi, gamma) -> np.ndarray:
    """Grey values per steradian, cosine included, (offsets, J, n, m), at the relative azimuths phi; rad."""
    si, context = mi.SurfaceInteraction3f(), mi.BSDFContext()
    values = np.empty((len(gamma), len(theta_r), len(theta_i), len(phi)))
    for g, at in enumerate(gamma):
        incident = [[direction(mi, t, p + at) for p in phi] for t in theta_i]
        for j, t_r in enumerate(theta_r):
            si.wi = direction(mi, t_r, at)
            values[g, j] = [[sum(bsdf.eval(context, si, w)) / 3 for w in row] for row in incident]
    return values


def contrasted(w: np.ndarray) -> np.ndarray:
    """Radiance from w (..., 3): dim, with a window and a small lamp."""
    window = np.exp(10 * (w @ _unit(0.5, 0.4, 0.77) - 1))
    lamp = np.exp(60 * (w @ _unit(-0.3, -0.5, -0.8) - 1))
    return 0.1 + 2 * window + 8 * lamp


def _unit(*v: float) -> np.ndarray:
    return np.array(v) / np.linalg.norm(v)


def largest_weight(mi: Any, bsdf: Any, theta_r: float) -> float:
    """The largest weight, value over density relative to the light at its offset, of a direction in which
    light of at least LIT of the brightest goes; over a grid of directions and offsets."""
    theta, phi = midpoints(-math.pi / 2, math.pi / 2, 96), midpoints(0, 2 * math.pi, 108)
    si, context, largest = mi.SurfaceInteraction3f(), mi.BSDFContext(), 0.0
    for gamma in midpoints(-REACH, REACH, 17):
        si.wi = direction(mi, theta_r, gamma)
        found = [
            [bsdf.eval_pdf(context, si, direction(mi, t, p + gamma)) for p in phi.tolist()] for t in theta
        ]
        value, density = (np.array([[part(f) for f in row] for row in found]) for part in (_grey, _density))
        cell = (math.pi / theta.size) * (2 * math.pi / phi.size)
        weight = value / density / ((value * np.cos(theta)[:, None]).sum() * cell)
        largest = max(largest, weight[value > LIT * value.max()].max())
    return float(largest)


def _grey(found: tuple) -> float:
    return sum(found[0]) / 3


def _density(found: tuple) -> float:
    return found[1]


def light(mi: Any, bsdf: Any, theta_r: float) -> tuple[np.ndarray, np.ndarray]:
    """(2,) the light towards theta_r, mean over the offset, in constant and in contrasted radiance; and how
    far a quadrature with fewer points is from it."""
    exact, coarse = (_light(mi, bsdf, theta_r, *points) for points in (POINTS, FEWER))
    return exact, abs(exact - coarse)


def _light(mi: Any, bsdf: Any, theta_r: float, inclinations: int, azimuths: int, offsets: int) -> np.ndarray:
    theta, phi = midpoints(-math.pi / 2, math.pi / 2, inclinations), midpoints(0, 2 * math.pi, azimuths)
    gamma = midpoints(-REACH, REACH, offsets)
    values = evaluate(mi, bsdf, [theta_r], theta, phi, gamma)[:, 0]
    azimuth = phi + gamma[:, None, None]
    across = np.cos(theta)[:, None]
    w = np.stack(
        np.broadcast_arrays(across * np.sin(azimuth), np.sin(theta)[:, None], across * np.cos(azimuth)), -1
    )
    gathered = values * across * (math.pi / inclinations) * (2 * math.pi / azimuths)
    share = np.cos(gamma) / np.cos(gamma).sum()
    return np.array([share @ (gathered * radiance).sum(axis=(1, 2)) for radiance in (1.0, contrasted(w))])
