"""Writes pages/shaders.md from shaders.md: how closely each shader follows C on this machine."""

from pathlib import Path

import numpy as np
import pytest
from shaders.agreement import (
    ANGLE_TOLERANCE,
    DENSITY_TOLERANCE,
    MODELS,
    NUMBER_TOLERANCE,
    agreement,
    hard_records,
    model_tables,
    random_records,
    reference,
    scene,
)
from shaders.backends import BACKENDS, Scene

from hairlut.files import write_whole
from report.places import PAGES

RANDOM = 100_000


def row(backend: str, model: str, tables: Scene, records: np.ndarray) -> str:
    """One line of the table; says so where this machine lacks the back end."""
    try:
        got = BACKENDS[backend](tables, records)
    except pytest.skip.Exception as reason:
        return f"| {backend} | {model} | not run: {reason} | | | | |"
    r = agreement(reference(model), records, got)
    figures = f"{r.angle:.1e} | {r.density:.1e} | {r.number:.1e} | {r.bordering}"
    return f"| {backend} | {model} | {r.records:,} | {figures} |"


def main() -> None:
    rows = []
    for model in MODELS:
        tables = scene(model_tables(model))
        records = np.concatenate([hard_records(tables), random_records(RANDOM)])
        rows += [row(backend, model, tables, records) for backend in BACKENDS]
    limits = {"angle": ANGLE_TOLERANCE, "density": DENSITY_TOLERANCE, "number": NUMBER_TOLERANCE}
    page = Path(__file__).with_suffix(".md").read_text().format(rows="\n".join(rows), random=RANDOM, **limits)
    out = PAGES / "shaders.md"
    write_whole(out, page.encode())
    print(out)


if __name__ == "__main__":
    main()
