# SPDX-License-Identifier: BSD-3-Clause
"""Writes the seeds of tests/fuzz/corpus: PYTHONPATH=tests python tests/fuzz/make_corpus.py. What fuzzing
found later is kept beside them."""

import tempfile
from pathlib import Path

import numpy as np
from conformance import cases, files

ROOT = Path(__file__).resolve().parents[2]
CORPUS = Path(__file__).resolve().parent / "corpus"


def write_loader() -> None:
    """Tables of both formats and a mixture, in every compression that OpenEXR has; and those of a model over
    parameters."""
    folder = CORPUS / "loader"
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        directory = files.write_small(Path(temporary) / "2", ROOT / "luts" / "fitted")
        for name in (*cases.KEPT, "PIZ", "B44", "ZSTD"):
            for file in (cases.THETA, cases.PHI, cases.MIXTURE):
                copy = folder / f"{Path(file).stem}_{name.lower()}.exr"
                copy.write_bytes((directory / file).read_bytes())
                cases.compression(name).apply(copy)
        for file in (cases.THETA, cases.PHI):
            copy = folder / f"{Path(file).stem}_format_1.exr"
            copy.write_bytes((directory / file).read_bytes())
            files.to_format_1(copy)
        over = files.write_over_parameters(Path(temporary) / "parametric")
        for file in (cases.THETA, cases.PHI, cases.MIXTURE):
            copy = folder / f"{Path(file).stem}_parameters.exr"
            copy.write_bytes((over / file).read_bytes())
            cases.compression("NO").apply(copy)


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
    write_random("memory", (0, 1, 2, 4, 8, 16, 32, 64, 63, 128, 144, 160, 192))
    write_random("round_trip", (0, 32, 128, 160))
