# SPDX-License-Identifier: BSD-3-Clause
"""The cells that a table could have, for the study and for tests of measure.py: those of version 1, parabolas
in u and straight lines, beside today's (cell.py).

With X and D a cell's low end and width in x and h its width in u, x(f) = X + f (D + C (1 - f)). The curvature
C comes from the densities at the cell's two knots, a density at a knot from the mean densities of the two
cells that meet there, blended linearly in x. |C| is kept below limit * D; limit 0 gives straight lines.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hairlut import interpolant
from hairlut.lobes import Array
from hairlut.measure import Reading
from hairlut.table import Table

LIMIT = 0.95


class Cell(NamedTuple):
    """A kind of cell: its name, and the rule by which measure.py reads a table."""

    name: str
    read: Reading


@dataclass(frozen=True)
class Parabolas:
    """What measure.py reads of a table, as interpolant.Cells; curvatures c (n, W-1)."""

    h: Array
    x: Array
    c: Array

    def angle_at(self, n: Array, i: Array, f: Array) -> Array:
        return self.read_at(n, i, f)[0]

    def read_at(self, n: Array, i: Array, f: Array) -> tuple[Array, Array]:
        d, c = self.x[n, i + 1] - self.x[n, i], self.c[n, i]
        return self.x[n, i] + f * (d + c * (1 - f)), (d + c * (1 - 2 * f)) / self.h[i]

    def column(self, x: Array) -> Array:
        i = np.clip((self.x[:, None, :] <= x[:, :, None]).sum(axis=2) - 1, 0, self.x.shape[1] - 2)
        n = np.arange(len(x))[:, None]
        d, c = self.x[n, i + 1] - self.x[n, i], self.c[n, i]
        distance = np.clip(x - self.x[n, i], 0.0, d)
        slope = np.sqrt(np.maximum((d + c) ** 2 - 4 * c * distance, 0.0))
        return i + np.clip(2 * distance / (d + c + slope), 0.0, 1.0)


def parabolas(limit: float = LIMIT) -> Reading:
    """The reading of a table's angles by parabolas, for measure(..., read=...)."""

    def read(table: Table, theta_r: Array) -> Parabolas:
        low, high = table.theta_r_range
        r = np.clip((theta_r - low) / (high - low), 0, 1) * (table.height - 1)
        j = np.minimum(r.astype(int), table.height - 2)
        t = (r - j)[:, None]
        x = table.texels.astype(float)
        h = table.warp.widths(table.width)
        blended = ((1 - t) * part[j] + t * part[j + 1] for part in (x, curvatures(x, h, limit)))
        return Parabolas(h, *blended)

    return read


def curvatures(x: Array, h: Array, limit: float) -> Array:
    """(H, W-1) curvature of every cell of the rows x (H, W), h (W-1,) being the cells' widths in u."""
    d = np.diff(x, axis=1)
    before, after = d[:, :-1], d[:, 1:]
    slope = (before + after) / (after * h[:-1] / before + before * h[1:] / after)  # dx/du at the inner knots
    c = np.empty_like(d)
    c[:, 1:-1] = h[1:-1] * (slope[:, :-1] - slope[:, 1:]) / 2
    # the inner end of an end cell has the mean slope of the next cell
    c[:, 0] = d[:, 0] - h[0] * d[:, 1] / h[1]
    c[:, -1] = h[-1] * d[:, -2] / h[-2] - d[:, -1]
    return np.clip(c, -limit * d, limit * d)


LINEAR, PARABOLA, RATIONAL = (
    Cell("linear", parabolas(0.0)),
    Cell("parabola", parabolas()),
    Cell("rational quadratic", interpolant.cells),
)
CELLS = LINEAR, PARABOLA, RATIONAL
