# SPDX-License-Identifier: BSD-3-Clause
"""The study as a page: what was compared, what came out, what was decided."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from hairlut import figures
from report import study
from report.markdown import table as markdown_table
from report.study import Result

WIDTH = HEIGHT = 64
SIDES = (16, 24, 32, 48, 64, 96, 128)
HALF_SIDES = (16, 32, 64, 128)
COLUMNS = (16, 32, 64)
GAP_WIDTHS = (33, 64)

TEXT = f"""# The study behind the design

Everything here is measured by `make report` with the same code that `hairlut verify` uses: float32 texels
of {WIDTH}x{HEIGHT} tables, on every row and at three points between rows, the worst of them shown. V is the
relative variance that a table adds to an estimate. The four lobes are theta of the direct lobe in both
readings, the azimuth, and theta of the multiple lobe; the readings share the last two.

## Decision

1. **Cells are monotone rational quadratics in u** (Gregory and Delbourgo 1982) through the exact density at
   every knot, so that a texel is an angle and its slope dx/du, and the density is continuous. Version 1 had
   parabolas, whose slopes follow from the angles alone. At the same number of columns V is now 9 to 200
   times less on rows alone, and the largest weight of the direct lobe is 1.55 instead of 4.7 or 7.2: half the
   columns, and so the same bytes, have the better of both. Linear cells have V near 1e-3 at 64 columns.
   **What it costs**: a call is slower at the same V, as the time of a call hardly depends on the columns.
   Version 1 (commit f153096, parabolas, 44x32) and this one (32x48), scalar calls and arrays of 4096 on one
   EPYC, least of 400: sample_direct 18.0 and 27.8 ns, pdf_direct 29.2 and 43.4 ns, sample_direct_n 2.1 and
   3.5 ns, pdf_direct_n 5.2 and 7.2 ns. The libraries differ in more than the cell (version 1's arrays used
   AVX-512). Adopted all the same: weights are what a lamp shows, the density's jumps at knots are gone, and
   tables that pass as the exact inverse with quasi-random numbers ([quasi.md](quasi.md)) stay small.
   **Slopes**: at inner knots 1 / density, but at most 8 times the smaller secant beside the knot, where it
   lies in a gap between two modes: without a bound V is 63 there and a weight 1,600 (the table of bounds). At
   the ends of the domain 1 / density may be 1e80; there the slope is the one that puts the end cell's middle
   on the true quantile. A search for the slope of least V gives the same V and slightly larger weights.
2. **Warp: octaves**, folded at u = 1/2, columns uniform in what the bits of m+e make when they are shifted
   right by two, m = min(u, 1-u). With these cells every warp with dense ends is as good at 64 columns but the
   square root, one bit less, which leaves the tails too coarse (1.2e-4 on fitted theta). This one is the
   cheapest, one integer operation.
3. **e is measured for each table**, a power of two: that of the least V on rows, among those that leave every
   cell two float steps wide.
4. **The outermost knot lies on the domain's end**, not at the 2^-25 quantile. Stopping at the quantile
   shortens the tails and loses 1e-7 of the lobe's mass, but a renderer's BSDF is not the lobe: a direction
   that the table never draws is energy that no weight restores. With curved end cells full support is nearly
   free: 4e-7 of V.
5. **Rows are even in theta_r.** Uneven rows help one lobe and harm another: rows dense in the middle take
   theta of the printed direct lobe from 6e-5 to 3e-5 and make V of every other table 7 to 15 times as large.
6. **The azimuth keeps the whole range** of theta_r. Half of it would do, at the same V, and save 3 KB; but
   then one table of three would be read by another rule, and lobes of one's own need not be even.
7. **Texels are 32-bit floats.** Half floats of the angle make cells of the direct lobe flat at many sizes.
   The best 16-bit form, the distance to the nearer end as a half float, is nearly as good as floats up to
   32x32, and adds variance from there on (1.9e-4 instead of 3.6e-6 at 64x64), since the middle of the
   domain is then known to 5e-4 rad only. In the direct lobe it never reaches the default tolerance: not
   shipped.
"""

WARPS = ("candidate", "cells", *(f"{lobe.model}/{lobe.name}" for lobe in study.LOBES))
DETAILS = (
    "candidate", "cells", "lobe", "e", "V", "largest weight", "P(weight > 4)", "TV", "quantile error",
    "u in [2^-12, 1-2^-12]", "flat cells", "narrowest, float steps",
)  # fmt: skip


def summary(results: list[Result]) -> str:
    """One line for each candidate and cell: V of each lobe."""
    lines: dict[tuple[str, str], dict[str, str]] = {}
    for each in results:
        lines.setdefault((each.candidate, each.cell), {})[each.lobe] = _variance(each)
    return markdown_table(
        WARPS, ((*key, *(found[lobe] for lobe in WARPS[2:])) for key, found in lines.items())
    )


def cells_summary(results: Iterable[Result]) -> str:
    """One line for each cell and width: V and largest weight of each lobe."""
    lines: dict[tuple[str, str], dict[str, str]] = {}
    for each in results:
        text = f"{_variance(each)}, {_number(each.errors.largest_weight, '.3g')}"
        lines.setdefault((each.cell, each.candidate), {})[each.lobe] = text
    return markdown_table(
        ("cells", "width", *WARPS[2:]),
        ((*key, *(found[lobe] for lobe in WARPS[2:])) for key, found in lines.items()),
    )


def _variance(each: Result) -> str:
    v = each.errors.relative_variance
    return "infinite" if each.flat or not v < 1e6 else f"{v:.1e}"


def _number(x: float, form: str) -> str:
    return "infinite" if not x < 1e6 else format(x, form)


def details(results: Iterable[Result]) -> str:
    return markdown_table(DETAILS, map(_detail, results))


def _detail(each: Result) -> tuple[str, ...]:
    errors = each.errors
    return (
        each.candidate,
        each.cell,
        each.lobe,
        f"2^{np.log2(each.e):.0f}" if each.e else "",
        _variance(each),
        _number(errors.largest_weight, ".3g"),
        f"{errors.heavy_probability:.0e}",
        f"{errors.total_variation:.1e}",
        f"{errors.quantile_error:.1e}",
        f"{errors.inner_quantile_error:.1e}",
        str(each.flat),
        f"{each.narrowest:.0f}",
    )


def short(results: Iterable[Result]) -> str:
    """Candidate, lobe, V, largest weight, lost mass."""
    rows = (
        (
            each.candidate,
            each.lobe,
            _variance(each),
            _number(each.errors.largest_weight, ".3g"),
            f"{each.errors.lost_mass:.0e}",
        )
        for each in results
    )
    return markdown_table(("candidate", "lobe", "V", "largest weight", "mass lost"), rows)


def sixteen_bits(results: Iterable[tuple[int, Result]]) -> str:
    rows: dict[tuple[int, str], dict[str, str]] = {}
    for side, each in results:
        flat = f" ({each.flat} flat)" if each.flat else ""
        rows.setdefault((side, each.candidate), {})[each.lobe] = _variance(each) + flat
    return markdown_table(
        ("side", "texel", *WARPS[2:]), ((*key, *found.values()) for key, found in rows.items())
    )


def draw_warps(results: list[Result], path: Path) -> Path:
    """V of every candidate on every lobe and with every kind of cell."""
    names = list(dict.fromkeys(each.candidate for each in results if each.errors.relative_variance < 1e6))
    figure, panel = figures.new(size=(9, 5.5))
    colours = figures.BLUE, figures.ORANGE, figures.GREEN, figures.PURPLE
    for lobe, colour in zip(WARPS[2:], colours, strict=True):
        for cell, marker, filled in (
            ("linear", "o", "white"), ("parabola", "^", "white"), ("rational quadratic", "D", colour),
        ):  # fmt: skip
            mine = [
                each
                for each in results
                if each.lobe == lobe and each.cell == cell and each.candidate in names
            ]
            panel.plot(
                [each.errors.relative_variance for each in mine],
                [names.index(each.candidate) for each in mine],
                marker, color=colour, mfc=filled, ms=7, label=f"{lobe}, {cell}",
            )  # fmt: skip
    panel.set(
        xscale="log",
        xlabel=f"relative variance V, {WIDTH}x{HEIGHT}",
        yticks=range(len(names)),
        yticklabels=names,
    )
    panel.invert_yaxis()
    panel.axvline(1e-4, color=figures.GREY, linewidth=1, linestyle=":")
    panel.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.3, -0.12), ncols=2)
    return figures.save(figure, path)


def draw_sizes(results: list[tuple[int, Result]], path: Path) -> Path:
    """V against the side of a square table for the designs of study.sizes."""
    figure, panels = figures.new(1, 2, size=(11, 4.6), sharey=True)
    looks = {
        "uniform, linear cells": (figures.ORANGE, "s-"),
        "octaves, linear cells": (figures.GREEN, "^-"),
        "octaves, parabolas": (figures.PURPLE, "x--"),
        "octaves, rational quadratics": (figures.BLUE, "o-"),
    }
    for panel, lobe in zip(panels, ("printed/direct_theta", "fitted/direct_theta"), strict=True):
        for name, (colour, line) in looks.items():
            mine = [(side, each) for side, each in results if each.candidate == name and each.lobe == lobe]
            variances = [each.errors.relative_variance for _, each in mine]
            panel.plot([side for side, _ in mine], variances, line, color=colour, label=name)
        panel.set(
            xscale="log",
            yscale="log",
            xlabel="side of the table",
            title=lobe,
            xticks=SIDES,
            xticklabels=SIDES,
        )
        panel.minorticks_off()
    panels[0].set_ylabel("relative variance V")
    panels[0].legend()
    return figures.save(figure, path)


def write(out: Path, step=lambda text: None) -> None:
    """study.md and its figures."""
    step("warps")
    warps = [*study.warps(WIDTH, HEIGHT), *study.bounds(WIDTH, HEIGHT)]
    draw_warps(warps, out / "study_warps.svg")
    step("sizes")
    draw_sizes(list(study.sizes(SIDES)), out / "study_sizes.svg")
    step("ends, bounds, rows, ranges")
    parts = [
        TEXT,
        "## Warps and cells: V\n",
        summary(warps),
        "![V of every warp and cell](study_warps.svg)\n",
        "![V against the size of the table](study_sizes.svg)\n",
        f"## Cells: V and the largest weight, on {HEIGHT} rows alone, each at the e that suits it best\n",
        cells_summary(study.columns(COLUMNS, HEIGHT)),
        "## The ends\n",
        short(study.ends(WIDTH, HEIGHT)),
        "## The bound of an inner slope, where two modes have a gap between them\n",
        short(study.slope_bounds(GAP_WIDTHS, HEIGHT + 1)),
        "## Rows\n",
        short(study.rows(WIDTH, HEIGHT)),
        "## The azimuth's range\n",
        short(study.half_range(WIDTH, HEIGHT)),
    ]
    step("16-bit texels")
    parts += ["## Sixteen bits: V at the e that suits each best\n", sixteen_bits(study.encodings(HALF_SIDES))]
    parts += ["## All metrics\n", details(warps)]
    parts += ["What the warp costs in C is measured in [speed.md](speed.md).\n"]
    (out / "study.md").write_text("\n".join(parts))
