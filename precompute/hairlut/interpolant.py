# SPDX-License-Identifier: BSD-3-Clause
"""How a table is read (luts/FORMAT.md): between its rows and columns, and backwards. In double precision.

The angles and slopes of two neighbouring rows are blended linearly in theta_r, and between two blended knots
lies a cell (cell.py). The blend of two quantile functions is again one, with these values and slopes at the
knots. Where a table depends on parameters of the hair, the rows of the 2^d nodes around their values are
blended likewise (axes.py); `parameters` has a value for each of the table's axes, and may have more.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from . import cell
from .axes import NO_PARAMETERS, corners
from .lobes import Array
from .table import Table


@dataclass(frozen=True)
class Cells:
    """The cells of a table at n viewer inclinations: angles x and slopes dx/du of the knots, (n, W), and the
    cells' widths h (W-1,) in u."""

    h: Array
    x: Array
    slopes: Array

    def angle(self, f: Array) -> Array:
        """(n, W-1, K) angles at the fractions f (K,) of every cell."""
        return cell.angle(*self._all(), np.asarray(f))

    def slope(self, f: Array) -> Array:
        """(n, W-1, K) dx/du at the fractions f (K,) of every cell; always positive."""
        return cell.slope(*self._all(), np.asarray(f))

    def density(self, f: Array) -> Array:
        """(n, W-1, K) density of the table, per rad, at the fractions f (K,) of every cell."""
        return 1 / self.slope(f)

    def read(self, f: Array) -> tuple[Array, Array]:
        """(angles, dx/du), each (n, W-1, K), at the fractions f (K,) of every cell."""
        return cell.read(*self._all(), np.asarray(f))

    def angle_at(self, n: Array, i: Array, f: Array) -> Array:
        """Angles at the fractions f of the cells i of the inclinations number n, all broadcasting."""
        return cell.angle(*self._one(n, i), f)

    def slope_at(self, n: Array, i: Array, f: Array) -> Array:
        """dx/du, likewise."""
        return cell.slope(*self._one(n, i), f)

    def read_at(self, n: Array, i: Array, f: Array) -> tuple[Array, Array]:
        """(angles, dx/du), likewise."""
        return cell.read(*self._one(n, i), f)

    def column(self, x: Array) -> Array:
        """(n, K) columns, with their fractions, at which the angles x (n, K) lie; x is clamped to the
        row's ends."""
        i = np.clip((self.x[:, None, :] <= x[:, :, None]).sum(axis=2) - 1, 0, self.x.shape[1] - 2)
        return i + self.locate(np.arange(len(x))[:, None], i, x)[0]

    def locate(self, n: Array, i: Array, x: Array) -> tuple[Array, Array]:
        """(fraction f, dx/du) at which the angles x lie in the cells i, likewise."""
        return cell.locate(*self._one(n, i), x)

    def _all(self) -> tuple[Array, ...]:
        knots = self.x[:, :-1], self.x[:, 1:], self.slopes[:, :-1], self.slopes[:, 1:]
        return *(part[..., None] for part in knots), self.h[:, None]

    def _one(self, n: Array, i: Array) -> tuple[Array, ...]:
        return self.x[n, i], self.x[n, i + 1], self.slopes[n, i], self.slopes[n, i + 1], self.h[i]


def cells(table: Table, theta_r: Array, parameters: Mapping[str, Array] = NO_PARAMETERS) -> Cells:
    """The blended cells at theta_r (n,); theta_r outside the table's range is clamped, NaN to its low end."""
    rows = _rows(table, np.atleast_1d(theta_r), parameters)
    return Cells(table.warp.widths(table.width), *(rows.blend(each) for each in (table.texels, table.slopes)))


def sample(
    table: Table, theta_r: Array, u: Array, parameters: Mapping[str, Array] = NO_PARAMETERS
) -> tuple[Array, Array]:
    """(angle, density) drawn at theta_r (n,) with the numbers u (n,); u is clamped to [0, 1]."""
    theta_r, u = np.broadcast_arrays(np.atleast_1d(theta_r), np.atleast_1d(u))
    u = np.clip(u.astype(float), 0.0, 1.0)
    upper = u > 0.5
    return sample_tail(table, theta_r, np.where(upper, 1 - u, u), upper, parameters)


def sample_tail(
    table: Table, theta_r: Array, m: Array, upper: Array, parameters: Mapping[str, Array] = NO_PARAMETERS
) -> tuple[Array, Array]:
    """As sample, for u = m, or u = 1 - m where upper; all (n,). Both tails keep the precision of m."""
    i, f = table.warp.place(m, upper, table.width)
    angle, slope = cell.read(*_knots(table, _rows(table, theta_r, parameters), i), f)
    return angle, 1 / slope


def locate(
    table: Table, theta_r: Array, x: Array, parameters: Mapping[str, Array] = NO_PARAMETERS
) -> tuple[Array, Array, Array]:
    """(cell i, fraction f, slope dx/du), each (n,), at which x (n,) lies; x is clamped to the row's ends."""
    rows = _rows(table, theta_r, parameters)
    i, above = np.zeros(len(x), int), np.full(len(x), table.width - 1)
    for _ in range((table.width - 2).bit_length()):
        middle = (i + above) // 2
        beyond = rows.blend(table.texels, middle) > x
        i, above = np.where(beyond, i, middle), np.where(beyond, middle, above)
    i = np.minimum(i, table.width - 2)
    return i, *cell.locate(*_knots(table, rows, i), x)


@dataclass(frozen=True)
class _Rows:
    """Rows of a table, and the part of each in the blend at n places: (rows, n)."""

    row: Array
    part: Array

    def blend(self, values: Array, column: Array | None = None) -> Array:
        """Of values (rows of the table, W): in one column (n,) of each place (n,), or in every one (n, W)."""
        if column is None:
            return np.einsum("rn,rnw->nw", self.part, values[self.row])
        return (self.part * values[self.row, column]).sum(axis=0)


def _rows(table: Table, theta_r: Array, parameters: Mapping[str, Array]) -> _Rows:
    """Two rows of each node around the parameters' values, at theta_r (n,)."""
    low, high = table.theta_r_range
    last = table.height - 1
    r = np.clip(np.nan_to_num(np.asarray(theta_r, float), nan=low), low, high)
    r = np.clip((r - low) / (high - low) * last, 0, last)
    j = np.minimum(r.astype(int), last - 1)
    t = r - j
    node, part = corners(table.axes, parameters, j.shape)
    first = node * table.height + j
    return _Rows(np.concatenate([first, first + 1]), np.concatenate([part * (1 - t), part * t]))


def _knots(table: Table, rows: _Rows, i: Array) -> tuple[Array, ...]:
    """Angles, slopes and width in u of the blended cells i, as the functions of cell.py take them."""
    ends = (rows.blend(values, k) for values in (table.texels, table.slopes) for k in (i, i + 1))
    return *ends, table.warp.widths(table.width)[i]


def pdf(table: Table, theta_r: Array, x: Array, parameters: Mapping[str, Array] = NO_PARAMETERS) -> Array:
    """(n,) density, per rad, with which sample draws x (n,) at theta_r (n,); 0 outside the domain."""
    theta_r, x = np.broadcast_arrays(np.atleast_1d(theta_r), np.atleast_1d(x))
    _, _, slope = locate(table, theta_r, np.nan_to_num(x), parameters)
    low, high = np.float32(table.domain)
    return np.where((x >= low) & (x <= high), 1 / slope, 0.0)


def invert(table: Table, theta_r: Array, x: Array) -> Array:
    """(n,) the numbers u from which sample draws x (n,) at theta_r (n,), of a table without axes."""
    m, upper = invert_tail(table, theta_r, x)
    return np.where(upper, 1 - m, m)


def invert_tail(table: Table, theta_r: Array, x: Array) -> tuple[Array, Array]:
    """(m, upper), each (n,): u = m, or u = 1 - m where upper."""
    theta_r, x = np.broadcast_arrays(np.atleast_1d(theta_r), np.atleast_1d(x))
    i, f, _ = locate(table, theta_r, x)
    h = table.warp.widths(table.width)[i]
    m, _ = table.warp.knots(table.width)
    low, high = m[i] + f * h, m[i + 1] + (1 - f) * h
    # whether the cell lies above u = 1/2; the middle one is counted from the low end
    upper = 2 * i + 1 > table.width - 1
    folded = np.where(upper, high, low)
    beyond = folded > 0.5
    return np.where(beyond, 1 - folded, folded), upper ^ beyond
