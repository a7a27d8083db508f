# SPDX-License-Identifier: BSD-3-Clause
"""The scale page: what a vertex costs against the number of lobes, offsets, rows, columns and threads."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from bench import summary
from bench.timing import Times

from hairlut import exr
from hairlut.lobes import FITTED
from hairlut.mixture import Mixture, constant
from hairlut.model import BakedLobe, BakedModel
from hairlut.table import Table, bake_table
from hairlut.warp import Warp
from report.markdown import table as markdown_table

LOBES, OFFSETS, SIDES = (1, 2, 4, 8, 16), (1, 2, 5, 17, 65), (16, 32, 64, 128, 256, 512)
SIDE = 32  # of what does not vary
ROWS = 33  # nodes of theta_r in a mixture
WARP = Warp("octaves", 2.0**-16)  # leaves no cell flat at any of these sizes
NAMES = (
    "^(lobes|offsets|columns|rows)-[0-9]+/(vertex|sample_hair|pdf_hair)/hairlut/(one|arrays)$|"
    "^(fitted|brown)/(vertex|sample_hair|pdf_hair)/hairlut/threads"
)


def write_models(folder: Path, lobes=LOBES, offsets=OFFSETS, sides=SIDES) -> None:
    """One model directory for each point of each axis: lobes-4, offsets-17, columns-64, rows-64."""
    models = {f"lobes-{count}": (SIDE, SIDE, constant(names(count))) for count in lobes}
    models |= {f"offsets-{count}": (SIDE, SIDE, over_offsets(count)) for count in offsets}
    models |= {f"columns-{side}": (side, SIDE, constant(names(1))) for side in sides}
    models |= {f"rows-{side}": (SIDE, side, constant(names(1))) for side in sides}
    for name, (width, height, mixture) in models.items():
        theta, phi = (
            replace(bake_table(lobe, width, height, WARP), model=name)
            for lobe in (FITTED.direct_theta, FITTED.direct_phi)
        )
        exr.write_model(folder / name, BakedModel(name, lobes_of(mixture.lobes, theta, phi), mixture))


def names(count: int) -> tuple[str, ...]:
    return tuple(f"lobe{k}" for k in range(count))


def lobes_of(names: tuple[str, ...], theta: Table, phi: Table) -> tuple[BakedLobe, ...]:
    """Lobes that have tables of their own, all with these texels."""
    return tuple(
        BakedLobe(name, replace(theta, name=f"{name}_theta"), replace(phi, name=f"{name}_phi"))
        for name in names
    )


def over_offsets(count: int) -> Mixture:
    """Four lobes whose shares and turns vary over theta_r and so many offsets."""
    random, shape = np.random.default_rng(5), (4, ROWS, count)
    offset = np.linspace(-1, 1, count) if count > 1 else np.zeros(1)
    theta_r = np.linspace(-np.pi / 2, np.pi / 2, ROWS)
    return Mixture(names(4), theta_r, offset, random.uniform(0.1, 1, shape), random.uniform(-3, 3, shape))


# ---- the page
# -------------------------------------------------------------------------------------------------

TEXT = """# Scale

What a vertex costs, one sample of the whole hair and the density of another direction, when a model
grows. Every lobe has two tables of its own, {side}x{side} where they do not vary, with the texels of
`fitted`'s direct lobe. The least of {repetitions} repeats, on {place}.
"""

CALCULATION = """
## By calculation

- A sample of K lobes draws from one and evaluates the density of the K - 1 others; the density of a
  direction evaluates all K. A vertex is one draw and 2 K - 1 densities, and 2 evaluations of the mixture
  (K shares and turns, bilinear). Hence a line in K:
{lines}
- More offsets, or more rows of the mixture, add memory, 16 bytes a lobe and node, and steps to the search
  of a node, which grow with their logarithm one at a time.
- A draw computes its column from u, and its row from theta_r: neither more rows nor more columns add
  work. A density searches a row for the cell of an angle, whose steps grow with the logarithm of the
  columns. What grows is the memory that both go through, and with it the time of a miss.
- Memory, measured: {memory:.0f} bytes a texel of the tables, which is {ratio:.1f} times that of the texture;
  {model:.0f} KiB for 16 lobes of {side}x{side}.
- Threads share a model that is only read, and nothing else: no lock, no counter, no allocation. Each
  adds its own speed until cores, or the caches that they share, run out. Above, a vertex takes a thread
  as much of its processor's time among others as alone. The clock on the wall says less: the machine was
  shared with other programs.
"""


def page(times: Times) -> str:
    text = TEXT.format(side=SIDE, repetitions=times.repetitions(), place=times.place)
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
        lines="\n".join(lines), side=SIDE, memory=whole / texels, ratio=whole / texels / 8, model=whole / 1024
    )


def threads(times: Times) -> str:
    """What a vertex takes each thread, when so many draw from one model at once. The benchmark's ns are of
    all threads together."""
    rows = []
    for model in ("fitted", "brown"):
        one = times.least(model, "vertex", "hairlut", "threads1")
        for count in (2**k for k in range(9)):
            ns = times.least(model, "vertex", "hairlut", f"threads{count}")
            if one and ns:
                rows.append((model, count, f"{count * ns:.1f}", f"{one / ns:.2f}"))
    return markdown_table(
        ("model", "threads", "ns of each thread's processor", "all together, times one"), rows
    )
