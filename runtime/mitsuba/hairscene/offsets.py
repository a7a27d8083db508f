"""By calculation: the variance that models for each offset leave, by how many offsets and lobes they have.

The BSDF is evaluated at FINE offsets; models are fitted to some of them, and between those the two
neighbours are drawn from. What no sampler of directions takes away is that the light itself differs between
offsets.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hairlut.decompose import decompose
from hairlut.family import fit_family, nearness
from hairlut.fit import variance
from hairlut.offsets import OffsetData, of_grids
from hairscene.nearfield import evaluate, midpoints

FINE = 65  # offsets, even in gamma from the middle of the fibre to its rim
EACH = (9, 17, 33)  # of these, with a model each; the ends among them
LOBES = (1, 2, 3, 4)
THETA_R = np.radians([-65.0, -35.0, -5.0, 25.0, 55.0, 75.0])
THETA_I, PHI = midpoints(-np.pi / 2, np.pi / 2, 64), midpoints(0, 2 * np.pi, 72)


def left(mi: Any, bsdf: Any) -> dict:
    """Relative variances, means over theta_r: {"none": drawn exactly, "split": {offsets: a direct and a
    multiple lobe at each}, "lobes": {K: {offsets: K products at each}}}."""
    gamma = np.linspace(0, np.pi / 2, FINE)
    values = evaluate(mi, bsdf, THETA_R, THETA_I, PHI, gamma)
    data = of_grids(np.sin(gamma), THETA_R, THETA_I, PHI, values, per_steradian=True)
    some = {count: slice(None, None, (FINE - 1) // (count - 1)) for count in EACH}
    families = {k: {n: fit_family(_part(data, at), k).drawn() for n, at in some.items()} for k in LOBES}
    splits = [decompose(one).drawn(one) for one in data.at[some[max(EACH)]]]
    steps = {n: (max(EACH) - 1) // (n - 1) for n in EACH}
    return {
        "none": _total(data, data.mass),
        "split": {n: _blended(data, some[n], np.stack(splits[:: steps[n]])) for n in EACH},
        "lobes": {
            k: {n: _blended(data, some[n], drawn) for n, drawn in f.items()} for k, f in families.items()
        },
    }


def _part(data: OffsetData, at: slice) -> OffsetData:
    return OffsetData(data.offset[at], data.at[at], data.light[at])


def _blended(data: OffsetData, at: slice, drawn: np.ndarray) -> float:
    places = [nearness(data.offset[at], h) for h in data.offset]
    return _total(data, np.stack([(1 - t) * drawn[o] + t * drawn[o + 1] for o, t in places]))


def _total(data: OffsetData, drawn: np.ndarray) -> float:
    """Of one draw's estimate of all light, at a random offset: drawn (FINE, J, n, m) masses of cells."""
    weight = np.gradient(data.offset)[:, None]
    second = sum(
        w * own**2 * (1 + variance(one, q))
        for w, own, one, q in zip(weight, data.light, data.at, drawn, strict=True)
    )
    return float((second * weight.sum() / (weight * data.light).sum(axis=0) ** 2 - 1).mean())
