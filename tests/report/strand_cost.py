# SPDX-License-Identifier: BSD-3-Clause
"""What parameters cost a vertex: Chiang's hair over three parameters, beside the same model at fixed ones.
Writes pages/strand_cost.md.

PYTHONPATH=tests .venv/bin/python -m report.strand_cost [--model DIR]...
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from bench import run, timing

from hairlut import exr
from hairlut.files import write_whole
from report.markdown import table
from report.places import PAGES, ROOT

EXAMPLE = ROOT / "precompute" / "examples" / "chiang_parameters.py"
TARGET = 1.5
TOLERANCES = "0.01", "0.03"  # the usual one, and the coarsest that meets the targets of parameters.md
REPETITIONS = 20
NAMES = (
    "^((strands/(sample|pdf|vertex)_strand(_64)?|fixed/(sample_hair|pdf_hair|vertex))/hairlut/(one|arrays)|"
    "(strands/(vertex_strand|hit_strand)|(fixed|brown)/(vertex|hit))(_viewer)?/(hairlut|Chiang)/(one|native))$"
)
CALLS = {
    "vertex": ("vertex", "vertex_strand"),
    "sample": ("sample_hair", "sample_strand"),
    "density": ("pdf_hair", "pdf_strand"),
}
VIEWERS = {"strands": "_strand", "fixed": "", "brown": ""}
HOW = {"one": "one at a time", "arrays": "over arrays"}

TEXT = """# What parameters cost

A call of a model of `hairlut fit precompute/examples/chiang_parameters.py`, with parameters, beside one of
the same model at its standard parameters (`hairlut export --at`), which has none left. Parameters
are random in their ranges: other ones for each sample, or the same for 64 samples in succession, as where a
strand is hit several times. A vertex is one sample, with its densities, and the density of another direction.
The least of {repetitions} repeats in one run and in random order, in ns a sample, on one thread of
{place};
in the median a repeat took {interference:.0%} longer. Inputs are those of the speed page.

    PYTHONPATH=tests .venv/bin/python -m report.strand_cost

Target: a vertex with parameters costs at most {target} times one without, one call at a time, with other
parameters for each sample. What it costs grows with the textures: a model over parameters takes more memory
than the second-level cache has, one without fits into it. The models are those of --tolerance 0.01, the usual
one, and 0.03, the coarsest that meets the targets of [parameters.md](parameters.md).
"""

MODEL_TEXT = """
## Textures of {kilobytes:.0f} KB

A vertex: **{verdict}**.

"""

VIEWER_TEXT = """
## Several calls at one hit

`hairlut_viewer` computes once what the calls at a hit have in common: the place of the parameters, the
mixture. A vertex is as above; a hit is one sample and the densities of four directions, as where four lights
are sampled. `strands` is the model with parameters, others for each sample, `fixed` the same model at its
standard ones, `brown` is compiled in. Chiang's own sampler and density (`bench/rivals/chiang.c`) compute the
viewer's side once a call for a vertex, and once in all for a hit; bold where they are faster. The
textures are those of the first table.

"""


def fitted(folder: Path, tolerance: str) -> Path:
    """The directory of the example's model."""
    run.run(run.tool("hairlut"), "fit", EXAMPLE, "--out", folder, "--tolerance", tolerance)
    return folder / EXAMPLE.stem


def measured(model: Path) -> tuple[float, timing.Times]:
    """KB of the textures in a directory, and the times of it and of it at fixed parameters in one run."""
    with tempfile.TemporaryDirectory() as folder:
        luts, work = Path(folder) / "luts", Path(folder) / "work"
        size = sum(file.stat().st_size for file in model.glob("*.exr")) / 1024
        shutil.copytree(model, luts / "strands")
        at = [f"--at={p.name}={p.standard!r}" for p in exr.read_model(model).parameters]
        run.run(run.tool("hairlut"), "export", luts / "strands", *at, "--to", "exr", "--out", work / "at")
        shutil.move(next((work / "at").iterdir()), luts / "fixed")
        times = timing.measure(run.build(), luts, NAMES, Path(folder) / "results.json", REPETITIONS)
        return size, times


def page(models: Sequence[tuple[float, timing.Times]]) -> str:
    """What was measured, in Markdown."""
    _, usual = models[0]
    text = TEXT.format(
        repetitions=usual.repetitions(), place=usual.place, interference=usual.interference(), target=TARGET
    )
    return text + "".join(of_model(*model) for model in models) + by_viewers(usual)


def of_model(kilobytes: float, times: timing.Times) -> str:
    """One model with parameters and without."""
    rows, ratios = [], {}
    for how, label in HOW.items():
        for call, (without, with_parameters) in CALLS.items():
            fixed = times.least("fixed", without, "hairlut", how)
            each, same = (
                times.least("strands", with_parameters + form, "hairlut", how) for form in ("", "_64")
            )
            ratios[how, call] = each / fixed
            cells = (f"{ns:.1f} ({ns / fixed:.2f})" for ns in (each, same))
            rows.append((f"{call}, {label}", f"{fixed:.1f}", *cells))
    ratio = ratios["one", "vertex"]
    verdict = f"{ratio:.2f} times, target {'met' if ratio <= TARGET else 'missed'}"
    columns = ("call", "without", "other parameters each sample (times)", "the same for 64 samples (times)")
    return MODEL_TEXT.format(kilobytes=kilobytes, verdict=verdict) + table(columns, rows)


def by_viewers(times: timing.Times) -> str:
    """What hairlut_viewer gains where a hit makes several calls."""
    rows = []
    for model, form in VIEWERS.items():
        for call in ("vertex", "hit"):
            each, viewer = (
                times.least(model, call + form + how, "hairlut", "one") for how in ("", "_viewer")
            )
            theirs = times.fastest(model, call, "Chiang", "one")
            rival = f"{theirs:.1f} ({viewer / theirs:.2f})" if theirs else ""
            rival = f"**{rival}**" if theirs and theirs < viewer else rival
            rows.append((f"{call}, `{model}`", f"{each:.1f}", f"{viewer:.1f} ({each / viewer:.2f})", rival))
    theirs = "Chiang's own (times as fast as the viewer)"
    return VIEWER_TEXT + table(("call", "each call by itself", "by a viewer (times as fast)", theirs), rows)


def main() -> int:
    parser = argparse.ArgumentParser(prog="report.strand_cost", description=__doc__.splitlines()[0])
    parser.add_argument(
        "--model",
        type=Path,
        action="append",
        metavar="DIR",
        help="a model over parameters; may be repeated; default: fits two",
    )
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        models = args.model or [fitted(Path(folder) / each, each) for each in TOLERANCES]
        text = page([measured(model) for model in models])
    print(write_whole(PAGES / "strand_cost.md", text.encode()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
