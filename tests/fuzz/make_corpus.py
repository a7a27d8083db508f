# SPDX-License-Identifier: BSD-3-Clause
"""Writes the seeds of tests/fuzz/corpus: PYTHONPATH=tests python tests/fuzz/make_corpus.py. What fuzzing
found later is kept beside them."""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from conformance import cases, files

from hairlut import exr
from hairlut.slopes import derived

ROOT = Path(__file__).resolve().parents[2]
CORPUS = Path(__file__).resolve().parent / "corpus"
SMALL = 6, 3  # columns, rows


def small_table(table):
    """A table of the same kind in a few columns and rows."""
    width, height = SMALL
    row = np.linspace(*table.domain, width, dtype=np.float32)
    row[[0, -1]] = table.domain
    texels = np.tile(row, (height, 1))
    slopes = derived(texels, table.warp.widths(width)).astype(np.float32)
    return replace(table, texels=texels, slopes=slopes, log_mass=np.zeros(height))


def write_loader() -> None:
    """Tables of both formats and a mixture, in every compression that OpenEXR has."""
    folder = CORPUS / "loader"
    folder.mkdir(parents=True, exist_ok=True)
    given = files.model(ROOT / "luts" / "fitted")
    lobes = [
        replace(lobe, theta=small_table(lobe.theta), phi=lobe.phi and small_table(lobe.phi))
        for lobe in given.lobes
    ]
    with tempfile.TemporaryDirectory() as temporary:
        directory = Path(temporary) / "2"
        exr.write_model(directory, replace(given, lobes=tuple(lobes)))
        for name in (*cases.KEPT, "PIZ", "B44", "ZSTD"):
            for file in (cases.THETA, cases.PHI, cases.MIXTURE):
                copy = folder / f"{Path(file).stem}_{name.lower()}.exr"
                copy.write_bytes((directory / file).read_bytes())
                cases.compression(name).apply(copy)
        for file in (cases.THETA, cases.PHI):
            copy = folder / f"{Path(file).stem}_format_1.exr"
            copy.write_bytes((directory / file).read_bytes())
            files.to_format_1(copy)


def write_random(name: str, first: tuple[int, ...]) -> None:
    """Descriptors (describe.h) of every number of lobes and nodes, from any bytes behind them."""
    folder = CORPUS / name
    folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(1)
    for flags in first:
        for lobes, rows, columns in ((1, 1, 1), (2, 3, 2), (4, 4, 4)):
            counts = [lobes - 1, rows - 1, columns - 1]
            data = bytes([flags, *counts]) + random.bytes(1500)
            (folder / f"{flags}_{lobes}x{rows}x{columns}").write_bytes(data)


if __name__ == "__main__":
    write_loader()
    write_random("memory", (0, 1, 2, 4, 8, 16, 32, 64, 63))
    write_random("round_trip", (0, 32))
