# SPDX-License-Identifier: BSD-3-Clause
"""What a table costs a Monte Carlo estimate, measured against the exact lobe.

With f the exact, normalised density of a lobe at one theta_r, and q the density that the table samples there,
the weight w = f/q is what a sample counts. The table's own coordinate makes every integral one over u: q dx =
du, so

    relative variance   V  = E_q[w^2] - 1 = integral (w - 1)^2 du - 2 lost
    total variation     TV = (integral |w - 1| du + lost) / 2
    lost mass              = mass of f that q never reaches
    heavy                  = probability, under q, of a weight above HEAVY

The form with (w - 1)^2 loses no digits where V is tiny. Integrals are Gauss-Legendre sums over the cells of
the table; a cell in which the integrand's Legendre coefficients have not died out is bisected until they
have. The table is taken as its texels in double precision: rounding inside a renderer's own arithmetic is a
test of the runtime, not of the table.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .exact import Exact, exact_at
from .interpolant import Cells, cells
from .lobes import Array, Lobe
from .table import Table

HEAVY = 4.0
BETWEEN = 3
ON_ROWS = slice(None, None, BETWEEN + 1)  # of the inclinations, those of the table's own rows
ORDER = 8
MAX_DEPTH = 48
CHUNK = 50_000  # points worked on at once
QUANTILES_AT = 64  # inclinations at most, spaced evenly over those that are measured
INNER = 2.0**-12  # the inner range of u is [INNER, 1 - INNER], the whole one [OUTER, 1 - OUTER]
OUTER = 2.0**-24

_nodes, _weights = np.polynomial.legendre.leggauss(ORDER)
NODES, WEIGHTS = (_nodes + 1) / 2, _weights / 2
LOBATTO = (
    1 + np.array([-1, -np.sqrt(3 / 7), 0, np.sqrt(3 / 7), 1])
) / 2  # where weights are largest: at ends
LOBATTO_WEIGHTS = np.array([9, 49, 64, 49, 9]) / 180
ENDS = np.array([0.0, 1.0])
DENSE = np.linspace(0, 1, 65)
# What ORDER points, weighted, give as the coefficients of the two highest Legendre polynomials that they
# resolve.
LAST_TWO = np.polynomial.legendre.legvander(_nodes, ORDER - 1)[:, -2:] * (2 * np.arange(ORDER - 2, ORDER) + 1)
# Coefficients allowed to remain. The sum is exact to twice their degree, and its error is about their square.
OWN_ERROR = 1e-2
MAX_FEATURES = 8
CELL_ERROR = 1e-4  # or this part of a row's variance, shared by its cells
ROUNDING = 1e-18


Reading = Callable[[Table, Array], Cells]


@dataclass(frozen=True)
class Errors:
    """Errors of a table at n viewer inclinations theta_r; every other array is (n,), and the properties are
    the worst.

    variance    relative variance V
    weight      largest weight
    heavy       probability of a weight above HEAVY
    variation   total variation
    lost        mass never reached
    quantile    largest |x_table(u) - x_exact(u)|, rad, for u from OUTER to 1 - OUTER; NaN where not
                measured: at most QUANTILES_AT inclinations are
    inner       the same from INNER to 1 - INNER
    """

    theta_r: Array
    variance: Array
    weight: Array
    heavy: Array
    variation: Array
    lost: Array
    quantile: Array
    inner: Array

    @property
    def relative_variance(self) -> float:
        return float(self.variance.max())

    @property
    def largest_weight(self) -> float:
        return float(self.weight.max())

    @property
    def total_variation(self) -> float:
        return float(self.variation.max())

    @property
    def lost_mass(self) -> float:
        return float(self.lost.max())

    @property
    def quantile_error(self) -> float:
        return float(np.fmax.reduce(self.quantile))

    @property
    def inner_quantile_error(self) -> float:
        return float(np.fmax.reduce(self.inner))

    @property
    def heavy_probability(self) -> float:
        return float(self.heavy.max())

    def summary(self) -> dict[str, float]:
        """The worst errors, by the names that they have in a file's header."""
        return {
            "relative_variance": self.relative_variance,
            "largest_weight": self.largest_weight,
            "total_variation": self.total_variation,
            "lost_mass": self.lost_mass,
            "quantile": self.quantile_error,
            "quantile_inner": self.inner_quantile_error,
        }


def inclinations(theta_r_range: tuple[float, float], height: int, between: int = BETWEEN) -> Array:
    """theta_r of every row, and of `between` points spaced evenly between each row and the next."""
    return np.linspace(*theta_r_range, (height - 1) * (between + 1) + 1)


def measure(
    table: Table,
    lobe: Lobe,
    between: int = BETWEEN,
    quantiles: bool = True,
    exact: Exact | None = None,
    at: Array | None = None,
    read: Reading = cells,
) -> Errors:
    """Errors of a table that is to sample the lobe, on its rows and between them.

    quantiles: also compare quantiles, which takes most of the time. exact: the lobe at these inclinations, if
    the caller has it already. at: numbers of the inclinations that are measured, if not all. read: the rule
    by which the table is read (the study compares others).
    """
    exact = exact or exact_at(lobe, inclinations(table.theta_r_range, table.height, between))
    at = np.arange(len(exact.theta_r)) if at is None else at
    step = max(1, CHUNK // (ORDER * (table.width - 1 + exact.knots.shape[1])))
    parts = [
        _densities(read(table, exact.theta_r[part]), table.domain, exact, part)
        for part in (at[n : n + step] for n in range(0, len(at), step))
    ]
    variance, weight, heavy, variation, lost = (np.concatenate(column) for column in zip(*parts, strict=True))
    quantile, inner = np.full((2, len(at)), np.nan)
    if quantiles:
        some = slice(None, None, -(-len(at) // QUANTILES_AT))
        quantile[some], inner[some] = _quantiles(table, exact, at[some], read)
    return Errors(exact.theta_r[at], variance, weight, heavy, variation, lost, quantile, inner)


def estimate(table: Table, lobe: Lobe, exact: Exact, at: Array) -> tuple[float, float]:
    """(V, largest weight) at the inclinations numbered `at`. Where the exact lobe's knots are known, from
    five places a panel: V off by up to 0.1 % above 1e-3, 1.5 % above 1e-4, 15 % below; weights by 7 %."""
    if not exact.knots.shape[1]:
        errors = measure(table, lobe, quantiles=False, exact=exact, at=at)
        return errors.relative_variance, errors.largest_weight
    read = cells(table, exact.theta_r[at])
    n, i, low, size = _panels(read, exact.knots[at])
    w, du = _weights(read, exact, at, n, i, low + size * LOBATTO[:, None])
    variance = np.bincount(n, LOBATTO_WEIGHTS @ (du * (w - 1) ** 2) * size, len(at))
    return float(variance.max()), float(w.max())


def flat_cells(texels: Array) -> int:
    """Cells whose ends are the same number, or run backwards: their density would be infinite or negative."""
    return int((np.diff(texels.astype(np.float64), axis=1) <= 0).sum())


def narrowest_cell(texels: Array) -> float:
    """Width of the narrowest cell in units of the last place of the larger of its ends, as float32."""
    size = np.spacing(np.maximum(abs(texels[:, 1:]), abs(texels[:, :-1])).astype(np.float32))
    return float((np.diff(texels.astype(np.float64), axis=1) / size).min())


def _densities(read: Cells, domain: tuple[float, float], exact: Exact, row: Array) -> tuple[Array, ...]:
    """(variance, weight, heavy, variation, lost) of the inclinations numbered row."""
    n, i, low, size = _panels(read, exact.knots[row])
    square, absolute, heavy, reached = (np.zeros(len(row)) for _ in range(4))
    at_knots, _ = _weights(read, exact, row, n, i, low + size * ENDS[:, None])
    peaks = _Peaks(len(row))
    peaks.consider(at_knots.max(axis=0), n, i, low, size)
    for depth in range(MAX_DEPTH):
        w, du = _weights(read, exact, row, n, i, low + size * NODES[:, None])
        peaks.consider(w.max(axis=0), n, i, low, size)
        du = du * (size * WEIGHTS[:, None])
        squares = du * (w - 1) ** 2
        value = squares.sum(axis=0)
        tail = abs(LAST_TWO.T @ squares).sum(axis=0)
        if depth == 0:
            allowed = CELL_ERROR / len(read.h) * np.bincount(n, value, len(row)) + ROUNDING
        split = tail > np.maximum(OWN_ERROR * value, allowed[n])
        split |= exact.features(row[n], *read.angle_at(n, i, np.array([low, low + size]))) > MAX_FEATURES
        split &= depth < MAX_DEPTH - 1
        parts = value, *((du * x).sum(axis=0) for x in (abs(w - 1), w > HEAVY, w))
        for total, part in zip((square, absolute, heavy, reached), parts, strict=True):
            total += np.bincount(n[~split], part[~split], len(row))
        if not split.any():
            break
        n, i, size, low = (np.repeat(values[split], 2) for values in (n, i, size / 2, low))
        low[1::2] += size[1::2]
    low_end, high_end = np.float32(domain)
    cut = (read.x[:, 0] > low_end) | (read.x[:, -1] < high_end)
    lost = np.where(cut, np.maximum(1 - reached, 0.0), 0.0)
    dense, _ = _weights(read, exact, row, *peaks.panels(), peaks.low + peaks.size * DENSE[:, None])
    weight = np.maximum(peaks.w, dense.max(axis=0))
    return square - 2 * lost, weight, heavy, (absolute + lost) / 2, lost


class _Peaks:
    """For each of R inclinations the panel with the largest weight w that was seen so far: the cell i, and
    the fractions low at which the panel begins and size that it spans, each (R,)."""

    def __init__(self, count: int) -> None:
        self.w, self.low, self.size = np.zeros(count), np.zeros(count), np.ones(count)
        self.i = np.zeros(count, int)

    def consider(self, w: Array, n: Array, i: Array, low: Array, size: Array) -> None:
        """Weights w (P,) of panels of the inclinations n (P,)."""
        order = np.lexsort((w, n))
        best = order[np.append(np.flatnonzero(np.diff(n[order])), len(w) - 1)]
        best = best[w[best] > self.w[n[best]]]
        at = n[best]
        self.w[at], self.i[at], self.low[at], self.size[at] = w[best], i[best], low[best], size[best]

    def panels(self) -> tuple[Array, Array]:
        """(inclinations, cells)"""
        return np.arange(len(self.i)), self.i


def _panels(read: Cells, knots: Array) -> tuple[Array, Array, Array, Array]:
    """The cells, cut at the knots (n, K) of the exact density: inclinations and cells (P,) by number, and
    the fractions of the cells at which the panels begin and that they span."""
    at = np.tile(np.arange(read.x.shape[1] + 0.0), (len(knots), 1))
    at = np.sort(np.concatenate([at, read.column(knots)], axis=1), axis=1)
    n, k = np.nonzero(np.diff(at) > 0)
    i = at[n, k].astype(int)
    return n, i, at[n, k] - i, at[n, k + 1] - at[n, k]


def _weights(read: Cells, exact: Exact, row: Array, n: Array, i: Array, f: Array) -> tuple[Array, Array]:
    """(f/q, du/df) at the fractions f (K, P) of the cells n, i (P,), between two knots each."""
    angle, slope = read.read_at(n, i, f)
    return exact.density(angle, row[n]) * slope, read.h[i]


def _quantiles(table: Table, exact: Exact, at: Array, read: Reading) -> tuple[Array, Array]:
    """Per inclination, the largest quantile error in the whole and in the inner range of u."""
    m, upper = _probabilities(table)
    i, f = table.warp.place(m, upper, table.width)
    knots = read(table, exact.theta_r[at])
    error = abs(knots.angle_at(np.arange(len(at))[:, None], i, f) - exact.quantiles(m, upper, at))
    return error.max(axis=1), error[:, m >= INNER].max(axis=1)


def _probabilities(table: Table) -> tuple[Array, Array]:
    """(m, upper), both (K,): every half of a cell, and all powers of two between OUTER and 1/2, in both
    tails."""
    columns = np.arange(0, (table.width - 1) / 2, 0.5)
    m = np.concatenate([table.warp.unfold(columns, table.width), np.exp2(np.arange(np.log2(OUTER), 0))])
    m = np.unique(m[(m >= OUTER) & (m <= 0.5)])
    return np.tile(m, 2), np.repeat([False, True], len(m))
