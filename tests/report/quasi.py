# SPDX-License-Identifier: BSD-3-Clause
"""Quasi-random numbers through tables: the error of a lighting integral beside that of the exact inverse.

Both axes of fitted/direct, drawn with Owen-scrambled Sobol points. With random numbers a table of variance V
costs V more samples. Quasi-random ones make the exact inverse's error fall faster than 1/sqrt(n), while what
the weights f/q of a table add still falls like that: a coarse table shows up at large n.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from scipy.stats import qmc

from hairlut import analytic, exr, figures
from hairlut.lobes import FITTED, Array
from hairlut.size import DEFAULT_TOLERANCE, smallest_tables
from hairlut.table import Table, bake_table
from hairlut.warp import Warp
from report.cells import PARABOLA, RATIONAL, Cell
from report.markdown import table as markdown_table

THETA_R = (0.3, 1.1, -0.7)
AXES = THETA, PHI = FITTED.direct_theta, FITTED.direct_phi
LIGHTS: dict[str, Callable[[Array, Array], Array]] = {
    "gradient": lambda t, p: 1 + 0.48 * np.sin(t) + np.cos(t) * (0.6 * np.cos(p) + 0.64 * np.sin(p)),
    "product": lambda t, p: (1 + 0.5 * np.sin(t)) * (1 + 0.5 * np.cos(p)),
    "front": lambda t, p: (1 + 0.5 * np.cos(t)) * (1 + 0.5 * np.cos(p - 1)),
    "soft lamp": lambda t, p: np.exp(0.5 * np.sin(t) + 0.5 * np.cos(p - 0.5)),
}
LIMITS = {64: 1.15, 1024: 2.2}
"""Of the RMSE, relative to the exact inverse's, by the number of samples."""

SEEDS = 64
SIZES = tuple(2**k for k in range(6, 17))
INSIDE = 2.0**-40  # how far points stay away from 0 and 1

Draw = Callable[[float, Array], tuple[Array, Array]]
"""(angles theta_i, relative phi (n, 2); weights f/q (n,)) drawn at theta_r with the points u (n, 2)."""


def inverse(theta_r: float, u: Array) -> tuple[Array, Array]:
    """The exact inverse: every weight is 1."""
    columns = [analytic.quantile(lobe, theta_r, *_tails(u[:, k])) for k, lobe in enumerate(AXES)]
    return np.stack(columns, axis=1), np.ones(len(u))


def through(tables: Iterable[Table], cell: Cell = RATIONAL) -> Draw:
    """Draws from tables of theta and phi."""
    tables = tuple(tables)

    def draw(theta_r: float, u: Array) -> tuple[Array, Array]:
        x, weight = np.empty_like(u), np.ones(len(u))
        for k, (table, lobe) in enumerate(zip(tables, AXES, strict=True)):
            i, f = table.warp.place(*_tails(u[:, k]), table.width)
            x[:, k], slope = cell.read(table, np.array([theta_r])).read_at(0, i, f)
            weight *= slope * analytic.density(lobe, np.float64(theta_r), np.clip(x[:, k], *lobe.domain))
        return x, weight

    return draw


def alias(cells: int = 1024) -> Draw:
    """Draws from alias tables of the exact masses of equal cells, as exact as tables get: u is shuffled."""

    def draw(theta_r: float, u: Array) -> tuple[Array, Array]:
        x, weight = np.empty_like(u), np.ones(len(u))
        for k, lobe in enumerate(AXES):
            edges = np.linspace(*lobe.domain, cells + 1)
            threshold, other, mass = _alias_table(k, theta_r, cells)
            place = u[:, k] * cells
            i = np.minimum(place.astype(int), cells - 1)
            f = place - i
            own = f < threshold[i]
            with np.errstate(divide="ignore", invalid="ignore"):
                f = np.where(own, f / threshold[i], (f - threshold[i]) / (1 - threshold[i]))
            i = np.where(own, i, other[i])
            x[:, k] = edges[i] + f * (edges[1] - edges[0])
            density = analytic.density(lobe, np.float64(theta_r), np.clip(x[:, k], *lobe.domain))
            weight *= density * (edges[1] - edges[0]) / mass[i]
        return x, weight

    return draw


@cache
def _alias_table(axis: int, theta_r: float, cells: int) -> tuple[Array, Array, Array]:
    """(threshold, alias, mass) of equal cells (Walker 1977)."""
    lobe = AXES[axis]
    nodes, weights = np.polynomial.legendre.leggauss(4)
    edges = np.linspace(*lobe.domain, cells + 1)
    h = edges[1] - edges[0]
    x = edges[:-1, None] + h * (nodes + 1) / 2
    mass = analytic.density(lobe, np.float64(theta_r), x) @ weights * h / 2
    mass /= mass.sum()
    threshold, other = mass * cells, np.arange(cells)
    small, large = (list(np.flatnonzero(part)) for part in (threshold < 1, threshold >= 1))
    while small and large:
        i, j = small.pop(), large[-1]
        other[i] = j
        threshold[j] -= 1 - threshold[i]
        if threshold[j] < 1:
            small.append(large.pop())
    threshold[[*small, *large]] = 1.0
    return threshold, other, mass


def _tails(u: Array) -> tuple[Array, Array]:
    return np.minimum(u, 1 - u), u > 0.5


@cache
def _points(n: int, seed: int) -> Array:
    points = qmc.Sobol(2, scramble=True, rng=np.random.default_rng(seed)).random(n)
    return np.clip(points, INSIDE, 1 - INSIDE)


@cache
def _truth(theta_r: float) -> Array:
    """(lights,) the lighting integrals, by a product rule in u."""
    nodes, weights = np.polynomial.legendre.leggauss(600)
    u = (nodes + 1) / 2
    theta, phi = (analytic.quantile(lobe, theta_r, *_tails(u)) for lobe in AXES)
    both = weights[:, None] * weights / 4
    return np.array([(light(theta[:, None], phi) * both).sum() for light in LIGHTS.values()])


def errors(draw: Draw, n: int, seeds: int = SEEDS) -> Array:
    """(theta_r, lights) root mean square error of n samples, over scramblings."""
    found = []
    for theta_r in THETA_R:
        off = []
        for seed in range(seeds):
            x, weight = draw(theta_r, _points(n, seed))
            values = [(light(x[:, 0], x[:, 1]) * weight).mean() for light in LIGHTS.values()]
            off.append(values - _truth(theta_r))
        found.append(np.sqrt(np.mean(np.square(off), axis=0)))
    return np.array(found)


def ratios(draw: Draw, n: int, seeds: int = SEEDS) -> Array:
    """The same relative to the exact inverse's."""
    return errors(draw, n, seeds) / errors(inverse, n, seeds)


# ---- the page


@dataclass(frozen=True)
class Way:
    """A way to draw: its name, how it is drawn, and how its curve looks."""

    name: str
    draw: Draw
    colour: str
    line: str


def ways(luts: Path) -> list[Way]:
    shipped = [exr.read(luts / "fitted" / f"{lobe.name}.exr")[0] for lobe in AXES]
    coarse = [choice.table for choice in smallest_tables(AXES, 1e-4)]
    first = [bake_table(lobe, 44, 32, Warp("octaves", 2.0**-18)) for lobe in AXES]
    square = [bake_table(lobe, 64, 64, Warp("octaves", 2.0**-20)) for lobe in AXES]
    return [
        Way(f"shipped, {_sizes(shipped)}", through(shipped), figures.BLUE, "o-"),
        Way("64x64", through(square), figures.GREEN, "^-"),
        Way(f"V <= 1e-4, {_sizes(coarse)}", through(coarse), figures.ORANGE, "s-"),
        Way("version 1: parabolas, 44x32", through(first, PARABOLA), figures.RED, "x--"),
        Way("alias tables, 1024 cells an axis", alias(), figures.PURPLE, "v--"),
    ]


def _sizes(tables: list[Table]) -> str:
    return " and ".join(f"{table.width}x{table.height}" for table in tables)


TEXT = """# Quasi-random numbers

Both axes of `fitted`/direct under four smooth lights, at theta_r = 0.3, 1.1 and -0.7, drawn with
Owen-scrambled Sobol points (scipy.stats.qmc). Each figure is the root mean square error of the lighting
integral over {fewest} to {seeds} scramblings, relative to that of the exact inverse with the same points; of
twelve such ratios (lights and theta_r) the worst is shown.

With random numbers, V = 1e-4 costs one sample in 10,000 and cannot be seen. With quasi-random ones it can:
the exact inverse's error falls almost as 1/n, and what the weights of a table add falls as 1/sqrt(n). That
is why tables are baked to V <= {default:g} by default, about the smallest that stay below {few} at 64 samples
and {many} at 1,024 (tests/report/test_quasi.py; V <= 3e-5 does not). At {most:,} samples a pixel no table of
this kind is as good as the exact inverse, and a larger one is better: `hairlut bake --tolerance 1e-7`.

Inversion is monotone: points that are well spread stay so. An alias table is not: however fine its cells, the
error stays well above the exact inverse's from the start.

"""


def page(luts: Path, figure: Path, step: Callable[[str], None] = lambda text: None) -> str:
    """The page as text; its figure is drawn on the way."""
    every, worst = ways(luts), {}
    seeds_of = {n: max(16, min(SEEDS, 2**19 // n)) for n in SIZES}
    for n in SIZES:
        step(f"{n} samples")
        exact = errors(inverse, n, seeds_of[n])
        for way in every:
            worst[way.name, n] = float((errors(way.draw, n, seeds_of[n]) / exact).max())
        _points.cache_clear()
    plot, panel = figures.new(size=(8, 4.8))
    for way in every:
        panel.plot(SIZES, [worst[way.name, n] for n in SIZES], way.line, color=way.colour, label=way.name)
    for n, limit in LIMITS.items():
        panel.plot([n], [limit], "_", color="black", ms=16, label="limit" if n == 64 else None)
    panel.set(xscale="log", yscale="log", xlabel="samples", ylabel="RMSE / RMSE of the exact inverse, worst")
    panel.set_xscale("log", base=2)
    panel.legend()
    figures.save(plot, figure)
    shown = [n for n in SIZES if np.log2(n) % 2 == 0]
    rows = [(way.name, *(f"{worst[way.name, n]:.2f}" for n in shown)) for way in every]
    text = TEXT.format(
        seeds=SEEDS,
        fewest=min(seeds_of.values()),
        default=DEFAULT_TOLERANCE,
        few=LIMITS[64],
        many=LIMITS[1024],
        most=SIZES[-1],
    )
    grid = markdown_table(("tables", *(f"n = {n:,}" for n in shown)), rows)
    return f"{text}{grid}\n![RMSE relative to the exact inverse's]({figure.name})\n"
