# SPDX-License-Identifier: BSD-3-Clause
"""What parameters cost a vertex: Chiang's hair over three parameters, beside the same model at fixed ones.
Writes pages/strand_cost.md.

PYTHONPATH=tests .venv/bin/python -m report.strand_cost [--model DIR]
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

from bench import run, timing

from hairlut import exr
from report.markdown import table
from report.places import PAGES, ROOT

EXAMPLE = ROOT / "precompute" / "examples" / "chiang_parameters.py"
TARGET = 1.5
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

Target: a vertex with parameters costs at most {target} times one without, one call at a time. With other
parameters for each sample it is **{verdict}**.

"""

VIEWER_TEXT = """
## Several calls at one hit

`hairlut_viewer` computes once what the calls at a hit have in common: the place of the parameters, the
mixture. A vertex is as above; a hit is one sample and the densities of four directions, as where four lights
are sampled. `strands` is the model with parameters, others for each sample, `fixed` the same model at its
standard ones, `brown` is compiled in. Chiang's own sampler and density (`bench/rivals/chiang.c`) compute the
viewer's side once a call for a vertex, and once in all for a hit; bold where they are faster.

"""


def measured(model: Path | None) -> timing.Times:
    """Both models timed in one run. model: the directory of a fitted one, else it is fitted here."""
    with tempfile.TemporaryDirectory() as folder:
        luts, work = Path(folder) / "luts", Path(folder) / "work"
        if not model:
            run.run(run.tool("hairlut"), "fit", EXAMPLE, "--out", work)
            model = work / EXAMPLE.stem
        shutil.copytree(model, luts / "strands")
        at = [f"--at={p.name}={p.standard!r}" for p in exr.read_model(model).parameters]
        run.run(run.tool("hairlut"), "export", luts / "strands", *at, "--to", "exr", "--out", work / "at")
        shutil.move(next((work / "at").iterdir()), luts / "fixed")
        return timing.measure(run.build(), luts, NAMES, Path(folder) / "results.json", REPETITIONS)


def page(times: timing.Times) -> str:
    """What was measured, in Markdown."""
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
    text = TEXT.format(
        repetitions=times.repetitions(),
        place=times.place,
        interference=times.interference(),
        target=TARGET,
        verdict=f"{'met' if ratio <= TARGET else 'missed'}: {ratio:.2f} times",
    )
    columns = ("call", "without", "other parameters each sample (times)", "the same for 64 samples (times)")
    return text + table(columns, rows) + by_viewers(times)


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
        "--model", type=Path, metavar="DIR", help="a model over parameters; default: fits one"
    )
    args = parser.parse_args()
    (PAGES / "strand_cost.md").write_text(page(measured(args.model)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
