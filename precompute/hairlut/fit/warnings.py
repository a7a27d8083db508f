# SPDX-License-Identifier: BSD-3-Clause
"""Warnings about what a file likely means by f: a cosine too many or too few costs samples, and nothing else
shows it.

A fibre scatters at most the light that it receives, and its f is the same when light and viewer change
places. Where f is not so, but f over a power of cos(theta_i) is, the file probably has f in another measure.
"""

from __future__ import annotations

import numpy as np

from ..lobes import Array
from .cells import Density
from .hair import Hair
from .promise import Losses
from .turning import TWO_PI

MOST_ENERGY = 1.5  # of the light received; numerical models of hair exceed 1 by a few percent
STEEP = np.radians(75.0)  # larger theta_r are not judged: many models gain energy there
PAIRS, OFFSETS = 200, 32
UNLIKE, ALIKE = 0.05, 0.005  # median difference of logarithms
MEANING = {
    1: "it seems to have the cosine already: leave cos(theta_i) out",
    2: "it seems to be per rad^2 in (theta_i, phi): divide by cos(theta_i)^2",
}


def warnings(hair: Hair, loss: Losses) -> list[str]:
    """Warnings about a hair, of whose light `loss` has the sums. A grid may be in any unit."""
    energy = _energy(loss) if hair.nodes is None else ""
    return [text for text in (energy, _reciprocity(hair)) if text]


def _energy(loss: Losses) -> str:
    light = np.where(abs(loss.theta_r) < STEEP, loss.light.mean(axis=1), 0.0)
    worst = int(light.argmax())
    if light[worst] <= MOST_ENERGY:
        return ""
    return (
        f"the fibre scatters {light[worst]:.3g} times the light that it receives at theta_r = "
        f"{np.degrees(loss.theta_r[worst]):.3g} deg, integral of f cos(theta_i) domega: is f per "
        "steradian, and without the cosine?"
    )


def _reciprocity(hair: Hair) -> str:
    random = np.random.default_rng(0)
    a, b = np.radians(random.uniform(-70, 70, (2, PAIRS)))
    phi = random.uniform(0, TWO_PI, PAIRS)
    there, back = _mean(hair, a, b, phi), _mean(hair, b, a, TWO_PI - phi)
    bright = np.sqrt(there) * np.sqrt(back)
    kept = bright > np.median(bright)
    if not kept.any():
        return ""
    ratio = np.log(there[kept] / back[kept])
    cosines = np.log(np.cos(b[kept]) / np.cos(a[kept]))

    def unlike(power: int) -> float:
        return float(np.median(abs(ratio - power * cosines)))

    if unlike(0) < UNLIKE:
        return ""
    for power, meaning in MEANING.items():
        if unlike(power) < ALIKE:
            return (
                f"not f, but f / cos(theta_i)^{power} is the same from theta_i to theta_r as back: {meaning}"
            )
    return ""


def _mean(hair: Hair, theta_r: Array, theta_i: Array, phi: Array) -> Array:
    """f, the mean over the offsets."""
    offset = np.sin(hair.angles(OFFSETS))[:, None] if hair.offsets else np.zeros((1, 1))
    density: Density = hair.density
    values = density(theta_r, theta_i, phi, offset)
    if hair.mirrored:
        values = values + density(theta_r, theta_i, TWO_PI - phi, offset)
    return np.broadcast_to(values, (len(offset), len(phi))).mean(axis=0) / np.cos(theta_i) ** 2
