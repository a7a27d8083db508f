# SPDX-License-Identifier: BSD-3-Clause
"""The cell of a table: a monotone rational quadratic in u (Gregory and Delbourgo 1982), in double precision.

A cell lies between two knots u0 < u1 = u0 + h, at which the angle is x0 < x1 and its slope dx/du d0, d1 > 0.
With w = x1 - x0, the secant s = w / h, the fraction f = (u - u0) / h and p = f (1 - f),

    G     = s (f^2 + (1-f)^2) + (d0 + d1) p
    x     = x0 + w (s f^2 + d0 p) / G
    dx/du = s^2 (d1 f^2 + 2 s p + d0 (1-f)^2) / G^2,            density = 1 / (dx/du).

Every term is positive, so nothing cancels and x rises for any positive d0, d1. The angle and the density are
continuous from one cell to the next. All arguments broadcast against each other.
"""

import numpy as np

from .lobes import Array


def angle(x0: Array, x1: Array, d0: Array, d1: Array, h: Array, f: Array) -> Array:
    """x at the fraction f in [0, 1] of a cell."""
    return read(x0, x1, d0, d1, h, f)[0]


def slope(x0: Array, x1: Array, d0: Array, d1: Array, h: Array, f: Array) -> Array:
    """dx/du at the fraction f in [0, 1] of a cell."""
    return read(x0, x1, d0, d1, h, f)[1]


def read(x0: Array, x1: Array, d0: Array, d1: Array, h: Array, f: Array) -> tuple[Array, Array]:
    """(x, dx/du) at the fraction f in [0, 1] of a cell."""
    w, g = x1 - x0, 1 - f
    s, p = w / h, f * g
    toward, away = s * (f * f), d0 * g
    near = s / _denominator(s, d0, d1, f, g)
    x = x0 + (toward + away * f) * near * h
    return x, (d1 * (f * f) + 2 * s * p + away * g) * (near * near)


def locate(x0: Array, x1: Array, d0: Array, d1: Array, h: Array, x: Array) -> tuple[Array, Array]:
    """(fraction f, dx/du) at which x lies in a cell; x is clamped to it. The root of a quadratic, without
    cancellation: f = a / (a + b)."""
    w = x1 - x0
    below, above = np.clip(x - x0, 0.0, w), np.clip(x1 - x, 0.0, w)
    s = w / h
    bend = d0 * above - d1 * below
    root = np.sqrt(bend * bend + 4 * s * s * below * above)
    a = np.where(bend >= 0, 2 * s * below, root - bend)
    b = np.where(bend >= 0, root + bend, 2 * s * above)
    f, g = a / (a + b), b / (a + b)
    return f, root / (h * _denominator(s, d0, d1, f, g))


def _denominator(s: Array, d0: Array, d1: Array, f: Array, g: Array) -> Array:
    """G, with g = 1 - f."""
    return s * (f * f + g * g) + (d0 + d1) * f * g
