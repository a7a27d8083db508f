# SPDX-License-Identifier: BSD-3-Clause
"""Tables of smooth rows: the smallest that lose no more than a given relative variance.

A table's rows are evenly spaced in theta_r. The rows of a fit are so too, so every table takes each s-th of
them, and what it loses on the others is measured there."""

from __future__ import annotations

import numpy as np

from .. import interpolant
from ..errors import HairlutError
from ..lobes import HALF_PI, NO_FORMULA, Array, Lobe
from ..table import Table, tabulate
from ..warp import Warp
from .smooth import SmoothRows
from .turning import TWO_PI

WIDTHS = 12, 16, 20, 24, 32, 40, 48, 64, 80, 96, 128, 160, 192, 256
EXPONENTS = -5, -8, -11, -14, -17  # of the warp's e
HEAVY = 4.0  # above this weight, a table's loss counts as many times as its weight is larger
FROM_WIDTH = 0.5  # part of the loss that the width may make; the rest is the height's
_nodes, _weights = np.polynomial.legendre.leggauss(4)
NODES, WEIGHTS = (_nodes + 1) / 2, _weights / 2


def smallest(name: str, model: str, exact: SmoothRows, importance: Array, loss: float) -> Table:
    """The table of fewest texels that loses at most `loss`, or else the best one. importance (J,): the
    lobe's share in the light of each row, by which its variance counts."""
    best = _widest_enough(name, model, exact, importance, loss * FROM_WIDTH)
    last = len(exact.theta_r) - 1
    for step in (s for s in range(last, 1, -1) if last % s == 0):
        table = _table(name, model, exact, best.width, best.warp, step)
        if table and _loss(table, exact, importance) <= loss:
            return table
    return best


def _widest_enough(name: str, model: str, exact: SmoothRows, importance: Array, loss: float) -> Table:
    best: tuple[float, Table] | None = None
    for width in WIDTHS:
        for exponent in EXPONENTS:
            table = _table(name, model, exact, width, Warp("octaves", 2.0**exponent), 1)
            if not table:
                continue
            lost = _loss(table, exact, importance)
            if best is None or lost < best[0]:
                best = lost, table
        if best and best[0] <= loss:
            break
    if best is None:
        raise HairlutError(f"{model}/{name}: its light is too narrow for a table of 32-bit floats")
    return best[1]


def _loss(table: Table, exact: SmoothRows, importance: Array) -> float:
    """The worst row's relative variance, times its importance; more where weights are large."""
    read = interpolant.cells(table, exact.theta_r)
    x, slope = read.angle(NODES), read.slope(NODES)
    weight = exact.density(x, np.arange(len(x))[:, None, None]) * slope
    variance = (((weight - 1) ** 2 @ WEIGHTS) * read.h).sum(axis=1)
    heavy = np.maximum(weight.max(axis=(1, 2)) / HEAVY, 1.0)
    return float((variance * heavy * importance).max())


def _table(name: str, model: str, exact: SmoothRows, width: int, warp: Warp, step: int) -> Table | None:
    try:
        return tabulate(_lobe(name, model, exact), exact, width, warp, slice(None, None, step))
    except HairlutError:  # some cell is flat
        return None


def _lobe(name: str, model: str, exact: SmoothRows) -> Lobe:
    """What a table's header says of it."""
    of_phi = name.endswith("_phi")
    return Lobe(
        model=model,
        name=name,
        angle="phi" if of_phi else "theta_i",
        azimuth="difference" if of_phi else "none",
        domain=(0.0, TWO_PI) if of_phi else (-HALF_PI, HALF_PI),
        log_density=_unused,
        formula=NO_FORMULA,
        theta_r_range=(float(exact.theta_r[0]), float(exact.theta_r[-1])),
    )


def _unused(x: Array, theta_r: Array) -> Array:
    raise NotImplementedError("a fitted lobe is known by its rows")
