"""How a table is read (luts/FORMAT.md): between its rows and columns, and backwards. In double precision.

Each cell of a row is a parabola in u. With X and D the cell's low end and width in x, h its width in u and f
the fraction of it at which u lies,

    x(f) = X + f (D + C (1 - f)),    dx/df = D + C (1 - 2f),    density = h / (dx/df).

The curvature C comes from the densities at the cell's two knots, and a density at a knot from the mean
densities of the two cells that meet there, blended linearly in x. C is kept below limit * D, so that the
slope stays positive. X, D and C of two neighbouring rows are blended linearly in theta_r.
"""

from dataclasses import dataclass

import numpy as np

from .lobes import Array
from .table import Table


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
    bound = limit * abs(d)  # rows that are counted from their high end fall
    return np.clip(c, -bound, bound)


@dataclass(frozen=True)
class Cells:
    """The cells of a table at n viewer inclinations: low end x0, width d, curvature c, each (n, W-1), and
    their widths h (W-1,) in u."""

    h: Array
    x0: Array
    d: Array
    c: Array

    def angle(self, f: Array) -> Array:
        """(n, W-1, K) angles at the fractions f (K,) of every cell."""
        return _angle(self.x0[..., None], self.d[..., None], self.c[..., None], f)

    def slope(self, f: Array) -> Array:
        """(n, W-1, K) dx/df at the fractions f (K,) of every cell; always positive."""
        return _slope(self.d[..., None], self.c[..., None], np.asarray(f))

    def density(self, f: Array) -> Array:
        """(n, W-1, K) density of the table, per rad, at the fractions f (K,) of every cell."""
        return self.h[:, None] / self.slope(f)

    def angle_at(self, n: Array, i: Array, f: Array) -> Array:
        """Angles at the fractions f of the cells i of the inclinations number n, all broadcasting."""
        return _angle(self.x0[n, i], self.d[n, i], self.c[n, i], f)

    def slope_at(self, n: Array, i: Array, f: Array) -> Array:
        """dx/df, likewise."""
        return _slope(self.d[n, i], self.c[n, i], f)

    def column(self, x: Array) -> Array:
        """(n, K) columns, with their fractions, at which the angles x (n, K) lie; x is clamped to the
        row's ends."""
        i = np.maximum((self.x0[:, None, :] <= x[:, :, None]).sum(axis=2) - 1, 0)
        return i + self.fraction_at(np.arange(len(x))[:, None], i, x)[0]

    def fraction_at(self, n: Array, i: Array, x: Array) -> tuple[Array, Array]:
        """(fraction f, slope dx/df) at which the angles x lie in the cells i, likewise."""
        d, c = self.d[n, i], self.c[n, i]
        distance = np.clip(x - self.x0[n, i], 0.0, d)
        slope = np.sqrt(np.maximum((d + c) ** 2 - 4 * c * distance, 0.0))
        return np.clip(2 * distance / (d + c + slope), 0.0, 1.0), slope


def _angle(x0: Array, d: Array, c: Array, f: Array) -> Array:
    return x0 + f * (d + c * (1 - f))


def _slope(d: Array, c: Array, f: Array) -> Array:
    return d + c * (1 - 2 * f)


def cells(table: Table, theta_r: Array) -> Cells:
    """The blended cells at theta_r (n,); theta_r outside the table's range is clamped, NaN to its low end."""
    low, high = table.theta_r_range
    last = table.height - 1
    r = np.clip(np.nan_to_num(np.atleast_1d(theta_r).astype(float), nan=low), low, high)
    r = np.clip((r - low) / (high - low) * last, 0, last)
    j = np.minimum(r.astype(int), last - 1)
    t = (r - j)[:, None]
    x = table.texels.astype(float)
    h = table.warp.widths(table.width)
    parts = x[:, :-1], np.diff(x, axis=1), curvatures(x, h, table.cell.limit)
    return Cells(h, *((1 - t) * part[j] + t * part[j + 1] for part in parts))


def sample(table: Table, theta_r: Array, u: Array) -> tuple[Array, Array]:
    """(angle, density) drawn at theta_r (n,) with the numbers u (n,); u is clamped to [0, 1]."""
    theta_r, u = np.broadcast_arrays(np.atleast_1d(theta_r), np.atleast_1d(u))
    u = np.clip(u.astype(float), 0.0, 1.0)
    upper = u > 0.5
    return sample_tail(table, theta_r, np.where(upper, 1 - u, u), upper)


def sample_tail(table: Table, theta_r: Array, m: Array, upper: Array) -> tuple[Array, Array]:
    """As sample, for u = m, or u = 1 - m where upper; all (n,). Both tails keep the precision of m."""
    read = cells(table, theta_r)
    i, f = table.warp.place(m, upper, table.width)
    n = np.arange(len(i))
    return read.angle_at(n, i, f), read.h[i] / read.slope_at(n, i, f)


def locate(table: Table, theta_r: Array, x: Array) -> tuple[Array, Array, Array, Array]:
    """(cell i, its width h in u, fraction f, slope dx/df), each (n,), at which x (n,) lies; x is clamped to
    the row's ends."""
    read = cells(table, theta_r)
    i = np.clip((read.x0 <= np.asarray(x)[:, None]).sum(axis=1) - 1, 0, table.width - 2)
    return i, read.h[i], *read.fraction_at(np.arange(len(i)), i, x)


def pdf(table: Table, theta_r: Array, x: Array) -> Array:
    """(n,) density, per rad, with which sample draws x (n,) at theta_r (n,); 0 outside the domain."""
    theta_r, x = np.broadcast_arrays(np.atleast_1d(theta_r), np.atleast_1d(x))
    _, h, _, slope = locate(table, theta_r, np.nan_to_num(x))
    low, high = np.float32(table.domain)
    return np.where((x >= low) & (x <= high), h / slope, 0.0)


def invert(table: Table, theta_r: Array, x: Array) -> Array:
    """(n,) the numbers u from which sample draws x (n,) at theta_r (n,)."""
    m, upper = invert_tail(table, theta_r, x)
    return np.where(upper, 1 - m, m)


def invert_tail(table: Table, theta_r: Array, x: Array) -> tuple[Array, Array]:
    """(m, upper), each (n,): u = m, or u = 1 - m where upper."""
    theta_r, x = np.broadcast_arrays(np.atleast_1d(theta_r), np.atleast_1d(x))
    i, h, f, _ = locate(table, theta_r, x)
    m, _ = table.warp.knots(table.width)
    low, high = m[i] + f * h, m[i + 1] + (1 - f) * h
    # whether the cell lies above u = 1/2; the middle one is counted from the low end
    upper = 2 * i + 1 > table.width - 1
    folded = np.where(upper, high, low)
    beyond = folded > 0.5
    return np.where(beyond, 1 - folded, folded), upper ^ beyond
