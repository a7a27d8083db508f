# SPDX-License-Identifier: BSD-3-Clause
"""The warp: which cumulative probability u each column of a table stands for.

It is symmetric about u = 1/2, so everything is written for the smaller tail m = min(u, 1-u) and its folded
column c, counted from the nearer end of the axis. The warp `octaves` makes columns uniform in F(m + e): a
chain of straight lines, one for each octave of m + e, close to its fourth root. F is what a float turns into
when its bits, taken as an integer, are shifted right by two: one integer operation in place of two square
roots. Columns are dense near the ends, where a quantile function is steep, and F's slope stays finite there.

F bends at every power of two. That costs nothing, because a cell is a curve in u and not in the column
(cell.py): the warp only chooses where the knots lie.

Why this one (tests/report/pages/study.md has every alternative on the same measure). A renderer pays for a
table's relative variance V. With curved cells every warp with dense ends is good enough, and this one is
the cheapest. The outermost knots are the domain's ends, not a far quantile: a renderer's BSDF is not the
lobe, and a direction that the table never samples is energy that no weight restores. With curved end cells
that support is nearly free. e is a power of two that size.py measures for each table.
"""

from dataclasses import dataclass

import numpy as np

from . import parameter
from .errors import HairlutError
from .lobes import Array

E_RANGE = (1e-12, 1.0)


@dataclass(frozen=True)
class Warp:
    """name: "octaves" or "uniform"; e: the parameter of octaves, in E_RANGE, 0 for the uniform warp."""

    name: str
    e: float = 0.0

    def __post_init__(self) -> None:
        if self.name == "uniform" and self.e == 0.0:
            return
        if self.name != "octaves":
            raise HairlutError(f"warp {self} is not known: expected 'octaves e=NUMBER' or 'uniform'")
        if not E_RANGE[0] <= self.e <= E_RANGE[1]:
            raise HairlutError(f"warp {self}: expected e from {E_RANGE[0]:g} to {E_RANGE[1]:g}")

    def __str__(self) -> str:
        return f"{self.name} e={self.e!r}" if self.name == "octaves" else self.name

    @classmethod
    def parse(cls, text: str) -> "Warp":
        """From "uniform" or "octaves e=NUMBER", as in a file's header."""
        expected = "'octaves e=NUMBER' or 'uniform'"
        name, e = parameter.parse(text, "warp", "e", expected)
        if name == "uniform" != text:
            raise HairlutError(f"warp {text!r} cannot be read: expected {expected}")
        return cls(name, e)

    def scale(self, width: int) -> tuple[float, float]:
        """(F0, k): F(m + e) = F0 + k c for octaves; m = k c for the uniform warp, with F0 = 0."""
        if self.name == "uniform":
            return 0.0, 1.0 / (width - 1)
        f0, f1 = (float(_curve(np.float64(m + self.e))) for m in (0.0, 0.5))
        return f0, 2 * (f1 - f0) / (width - 1)

    def fold(self, m: Array, width: int) -> Array:
        """Folded column of the smaller tail m in [0, 1/2]."""
        f0, k = self.scale(width)
        if self.name == "uniform":
            return m / k
        return (_curve(m + self.e) - f0) / k

    def unfold(self, c: Array, width: int) -> Array:
        """Smaller tail m of the folded column c in [0, (width-1)/2]."""
        f0, k = self.scale(width)
        if self.name == "uniform":
            return k * c
        return np.where(c == 0, 0.0, _inverse_curve(f0 + k * c) - self.e)

    def widths(self, width: int) -> Array:
        """(width-1,) the part of u that each cell spans; positive and symmetric."""
        m, _ = self.knots(width)
        spans = abs(np.diff(m))
        if width % 2 == 0:  # the cell around u = 1/2
            spans[width // 2 - 1] = 1 - 2 * m[width // 2 - 1]
        return spans

    def place(self, m: Array, upper: Array, width: int) -> tuple[Array, Array]:
        """(cell i, fraction f) of u = m <= 1/2, or of u = 1 - m where upper. f is linear in u."""
        last = width - 2
        i = np.clip(self.fold(m, width), 0.0, last).astype(int)
        f = (m - self.knots(width)[0][i]) / self.widths(width)[i]
        return np.where(upper, last - i, i), np.where(upper, 1 - f, f)

    def knots(self, width: int) -> tuple[Array, Array]:
        """(m, upper), each (width,): the smaller tail of a column, and whether it lies above the texel."""
        column = np.arange(width)
        mirrored = width - 1 - column
        upper = mirrored < column
        return self.unfold(np.minimum(column, mirrored).astype(float), width), upper

    def u(self, width: int) -> Array:
        """(width,) the cumulative probability of each column."""
        m, upper = self.knots(width)
        return np.where(upper, 1 - m, m)


def _curve(s: Array) -> Array:
    """F(s) for s = 2^n (1+g): 2^q (1 + (r+g)/4) with n + 3 = 4 q + r, r from 0 to 3."""
    mantissa, exponent = np.frexp(s)
    q, r = np.divmod(exponent + 2, 4)
    return np.ldexp(1 + (r + (2 * mantissa - 1)) / 4, q)


def _inverse_curve(y: Array) -> Array:
    """s of y = F(s)."""
    mantissa, exponent = np.frexp(y)
    quarters = 4 * (2 * mantissa - 1)
    r = np.floor(quarters)
    return np.ldexp(1 + quarters - r, (4 * (exponent - 1) + r - 3).astype(int))
