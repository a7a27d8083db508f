# SPDX-License-Identifier: BSD-3-Clause
"""By calculation: the variance that a family leaves, by the offsets that it is fitted to, and by its lobes.

The BSDF is evaluated at FINE offsets; families are fitted to some of them, and drawn from at all. What no
sampler of directions takes away is that the light itself differs between offsets.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hairlut.fit.family import fit_family
from hairlut.fit.model import variance
from hairlut.fit.offsets import OffsetData, of_grids
from report.hairscene.nearfield import evaluate, midpoints

FINE = 65  # offsets, even in gamma from the middle of the fibre to its rim
EACH = (5, 9, 17)  # of these, to which a family is fitted; the ends among them
LOBES = (1, 2, 3, 4)
THETA_R = np.radians([-60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0])
THETA_I, PHI = midpoints(-np.pi / 2, np.pi / 2, 64), midpoints(0, 2 * np.pi, 72)


def left(mi: Any, bsdf: Any) -> dict:
    """Relative variances, means over theta_r: {"none": drawn exactly, "lobes": {K: {offsets: K lobes}}}."""
    gamma = np.linspace(0, np.pi / 2, FINE)
    values = evaluate(mi, bsdf, THETA_R, THETA_I, PHI, gamma)
    data = of_grids(np.sin(gamma), THETA_R, THETA_I, PHI, values, per_steradian=True)
    some = {n: data.at_offsets(slice(None, None, (FINE - 1) // (n - 1))) for n in EACH}
    return {
        "none": _total(data, [one.mass for one in data.at]),
        "lobes": {k: {n: _of_family(data, part, k) for n, part in some.items()} for k in LOBES},
    }


def _of_family(data: OffsetData, part: OffsetData, lobes: int) -> float:
    family = fit_family(part, lobes)
    return _total(data, [family.drawn(h) for h in data.offset])


def _total(data: OffsetData, drawn: list[np.ndarray]) -> float:
    """Of one draw's estimate of all light, at a random offset: drawn FINE (J, n, m) masses of cells."""
    weight = np.gradient(data.offset)[:, None]
    second = sum(
        w * own**2 * (1 + variance(one, q))
        for w, own, one, q in zip(weight, data.light, data.at, drawn, strict=True)
    )
    return float((second * weight.sum() / (weight * data.light).sum(axis=0) ** 2 - 1).mean())
