# SPDX-License-Identifier: BSD-3-Clause
"""Quick estimates of a table's relative variance V, for the search of its size (size.py).

Between two rows V comes from two sources that hardly depend on each other: the width, on the rows themselves,
and the blend of two rows, which is worst midway. The first is estimated on a few rows, the second at the few
places where it was largest on a table of PROBE rows. Each cell is summed by a fixed rule: what a table costs
in the end is measured by measure.py.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from .errors import HairlutError
from .exact import Exact, exact_at
from .interpolant import Cells
from .lobes import Array, Lobe
from .measure import NODES, WEIGHTS, inclinations, narrowest_cell
from .slopes import fitted
from .table import Table, density_at, exact_knots, row_angles, tabulate
from .warp import Warp

PROBE = 33  # rows
FEW_ROWS = 17
FINE = 257  # columns
PLACES = 6
MIN_STEPS = 2.0  # of a float, that the narrowest cell spans
EXPONENTS = range(-34, 1)  # of e
COARSE = 4  # every so many exponents are tried first


class Sketch:
    """Estimates of V for tables of one lobe; infinite where a cell is too narrow for float32."""

    def __init__(self, lobe: Lobe) -> None:
        self.lobe = lobe
        self.height = lobe.own_height or PROBE
        self.exact = exact_at(lobe, inclinations(lobe.theta_r_range, self.height, 1))
        rows = 2 * np.arange(self.height)
        self.few = rows[:: max(1, (self.height - 1) // (FEW_ROWS - 1))]
        self.fine = Warp("octaves", 2.0 ** EXPONENTS[0])
        self.cells = Cells(self.fine.widths(FINE), *exact_knots(self.exact, FINE, self.fine, self.few))
        self.on_rows = cache(self._on_rows)
        self.best_exponent = cache(self._best_exponent)

    def _on_rows(self, width: int, exponent: int) -> float:
        """V on the few rows alone."""
        warp = Warp("octaves", 2.0**exponent)
        m, upper = warp.knots(width)
        middle = (m[0] + m[1]) / 2
        quantiles = self._quantiles(np.append(m, [middle, middle]), np.append(upper, [False, True]))
        x, middles = quantiles[:, :-2], (quantiles[:, -2], quantiles[:, -1])
        if not narrowest_cell(x.astype(np.float32)) >= MIN_STEPS:
            return np.inf
        h = warp.widths(width)
        slopes = fitted(x, h, density_at(self.exact, x, self.few), middles)
        return float(_variance(x, slopes, h, self.exact, self.few).max())

    def _quantiles(self, m: Array, upper: Array) -> Array:
        """(rows, K) angles of the tails m, upper (K,), read from a fine table instead of inverted."""
        i, f = self.fine.place(m, upper, FINE)
        return self.cells.angle_at(np.arange(len(self.few))[:, None], i, f)

    def _best_exponent(self, width: int, near: int | None = None) -> int:
        """The exponent of e with the least V on rows, downhill from near, or from the best of a few."""

        def variance(exponent: int) -> tuple[float, int]:
            return self.on_rows(width, exponent), -exponent

        here = min(EXPONENTS[::COARSE], key=variance) if near is None else near
        step = COARSE // 2 if near is None else 1
        while step:
            best = min((e for e in (here, here + step, here - step) if e in EXPONENTS), key=variance)
            step = step if best != here else step // 2
            here = best
        return here

    def blend(self, width: int, exponent: int) -> tuple[float, Array]:
        """(V midway between the probe's rows, beyond that on the rows; theta_r of the worst PLACES)."""
        rows, middles = 2 * np.arange(self.height), 2 * np.arange(self.height - 1) + 1
        warp = Warp("octaves", 2.0**exponent)
        x, slopes = exact_knots(self.exact, width, warp, rows)
        h = warp.widths(width)
        on_rows = _variance(x, slopes, h, self.exact, rows)
        found = _variance(_midway(x), _midway(slopes), h, self.exact, middles)
        worst = np.argsort(found)[-PLACES:]
        return float((found - _midway(on_rows)).max()), self.exact.theta_r[middles[worst]]

    def between(self, width: int, exponent: int, height: int, places: Array) -> float:
        """V on rows, and midway between those rows of `height` that have these theta_r (P,) between them."""
        theta_r = row_angles(self.lobe.theta_r_range, height)
        j = np.unique(np.clip(np.searchsorted(theta_r, places) - 1, 0, height - 2))
        angles = np.concatenate([theta_r[j], theta_r[j + 1], (theta_r[j] + theta_r[j + 1]) / 2])
        exact = exact_at(self.lobe, angles)
        count = len(j)
        warp = Warp("octaves", 2.0**exponent)
        knots = exact_knots(exact, width, warp, np.arange(2 * count))
        x, slopes = ((rows[:count] + rows[count:]) / 2 for rows in knots)
        blended = _variance(x, slopes, warp.widths(width), exact, np.arange(2 * count, 3 * count))
        return max(float(blended.max()), self.on_rows(width, exponent))


def usable(
    lobe: Lobe, exact: Exact, width: int, exponent: int, rows: slice | Array = slice(None)
) -> Table | None:
    """The table whose rows are these of the exact lobe's; None if a cell is flat or too narrow for
    float32."""
    try:
        table = tabulate(lobe, exact, width, Warp("octaves", 2.0**exponent), rows)
    except HairlutError:  # flat cells
        return None
    return table if narrowest_cell(table.texels) >= MIN_STEPS else None


def _midway(rows: Array) -> Array:
    return (rows[:-1] + rows[1:]) / 2


def _variance(x: Array, slopes: Array, h: Array, exact: Exact, row: Array) -> Array:
    """(n,) V of knots x, slopes (n, W), h (W-1,) apart in u, at the inclinations numbered row (n,)."""
    angle, slope = Cells(h, x, slopes).read(NODES)
    inclination = np.repeat(row, angle[0].size)
    density = exact.density(angle.reshape(1, -1), inclination).reshape(angle.shape)
    return ((density * slope - 1) ** 2 @ WEIGHTS) @ h
