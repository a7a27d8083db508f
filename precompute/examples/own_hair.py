# SPDX-License-Identifier: BSD-3-Clause
"""From a BSDF that is only a formula to textures, and to a rendered lock of hair, beside the alternatives.

    pip install 'hairlut[engine,report]'                             # Mitsuba 3, and plots
    python precompute/examples/own_hair.py --out own_hair            # a minute or two on two cores

1. `hairlut fit` turns the function bsdf of chiang2016.py into textures.
2. Mitsuba renders a lock of that hair, in an array variant. The engine's own BSDF of the same paper gives the
   values to every picture. What differs is where the directions come from: the whole sphere, as for a BSDF
   without a sampler; the shipped textures of other hair; the textures of this hair; and the sampler that the
   paper's authors derived by hand.
3. Every picture is rendered in batches. Their spread is the variance, which is printed, beside the time.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from hairlut import cli

HERE = Path(__file__).resolve().parent
VARIANT = "llvm_ad_rgb"
SIZE = (120, 160)
STRANDS, BATCHES, SAMPLES = 900, 16, 8
EXPOSURE = 6.0
TINT = (1.0, 0.72, 0.45)  # of the light: the formula is for one wavelength
LUMINANCE = np.array([0.212671, 0.715160, 0.072169])

# chiang2016.py's hair as the engine's BSDF, which gives the values
VALUES = {
    "type": "hair",
    "longitudinal_roughness": 0.3,
    "azimuthal_roughness": 0.3,
    "sigma_a": {"type": "rgb", "value": 0.6},
    "scale_tilt": 2.0,
}


def fit(out: Path) -> Path:
    """Step 1, as on the command line; the directory of the textures."""
    source = HERE / "chiang2016.py"
    if cli.main(["fit", str(source), "--out", str(out)]) != cli.OK:
        raise SystemExit(1)
    return out / source.stem


def samplers(textures: Path) -> dict[str, dict[str, object]]:
    """Step 2: BSDF dictionaries with the same values, by where directions come from."""
    return {
        "whole sphere": {"type": "whole_sphere", "nested": VALUES},
        "other hair's textures": {"type": "hairlut", "model": "fitted", "nested": VALUES},
        "own textures": {"type": "hairlut", "model": str(textures), "nested": VALUES},
        "authors' sampler": VALUES,
    }


def start_engine(variant: str) -> None:
    """Sets the variant, and registers the BSDFs "hairlut" and "whole_sphere" in it."""
    mi.set_variant(variant)
    import hairlut.mitsuba  # noqa: F401

    class WholeSphere(mi.BSDF):
        """What is left to a BSDF that can be evaluated but not sampled."""

        def __init__(self, props: mi.Properties) -> None:
            super().__init__(props)
            self.nested = props["nested"]
            self.m_components, self.m_flags = [self.nested.flags()], self.nested.flags()

        def sample(self, ctx, si, sample1, sample2, active=True):
            bs = dr.zeros(mi.BSDFSample3f)
            bs.wo = mi.warp.square_to_uniform_sphere(sample2)
            bs.pdf, bs.eta = mi.warp.square_to_uniform_sphere_pdf(bs.wo), 1.0
            bs.sampled_type = mi.UInt32(+mi.BSDFFlags.Glossy)
            return bs, self.nested.eval(ctx, si, bs.wo, active) / bs.pdf

        def eval(self, ctx, si, wo, active=True):
            return self.nested.eval(ctx, si, wo, active)

        def pdf(self, ctx, si, wo, active=True):
            return mi.warp.square_to_uniform_sphere_pdf(wo)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def to_string(self) -> str:
            return "WholeSphere"

    mi.register_bsdf("whole_sphere", WholeSphere)


def write_lock(path: Path, strands: int = STRANDS) -> None:
    """A curl of B-spline strands: a line `x y z radius` a control point, an empty line between strands."""
    random = np.random.default_rng(1)
    s = np.linspace(0, 1, 12)
    radius, angle = 0.34 * np.sqrt(random.random((strands, 1))), random.uniform(0, 2 * np.pi, (strands, 1))
    gathered = 1 - 0.75 * s**0.7  # towards the tip
    turn = angle + 2.5 * s + random.normal(0, 0.25, (strands, 1)) * s
    x = 0.35 * s * np.sin(5.5 * s) + radius * gathered * np.cos(turn)
    z = 0.35 * s * np.cos(5.5 * s) + radius * gathered * np.sin(turn)
    y = 1.1 - 2.2 * s + random.normal(0, 0.06, (strands, 1)) * s
    thick = 0.008 * (1 - 0.6 * s**3) + 0 * x
    points = np.stack([x, y, z, thick], axis=2)
    lines = [["{:.6g} {:.6g} {:.6g} {:.4g}".format(*point) for point in strand] for strand in points]
    # Mitsuba 3.9 reads beyond its strands where a ray hits the tip of the last one: let that be out of reach
    lines.append([f"0 {-40 + 0.001 * k:g} 0 1e-6" for k in range(4)])
    path.write_text("\n\n".join("\n".join(strand) for strand in lines) + "\n")


def scene(strands: Path, bsdf: Mapping[str, object], size: tuple[int, int] = SIZE) -> Any:
    """The lock before a sky with two lamps; up to four scatterings, with the engine's light sampling."""
    look = mi.ScalarTransform4f().look_at(origin=[0, 0, 6], target=[0, -0.1, 0], up=[0, 1, 0])
    film = {"type": "hdrfilm", "width": size[0], "height": size[1], "rfilter": {"type": "box"}}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 5, "rr_depth": 100, "hide_emitters": True},
            "sensor": {
                "type": "perspective",
                "fov": 24,
                "fov_axis": "larger",
                "to_world": look,
                "film": film,
            },
            "sky": {"type": "envmap", "bitmap": mi.Bitmap(sky())},
            "hair": {"type": "bsplinecurve", "filename": str(strands), "bsdf": dict(bsdf)},
        }
    )


def sky(width: int = 64) -> np.ndarray:
    """Radiance (width/2, width, 3) with soft lamps behind the hair and beside the camera."""
    phi = (np.arange(width) + 0.5) / width * 2 * np.pi
    theta = phi[: width // 2, None]
    x, y, z = np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)
    behind = 4 * np.exp(8 * (0.5 * x + 0.5 * y - 0.71 * z - 1))
    beside = 8 * np.exp(12 * (-0.6 * x + 0.4 * y + 0.69 * z - 1))
    return ((0.1 + behind + beside)[..., None] * np.array(TINT)).astype(np.float32)


@dataclass(frozen=True)
class Rendered:
    """first      (height, width, 3), linear, one batch
    image      the mean of all batches
    variance   of the luminance of one sample, mean over the pixels, relative to the squared mean
    mean       luminance of the image; error: its standard error, relative
    seconds    processor time of a batch
    """

    first: np.ndarray
    image: np.ndarray
    variance: float
    mean: float
    error: float
    seconds: float


def render(loaded: Any, batches: int = BATCHES, samples: int = SAMPLES) -> Rendered:
    """Step 3: the mean of batches, after one that compiles."""
    mi.render(loaded, spp=samples, seed=999)
    start = process_time()
    images = np.array([np.array(mi.render(loaded, spp=samples, seed=k))[..., :3] for k in range(batches)])
    seconds = (process_time() - start) / batches
    grey = images @ LUMINANCE
    means = grey.mean(axis=(1, 2))
    variance = float(grey.var(axis=0, ddof=1).mean()) * samples / means.mean() ** 2
    error = float(means.std(ddof=1) / np.sqrt(batches) / means.mean())
    return Rendered(images[0], images.mean(axis=0), variance, float(means.mean()), error, seconds)


def render_all(textures: Path, folder: Path, variant: str) -> dict[str, Rendered]:
    """Every picture, by where directions come from; the lock's strands are written to folder."""
    start_engine(variant)
    strands = folder / "strands.txt"
    write_lock(strands)
    return {name: render(scene(strands, bsdf)) for name, bsdf in samplers(textures).items()}


def text(rows: Mapping[str, Rendered]) -> str:
    """A table: how much the samples vary, how many times the authors' sampler's, and the time."""
    best = rows["authors' sampler"]
    lines = [f"{'directions from':24}{'variance':>10}{'samples':>10}{'time':>8}{'mean':>9}"]
    for name, one in rows.items():
        needed, time = one.variance / best.variance, one.seconds / best.seconds
        mean = f"{one.mean:9.4f} +- {one.mean * one.error:.4f}"
        lines.append(f"{name:24}{one.variance:10.3f}{needed:10.2f}{time:8.2f}{mean}")
    return "\n".join(
        [*lines, "samples: how many the same noise takes; time of a sample: both over the authors' sampler"]
    )


def picture(rows: Mapping[str, Rendered], path: Path) -> Path:
    """A column for each: one batch above, all below."""
    from hairlut import figures

    figure, axes = figures.new(2, len(rows), size=(2.2 * len(rows), 6.4))
    for column, (name, one) in zip(axes.T, rows.items(), strict=True):
        counts = SAMPLES, BATCHES * SAMPLES
        for axis, image, count in zip(column, (one.first, one.image), counts, strict=True):
            axis.imshow(np.clip(EXPOSURE * image, 0, 1) ** (1 / 2.2), interpolation="nearest")
            axis.set_title(f"{name}, {count} spp", fontsize=8)
            axis.set_axis_off()
    return figures.save(figure, path, 110)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out", type=Path, default=Path("own_hair"), metavar="DIR", help="default: %(default)s"
    )
    parser.add_argument("--variant", default=VARIANT, help="of Mitsuba (default: %(default)s)")
    args = parser.parse_args()
    start = perf_counter()
    rows = render_all(fit(args.out), args.out, args.variant)
    print(f"\n{text(rows)}\n\n{picture(rows, args.out / 'own_hair.png')}")
    print(f"{perf_counter() - start:.0f} s in all")
    return 0


if __name__ == "__main__":
    sys.exit(main())
