# SPDX-License-Identifier: BSD-3-Clause
"""The comparison from which the table's design was decided: warps, cells, rows, ends and 16-bit texels.

Every candidate is measured by measure.py on the four different lobes of the two models, at every row and
three points between rows. The candidates live here and nowhere else: what won is in warp.py and
interpolant.py.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize
from scipy.special import ndtr, ndtri

from hairlut.errors import HairlutError
from hairlut.exact import Exact
from hairlut.integrate import integrate, rows_of_lobe
from hairlut.invert import invert
from hairlut.lobes import FITTED, HALF_PI, PRINTED, Array, Lobe
from hairlut.measure import BETWEEN, Errors, flat_cells, inclinations, measure, narrowest_cell
from hairlut.slopes import LARGEST_INNER, fitted
from hairlut.table import Table, row_angles
from hairlut.warp import Warp
from report.cells import CELLS, LINEAR, PARABOLA, RATIONAL, Cell

LOBES = (PRINTED.direct_theta, FITTED.direct_theta, FITTED.direct_phi, FITTED.multiple_theta)
EXPONENTS = range(-34, -7, 2)
LEAST_STEPS = 2.0
QUANTILE = 2.0**-25


# ---- candidate warps
# ------------------------------------------------------------------------------------------


class Symmetric(Warp):
    """A warp given by an increasing function F of the smaller tail m, and its inverse."""

    def __init__(self, label: str, forward: Callable, inverse: Callable):
        for name, value in {"name": label, "e": 0.0, "F": forward, "G": inverse}.items():
            object.__setattr__(self, name, value)

    def _scale(self, width: int) -> tuple[float, float]:
        low, high = (float(self.F(np.float64(m))) for m in (0.0, 0.5))
        return low, 2 * (high - low) / (width - 1)

    def fold(self, m: Array, width: int) -> Array:
        low, k = self._scale(width)
        return (self.F(m) - low) / k

    def unfold(self, c: Array, width: int) -> Array:
        low, k = self._scale(width)
        return np.where(c == 0, 0.0, np.clip(self.G(low + k * np.asarray(c, float)), 0.0, 0.5))


class OneSided(Warp):
    """Columns uniform in u^(1/4): dense at the lower end alone, with a slope that vanishes there."""

    def __init__(self):
        object.__setattr__(self, "name", "one-sided power u^(1/4)")
        object.__setattr__(self, "e", 0.0)

    def u(self, width: int) -> Array:
        return (np.arange(width) / (width - 1)) ** 4

    def knots(self, width: int) -> tuple[Array, Array]:
        u = self.u(width)
        return np.minimum(u, 1 - u), u > 0.5

    def unfold(self, c: Array, width: int) -> Array:
        return (np.asarray(c, float) / (width - 1)) ** 4

    def widths(self, width: int) -> Array:
        return np.diff(self.u(width))

    def place(self, m: Array, upper: Array, width: int) -> tuple[Array, Array]:
        u = np.where(upper, 1 - m, m)
        i = np.clip(np.searchsorted(self.u(width), u, side="right") - 1, 0, width - 2)
        return i, (u - self.u(width)[i]) / self.widths(width)[i]


def two_sided_power(e: float) -> Warp:
    """Columns uniform in (u+e)^(1/4) - (1-u+e)^(1/4)."""

    def forward(m):
        return (m + e) ** 0.25 - (1 - m + e) ** 0.25

    def derivative(m):
        return 0.25 * ((m + e) ** -0.75 + (1 - m + e) ** -0.75)

    return Symmetric("two-sided power", forward, _numerical_inverse(forward, derivative, e))


def _numerical_inverse(forward: Callable, derivative: Callable, e: float) -> Callable:
    grid = np.concatenate([[0.0], np.geomspace(e * 1e-4, 0.5, 20000)])
    values = forward(grid)

    def inverse(y):
        m = np.interp(y, values, grid)
        for _ in range(4):
            m = np.clip(m - (forward(m) - y) / derivative(m), 0.0, 0.5)
        return m

    return inverse


def logit(e: float) -> Warp:
    """Columns uniform in log((u+e)/(1-u+e))."""

    def inverse(y):
        ratio = np.exp(y)
        return ((1 + e) * ratio - e) / (1 + ratio)

    return Symmetric("logit", lambda m: np.log((m + e) / (1 - m + e)), inverse)


def probit(e: float) -> Warp:
    """Columns uniform in the normal quantile of (u+e)/(1+2e)."""
    share = 1 + 2 * e
    return Symmetric("probit", lambda m: ndtri((m + e) / share), lambda y: ndtr(y) * share - e)


def power(exponent: float) -> Callable[[float], Warp]:
    """Columns uniform in (m+e)^exponent."""
    return lambda e: Symmetric("power", lambda m: (m + e) ** exponent, lambda y: y ** (1 / exponent) - e)


def shifted(bits: int) -> Callable[[float], Warp]:
    """Columns uniform in what the bits of a float make that are shifted right by so many: near a root of
    degree 2^bits, straight in each octave. No shift: the same number of columns in every octave."""
    parts = 2**bits

    def forward(s):
        mantissa, exponent = np.frexp(s)
        q, r = np.divmod(exponent + parts - 2, parts)
        g = (r + 2 * mantissa - 1) / parts
        return q + g if bits == 0 else np.ldexp(1 + g, q)

    def inverse(y):
        mantissa, exponent = (y - np.floor(y), np.floor(y)) if bits == 0 else np.frexp(y)
        q, g = (exponent, mantissa) if bits == 0 else (exponent - 1, 2 * mantissa - 1)
        r = np.floor(parts * g)
        return np.exp2(parts * (q - 1.0) + r + 1) * (1 + parts * g - r)

    return lambda e: Symmetric("shifted", lambda m: forward(m + e), lambda y: inverse(y) - e)


def octaves(e: float) -> Warp:
    return Warp("octaves", e)


FAMILIES: dict[str, Callable[[float], Warp]] = {
    "two-sided power (u+e)^(1/4) - (1-u+e)^(1/4)": two_sided_power,
    "regularised logit log((u+e)/(1-u+e))": logit,
    "regularised probit": probit,
    "quartic (m+e)^(1/4), two square roots": power(1 / 4),
    "knots evenly in every octave of m+e": shifted(0),
    "bits of m+e shifted by one: near a square root": shifted(1),
    "octaves, bits of m+e shifted by two": octaves,
    "bits of m+e shifted by three: near an eighth root": shifted(3),
}
FIXED: dict[str, Warp] = {"uniform in u": Warp("uniform"), "one-sided power u^(1/4)": OneSided()}


# ---- measuring a candidate
# ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Result:
    """One candidate on one lobe: its errors, cells that are flat, and the narrowest cell in steps of a
    float."""

    candidate: str
    cell: str
    lobe: str
    e: float
    errors: Errors
    flat: int
    narrowest: float


@cache
def _rows(lobe: Lobe, height: int):
    return integrate(rows_of_lobe(lobe, row_angles(lobe.theta_r_range, height)))


@cache
def _exact(lobe: Lobe, height: int) -> Exact:
    return Exact(lobe, inclinations(lobe.theta_r_range, height))


def tabulate_any(
    lobe: Lobe, width: int, height: int, warp: Warp, outermost: float = 0.0, largest: float = LARGEST_INNER
) -> Table:
    """A table with any warp, even with flat cells; the end knots at the quantiles `outermost` and 1 -
    outermost, inner slopes bounded by `largest`."""
    m, upper = warp.knots(width)
    middle = (m[0] + m[1]) / 2
    every = np.append(np.maximum(m, outermost), [middle, middle]), np.append(upper, [False, True])
    quantiles = invert(_rows(lobe, height), *every)
    x, h = quantiles[:, :-2], warp.widths(width)
    theta_r = row_angles(lobe.theta_r_range, height)[:, None]
    log_mass = _rows(lobe, height).log_mass
    density = np.exp(lobe.log_density(np.clip(x, *lobe.domain), theta_r) - log_mass[:, None])
    with np.errstate(all="ignore"):  # flat cells
        slopes = fitted(x, h, density, (quantiles[:, -2], quantiles[:, -1]), largest)
    return Table(
        lobe.model, lobe.name, lobe.angle, lobe.azimuth, lobe.domain, lobe.theta_r_range, lobe.formula,
        warp, x.astype(np.float32), slopes.astype(np.float32), log_mass,
    )  # fmt: skip


def result(name: str, table: Table, lobe: Lobe, cell: Cell = RATIONAL, quantiles: bool = True) -> Result:
    with np.errstate(all="ignore"):  # candidates may divide by zero
        exact = _exact(lobe, table.height)
        errors = measure(table, lobe, quantiles=quantiles, exact=exact, read=cell.read)
    label = f"{lobe.model}/{lobe.name}"
    flat, narrowest = flat_cells(table.texels), narrowest_cell(table.texels)
    return Result(name, cell.name, label, table.warp.e, errors, flat, narrowest)


def best_of(
    family: Callable[[float], Warp], lobe: Lobe, width: int, height: int, cell: Cell = RATIONAL
) -> tuple[Warp, float]:
    """(warp, e) of the family with the least V, among those whose cells span LEAST_STEPS steps of a float."""
    trials = []
    for exponent in EXPONENTS:
        table = tabulate_any(lobe, width, height, family(2.0**exponent))
        if narrowest_cell(table.texels) >= LEAST_STEPS:
            exact = _exact(lobe, height)
            at = np.arange(0, len(exact.theta_r), (BETWEEN + 1) // 2)  # rows, and midway between them
            errors = measure(table, lobe, quantiles=False, exact=exact, at=at, read=cell.read)
            trials.append((errors.relative_variance, 2.0**exponent))
    if not trials:
        raise HairlutError(f"{lobe.model}/{lobe.name}: no e leaves every cell {LEAST_STEPS:g} steps wide")
    e = min(trials)[1]
    return family(e), e


def warps(width: int, height: int) -> Iterator[Result]:
    """Every warp with every cell on every lobe, each family at its best e."""
    for name, warp in FIXED.items():
        for cell in CELLS:
            for lobe in LOBES:
                yield result(name, tabulate_any(lobe, width, height, warp), lobe, cell)
    for name, family in FAMILIES.items():
        for cell in CELLS:
            for lobe in LOBES:
                warp, e = best_of(family, lobe, width, height, cell)
                yield replace(result(name, tabulate_any(lobe, width, height, warp), lobe, cell), e=e)


# ---- a warp of its own for each lobe
# ---------------------------------------------------------------

CONTROLS = 7
BOUND_HEIGHT = 24
BOUND_EVALUATIONS = 160
WEIGHT_ALLOWED = 12.0


def spline_warp(log_slopes: Array, e: float) -> Warp:
    """d(column)/dm is the exponential of a cubic spline in log2(m), constant below e."""
    at = np.linspace(np.log2(e), -1, len(log_slopes))
    spline = CubicSpline(at, log_slopes, bc_type="natural")
    grid = np.concatenate([[0.0], np.geomspace(e * 1e-3, 0.5, 4000)])
    slope = np.exp(np.clip(spline(np.log2(np.maximum(grid, e))), -30, 30))
    total = np.concatenate([[0.0], np.cumsum((slope[1:] + slope[:-1]) / 2 * np.diff(grid))])
    return Symmetric(
        "own spline",
        lambda m: np.interp(m, grid, total),
        lambda y: np.interp(y, total, grid),
    )


def own_warp(lobe: Lobe, width: int, cell: Cell, e: float = 2.0**-17, rounds: int = 2) -> Warp:
    """The best smooth monotone warp for this lobe alone, starting from the fourth root's slope."""

    def cost(log_slopes: Array) -> float:
        table = tabulate_any(lobe, width, BOUND_HEIGHT, spline_warp(log_slopes, e))
        narrowest = narrowest_cell(table.texels)
        if not narrowest > 0:
            return 1e3
        errors = measure(table, lobe, between=0, quantiles=False, exact=_on_rows(lobe), read=cell.read)
        heavy = max(0.0, np.log(errors.largest_weight / WEIGHT_ALLOWED))
        return np.log(errors.relative_variance) + 3 * heavy + 2 * max(0.0, np.log(LEAST_STEPS / narrowest))

    slopes = -0.75 * np.log(2) * np.linspace(np.log2(e), -1, CONTROLS)
    for _ in range(rounds):
        slopes = minimize(
            cost,
            slopes,
            method="Nelder-Mead",
            options={"maxfev": BOUND_EVALUATIONS, "xatol": 1e-2, "fatol": 1e-3},
        ).x
    return spline_warp(slopes, e)


@cache
def _on_rows(lobe: Lobe) -> Exact:
    return Exact(lobe, row_angles(lobe.theta_r_range, BOUND_HEIGHT))


def bounds(width: int, height: int) -> Iterator[Result]:
    """The optimised warp of each lobe, with the plainest and with today's cells."""
    for cell in (LINEAR, RATIONAL):
        for lobe in LOBES:
            warp = own_warp(lobe, width, cell)
            yield result("optimised for each lobe", tabulate_any(lobe, width, height, warp), lobe, cell)


# ---- ends, rows, sizes
# ----------------------------------------------------------------------------------------


def ends(width: int, height: int) -> Iterator[Result]:
    """The shipped warp and cells: the outermost knots at the domain's ends or at the 2^-25 quantiles."""
    for lobe in LOBES:
        warp, e = best_of(octaves, lobe, width, height)
        for name, outermost in (("domain's end", 0.0), ("2^-25 quantile", QUANTILE)):
            table = tabulate_any(lobe, width, height, warp, outermost)
            yield replace(result(name, table, lobe), e=e)


def two_modes(share: float) -> Lobe:
    """Two Gaussians of sigma 0.1 and a gap of 10 sigma; the first one's share changes with theta_r."""

    def log_density(x, theta_r):
        first = share + 0.3 * np.sin(theta_r)
        modes = [
            np.log(part) - 0.5 * ((x - mean) / 0.1) ** 2 for part, mean in ((first, -0.5), (1 - first, 0.5))
        ]
        return np.logaddexp(*modes)

    name = f"two modes, {share:g} in the first"
    return replace(FITTED.direct_theta, model=name, log_density=log_density, moments=None)


def slope_bounds(widths: tuple[int, ...], height: int) -> Iterator[Result]:
    """The bound of an inner slope, relative to the smaller secant beside it. With an odd width and height a
    knot of the row theta_r = 0 is in the middle of the gap."""
    lobe = two_modes(0.5)
    for width in widths:
        for bound in (2.0, 4.0, 8.0, 16.0, 64.0, np.inf):
            table = tabulate_any(lobe, width, height, octaves(2.0**-8), largest=bound)
            label = f"{'none' if bound == np.inf else f'{bound:g}'}, {width} columns"
            yield result(label, table, lobe, quantiles=False)


def sine_rows(t: Array) -> Array:
    """theta_r of the row coordinate t in [-1, 1]: dense at both ends."""
    return HALF_PI * np.sin(HALF_PI * t)


def tangent_rows(t: Array) -> Array:
    """Dense in the middle."""
    return HALF_PI * np.tan(t) / np.tan(1.0)


def moved_rows(lobe: Lobe, rows: Callable[[Array], Array]) -> Lobe:
    """The lobe over the row coordinate t: evenly spaced rows of it are uneven rows of theta_r."""

    def log_density(x, t):
        return lobe.log_density(x, rows(t))

    return replace(lobe, log_density=log_density, theta_r_range=(-1.0, 1.0), moments=None)


def rows(width: int, height: int) -> Iterator[Result]:
    """Even against uneven rows."""
    spacings = {"even": None, "sine: dense at +-90 deg": sine_rows, "tangent: dense at 0": tangent_rows}
    for lobe in LOBES:
        warp, e = best_of(octaves, lobe, width, height)
        for name, spacing in spacings.items():
            moved = moved_rows(lobe, spacing) if spacing else lobe
            table = tabulate_any(moved, width, height, warp)
            yield replace(result(name, table, moved, quantiles=False), e=e)


def half_range(width: int, height: int) -> Iterator[Result]:
    """direct_phi, even in theta_r, with rows over the whole range, or half of them over [0, pi/2]."""
    lobe = FITTED.direct_phi
    half = replace(lobe, theta_r_range=(0.0, HALF_PI))
    warp, e = best_of(octaves, lobe, width, height)
    for name, each, count in (("whole range", lobe, height), ("half range", half, height // 2)):
        table = tabulate_any(each, width, count, warp)
        yield replace(result(f"{name}, {count} rows", table, each, quantiles=False), e=e)


# ---- sixteen bits
# ---------------------------------------------------------------------------------------------


def as_half(texels: Array, domain: tuple[float, float]) -> Array:
    """The angle itself as a half float."""
    return texels.astype(np.float16).astype(np.float32)


def as_fixed(texels: Array, domain: tuple[float, float]) -> Array:
    """The angle in 65535 equal steps of the domain."""
    low, high = domain
    steps = np.round((texels.astype(float) - low) / (high - low) * 65535)
    return (low + steps * (high - low) / 65535).astype(np.float32)


def as_offset(texels: Array, domain: tuple[float, float]) -> Array:
    """The offset from the row's middle texel as a half float, with that texel kept as a float."""
    centre = texels[:, texels.shape[1] // 2][:, None].astype(float)
    return (centre + (texels - centre).astype(np.float16).astype(float)).astype(np.float32)


def as_distance(texels: Array, domain: tuple[float, float]) -> Array:
    """The distance to the nearer end of the domain as a half float, its sign telling the end."""
    low, high = np.float32(domain).astype(float)
    below = texels - low < high - texels
    distance = np.where(below, texels - low, high - texels).astype(np.float16).astype(float)
    return np.where(below, low + distance, high - distance).astype(np.float32)


ENCODINGS = {
    "32-bit float": lambda texels, domain: texels,
    "half float": as_half,
    "16-bit fixed point": as_fixed,
    "half float, offset from the row's middle": as_offset,
    "half float, distance to the nearer end": as_distance,
}


def encodings(sides: tuple[int, ...]) -> Iterator[tuple[int, Result]]:
    """Every 16-bit form of square tables at the e that suits it best: fewest flat cells, then least V."""
    for side in sides:
        for name, encode in ENCODINGS.items():
            for lobe in LOBES:
                yield side, _encoded(name, encode, lobe, side)


def _encoded(name: str, encode: Callable, lobe: Lobe, side: int) -> Result:
    trials = []
    for exponent in EXPONENTS:
        table = tabulate_any(lobe, side, side, octaves(2.0**exponent))
        table = replace(table, texels=encode(table.texels, lobe.domain))
        trials.append(result(name, table, lobe, quantiles=False))
    return min(trials, key=lambda trial: (trial.flat, trial.errors.relative_variance))


# ---- sizes
# ----------------------------------------------------------------------------------------------------


def sizes(sides: tuple[int, ...]) -> Iterator[tuple[int, Result]]:
    """V of theta of the direct lobe against the side of a square table, for warps and cells."""
    designs = (
        ("uniform, linear cells", None, LINEAR),
        ("octaves, linear cells", octaves, LINEAR),
        ("octaves, parabolas", octaves, PARABOLA),
        ("octaves, rational quadratics", octaves, RATIONAL),
    )
    for side in sides:
        for name, family, cell in designs:
            for lobe in LOBES[:2]:
                warp = best_of(family, lobe, side, side, cell)[0] if family else Warp("uniform")
                table = tabulate_any(lobe, side, side, warp)
                yield side, result(name, table, lobe, cell, quantiles=False)


def columns(widths: tuple[int, ...], height: int) -> Iterator[Result]:
    """V and the largest weight on every lobe, on rows alone, at the e that suits each cell best."""
    for cell in CELLS:
        for width in widths:
            for lobe in LOBES:
                trials = []
                for exponent in EXPONENTS:
                    table = tabulate_any(lobe, width, height, octaves(2.0**exponent))
                    if narrowest_cell(table.texels) < LEAST_STEPS:
                        continue
                    exact = _exact(lobe, height)
                    at = np.arange(0, len(exact.theta_r), BETWEEN + 1)
                    with np.errstate(all="ignore"):
                        errors = measure(table, lobe, quantiles=False, exact=exact, at=at, read=cell.read)
                    label = f"{width} columns"
                    place = f"{lobe.model}/{lobe.name}"
                    trials.append(Result(label, cell.name, place, 2.0**exponent, errors, 0, 0.0))
                yield min(trials, key=lambda trial: trial.errors.relative_variance)
