# SPDX-License-Identifier: BSD-3-Clause
"""Writes pages/shaders.md from shaders.md: how closely each shader follows C on this machine."""

import argparse
from pathlib import Path

import numpy as np
import pytest
from shaders.agreement import (
    ANGLE_TOLERANCE,
    DENSITY_TOLERANCE,
    NUMBER_TOLERANCE,
    ROOT,
    Reference,
    agreement,
    hard_records,
    random_records,
    scene,
)
from shaders.backends import BACKENDS, Scene
from shaders.models import MODELS

from hairlut import exr
from hairlut.files import write_whole
from report.markdown import table
from report.places import PAGES

RANDOM = 100_000
SHIPPED = ("printed", "fitted", "brown")
COLUMNS = ("back end", "model", "inputs", "angle [rad]", "density, relative", "inverted u", "beside a border")


def row(backend: str, name: str, reference: Reference, where: Scene, records: np.ndarray) -> list[object]:
    """One line of the table; says so where this machine lacks the back end."""
    try:
        got = BACKENDS[backend](where, records)
    except pytest.skip.Exception as reason:
        return [backend, name, f"not run: {reason}", "", "", "", ""]
    r = agreement(reference, records, got)
    figures = f"{r.angle:.1e}", f"{r.density:.1e}", f"{r.number:.1e}", r.bordering
    return [backend, name, f"{r.records:,}", *figures]


def main() -> None:
    parser = argparse.ArgumentParser(prog="report.shaders", description=__doc__)
    parser.add_argument("--out", type=Path, default=PAGES / "shaders.md", metavar="FILE", help="%(default)s")
    out = parser.parse_args().out
    models = {name: exr.read_model(ROOT / "luts" / name) for name in SHIPPED}
    models |= {name: make() for name, make in MODELS.items()}
    rows = []
    for name, model in models.items():
        records = np.concatenate([hard_records(model), random_records(RANDOM, model)])
        rows += [row(backend, name, Reference(model), scene(model), records) for backend in BACKENDS]
    limits = (f"{limit:.0e}" for limit in (ANGLE_TOLERANCE, DENSITY_TOLERANCE, NUMBER_TOLERANCE))
    rows.append(["tolerance", "", "", *limits, "0.1 %"])
    template = Path(__file__).with_suffix(".md").read_text()
    page = template.format(table=table(COLUMNS, rows), random=RANDOM)
    print(write_whole(out, page.encode()))


if __name__ == "__main__":
    main()
