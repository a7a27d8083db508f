# SPDX-License-Identifier: BSD-3-Clause
"""Runs precompute/examples/own_hair.py and writes the page with its pictures, pages/own_hair.md.

PYTHONPATH=tests .venv/bin/python -m report.own_hair
"""

from __future__ import annotations

import argparse
import io
import sys
import tempfile
from contextlib import redirect_stdout
from pathlib import Path
from string import Template
from time import perf_counter
from types import ModuleType

from hairlut.files import write_whole
from report.engine import lack_of_llvm
from report.markdown import table
from report.places import PAGES, ROOT


def example() -> ModuleType:
    """The example as a module."""
    sys.path.insert(0, str(ROOT / "precompute" / "examples"))
    import own_hair

    return own_hair


def table_of(rows: dict) -> str:
    best = rows["authors' sampler"]
    header = ["directions from", "variance", "samples", "time", "mean luminance"]
    return table(
        header,
        [
            [
                name,
                f"{one.variance:.3g}",
                f"{one.variance / best.variance:.2f}",
                f"{one.seconds / best.seconds:.2f}",
                f"{one.mean:.5f} +- {one.mean * one.error:.5f}",
            ]
            for name, one in rows.items()
        ],
    )


def main() -> int:
    parser = argparse.ArgumentParser(prog="report.own_hair", description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=PAGES, metavar="DIR", help="default: %(default)s")
    out = parser.parse_args().out
    if lack := lack_of_llvm():
        print(f"SKIPPED: no lock is rendered: {lack}", file=sys.stderr)
        return 0
    own_hair, start, said = example(), perf_counter(), io.StringIO()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with redirect_stdout(said):
            textures = own_hair.fit(folder)
        rows = own_hair.render_all(textures, folder, own_hair.VARIANT)
    picture = own_hair.picture(rows, out / "own_hair.png")
    text = Template(Path(__file__).with_suffix(".md").read_text(encoding="utf-8")).substitute(
        variant=own_hair.VARIANT,
        seconds=f"{perf_counter() - start:.0f}",
        fit=said.getvalue().strip().replace(f"{folder}", "own_hair").replace(f"{ROOT}/", ""),
        table=table_of(rows),
    )
    print(write_whole(out / "own_hair.md", text.encode()), picture, sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
