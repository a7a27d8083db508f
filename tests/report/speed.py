"""Speed against error: tables of every size, other warps and cells, and the rivals, all timed in one run."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from hairlut import exr, figures
from hairlut.errors import HairlutError
from hairlut.lobes import FITTED
from hairlut.measure import Errors, flat_cells, measure, narrowest_cell
from hairlut.model import assemble
from hairlut.size import EXPONENTS, MIN_STEPS, table_of_size
from hairlut.table import Table, bake_table
from hairlut.warp import Warp
from report import timing
from report.cells import LINEAR, PARABOLA, RATIONAL, Cell
from report.markdown import table as markdown_table
from report.study import as_half

LOBE = FITTED.direct_theta
SIDES = (16, 32, 64, 128, 256, 512, 1024)
SEARCHED = 128  # sides up to which e is searched for; above, the smallest that leaves no cell too narrow
PATTERN = (
    "(sample|uniform)/(scalar|batch)/.*/direct_theta|rival/.*/fitted/direct_theta|"
    "(sample|uniform)/scalar/64/.*|warp/.*|pdf/(scalar|batch)/64/direct_theta|floor/(index|angles)/(64|256)/direct_theta"
)

RIVALS = {
    "analytic/scalar": "plain C: two erff, Giles' erfinv",
    "hybrid/scalar": "hybrid: ends tabulated, Giles' erfinv",
    "boost/scalar": "Boost.Math erf_inv",
    "analytic/vector256": "analytic, vectorised by the compiler, 256 bits, -ffast-math",
    "analytic/vector512": "analytic, vectorised by the compiler, AVX-512, -ffast-math",
    "hybrid/vector256": "hybrid, vectorised by the compiler, 256 bits, -ffast-math",
    "hybrid/vector512": "hybrid, vectorised by the compiler, AVX-512, -ffast-math",
    "mkl/vector": "MKL: vsErf, vsErfInv, vsExp over arrays",
}

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
    """One design at one size: what it costs an estimate. `timed` names its benchmark with {} for scalar or
    batch."""

    design: str
    side: int
    errors: Errors
    bytes: int
    flat: int
    timed: str | None


def bake_sizes(folder: Path, sides=SIDES) -> list[Point]:
    """Writes a model directory for each side below folder; the points of every design at every side."""
    points = []
    for side in sides:
        e = write_square_model(folder / str(side), side)
        points += designs(side, Warp("octaves", e))
    return points


def write_square_model(folder: Path, side: int) -> float:
    """Bakes the fitted model square; the e of its LOBE."""
    tables = {lobe.name: square(lobe, side) for lobe in FITTED.lobes}
    exr.write_model(folder, assemble(FITTED, tables))
    return tables[LOBE.name].warp.e


def square(lobe, side: int) -> Table:
    if side <= SEARCHED:
        return table_of_size(lobe, side, side).table
    for exponent in EXPONENTS:
        if exponent >= -24:
            table = bake_unless_flat(lobe, side, Warp("octaves", 2.0**exponent))
            if table and narrowest_cell(table.texels) >= MIN_STEPS:
                return table
    raise AssertionError("the widest e leaves wide cells")


def bake_unless_flat(lobe, side: int, warp: Warp) -> Table | None:
    try:
        return bake_table(lobe, side, side, warp)
    except HairlutError:
        return None


def designs(side: int, warp: Warp) -> list[Point]:
    """The shipped design and the simpler ones that it displaced, of one size."""
    tables = {
        ("octaves warp, curved cells", "sample/{}"): (bake_table(LOBE, side, side, warp), RATIONAL),
        ("octaves warp, parabolas", None): (bake_table(LOBE, side, side, warp), PARABOLA),
        ("octaves warp, linear cells", None): (bake_table(LOBE, side, side, warp), LINEAR),
        ("uniform in u, linear cells", "uniform/{}"): (
            bake_table(LOBE, side, side, Warp("uniform")), LINEAR,
        ),
    }  # fmt: skip
    shipped, _ = next(iter(tables.values()))
    halves = replace(shipped, texels=as_half(shipped.texels, shipped.domain))
    tables["octaves warp, curved cells, half floats", None] = halves, RATIONAL
    return [
        _point(name, timed and f"{timed}/{side}/direct_theta", table, cell)
        for (name, timed), (table, cell) in tables.items()
    ]


def _point(design: str, timed: str | None, table: Table, cell: Cell) -> Point:
    between = 3 if table.width <= SEARCHED else 0  # so many rows leave no room for errors between them
    with np.errstate(all="ignore"):  # flat cells of half floats
        errors = measure(table, LOBE, between, read=cell.read)
    size = table.texels.nbytes * (1 if "half" in design or cell is not RATIONAL else 2)
    return Point(design, table.width, errors, size, flat_cells(table.texels), timed)


# ---- figures
# --------------------------------------------------------------------------------------------------

LOOKS = {
    ("octaves warp, curved cells", "batch"): (figures.BLUE, "o-", "hairlut, batch"),
    ("octaves warp, curved cells", "scalar"): (figures.BLUE, "o--", "hairlut, one call a sample"),
    ("uniform in u, linear cells", "batch"): (figures.ORANGE, "s-", "uniform table, batch"),
    ("uniform in u, linear cells", "scalar"): (figures.ORANGE, "s--", "uniform table, one call"),
}
RIVAL_LOOKS = {
    "boost/scalar": (figures.BROWN, "--", "Boost.Math"),
    "analytic/scalar": (figures.RED, "--", "analytic in C"),
    "hybrid/scalar": (figures.GREEN, "--", "hybrid"),
    "mkl/vector": (figures.PURPLE, "-", "MKL, arrays"),
    "analytic/vector256": (figures.RED, "-", "analytic, arrays"),
    "hybrid/vector256": (figures.GREEN, "-", "hybrid, arrays"),
}
AXES = {
    "relative variance V that the table adds": lambda point: point.errors.relative_variance,
    "quantile error [rad], u in [2^-12, 1-2^-12]": lambda point: point.errors.inner_quantile_error,
    "bytes of the table": lambda point: point.bytes,
}


def draw(points: list[Point], times: timing.Times, path: Path, axes=AXES) -> Path:
    """Nanoseconds a sample against each of the axes; rivals, which have no table, as lines across."""
    figure, panels = figures.new(
        1, len(axes), (8.4 if len(axes) == 1 else 15, 5.2), sharey=True, squeeze=False
    )
    for panel, (label, value) in zip(panels[0], axes.items(), strict=True):
        _draw_tables(panel, points, times, value)
        _draw_rivals(panel, times, last=panel is panels[0][-1])
        panel.set(xscale="log", yscale="log", xlabel=label)
    first = panels[0][0]
    first.set_ylabel("time per sample with density [ns]")
    first.legend(loc="center", bbox_to_anchor=(0.45, 0.42), fontsize=8.5)
    first.set_title("Theta of the direct lobe, model fitted; numbers are sides of square tables")
    return figures.save(figure, path)


def _draw_tables(panel, points: list[Point], times: timing.Times, value) -> None:
    for (design, form), (colour, line, label) in LOOKS.items():
        mine = [
            (value(p), times.get(p.timed.format(form)), p.side)
            for p in points
            if p.design == design and p.timed
        ]
        mine = [each for each in mine if each[1] is not None]
        panel.plot([x for x, _, _ in mine], [y for _, y, _ in mine], line, color=colour, label=label)
        for x, y, side in mine if form == "batch" else []:
            panel.annotate(
                str(side),
                (x, y),
                (0, -12),
                textcoords="offset points",
                fontsize=7.5,
                ha="center",
                color=colour,
            )


def _draw_rivals(panel, times: timing.Times, last: bool) -> None:
    for name, (colour, line, label) in RIVAL_LOOKS.items():
        ns = times.get(f"rival/{name}/fitted/direct_theta")
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

ELSEWHERE = """
Where a rival wins: scipy's truncnorm.ppf, which knows the closed form, inverts the same nodes in less time
than hairlut's bake, which integrates any density (below). And a renderer that already holds the two ends of
the interval and needs no density would be served faster by an array of inverse normals alone, which is a
smaller task than the one timed here.
"""

TEXT = """# Speed against error

![Time per sample against relative variance, quantile error and bytes](speed_error_axes.svg)

One axis of the direct lobe (theta, model `fitted`), an angle with its density, random theta_r and u. All
times are of one run on one thread, least of {repetitions} repetitions in random order, of processor time, on
{processor}.
Compare them with each other, not with another machine. The rivals evaluate the closed form of this Gaussian,
so their V is 0: that a table can do without a closed form is its reason to be, and this page asks what it
costs where there is one.
"""

WARPS = """
By themselves, the warps of the [study](study.md), u to the coordinate whose integer part is the cell. A map
optimised for one lobe is a spline, which costs a search or a table of its own, and was not timed.

"""
HALF = """
V stops falling at about 256: there the end cells of a row are only a few float steps wide, and e has to grow
with the width to keep them from vanishing. Nothing is gained beyond that size, and 64x64 is where V is
invisible already.

Half floats cost the same time, since the library expands texels when it loads them. At every size some of
their cells are flat: no angle, and so an infinite density. The [study](study.md) has the other 16-bit forms.
"""


def page(points: list[Point], times: timing.Times, others: str = "") -> str:
    """The page as Markdown; others: further sections."""
    text = TEXT.format(repetitions=timing.REPETITIONS, processor=times.processor)
    parts = [text, verdict(times) + ELSEWHERE, "## Tables\n", _sizes(points, times), HALF]
    parts += ["## Rivals\n", _rivals(times), "## What the warp costs\n", _warp(times), others]
    return "\n".join(parts)


def _sizes(points: list[Point], times: timing.Times) -> str:
    columns = (
        "design", "side", "bytes", "V", "largest weight", "TV", "quantile error", "flat cells",
        "ns, one call", "ns, batch",
    )  # fmt: skip
    return markdown_table(columns, (_size_row(point, times) for point in points))


def _size_row(point: Point, times: timing.Times) -> tuple[str, ...]:
    scalar, batch = (
        times.get(point.timed.format(form)) if point.timed else None for form in ("scalar", "batch")
    )
    errors = point.errors
    return (
        point.design,
        str(point.side),
        str(point.bytes),
        f"{errors.relative_variance:.1e}" if not point.flat else "infinite",
        f"{errors.largest_weight:.3g}" if not point.flat else "",
        f"{errors.total_variation:.1e}" if not point.flat else "",
        f"{errors.inner_quantile_error:.1e}" if not point.flat else "",
        str(point.flat),
        f"{scalar:.1f}" if scalar else "",
        f"{batch:.2f}" if batch else "",
    )


def _rivals(times: timing.Times) -> str:
    ours = {form: times.get(f"sample/{form}/64/direct_theta") for form in ("scalar", "batch")}
    rows = []
    for name, label in RIVALS.items():
        ns = times.get(f"rival/{name}/fitted/direct_theta")
        against = "scalar" if name.endswith("scalar") else "batch"
        if ns is None:
            rows.append((label, "not timed here", "", ""))
        else:
            spread = times.spread[f"rival/{name}/fitted/direct_theta"]
            rows.append((label, f"{ns:.2f}", f"{spread:.0%}", f"{ns / ours[against]:.2f} ({against})"))
    return markdown_table(("rival", "ns", "spread of repeats", "times hairlut's 64x64"), rows)


def _warp(times: timing.Times) -> str:
    rows = []
    for name in ("direct_theta", "direct_phi", "multiple_theta"):
        octaves, uniform = (times.get(f"{kind}/scalar/64/{name}") for kind in ("sample", "uniform"))
        if octaves and uniform:
            rows.append((name, f"{uniform:.1f}", f"{octaves:.1f}", f"{octaves / uniform - 1:+.0%}"))
    whole = markdown_table(("table, 64x64, one call", "uniform, ns", "octaves, ns", "more"), rows)
    return whole + WARPS + _candidates(times)


def _candidates(times: timing.Times) -> str:
    """The warps of the study, by themselves."""
    rows = []
    for name, label in CANDIDATES.items():
        scalar, vector = (times.get(f"warp/{form}/{name}") for form in ("scalar", "vector"))
        if scalar and vector:
            rows.append((label, f"{scalar:.1f}", f"{vector:.2f}"))
    return markdown_table(("warp", "ns, one call", "ns, arrays, compiler's fastest flags"), rows)


def verdict(times: timing.Times) -> str:
    """Who is faster, from the figures."""
    ours = {form: times.get(f"sample/{form}/64/direct_theta") for form in ("scalar", "batch")}
    lines = []
    for name, label in RIVALS.items():
        ns = times.get(f"rival/{name}/fitted/direct_theta")
        if ns is None:
            continue
        mine = ours["scalar" if name.endswith("scalar") else "batch"]
        who = (
            f"hairlut is {ns / mine:.1f} times faster"
            if ns > mine
            else f"**the rival wins, {mine / ns:.1f} times**"
        )
        lines.append(f"- against {label}: {who}")
    return "## Who is faster\n\n" + "\n".join(lines) + "\n"
