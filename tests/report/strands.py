# SPDX-License-Identifier: BSD-3-Clause
"""Renders a lock whose strands all differ, with one model over parameters and beside it other ways to draw
directions; writes pages/strands.md.

PYTHONPATH=tests .venv/bin/python -m report.strands              # fits the model first, 10 minutes
PYTHONPATH=tests .venv/bin/python -m report.strands --model DIR  # with one that is there
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template
from typing import Any

import numpy as np
from scipy.cluster.vq import kmeans2
from scipy.stats import norm

from hairlut import cli, exr
from hairlut.files import write_whole
from hairlut.fixed import fixed
from hairlut.model import BakedModel
from report.engine import lack_of_llvm
from report.hairscene import chiang
from report.hairscene.perception import colour_difference
from report.markdown import table
from report.own_hair import example
from report.places import PAGES, ROOT

SOURCE = ROOT / "precompute" / "examples" / "chiang_parameters.py"
STRANDS, GROUPS = 900, 8
SPREAD = {
    "beta_m": (0.08, 0.5),
    "beta_n": (0.15, 0.5),
    "absorption": (0.1, 4.0),
}  # of the strands, log-uniform
SIZE, BATCHES, SAMPLES = (90, 120), 24, 16
ALPHA = 0.01  # of all comparisons of means together
LIGHTS = ("lamps", "even sky")
SPHERE = "whole sphere"
ONE_MODEL, GROUPED, STANDARD = (
    "one model over parameters",
    f"one model for each of {GROUPS} groups",
    "one model at standard values",
)
REFERENCE = "the authors' sampler"  # exact (tests/report/test_strands.py), and with the least noise


@dataclass(frozen=True)
class Lock:
    """curves: the text of each; values: of each parameter, (strands,)."""

    curves: list[str]
    values: dict[str, np.ndarray]

    def part(self, chosen: np.ndarray) -> Lock:
        return Lock([self.curves[k] for k in chosen], {n: v[chosen] for n, v in self.values.items()})


def lock(folder: Path, strands: int = STRANDS, seed: int = 2) -> Lock:
    """The curl of precompute/examples/own_hair.py, each strand with parameters of its own."""
    example().write_lock(folder / "lock.txt", strands)
    curves = (folder / "lock.txt").read_text().strip().split("\n\n")[:strands]  # without the one out of reach
    random = np.random.default_rng(seed)
    values = {name: np.exp(random.uniform(*np.log(spread), len(curves))) for name, spread in SPREAD.items()}
    return Lock(curves, values)


def groups(strands: Lock, count: int = GROUPS, seed: int = 3) -> list[np.ndarray]:
    """Numbers of the strands of each group: nearest to each other in the logarithms of the parameters."""
    logs = [np.log(each) / np.ptp(np.log(SPREAD[name])) for name, each in strands.values.items()]
    _, label = kmeans2(np.column_stack(logs), count, minit="++", rng=seed)
    return [np.flatnonzero(label == k) for k in range(count)]


def shape(
    strands: Lock, folder: Path, name: str, directions: dict | None, textured: Sequence[str] = ()
) -> dict:
    """Curves with the BSDF "chiang" of their parameters, nested in a BSDF that gives directions (None: its
    own), to which the strands' own values of the parameters named by textured are passed."""
    curves = folder / f"{name}.txt"
    # Mitsuba 3.9 reads beyond its strands where a ray hits the tip of the last one: let that be out of reach
    unreached = "\n".join(f"0 {-40 + 0.001 * k:g} 0 1e-6" for k in range(4))
    curves.write_text("\n\n".join([*strands.curves, unreached]) + "\n")
    textures = {}
    for parameter, values in strands.values.items():
        file = folder / f"{name}_{parameter}.txt"
        file.write_text("".join(f"{value:.8g}\n" for value in [*values, values[0]]))
        textures[parameter] = {"type": "hair_strands", "curves": str(curves), "values": str(file)}
    bsdf = {"type": "chiang", **textures}
    if directions is not None:
        bsdf = {**directions, "nested": bsdf, **{each: textures[each] for each in textured}}
    return {"type": "bsplinecurve", "filename": str(curves), "bsdf": bsdf}


def shapes(strands: Lock, directory: Path, folder: Path, mix: float = 0.0) -> dict[str, list[dict]]:
    """The curves, by where directions come from; directory: of the model over parameters; mix: share of the
    authors' sampler in the draws from textures."""
    model = exr.read_model(directory)
    names = [parameter.name for parameter in model.parameters]
    one = {"type": "hairlut", "model": str(directory), "mix": mix}
    return {
        SPHERE: [shape(strands, folder, "sphere", {"type": "whole_sphere"})],
        ONE_MODEL: [shape(strands, folder, "one", one, names)],
        GROUPED: [
            group(strands.part(chosen), model, folder / f"group{k}", mix)
            for k, chosen in enumerate(groups(strands))
        ],
        STANDARD: [shape(strands, folder, "standard", one)],
        REFERENCE: [shape(strands, folder, "own", None)],
    }


def group(strands: Lock, model: BakedModel, folder: Path, mix: float) -> dict:
    """The curves of a group, with the model at the middle of their parameters."""
    middle = {each.name: float(np.exp(np.log(strands.values[each.name]).mean())) for each in model.parameters}
    exr.write_model(folder / "model", fixed(folder, model, middle))
    return shape(strands, folder, "lock", {"type": "hairlut", "model": str(folder / "model"), "mix": mix})


def scene(curves: Sequence[dict], light: str, size: tuple[int, int] = SIZE) -> Any:
    """The lock in the lamps of the example, or in an even sky, found by the BSDF alone; one scattering."""
    import mitsuba as mi

    sky = example().sky()
    if light == "even sky":
        sky = np.ones_like(sky)
    look = mi.ScalarTransform4f().look_at(origin=[0, 0, 6], target=[0, -0.1, 0], up=[0, 1, 0])
    film = {"type": "hdrfilm", "width": size[0], "height": size[1], "rfilter": {"type": "box"}}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "direct", "emitter_samples": 0, "bsdf_samples": 1, "hide_emitters": True},
            "sensor": {
                "type": "perspective",
                "fov": 9,
                "fov_axis": "larger",
                "to_world": look,
                "film": film,
            },
            "sky": {"type": "envmap", "bitmap": mi.Bitmap(sky)},
            **{f"hair{k}": each for k, each in enumerate(curves)},
        }
    )


def start_engine() -> None:
    example().start_engine(example().VARIANT)
    chiang.register()


def render_all(
    directory: Path,
    strands: int = STRANDS,
    size: tuple[int, int] = SIZE,
    batches: int = BATCHES,
    mix: float = 0.0,
    lights: Sequence[str] = LIGHTS,
) -> dict[str, dict]:
    """own_hair.Rendered by the light and by where directions come from; the reference and the whole
    sphere have four times the batches."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        kinds = shapes(lock(folder, strands), directory, folder, mix)
        return {
            light: {
                kind: example().render(
                    scene(curves, light, size), batches * (4 if kind in (REFERENCE, SPHERE) else 1), SAMPLES
                )
                for kind, curves in kinds.items()
            }
            for light in lights
        }


def deviations(rows: Mapping[str, Any]) -> dict[str, float]:
    """Standard errors by which each picture's mean is off the reference's."""
    truth = rows[REFERENCE]
    return {
        kind: float((one.mean - truth.mean) / np.hypot(one.mean * one.error, truth.mean * truth.error))
        for kind, one in rows.items()
        if kind != REFERENCE
    }


def differences(rows: Mapping[str, Any]) -> dict[str, float]:
    """Mean CIE 2000 difference of each first batch from the reference's mean picture, where there is hair."""
    truth = rows[REFERENCE].image
    hair = truth.max(axis=-1) > 0
    return {
        kind: float(colour_difference(one.first, truth, example().EXPOSURE)[hair].mean())
        for kind, one in rows.items()
    }


def limit(comparisons: int) -> float:
    """Standard errors beyond which one of so many is off, with the probability ALPHA where none is."""
    return float(norm.isf((1 - (1 - ALPHA) ** (1 / comparisons)) / 2))


def table_of(lights: Mapping[str, Mapping[str, Any]]) -> str:
    header = [
        "light",
        "directions from",
        "variance",
        "samples",
        "time",
        "mean luminance",
        "standard errors off",
        "colour difference",
    ]
    lines = []
    for light, rows in lights.items():
        best, off, seen = rows[REFERENCE], deviations(rows), differences(rows)
        for kind, one in rows.items():
            figures = one.variance, one.variance / best.variance, one.seconds / best.seconds
            mean = f"{one.mean:.4g} +- {one.mean * one.error:.2g}"
            beside = f"{off[kind]:+.1f}" if kind in off else ""
            lines.append(
                [light, kind, *(f"{figure:.3g}" for figure in figures), mean, beside, f"{seen[kind]:.1f}"]
            )
    return table(header, lines)


def picture(rows: Mapping[str, Any], out: Path) -> Path:
    """In the lamps: the first batch of each kind, and below it the mean of all."""
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, len(rows), figsize=(1.8 * len(rows), 5), layout="constrained")
    for column, (kind, one) in zip(axes.T, rows.items(), strict=True):
        for axis, image in zip(column, (one.first, one.image), strict=True):
            axis.imshow(np.clip(example().EXPOSURE * image, 0, 1) ** (1 / 2.2))
            axis.set_axis_off()
        column[0].set_title(
            kind.replace(" for each", "\nfor each").replace(" over", "\nover").replace(" at", "\nat"),
            fontsize=9,
        )
    figure.savefig(out, dpi=100)
    plt.close(figure)
    return out


def main() -> int:
    parser = argparse.ArgumentParser(prog="report.strands", description=__doc__.splitlines()[0])
    parser.add_argument("--model", type=Path, metavar="DIR", help=f"default: fit {SOURCE.name} first")
    parser.add_argument("--out", type=Path, default=PAGES, metavar="DIR", help="default: %(default)s")
    arguments = parser.parse_args()
    if lack := lack_of_llvm():
        print(f"SKIPPED: no lock is rendered: {lack}", file=sys.stderr)
        return 0
    with tempfile.TemporaryDirectory() as name:
        directory = arguments.model or Path(name, SOURCE.stem)
        if not arguments.model and cli.main(["fit", str(SOURCE), "--out", name]) != cli.OK:
            return 1
        start_engine()
        lights = render_all(directory)
        model = exr.read_model(directory)
        size = sum(file.stat().st_size for file in directory.glob("*.exr")) / 1024
    text = Template(Path(__file__).with_suffix(".md").read_text(encoding="utf-8")).substitute(
        table=table_of(lights),
        spread="; ".join(f"`{n}` from {low:g} to {high:g}" for n, (low, high) in SPREAD.items()),
        limit=f"{limit(sum(len(deviations(rows)) for rows in lights.values())):.2f}",
        size=f"{size:.0f}",
        lobes=len(model.lobes),
        strands=STRANDS,
        groups=GROUPS,
        samples=BATCHES * SAMPLES,
        reference=4 * BATCHES * SAMPLES,
        first=SAMPLES,
    )
    made = picture(lights[LIGHTS[0]], arguments.out / "strands.png")
    print(write_whole(arguments.out / "strands.md", text.encode()), made, sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
