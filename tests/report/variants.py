# SPDX-License-Identifier: BSD-3-Clause
"""Times a picture with the C++ plugin and with the Dr.Jit BSDF; writes pages/variants.md.

PYTHONPATH=tests .venv/bin/python -m report.variants
"""

from __future__ import annotations

import argparse
import platform
import sys
import tempfile
from pathlib import Path
from string import Template
from time import process_time
from typing import Any

import numpy as np

from hairlut.files import write_whole
from report.engine import PluginBroken, PluginUnavailable, lack_of_llvm, load_engine
from report.hairscene.scene import Hair, brown_hair, scene_dict, strand_points, write_strands
from report.markdown import table
from report.places import PAGES

STRANDS = 4000
BATCHES = 9
INTEGRATOR = {"type": "direct", "emitter_samples": 0, "bsdf_samples": 1}
# variant: image size, samples per pixel. Python's own numbers are slow.
SIZES = {"scalar_rgb": ((32, 24), 4), "llvm_ad_rgb": ((160, 120), 16)}
OWN = "the nested BSDF's own"


def samplers(variant: str) -> dict[str, dict[str, object]]:
    """BSDF dictionaries by their name on the page."""
    nested = brown_hair()
    models = ("fitted", "brown")
    drjit = "hairlut_drjit" if variant == "scalar_rgb" else "hairlut"
    kinds = {f"Dr.Jit, {model}": {"type": drjit, "model": model, "nested": nested} for model in models}
    if variant == "scalar_rgb":
        cpp = {f"C++, {model}": {"type": "hairlut", "model": model, "nested": nested} for model in models}
        kinds = cpp | kinds
    return {OWN: nested, **kinds}


def seconds(mi: Any, variant: str, strands: Path) -> dict[str, float]:
    """Processor seconds of a sample and pixel."""
    mi.set_variant(variant)
    import hairlut.mitsuba

    if variant == "scalar_rgb":
        hairlut.mitsuba.register("hairlut_drjit")
    size, spp = SIZES[variant]
    scenes = {
        name: mi.load_dict({**scene_dict(mi, strands, bsdf, size), "integrator": INTEGRATOR})
        for name, bsdf in samplers(variant).items()
    }
    times: dict[str, list[float]] = {name: [] for name in scenes}
    for batch in range(BATCHES + 1):
        for name, scene in scenes.items():
            start = process_time()
            np.array(mi.render(scene, spp=spp, seed=batch))
            times[name].append(process_time() - start)
    samples = size[0] * size[1] * spp
    return {name: float(np.median(each[1:])) / samples for name, each in times.items()}  # the first compiles


def main() -> int:
    parser = argparse.ArgumentParser(prog="report.variants", description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=PAGES / "variants.md", metavar="FILE", help="%(default)s")
    out = parser.parse_args().out
    try:
        mi = load_engine()
    except PluginUnavailable as error:
        print(f"SKIPPED: nothing is timed. {error}", file=sys.stderr)
        return 0
    except PluginBroken as error:
        print(error, file=sys.stderr)
        return 1
    if lack := lack_of_llvm():
        print(f"SKIPPED: nothing is timed: {lack}", file=sys.stderr)
        return 0
    with tempfile.TemporaryDirectory() as folder:
        strands = Path(folder) / "strands.txt"
        write_strands(strand_points(Hair(strands=STRANDS)), strands)
        found = {variant: seconds(mi, variant, strands) for variant in SIZES}
    rows = [
        [variant, name, f"{1e6 * time:.2f}", f"{time / times[OWN]:.2f}"]
        for variant, times in found.items()
        for name, time in times.items()
    ]
    scalar = found["scalar_rgb"]
    text = Template(Path(__file__).with_suffix(".md").read_text(encoding="utf-8")).substitute(
        machine=f"{platform.system()} {platform.machine()}",
        strands=STRANDS,
        batches=BATCHES,
        table=table(["variant", "directions from", "microseconds", "over its own"], rows),
        faster=f"{scalar['Dr.Jit, brown'] / scalar['C++, brown']:.0f}",
    )
    print(write_whole(out, text.encode()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
