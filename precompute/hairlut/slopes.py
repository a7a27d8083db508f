# SPDX-License-Identifier: BSD-3-Clause
"""The slopes dx/du of a table's knots.

At an inner knot the slope is the exact one, 1 / density. Two places need another:

* Where the density all but vanishes, in a gap between two modes, the exact slope would crowd the mass of both
  cells beside it at their far ends. It is kept below LARGEST_INNER times the smaller of their secants (the
  study has V and the largest weight of other bounds).
* At the ends of the domain 1 / density may be 1e80. There the slope is the one whose cell is exact in the
  middle: half of the end cell's mass lies on either side of the true quantile.
"""

import numpy as np

from .lobes import Array

LARGEST_INNER = 8.0  # of the smaller secant beside a knot
END_RANGE = 1 / 8, 256.0  # of the end cell's secant
DERIVED_RANGE = 1 / 8, 8.0
RANGE = 1e-9, 1e12  # rad per unit of u: what a reader accepts


def fitted(
    x: Array, h: Array, density: Array, middle: tuple[Array, Array], largest: float = LARGEST_INNER
) -> Array:
    """(H, W) slopes of rows x (H, W) whose cells have the widths h (W-1,) in u.

    density: (H, W) of the lobe at x, per rad; the columns at the ends are not used. middle: (H,) angles of
    the lobe at the middle in u of the first and of the last cell. largest: bound of an inner slope, relative
    to the smaller secant beside it.
    """
    secant = np.diff(x, axis=1) / h
    with np.errstate(divide="ignore"):
        slopes = 1 / density
    inner = slice(1, -1)
    slopes[:, inner] = np.minimum(slopes[:, inner], largest * np.minimum(secant[:, :-1], secant[:, 1:]))
    first, last = middle
    slopes[:, 0] = _through(first - x[:, 0], x[:, 1] - first, secant[:, 0], slopes[:, 1])
    slopes[:, -1] = _through(x[:, -1] - last, last - x[:, -2], secant[:, -1], slopes[:, -2])
    return np.clip(slopes, *RANGE)


def _through(before: Array, after: Array, s: Array, inner: Array) -> Array:
    """Slope at the outer end of a cell whose middle in u divides it into the angles before and after.

    x - x0 = w (s + d0) / (2 s + d0 + d1) at f = 1/2, solved for d0; before + after = w.
    """
    with np.errstate(divide="ignore", invalid="ignore"):  # of cells without a width, which are refused
        slope = ((before - after) * s + before * inner) / after
    low, high = END_RANGE
    return np.clip(slope, low * s, high * s)


def derived(x: Array, h: Array) -> Array:
    """(H, W) slopes of a table that has none (format 1): at an inner knot those of the mean densities of both
    cells, blended linearly in x; an end cell has its own mean slope in the middle, within DERIVED_RANGE."""
    x = np.asarray(x, float)
    w = np.diff(x, axis=1)
    before, after = w[:, :-1], w[:, 1:]
    slopes = np.empty_like(x)
    slopes[:, 1:-1] = (before + after) / (after * h[:-1] / before + before * h[1:] / after)
    low, high = DERIVED_RANGE
    for end, inner, n in ((0, 1, 0), (-1, -2, -1)):
        s = w[:, n] / h[n]
        slopes[:, end] = np.clip(2 * s - slopes[:, inner], low * s, high * s)
    return np.clip(slopes, *RANGE)
