# SPDX-License-Identifier: BSD-3-Clause
"""Tables fitted to the engine's own hair BSDF, against the sampler that its authors derived for it by hand.

    PYTHONPATH=tests .venv/bin/python -m report.fitted_hair [--draws N] --out tests/report/pages/fit.json

For each hair: evaluate the BSDF on a grid (theta_r, theta_i, phi, and the offset at which the fibre is hit).
Fit and bake one model to its mean over the offset, and a family over the offset. Draw from the
tables through the plugin: hairlut's C library proposes, the BSDF gives the value. The estimates are of the
light that the fibre scatters towards a viewer, at a random offset, from an environment of constant and of
contrasted radiance; a quadrature of the BSDF says what they should be.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

from hairlut import cli
from hairlut.files import write_whole
from hairlut.fit.distribution import of_grid
from hairlut.fit.family import fit_family
from hairlut.fit.familyfiles import write_family
from hairlut.fit.files import write_all
from hairlut.fit.model import Fit, fit
from hairlut.fit.offsets import OffsetData, of_grids
from hairlut.fit.plot import plot
from report.hairscene import owndensity
from report.hairscene.draws import corrected, draw
from report.hairscene.nearfield import evaluate, largest_weight, light, midpoints
from report.hairscene.offsets import left
from report.hairscene.scene import Hair, scene_dict, strand_points, write_strands

HAIRS = {
    "brown": {},
    "blond": {
        "eumelanin": 0.2,
        "pheomelanin": 0.4,
        "longitudinal_roughness": 0.2,
        "azimuthal_roughness": 0.5,
    },
    "black": {
        "eumelanin": 8.0,
        "pheomelanin": 0.0,
        "longitudinal_roughness": 0.4,
        "azimuthal_roughness": 0.6,
    },
    "rough": {
        "eumelanin": 0.3,
        "pheomelanin": 0.1,
        "longitudinal_roughness": 0.5,
        "azimuthal_roughness": 0.8,
    },
}
IMAGE, STRANDS, SPP, BATCHES = (64, 48), 4000, 16, 48
VIEWERS = (2.5, 32.5, -57.5)  # between the rows of the grid
SIZE = "96x37"  # rows every 5 degrees: the grid's are among them
THETA_R = np.radians(np.arange(-85.0, 86.0, 5.0))
THETA_I, PHI = midpoints(-math.pi / 2, math.pi / 2, 64), midpoints(0, 2 * math.pi, 72)
# The offset sin(gamma) is uniform over a fibre's width; even steps in gamma resolve its rims.
GAMMA = np.linspace(0, math.pi / 2, 17)
LIGHTS = ("constant", "contrasted")
WEIGHED = ("family over offsets", "its own")
OWN = {"half tables, half its own": 0.5, "its own": 1.0}  # share of the engine's own draws


def share_of(gamma: np.ndarray) -> np.ndarray:
    """(offsets,) shares of the fibre's width around even gamma from 0 to the rim."""
    width = np.cos(gamma) * np.where((gamma == gamma[0]) | (gamma == gamma[-1]), 0.5, 1.0)
    return width / width.sum()


def far_field(values: np.ndarray, gamma: np.ndarray = GAMMA) -> np.ndarray:
    """(J, n, m) the mean over all offsets; those of the other half mirror the azimuth."""
    mean = np.tensordot(share_of(gamma), values, 1)
    return (mean + mean[..., ::-1]) / 2


def bake(found: Fit, name: str, folder: Path) -> Path:
    """Bakes the fit's masses; the model's directory."""
    masses = write_all(found, folder, name)[0]
    _bake(masses, folder)
    return folder / masses.stem


def bake_family(data: OffsetData, name: str, folder: Path) -> tuple[Path, float]:
    """Fits and bakes a family; its directory, and the seconds that the fit took."""
    start = perf_counter()
    family = fit_family(data)
    seconds = perf_counter() - start
    write_family(family, folder / f"{name}_models")
    baked = folder / f"{name}_family"
    _bake(folder / f"{name}_models", baked)
    return baked, seconds


def _bake(model: Path, out: Path) -> None:
    if cli.main(["bake", "--model", str(model), "--size", SIZE, "--jobs", "1", "--out", str(out)]):
        raise RuntimeError(f"{model} does not bake")


def samplers(nested: dict, tables: Path, weight: float, family: Path) -> dict[str, dict]:
    """BSDF dictionaries by what proposes directions; all have the same values."""
    plugin = {"type": "hairlut", "nested": nested}
    fitted = {**plugin, "model": str(tables), "direct_weight": weight}
    return {
        "uniform": {**plugin, "uniform": True},
        "built-in tables": {**plugin, "model": "fitted"},
        "one fitted model": fitted,
        "family over offsets": {**plugin, "family": str(family)},
        "half tables, half its own": {**fitted, "nested_weight": 0.5},
        "its own": nested,
    }


def compare(mi: Any, name: str, folder: Path, draws: int, pictures: Path) -> dict:
    """All numbers of one hair; its fit as pictures/fit_<name>.png."""
    strands = folder / "strands.txt"
    write_strands(strand_points(Hair(strands=STRANDS)), strands)
    nested = {"type": "hair", **HAIRS[name]}
    own = mi.load_dict(nested)
    clock = [perf_counter()]
    values = evaluate(mi, own, THETA_R, THETA_I, PHI, GAMMA)
    clock.append(perf_counter())
    found = fit(of_grid(THETA_R, THETA_I, PHI, far_field(values), per_steradian=True))
    clock.append(perf_counter())
    tables = bake(found, name, folder)
    clock.append(perf_counter())
    data = of_grids(np.sin(GAMMA), THETA_R, THETA_I, PHI, values, per_steradian=True)
    family, fit_seconds = bake_family(data, name, folder)
    clock.append(perf_counter())
    write_whole(pictures / f"fit_{name}.png", plot(found, name))
    kinds = samplers(nested, tables, found.split.direct_weight, family)
    steps = dict(zip(("evaluate", "fit", "bake", "family"), np.diff(clock).tolist(), strict=True))
    return {
        "parameters": nested,
        "seconds": {**steps, "family_fit": fit_seconds, "family_bake": steps["family"] - fit_seconds},
        "bytes": {"model": size_of(tables), "family": size_of(family)},
        "direct_weight": found.split.direct_weight,
        "predicted": {
            "uniform": float(found.uniform.mean()),
            "marginals": float(found.marginal.mean()),
            "masses": float(found.masses.mean()),
        },
        "by_offset": left(mi, own),
        "viewers": [towards(mi, viewer, HAIRS[name], kinds, draws) for viewer in VIEWERS],
        "render": render(mi, kinds, strands),
    }


def size_of(folder: Path) -> int:
    """Bytes of the textures in folder and of what says how to draw from them."""
    return sum(path.stat().st_size for end in ("*.exr", "family.txt") for path in folder.rglob(end))


def towards(mi: Any, viewer: float, hair: dict, kinds: dict[str, dict], draws: int) -> dict:
    """What every sampler estimates towards one viewer (deg), and the light by quadrature."""
    theta_r = math.radians(viewer)
    exact, error = light(mi, mi.load_dict({"type": "hair", **hair}), theta_r)
    row = {
        "theta_r_deg": viewer,
        "light": {key: {"mean": m, "error": e} for key, m, e in zip(LIGHTS, exact, error, strict=True)},
    }
    for k, (kind, bsdf) in enumerate(kinds.items()):
        seed = [k, list(HAIRS.values()).index(hair), round(viewer * 2) % 720]
        drawn = draw(mi, mi.load_dict(bsdf), theta_r, draws, seed)
        row[kind] = {**statistics(drawn.estimates()), "seconds": drawn.seconds}
        if kind in WEIGHED:
            row[kind]["largest_weight"] = largest_weight(mi, mi.load_dict(bsdf), theta_r)
        if kind in OWN:
            row[kind]["atom"] = float(owndensity.is_atom(drawn.wo).mean())
            row[kind]["corrected"] = statistics(corrected(mi, drawn, hair, theta_r, OWN[kind]).estimates())
    return row


def render(mi: Any, kinds: dict[str, dict], strands: Path) -> dict:
    """One scattering found by BSDF sampling alone, sky and lamps: the image's mean, its standard error, the
    mean variance of a pixel at one sample relative to the square of the image's mean, its own standard error
    (jackknife over the batches), and the time of a batch relative to that of the BSDF's own sampler: median,
    quartiles, and the standard error of a mean. The samplers take turns, so that a busy machine slows all
    alike; time is processor time of all threads."""
    integrator = {"type": "direct", "emitter_samples": 0, "bsdf_samples": 1}
    scenes = {
        kind: mi.load_dict({**scene_dict(mi, strands, bsdf, IMAGE, True), "integrator": integrator})
        for kind, bsdf in kinds.items()
    }
    images, seconds = ({kind: [] for kind in kinds} for _ in range(2))
    for batch in range(BATCHES):
        for kind, scene in scenes.items():
            start = process_time()
            images[kind].append(np.array(mi.render(scene, spp=SPP, seed=batch)).mean(axis=2))
            seconds[kind].append(process_time() - start)
    return {
        kind: {
            **image_statistics(np.array(images[kind])),
            **time_statistics(np.array(seconds[kind]) / seconds["its own"]),
        }
        for kind in kinds
    }


def image_statistics(images: np.ndarray) -> dict:
    means = images.mean(axis=(1, 2))
    others = np.array([relative_variance(np.delete(images, k, axis=0)) for k in range(BATCHES)])
    return {
        "mean": float(means.mean()),
        "standard_error": float(means.std(ddof=1) / np.sqrt(BATCHES)),
        "relative_variance": relative_variance(images),
        "variance_error": float(np.sqrt((BATCHES - 1) * others.var())),
    }


def time_statistics(ratios: np.ndarray) -> dict:
    low, middle, high = np.quantile(ratios, (0.25, 0.5, 0.75))
    return {
        "time": float(middle),
        "time_quartiles": [float(low), float(high)],
        "time_error": float(ratios.std(ddof=1) / np.sqrt(BATCHES)),
    }


def relative_variance(images: np.ndarray) -> float:
    """Of a pixel at one sample, relative to the squared mean of the images (batches, height, width)."""
    return float(SPP * images.var(axis=0, ddof=1).mean() / images.mean() ** 2)


def statistics(values: np.ndarray) -> dict:
    """Mean, standard error and relative variance of (2, draws) estimates."""
    mean, spread = values.mean(axis=1), values.var(axis=1)
    return {
        light: {
            "mean": float(mean[k]),
            "standard_error": float(np.sqrt(spread[k] / values.shape[1])),
            "relative_variance": float(spread[k] / mean[k] ** 2),
        }
        for k, light in enumerate(LIGHTS)
    }


def main() -> int:
    from report.engine import load_engine

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=200_000)
    parser.add_argument("--hair", action="append", choices=HAIRS, help="may be repeated (default: all)")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.json")
    args = parser.parse_args()
    mi = load_engine()
    with tempfile.TemporaryDirectory() as folder:
        report = {
            name: compare(mi, name, Path(folder), args.draws, args.out.parent) for name in args.hair or HAIRS
        }
    write_whole(args.out, f"{json.dumps({'draws': args.draws, 'hairs': report}, indent=1)}\n".encode())
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
