# SPDX-License-Identifier: BSD-3-Clause
"""The density that the draws of the engine's `hair` really have, which is not quite what its pdf() says.

Its sample() draws from four lobes (Chiang et al. 2016). Two things are off in Mitsuba 3.9:

- pdf() takes the logarithm of the Bessel function I0 from two terms of its series where the argument is
  above 12, and halves the second, 1/(8x): up to half a per cent is missing, in values and densities alike.
  Draws are exact, so that an estimate with them is as much too high.
- sample() tilts the first three lobes by the cuticle's scales and leaves the frame of the last, light that is
  reflected twice or more inside the fibre, at zero: all of its draws lie on theta_i = 0. An atom without
  density; pdf() has a lobe.

Leave the atom's draws out and divide by the exact density of the first three lobes: the rest is unbiased.
"""

from __future__ import annotations

import numpy as np
from scipy.special import ive

from report.hairscene.luminance import luminance

ETA = 1.55 / 1.000277  # amber in air
TILT = np.radians(2.0)
MELANIN = np.array([[0.419, 0.697, 1.37], [0.187, 0.4, 1.05]])  # absorption of eumelanin, pheomelanin
DEFAULTS = {
    "eumelanin": 1.3,
    "pheomelanin": 0.2,
    "longitudinal_roughness": 0.3,
    "azimuthal_roughness": 0.3,
}


def is_atom(wo: np.ndarray) -> np.ndarray:
    """(N,) whether draws wo (N, 3) are the atom's."""
    return wo[:, 1] == 0.0


def density(hair: dict, theta_r: float, gamma: np.ndarray, wo: np.ndarray) -> np.ndarray:
    """(N,) per steradian at wo (N, 3), where the fibre is hit at gamma (N,): the first three lobes."""
    hair = DEFAULTS | hair
    share = _shares(hair, theta_r, gamma)
    theta_i = np.arctan2(wo[:, 1], np.hypot(wo[:, 0], wo[:, 2]))
    phi = np.arctan2(wo[:, 0], wo[:, 2]) - gamma
    beta = hair["longitudinal_roughness"]
    v = (0.726 * beta + 0.812 * beta**2 + 3.7 * beta**20) ** 2
    inside = np.arcsin(np.sin(gamma) / _eta_across(theta_r))
    lobes = zip(share[:3], (-2, 1, 4), (v, v / 4, 4 * v), strict=True)
    return sum(
        a
        * _along(theta_i, theta_r + tilt * TILT, width)
        * _around(phi - (2 * p * inside - 2 * gamma + p * np.pi), hair["azimuthal_roughness"])
        for p, (a, tilt, width) in enumerate(lobes)
    )


def _eta_across(theta_r: float) -> float:
    """Index of refraction in the plane across the fibre."""
    return np.sqrt(ETA**2 - np.sin(theta_r) ** 2) / np.cos(theta_r)


def _shares(hair: dict, theta_r: float, gamma: np.ndarray) -> np.ndarray:
    """(4, N) probabilities of the lobes: their luminances."""
    absorbed = _absorption(hair)
    inside = np.sqrt(1 - (np.sin(gamma) / _eta_across(theta_r)) ** 2)
    path = 2 * inside / np.sqrt(1 - (np.sin(theta_r) / ETA) ** 2)
    passed = np.exp(-absorbed * path[:, None])
    mirror = _fresnel(np.cos(theta_r) * np.cos(gamma))[:, None]
    through = (1 - mirror) ** 2 * passed
    again = through * passed * mirror
    rest = again * passed * mirror / (1 - passed * mirror)
    share = luminance(np.stack([np.broadcast_to(mirror, passed.shape), through, again, rest]))
    return share / share.sum(axis=0)


def _absorption(hair: dict) -> np.ndarray:
    """(3,) per radius, of red, green and blue."""
    if "sigma_a" in hair:
        return np.full(3, hair["sigma_a"]["value"])
    return np.array([hair["eumelanin"], hair["pheomelanin"]]) @ MELANIN


def _fresnel(cosine: np.ndarray) -> np.ndarray:
    """Reflectance of unpolarised light from outside."""
    refracted = np.sqrt(1 - (1 - cosine**2) / ETA**2)
    across = (cosine - ETA * refracted) / (cosine + ETA * refracted)
    along = (ETA * cosine - refracted) / (ETA * cosine + refracted)
    return (across**2 + along**2) / 2


def _along(theta_i: np.ndarray, theta_r: float, v: float) -> np.ndarray:
    """d'Eon's longitudinal lobe, per steradian and 2 pi of azimuth."""
    bessel = np.cos(theta_i) * abs(np.cos(theta_r)) / v
    exponent = bessel - np.sin(theta_i) * np.sin(theta_r) / v - 1 / v
    return ive(0, bessel) * np.exp(exponent) / (v * -np.expm1(-2 / v))


def _around(phi: np.ndarray, beta: float) -> np.ndarray:
    """The trimmed logistic, per radian."""
    s = np.sqrt(np.pi / 8) * (0.265 * beta + 1.194 * beta**2 + 5.372 * beta**22)
    x = np.exp(-abs(np.mod(phi + np.pi, 2 * np.pi) - np.pi) / s)
    return x / (s * (1 + x) ** 2) / np.tanh(np.pi / (2 * s))
