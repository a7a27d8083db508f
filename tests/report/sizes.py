# SPDX-License-Identifier: BSD-3-Clause
"""Which size of `fitted` to ship: the time of a vertex, bytes, and the error of quasi-random numbers, by the
tolerance that its tables are baked to.

The default is to be the fastest vertex among those that meet the limits of quasi.LIMITS.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from bench.timing import Times

from hairlut import exr
from hairlut.lobes import FITTED
from hairlut.mixture import constant
from hairlut.model import BakedLobe, BakedModel
from hairlut.size import DEFAULT_TOLERANCE, smallest_tables, table_of_size
from hairlut.table import Table
from report import quasi
from report.markdown import table as markdown_table

TOLERANCES = (1e-4, 5e-5, 3e-5, 2e-5, 1e-5, 3e-6, 1e-6)
SQUARE = (64, 128)  # sides of tables that no tolerance chose
NAMES = "^size-.*/vertex/hairlut/(one|arrays)$"


@dataclass(frozen=True)
class Size:
    """Tables of theta and phi of the direct lobe, and theta of the multiple one. model: the directory that is
    timed."""

    title: str
    model: str
    tables: tuple[Table, ...]

    def bytes(self) -> int:
        """Of the textures: an angle and a slope a texel."""
        return sum(table.texels.size for table in self.tables) * 2 * 4

    def ratios(self) -> dict[int, float]:
        """The worst of the limits' ratios, by the number of samples."""
        draw = quasi.through(self.tables[:2])
        return {n: float(quasi.ratios(draw, n).max()) for n in quasi.LIMITS}


def sizes() -> list[Size]:
    """Those that are compared."""
    chosen = [
        Size(
            f"V <= {tolerance:g}",
            f"size-{tolerance:g}",
            tuple(c.table for c in smallest_tables(FITTED.lobes, tolerance)),
        )
        for tolerance in TOLERANCES
    ]
    square = [
        Size(
            f"{side}x{side}",
            f"size-{side}",
            tuple(table_of_size(lobe, side, side).table for lobe in FITTED.lobes),
        )
        for side in SQUARE
    ]
    return chosen + square


def write_model(folder: Path, size: Size) -> None:
    """`fitted` with tables of this size, as folder/MODEL."""
    direct_theta, direct_phi, multiple_theta = (replace(table, model=size.model) for table in size.tables)
    lobes = (BakedLobe("direct", direct_theta, direct_phi), BakedLobe("multiple", multiple_theta, None))
    exr.write_model(folder / size.model, BakedModel(size.model, lobes, constant(("direct", "multiple"))))


TEXT = """# The size to ship

`fitted`, baked to tolerances of the relative variance V, and with square tables: the time of a path vertex
(a sample of the whole hair and the density of another direction), the bytes of its three textures, and the
error of lighting integrals with quasi-random numbers relative to the exact inverse's, the worst of twelve
([quasi-random numbers](quasi.md)). The least of {repetitions} repeats, on
{place}.

A size meets the limits where that error is at most {few} at 64 samples and {many} at 1,024. Among those that
do, the default is to have the fastest vertex: {verdict}

"""


def page(compared: list[Size], times: Times, step: Callable[[str], None] = lambda text: None) -> str:
    rows, fastest = [], {}
    few, many = quasi.LIMITS.values()
    for size in compared:
        step(size.title)
        found = size.ratios()
        one, arrays = (times.least(size.model, "vertex", "hairlut", how) for how in ("one", "arrays"))
        meets = all(found[n] <= limit for n, limit in quasi.LIMITS.items())
        if meets:
            fastest[size.title] = one
        shape = ", ".join(f"{table.width}x{table.height}" for table in size.tables)
        title = (
            f"**{size.title}**, the default" if size.title == f"V <= {DEFAULT_TOLERANCE:g}" else size.title
        )
        rows.append(
            (
                title,
                shape,
                f"{size.bytes():,}",
                f"{one:.1f}",
                f"{arrays:.1f}",
                *(f"{found[n]:.2f}" for n in quasi.LIMITS),
                "yes" if meets else "no",
            )
        )
    head = ("tables", "theta, phi, theta", "bytes", "vertex, one, ns", "arrays, ns")
    head += tuple(f"n = {n:,}" for n in quasi.LIMITS)
    text = TEXT.format(
        place=times.place,
        repetitions=times.repetitions(),
        few=few,
        many=many,
        verdict=_verdict(fastest),
    )
    return text + markdown_table((*head, "meets both"), rows) + "\n"


def _verdict(fastest: dict[str, float]) -> str:
    """Which of the sizes that meet the limits is the fastest, one call at a time; is it shipped?"""
    best, shipped = min(fastest, key=fastest.__getitem__), f"V <= {DEFAULT_TOLERANCE:g}"
    if best == shipped:
        return f"it is {shipped}, as shipped."
    if shipped not in fastest:
        return f"it is {best}; {shipped}, as shipped, does not meet them."
    more = fastest[shipped] / fastest[best] - 1
    return f"it is {best}; {shipped}, as shipped, takes {more:.0%} longer."
