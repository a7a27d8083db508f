# SPDX-License-Identifier: BSD-3-Clause
"""The scale page: what a vertex costs against the number of lobes, offsets, rows, columns and threads."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from bench import summary
from bench.timing import REPETITIONS, Times

from hairlut import exr
from hairlut.lobes import FITTED
from hairlut.mixture import Mixture, constant
from hairlut.model import BakedLobe, BakedModel
from hairlut.size import table_of_size
from hairlut.table import Table, bake_table
from report.markdown import table as markdown_table

LOBES, OFFSETS, SIDES = (1, 2, 4, 8, 16), (1, 2, 5, 17, 65), (16, 32, 64, 128, 256, 512)
SIDE = 32  # of what does not vary
ROWS = 33  # nodes of theta_r in a mixture
NAMES = (
    "^(lobes|offsets|columns|rows)-[0-9]+/(vertex|sample_hair|pdf_hair)/hairlut/(one|arrays)$|"
    "^(fitted|brown)/(vertex|sample_hair|pdf_hair)/hairlut/threads"
)


def write_models(folder: Path, lobes=LOBES, offsets=OFFSETS, sides=SIDES) -> None:
    """One model directory for each point of each axis: lobes-4, offsets-17, columns-64, rows-64."""
    theta, phi = (table_of_size(lobe, SIDE, SIDE).table for lobe in (FITTED.direct_theta, FITTED.direct_phi))
    for count in lobes:
        names = tuple(f"lobe{k}" for k in range(count))
        write(folder / f"lobes-{count}", theta, phi, constant(names))
    for count in offsets:
        write(folder / f"offsets-{count}", theta, phi, over_offsets(count))
    for side in sides:
        for axis, (width, height) in {"columns": (side, SIDE), "rows": (SIDE, side)}.items():
            tables = (resized(lobe, like, width, height) for lobe, like in
                      ((FITTED.direct_theta, theta), (FITTED.direct_phi, phi)))  # fmt: skip
            write(folder / f"{axis}-{side}", *tables, constant(("lobe0",)))


def write(folder: Path, theta: Table, phi: Table, mixture: Mixture) -> None:
    """A model whose lobes have tables of their own, all with these texels."""
    lobes = tuple(
        BakedLobe(name, replace(theta, name=f"{name}_theta"), replace(phi, name=f"{name}_phi"))
        for name in mixture.lobes
    )
    exr.write_model(folder, BakedModel(folder.name, lobes, mixture))


def over_offsets(count: int) -> Mixture:
    """Four lobes whose shares and turns vary over theta_r and so many offsets."""
    names, random = tuple(f"lobe{k}" for k in range(4)), np.random.default_rng(5)
    shape = len(names), ROWS, count
    offset = np.linspace(-1, 1, count) if count > 1 else np.zeros(1)
    theta_r = np.linspace(-np.pi / 2, np.pi / 2, ROWS)
    return Mixture(names, theta_r, offset, random.uniform(0.1, 1, shape), random.uniform(-3, 3, shape))


def resized(lobe, like: Table, width: int, height: int) -> Table:
    return bake_table(lobe, width, height, like.warp)


# ---- the page
# -------------------------------------------------------------------------------------------------

TEXT = """# Scale

What a vertex costs, one sample of the whole hair and the density of another direction, when a model
grows. Every lobe has two tables of its own, {side}x{side} where they do not vary, with the texels of
`fitted`'s direct lobe. The least of {repetitions} repeats, on {place}.
"""

CALCULATION = """
## By calculation

- A sample of K lobes draws from one and asks the density of the K - 1 others; the density of a direction
  asks all K. A vertex is one draw and 2 K - 1 densities, and 2 evaluations of the mixture (K shares and
  turns, bilinear). Hence a line in K:
{lines}
- A number of offsets or of rows of the mixture adds memory only: 8 bytes a lobe and node. The two nodes
  are found by {search}.
- A draw computes its column from u, and its row from theta_r: neither more rows nor more columns add
  work. A density searches a row for the cell of an angle, whose steps grow with the logarithm of the
  columns. What grows is the memory that both go through, and with it the time of a miss.
- Memory, measured: {memory} bytes a texel of its tables. {model} of a model of 16 lobes of
  {side}x{side}.
- Threads share a model that is only read, and nothing else: no lock, no counter, no allocation. Each
  adds its own speed until cores, or the caches that they share, run out.
"""


def page(times: Times) -> str:
    text = TEXT.format(side=SIDE, repetitions=REPETITIONS, place=times.place)
    parts = [text, "\n## Lobes\n\n", axis(times, "lobes", LOBES), "\n## Offsets\n\n"]
    parts += [f"Four lobes, {ROWS} nodes of theta_r.\n\n", axis(times, "offsets", OFFSETS)]
    parts += ["\n## Columns\n\nOne lobe.\n\n", axis(times, "columns", SIDES)]
    parts += ["\n## Rows\n\nOne lobe.\n\n", axis(times, "rows", SIDES)]
    parts += ["\n## Threads\n\n", threads(times), calculation(times)]
    return "".join(parts)


def axis(times: Times, name: str, counts: tuple[int, ...]) -> str:
    """The times of every point of one axis, and its memory."""
    calls = [(call, how) for call in ("vertex", "sample_hair", "pdf_hair") for how in summary.HOW]
    rows = []
    for count in counts:
        taken = [times.least(f"{name}-{count}", call, "hairlut", how) for call, how in calls]
        if any(taken):
            memory = times.memory.get(f"{name}-{count}", "")
            rows.append((count, memory, *(f"{ns:.1f}" if ns else "" for ns in taken)))
    columns = (name, "bytes in memory", *(f"{call}, {summary.HOW[how]}" for call, how in calls))
    return markdown_table(columns, rows)


def line(times: Times, how: str) -> tuple[float, float] | None:
    """(a, b) of a vertex of K lobes, a + b K ns, by least squares of relative errors."""
    points = [(k, ns) for k in LOBES if (ns := times.least(f"lobes-{k}", "vertex", "hairlut", how))]
    if len(points) < 3:
        return None
    k, ns = np.array(points).T
    b, a = np.polyfit(k, ns, 1, w=1 / ns)
    return float(a), float(b)


def calculation(times: Times) -> str:
    fits = {label: fit for how, label in summary.HOW.items() if (fit := line(times, how))}
    lines = [f"  {label}, {a:.1f} + {b:.1f} K ns" for label, (a, b) in fits.items()]
    texels = 2 * SIDE * SIDE * 16
    whole = times.memory.get("lobes-16", 0)
    return CALCULATION.format(
        lines="\n".join(lines), side=SIDE, memory=f"{whole / texels:.0f}", model=f"{whole / 1024:.0f} KiB",
        search="the number of the interval, computed where nodes are even",
    )  # fmt: skip


def threads(times: Times) -> str:
    """How much faster so many threads are than one, drawing from one model."""
    parts = []
    for model in ("fitted", "brown"):
        one = times.least(model, "vertex", "hairlut", "threads1")
        rows = []
        for count in (2**k for k in range(9)):
            ns = times.least(model, "vertex", "hairlut", f"threads{count}")
            if one and ns:
                rows.append((count, f"{ns:.1f}", f"{one / ns:.2f}"))
        if rows:
            parts.append(f"`{model}`, a vertex over arrays, by the clock on the wall:\n\n")
            parts.append(markdown_table(("threads", "ns a vertex", "times as fast as one"), rows) + "\n")
    return "".join(parts)
