# SPDX-License-Identifier: BSD-3-Clause
"""The page of parameters.py's numbers."""

from __future__ import annotations

from report.markdown import table

MEDIAN, PERCENTILE, MEGABYTES = 1.02, 1.05, 1.0
DEFAULT = "0.01"

TEXT = """# One model for every strand

`hairlut fit precompute/examples/chiang_parameters.py` makes one model of Chiang's hair over longitudinal
roughness (beta_m, 0.05 to 0.6), azimuthal roughness (beta_n, 0.1 to 0.6) and absorption (0.05 to 5). The
numbers below are of its textures, read through the C library, at {places} random parameters, viewers theta_r
(within 89.9 degrees) and offsets, by a midpoint rule of {points} x {points} directions: a quadrature that the
fit has no part in. The authors' sampler chooses a lobe by its attenuation and draws both angles exactly.
Seconds are of one core.

    PYTHONPATH=tests .venv/bin/python -m report.parameters

"""

AXES = """## What depends on what

The fit with --tolerance {:g}: axes that it gave each texture, and how many nodes. In the equations of the
paper theta depends on beta_m alone, the azimuth on beta_n alone, and a lobe's attenuation on the absorption
alone.

"""

WAYS = """## Between the nodes of a parameter

Two ways to read a table between its nodes: blend the quantiles of the nodes, as between rows of theta_r; or
read one node alone, chosen by a random number with the blend's parts, whose density is then the blend of the
nodes' densities. Both are unbiased. A lobe of another width has the same quantiles scaled: a blend of
quantiles is such a lobe, a blend of densities is not.

"""


def page(results: dict[str, dict], places: int, points: int) -> str:
    """The page in Markdown."""
    rows = [results[key] for key in sorted(results, key=float, reverse=True)]
    return "\n".join([TEXT.format(places=places, points=points) + _sizes(rows), _axes(results), _ways(rows)])


def _sizes(rows: list[dict]) -> str:
    columns = (
        "--tolerance",
        "KB of files",
        "KB of texels",
        "samples, own = 1: median",
        "90 %",
        "99 %",
        "worst",
        "promised V",
        "weight: median",
        "99 %",
        "worst",
        "s",
        "misses",
    )
    shown = [
        (
            f"{row['tolerance']:g}",
            f"{row['bytes'] / 1024:.0f}",
            f"{row['texels'] / 1024:.0f}",
            *(f"{x:.4f}" for x in row["samples"]),
            f"{row['promise'][0]:.4f} ({row['promise'][1]:.4f} to {row['promise'][2]:.4f})",
            *(f"{x:.1f}" for x in row["weights"]),
            f"{row['seconds']:.0f}",
            ", ".join(misses(row)) or "none",
        )
        for row in rows
    ]
    return (
        "## Size against samples\n\n"
        f"Targets: at most {MEDIAN} times the own sampler's samples in the median, {PERCENTILE} at the 99th "
        f"percentile, {MEGABYTES:g} MB. Files are compressed; a renderer holds the texels.\n\n"
        + table(columns, shown)
    )


def misses(row: dict) -> list[str]:
    """The targets that a row misses."""
    return [
        what
        for what, missed in (
            ("median", row["samples"][0] > MEDIAN),
            ("99 %", row["samples"][2] > PERCENTILE),
            ("size", row["bytes"] > MEGABYTES * 2**20),
        )
        if missed
    ]


def _axes(results: dict[str, dict]) -> str:
    row = results.get(DEFAULT) or next(iter(results.values()))
    shown = [
        (name, ", ".join(f"{axis} ({count})" for axis, count in axes.items()) or "none")
        for name, axes in row["axes"].items()
    ]
    return AXES.format(row["tolerance"]) + table(("texture", "parameters"), shown)


def _ways(rows: list[dict]) -> str:
    columns = ("--tolerance", "way", "V: median", "99 %", "mean")
    names = {"blended": "quantiles blended over the nodes", "chosen": "a random node's quantile"}
    shown = [
        (f"{row['tolerance']:g}", names[way], *(f"{v:.4f}" for v in row["ways"][way]))
        for row in rows
        for way in names
    ]
    return WAYS + table(columns, shown)
