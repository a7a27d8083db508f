# SPDX-License-Identifier: BSD-3-Clause
"""The speed page: whole calls beside their rivals, and the cost of a table of every size beside its error."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from bench import summary
from bench.timing import Times

from hairlut import exr, figures
from hairlut.errors import HairlutError
from hairlut.lobes import FITTED, Lobe
from hairlut.measure import Errors, flat_cells, measure, narrowest_cell
from hairlut.mixture import constant
from hairlut.model import BakedLobe, BakedModel
from hairlut.size import EXPONENTS, MIN_STEPS, table_of_size
from hairlut.table import Table, bake_table
from hairlut.warp import Warp
from report.cells import LINEAR, PARABOLA, RATIONAL, Cell
from report.markdown import table as markdown_table
from report.study import as_half

LOBE = FITTED.direct_theta
SIDES = (16, 32, 64, 128, 256, 512)
SEARCHED = 128  # sides up to which e is searched for; above, the smallest that leaves no cell too narrow
SHIPPED, UNIFORM = "octaves", "uniform"  # the designs that are timed: a model directory each, DESIGN-SIDE
NAMES = (
    "^(fitted|brown|printed)/[^/]+/[^/]+/(one|native|avx2|avx512|arrays[0-9]*)$|"
    f"^({SHIPPED}|{UNIFORM})-.*/(sample|pdf)_direct/hairlut/(one|arrays)$|^warp/"
)

CANDIDATES = {
    "uniform": "uniform in u",
    "one-sided-power": "one-sided power u^(1/4)",
    "two-sided-power": "two-sided power",
    "logit": "regularised logit",
    "probit": "regularised probit, by Giles' polynomial",
    "logarithm": "knots evenly in every octave, a float's bits",
    "quartic": "quartic, folded: two square roots",
    "octaves": "octaves, folded: a float's bits shifted by two",
}


@dataclass(frozen=True)
class Point:
    """One design at one size: what it costs an estimate. model: the directory that is timed, if it is."""

    design: str
    side: int
    errors: Errors
    bytes: int
    flat: int
    model: str | None


def bake_sizes(folder: Path, sides=SIDES) -> list[Point]:
    """Writes a model of one table for each side and timed design below folder; every design's points."""
    return [point for side in sides for point in designs(folder, square(LOBE, side))]


def square(lobe: Lobe, side: int) -> Table:
    if side <= SEARCHED:
        return table_of_size(lobe, side, side).table
    for exponent in EXPONENTS:
        if exponent >= -24:
            table = bake_unless_flat(lobe, side, Warp("octaves", 2.0**exponent))
            if table and narrowest_cell(table.texels) >= MIN_STEPS:
                return table
    raise AssertionError("the widest e leaves wide cells")


def bake_unless_flat(lobe: Lobe, side: int, warp: Warp) -> Table | None:
    try:
        return bake_table(lobe, side, side, warp)
    except HairlutError:
        return None


def designs(folder: Path, shipped: Table) -> list[Point]:
    """The shipped design and the simpler ones that it displaced, of one size."""
    uniform = bake_table(LOBE, shipped.width, shipped.height, Warp("uniform"))
    halves = replace(shipped, texels=as_half(shipped.texels, shipped.domain))
    timed = [write_alone(folder, name, table) for name, table in ((SHIPPED, shipped), (UNIFORM, uniform))]
    return [
        _point("octaves, rational quadratic cells", shipped, RATIONAL, 8, timed[0]),
        _point("octaves, parabolas", shipped, PARABOLA, 4),
        _point("octaves, linear cells", shipped, LINEAR, 4),
        _point("uniform in u, rational quadratic cells", uniform, RATIONAL, 8, timed[1]),
        _point("octaves, rational quadratic cells, half floats", halves, RATIONAL, 4),
    ]


def write_alone(folder: Path, design: str, table: Table) -> str:
    """A model of this one table, its azimuth uniform; the directory's name."""
    name = f"{design}-{table.width}"
    lobe = BakedLobe("direct", table, None)
    exr.write_model(folder / name, BakedModel(table.model, (lobe,), constant(("direct",))))
    return name


def _point(design: str, table: Table, cell: Cell, texel: int, model: str | None = None) -> Point:
    between = 3 if table.width <= SEARCHED else 0  # so many rows leave no room for errors between them
    with np.errstate(all="ignore"):  # flat cells of half floats
        errors = measure(table, LOBE, between, read=cell.read)
    return Point(design, table.width, errors, texel * table.texels.size, flat_cells(table.texels), model)


# ---- figures
# --------------------------------------------------------------------------------------------------

LOOKS = {
    (SHIPPED, "arrays"): (figures.BLUE, "o-", "hairlut, arrays"),
    (SHIPPED, "one"): (figures.BLUE, "o--", "hairlut, one call a sample"),
    (UNIFORM, "arrays"): (figures.ORANGE, "s-", "knots uniform in u, arrays"),
    (UNIFORM, "one"): (figures.ORANGE, "s--", "knots uniform in u, one call"),
}
RIVAL_LOOKS = {
    ("Boost", "one"): (figures.BROWN, "--", "Boost.Math"),
    ("plain", "one"): (figures.RED, "--", "closed form"),
    ("hybrid", "one"): (figures.GREEN, "--", "hybrid"),
    ("plain", "arrays"): (figures.RED, "-", "closed form, arrays"),
    ("hybrid", "arrays"): (figures.GREEN, "-", "hybrid, arrays"),
    ("logistic", "arrays"): (figures.PURPLE, "-", "logistic, arrays"),
}
AXES = {
    "relative variance V that the table adds": lambda point: point.errors.relative_variance,
    "quantile error [rad], u in [2^-12, 1-2^-12]": lambda point: point.errors.inner_quantile_error,
    "bytes of the table": lambda point: point.bytes,
}


def draw(points: list[Point], times: Times, path: Path, axes=AXES) -> Path:
    """Nanoseconds a sample against each of the axes; rivals, which have no table, as lines across."""
    figure, panels = figures.new(
        1, len(axes), (8.4 if len(axes) == 1 else 15, 5.2), sharey=True, squeeze=False
    )
    for panel, (label, value) in zip(panels[0], axes.items(), strict=True):
        _draw_tables(panel, points, times, value)
        _draw_rivals(panel, times, last=panel is panels[0][-1])
        panel.set(xscale="log", yscale="log", xlabel=label)
    first = panels[0][0]
    first.set_ylabel("time per sample with both densities [ns]")
    first.legend(loc="best", fontsize=8.5)
    first.set_title("One Gaussian in theta_i, uniform azimuth; numbers are sides of square tables")
    return figures.save(figure, path)


def _draw_tables(panel, points: list[Point], times: Times, value) -> None:
    for (design, how), (colour, line, label) in LOOKS.items():
        mine = [(value(p), ns, p.side) for p in points if p.model and p.model.startswith(design)
                if (ns := times.least(p.model, "sample_direct", "hairlut", how))]  # fmt: skip
        panel.plot([x for x, _, _ in mine], [y for _, y, _ in mine], line, color=colour, label=label)
        for x, y, side in mine if how == "arrays" else []:
            panel.annotate(
                str(side),
                (x, y),
                (0, -12),
                textcoords="offset points",
                fontsize=7.5,
                ha="center",
                color=colour,
            )


def _draw_rivals(panel, times: Times, last: bool) -> None:
    for (who, how), (colour, line, label) in RIVAL_LOOKS.items():
        ns = times.fastest("fitted", "sample_multiple", who, how)
        if ns is None:
            continue
        panel.axhline(ns, color=colour, linestyle=line, linewidth=1.1, alpha=0.75)
        if last:
            panel.annotate(
                f"{label}, V = 0", (1.0, ns), (-2, 3), xycoords=("axes fraction", "data"),
                textcoords="offset points", fontsize=8, color=colour, ha="right",
            )  # fmt: skip


# ---- the page
# -------------------------------------------------------------------------------------------------

TEXT = """# Speed

Whole calls of hairlut.h on the shipped models, beside what a renderer would use instead. The least of
{repetitions} repeats on one thread, in random order, of processor time, on {place}; in the median a
repeat took {interference:.0%} longer. Compare these times with each other, not with another machine's.
`make bench` prints the first tables again.

A **vertex** of a path is one sample of the whole hair, with its densities, and the density of another
direction, which a light chose. `sample_hair` and `pdf_hair` are its two calls; `direct` and `multiple`
are single lobes. theta_r, phi_r and the random numbers are uniform, the light's directions uniform on
the sphere, in arrays of 4096.

"""

RIVALS = """
The rivals ([tests/bench/rivals](../../bench/rivals)) are checked as hairlut is: their samples follow
their densities, which integrate to 1. Both sides take angles and return angles, phi_i in [-pi, pi) and
both densities.

- *closed form*: the cut Gaussian's mean and width computed, two erff for the interval's ends, Giles'
  erfinv, expf.
- *hybrid*: ends, mean and width tabulated at 64 nodes of theta_r and interpolated, then Giles' erfinv
  and expf.
- *logistic*: a logistic of the same variance, cut likewise, which Chiang 2016 puts in a Gaussian's
  place. It needs no erf. The *logistic hybrid* tabulates its ends. It is another lobe: what a user would
  choose where a closed form matters.
- *Box-Muller with rejection*: with the hybrid's rows; its density of a given direction is the hybrid's.
- *SLEEF*, *Boost.Math*, *MKL*: the closed form with their erf, and Boost's and MKL's inverse.
- *the same tables, with constants*: no rival but a bound, [floor.c](../../bench/floor.c), with AVX2:
  hairlut's own steps, written for the three tables of `fitted` alone: no list of lobes, no mixture, no
  choice of kernels, no test for NaN. It draws the same bits. What hairlut takes more is the price of
  taking any hair; where this is slower than a target asks for, tables of these cells cannot meet it.
- *Chiang 2016, its own sampler*: the BSDF that `brown` is fitted to, with the sampler that its authors
  derived, written from the paper, for a single channel of absorption.

"one at a time" is a call of a function for each sample, compiled with -O2 for any x86-64; hairlut chooses
its AVX2 or AVX-512 form while it runs, as it does for arrays. "fastest flags" is the same with -O3
-march=native -ffast-math, for this processor alone. Over arrays, rivals are loops that gcc vectorises
with those flags and libmvec, for 256 and 512 bits. Their results then depend on the processor; hairlut's
do not. The C library's scalar erff takes about 40 cycles, which is most of the scalar closed form's
time. Its vector form (libmvec) is a modern one, faster than SLEEF's.

"""

SIZES = """## Time against error

![Time per sample against relative variance, quantile error and bytes](speed_error_axes.svg)

One table, theta_i of the direct lobe of `fitted`, with a uniform azimuth: a direction and both
densities. The rivals' lines are their samples of a lobe of that kind (`sample_multiple`), V = 0: that a
table can do without a closed form is its reason to be; the figure shows what it costs where there is
one.

"""

LARGE = """
V stops falling at about 256: there the end cells of a row are only a few float steps wide, and e has to
grow with the width to keep them from vanishing.

Who needs larger tables than the shipped ones? Not who draws with random numbers: V is below 1e-4 at
{small}, which costs one sample in 10,000. Quasi-random numbers at a thousand samples and more do see a
smaller V ([the page](quasi.md)), as does a lobe that is narrow against the whole range of theta_r or
changes quickly with it ([hard cases](hard_cases.md) has the sizes that such lobes took). Larger tables
leave the caches, which is what the times show: in memory a 256x256 table keeps {large:.1f} times the bytes
of its texels, one of 32x32 {little:.1f} times.

Half floats cost the same time, since the library expands texels when it loads them. At every size some
of their cells are flat: no angle, and so an infinite density. The [study](study.md) has the other 16-bit
forms.

"""

WARPS = """
By themselves, the warps of the [study](study.md), u to the coordinate whose integer part is the cell. A
map optimised for one lobe is a spline, which costs a search or a table of its own, and was not timed.

"""

ELSEWHERE = """
## Elsewhere

No graphics hardware was at hand: the shaders ran on software drivers, which say nothing about their
speed. It was not measured.

"""


def page(points: list[Point], times: Times, others: str = "") -> str:
    """The page as Markdown; others: further sections."""
    intro = TEXT.format(repetitions=times.repetitions(), place=times.place, interference=times.interference())
    parts = [intro, "## Who is faster\n\n", summary.headline(times), "\n", summary.targets(times), RIVALS]
    parts += [
        f"\n### {text}"
        for m in ("fitted", "brown", "printed")
        for how in summary.HOW
        if (text := summary.beside(times, m, how))
    ]
    parts += ["\n", SIZES, _sizes(points, times), large(points, times)]
    parts += [
        "## What the warp costs\n\n",
        _warp(points, times),
        WARPS,
        _candidates(times),
        ELSEWHERE,
        others,
    ]
    return "".join(parts)


def _sizes(points: list[Point], times: Times) -> str:
    columns = (
        "design", "side", "bytes", "in memory", "V", "largest weight", "TV", "quantile error", "flat cells",
        "sample, one", "arrays", "density, one", "arrays",
    )  # fmt: skip
    return markdown_table(columns, (_size_row(point, times) for point in points))


def _size_row(point: Point, times: Times) -> tuple[object, ...]:
    errors = point.errors
    measured = ("infinite", "", "", "") if point.flat else (
        f"{errors.relative_variance:.1e}",
        f"{errors.largest_weight:.3g}",
        f"{errors.total_variation:.1e}",
        f"{errors.inner_quantile_error:.1e}",
    )  # fmt: skip
    taken = [
        times.least(point.model or "", f"{call}_direct", "hairlut", how)
        for call in ("sample", "pdf")
        for how in ("one", "arrays")
    ]
    memory = times.memory.get(point.model or "", "")
    return (
        point.design, point.side, point.bytes, memory, *measured, point.flat,
        *(f"{ns:.2f}" if ns else "" for ns in taken),
    )  # fmt: skip


def large(points: list[Point], times: Times) -> str:
    """Who needs large tables, and what they cost."""
    shipped = [p for p in points if p.model and p.model.startswith(SHIPPED)]
    small = [p.side for p in shipped if p.errors.relative_variance < 1e-4]
    ratio = {p.side: times.memory[p.model] / p.bytes for p in shipped if p.model in times.memory}
    return LARGE.format(
        small=f"{min(small)}x{min(small)}" if small else "no size here",
        large=ratio.get(256, float("nan")),
        little=ratio.get(32, float("nan")),
    )


def _warp(points: list[Point], times: Times) -> str:
    rows = []
    for side in sorted({p.side for p in points}):
        for how, label in summary.HOW.items():
            octaves, uniform = (
                times.least(f"{design}-{side}", "sample_direct", "hairlut", how)
                for design in (SHIPPED, UNIFORM)
            )
            if octaves and uniform:
                rows.append(
                    (
                        f"{side}x{side}, {label}",
                        f"{uniform:.2f}",
                        f"{octaves:.2f}",
                        f"{octaves / uniform - 1:+.0%}",
                    )
                )
    return markdown_table(("sample of one table, ns", "uniform", "octaves", "more"), rows)


def _candidates(times: Times) -> str:
    """The warps of the study, by themselves."""
    rows = []
    for name, label in CANDIDATES.items():
        one, arrays = (times.least("warp", name, "alone", how) for how in ("one", "arrays"))
        if one and arrays:
            rows.append((label, f"{one:.1f}", f"{arrays:.2f}"))
    return markdown_table(("warp", "ns, one call", "ns, arrays, compiler's fastest flags"), rows)
