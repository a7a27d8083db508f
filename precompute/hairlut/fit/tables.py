# SPDX-License-Identifier: BSD-3-Clause
"""Tables of smooth rows: the smallest that lose no more than a given relative variance.

A table's rows are evenly spaced in theta_r. The rows of a fit are so too, so every table takes each s-th of
them, and what it loses on the others is measured there."""

from __future__ import annotations

from dataclasses import dataclass, replace

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
HEAVIEST = 4.0
CLOSE = 1.5  # times the least loss, where no table meets the need: what is as good as that
FROM_WIDTH = 0.5  # part of the loss that the width may make; the rest is the height's
_nodes, _weights = np.polynomial.legendre.leggauss(4)
NODES, WEIGHTS = (_nodes + 1) / 2, _weights / 2


@dataclass(frozen=True)
class Need:
    """What each row of a table is worth, (J,): importance, the lobe's share in the row's light; bright, the
    part of the row's own peak above which its weights count. loss: relative variance that it may cost.
    heaviest: the largest weight that it may cause where its lobe is bright: lobes of little light are alone
    at some azimuths, so that their importance does not forgive it."""

    importance: Array
    bright: Array
    loss: float
    heaviest: float = HEAVIEST

    def eased(self, times: float) -> Need:
        """What a smaller table can do: `times` the loss, and a heaviest weight that grows more slowly."""
        return replace(self, loss=self.loss * times, heaviest=self.heaviest * times**0.5)


def smallest(name: str, model: str, exact: SmoothRows, need: Need) -> Table:
    """The table of fewest texels that does what is needed, or else one that comes close to the best."""
    wide = _wide_enough(name, model, exact, replace(need, loss=need.loss * FROM_WIDTH))
    allowed = max(1.0, CLOSE * part_lost(wide, exact, need))
    last = len(exact.theta_r) - 1
    for step in (s for s in range(last, 1, -1) if last % s == 0):
        table = table_of(name, model, exact, wide.width, wide.warp, step)
        if table and part_lost(table, exact, need) <= allowed:
            return table
    return wide


def _wide_enough(name: str, model: str, exact: SmoothRows, need: Need) -> Table:
    """The narrowest table of all rows that does what is needed, or comes close to the best."""
    found: list[tuple[float, Table]] = []
    for width in WIDTHS:
        tried = [
            table_of(name, model, exact, width, Warp("octaves", 2.0**exponent), 1) for exponent in EXPONENTS
        ]
        lost = [(part_lost(table, exact, need), table) for table in tried if table]
        if lost:
            found.append(min(lost, key=lambda one: one[0]))
            if found[-1][0] <= 1:
                return found[-1][1]
    if not found:
        raise HairlutError(f"{model}/{name}: its light is too narrow for a table of 32-bit floats")
    allowed = CLOSE * min(lost for lost, _ in found)
    return next(table for lost, table in found if lost <= allowed)


def part_lost(table: Table, exact: SmoothRows, need: Need) -> float:
    """The worst row's variance or largest weight, as a part of what is allowed."""
    read = interpolant.cells(table, exact.theta_r)
    x, slope = read.angle(NODES), read.slope(NODES)
    density = exact.density(x, np.arange(len(x))[:, None, None])
    weight = density * slope
    variance = (((weight - 1) ** 2 @ WEIGHTS) * read.h).sum(axis=1)
    light = density / np.cos(x) if table.angle == "theta_i" else density
    bright = light > need.bright[:, None, None] * light.max(axis=(1, 2), keepdims=True)
    heaviest = np.where(bright, weight, 0.0).max()
    return float(max((variance * need.importance).max() / need.loss, heaviest / need.heaviest))


def table_of(name: str, model: str, exact: SmoothRows, width: int, warp: Warp, step: int) -> Table | None:
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
