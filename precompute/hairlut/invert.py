# SPDX-License-Identifier: BSD-3-Clause
"""The inverse of a running integral: the angle below, or above, which a given part of the mass lies."""

import numpy as np

from .integrate import EPS, NODES, WEIGHTS, Integral
from .lobes import Array

NEWTON_STEPS, BISECTIONS = 40, 80
ALL = slice(None)


def invert(integral: Integral, m: Array, upper: Array, rows: slice | Array = ALL) -> Array:
    """Angles with the part m (K,) of a row's mass below them, or above them where upper (K,) is set, in these
    of the integral's rows; (number of rows, K).

    m in [0, 1]; with m <= 1/2 and `upper` chosen accordingly both tails come out to full relative precision.
    m = 0 gives the end of the domain exactly.
    """
    m, upper = np.broadcast_arrays(np.asarray(m, float), upper)
    numbers = np.arange(len(integral.mantissa))[rows]
    result = np.empty((len(numbers), len(m)))
    for side in (False, True):
        if (upper == side).any():
            result[:, upper == side] = _invert_side(integral, numbers, m[upper == side], side)
    return result


def _invert_side(integral: Integral, rows: Array, m: Array, upper: bool) -> Array:
    edges, running = integral.edges[rows], integral.below[rows]
    if upper:  # the same from the other end
        edges, running = edges[:, ::-1], integral.above[rows, ::-1]
    target = m * integral.mantissa[rows, None]
    panel = np.array([np.searchsorted(run, t) for run, t in zip(running, target, strict=True)])
    panel = np.clip(panel - 1, 0, running.shape[1] - 2)
    at = np.arange(len(running))[:, None]
    start, end = edges[at, panel], edges[at, panel + 1]
    rest = target - running[at, panel]
    mass = running[at, panel + 1] - running[at, panel]
    row = np.broadcast_to(rows[:, None], panel.shape)
    x = _newton(integral, row.ravel(), start.ravel(), end.ravel(), rest.ravel(), mass.ravel(), target.ravel())
    return x.reshape(panel.shape)


def _density(integral: Integral, x: Array, row: Array) -> Array:
    return np.exp(integral.rows.log_density(x, row) - integral.log_scale[row][:, None])


def _newton(
    integral: Integral, row: Array, start: Array, end: Array, rest: Array, mass: Array, target: Array
) -> Array:
    """Newton steps in the distance from a panel's start, kept inside a bracket; where rounding in a steep
    density keeps them from settling, the bracket is bisected to the end."""
    sign = np.sign(end - start)
    low, high = np.zeros_like(start), abs(end - start)
    safe = np.where(mass > 0, mass, 1.0)
    d = high * np.clip(rest / safe, 0.0, 1.0)
    active = np.flatnonzero((high > 0) & (rest > 0))
    for count in range(NEWTON_STEPS + BISECTIONS):
        if not len(active):
            break
        here, r = d[active], row[active]
        x = start[active, None] + sign[active, None] * here[:, None] * np.append(NODES, 1.0)
        p = _density(integral, x, r)
        excess = here * (p[:, :-1] @ WEIGHTS) - rest[active]
        low[active] = np.where(excess <= 0, here, low[active])
        high[active] = np.where(excess >= 0, here, high[active])
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            step = here - excess / p[:, -1]
        inside = (step >= low[active]) & (step <= high[active]) & (count < NEWTON_STEPS)
        d[active] = np.where(inside, step, (low[active] + high[active]) / 2)
        resolution = EPS * np.maximum(2 * here, abs(x[:, -1]) / 2)
        done = (abs(excess) <= 8 * EPS * target[active]) | (abs(d[active] - here) <= resolution)
        done |= high[active] - low[active] <= 2 * EPS * (abs(start[active]) + here)
        active = active[~done]
    return start + sign * d
