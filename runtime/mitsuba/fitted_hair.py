"""Tables fitted to the engine's own hair BSDF, against the sampler that its authors derived for it by hand.

    .venv/bin/python runtime/mitsuba/fitted_hair.py [--draws N] --out luts/report/fit.json

For each hair: evaluate the BSDF on a grid (theta_r, theta_i, phi, and the offset at which the fibre is
hit), average it over the offset, fit, bake, and draw from the tables through the plugin: hairlut's C
library proposes, the BSDF gives the value. The estimates are of the light that the fibre scatters towards a
viewer, at a random offset, from an environment of constant and of contrasted radiance.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from hairscene.scene import Hair, scene_dict, strand_points, write_strands

from hairlut import cli
from hairlut.distribution import of_grid
from hairlut.files import write_whole
from hairlut.fit import Fit, fit
from hairlut.fitfiles import write_all
from hairlut.fitplot import plot

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
IMAGE, STRANDS, SPP, BATCHES = (64, 48), 4000, 16, 12
VIEWERS = (0.0, 30.0, -60.0)
SIZE = "96x37"  # rows every 5 degrees: the grid's are among them
THETA_R = np.radians(np.arange(-85.0, 86.0, 10.0))
THETA_I = (np.arange(64) + 0.5) / 64 * np.pi - np.pi / 2
PHI = (np.arange(72) + 0.5) / 72 * 2 * np.pi
OFFSETS = 16
# The offset h = sin(gamma) is uniform over a fibre's width; even steps in gamma resolve its rims.
GAMMA = (np.arange(OFFSETS) + 0.5) / OFFSETS * np.pi / 2
WEIGHT = np.cos(GAMMA) / np.cos(GAMMA).sum()


def direction(mi: Any, theta: float, phi: float):
    """Local direction: the fibre along y, phi from z (the surface normal) towards x."""
    return mi.Vector3f(math.cos(theta) * math.sin(phi), math.sin(theta), math.cos(theta) * math.cos(phi))


def evaluate(mi: Any, bsdf: Any, theta_r=THETA_R, theta_i=THETA_I, phi=PHI, gamma=GAMMA) -> np.ndarray:
    """Grey values per steradian, cosine included, (offsets, J, n, m), at the relative azimuths phi."""
    si, context = mi.SurfaceInteraction3f(), mi.BSDFContext()
    values = np.empty((len(gamma), len(theta_r), len(theta_i), len(phi)))
    for g, at in enumerate(gamma):
        incident = [[direction(mi, t, p + at) for p in phi] for t in theta_i]
        for j, t_r in enumerate(theta_r):
            si.wi = direction(mi, t_r, at)
            values[g, j] = [[sum(bsdf.eval(context, si, w)) / 3 for w in row] for row in incident]
    return values


def far_field(values: np.ndarray, weight=WEIGHT) -> np.ndarray:
    """(J, n, m) the mean over all offsets; those of the other half mirror the azimuth."""
    mean = np.tensordot(weight, values, 1)
    return (mean + mean[..., ::-1]) / 2


def per_offset(values: np.ndarray, weight=WEIGHT) -> float:
    """Relative variance, mean over theta_r, that a model of its own for each offset would leave."""
    fits = [fit(of_grid(THETA_R, THETA_I, PHI, value, per_steradian=True)) for value in values]
    measure = np.diff(np.sin(fits[0].data.theta_edges))[:, None] * np.diff(fits[0].data.phi_edges)
    light = (values * measure).sum(axis=(2, 3))
    mean = weight @ light
    second = sum(w * own**2 * (1 + f.masses) for w, own, f in zip(weight, light, fits, strict=True))
    return float((second / mean**2 - 1).mean())


def bake(found: Fit, name: str, folder: Path) -> Path:
    """Bakes the fit's masses; the model's directory."""
    masses = write_all(found, folder, name)[0]
    if cli.main(["bake", "--model", str(masses), "--size", SIZE, "--out", str(folder)]):
        raise RuntimeError(f"{masses} does not bake")
    return folder / masses.stem


def samplers(nested: dict, tables: Path, weight: float) -> dict[str, dict]:
    """BSDF dictionaries by what proposes directions; all have the same values."""
    plugin = {"type": "hairlut", "nested": nested}
    return {
        "uniform": {**plugin, "uniform": True},
        "built-in tables": {**plugin, "model": "fitted"},
        "tables fitted to it": {**plugin, "model": str(tables), "direct_weight": weight},
        "half tables, half its own": {
            **plugin,
            "model": str(tables),
            "direct_weight": weight,
            "nested_weight": 0.5,
        },
        "its own": nested,
    }


def contrasted(w: np.ndarray) -> np.ndarray:
    """Radiance from w (N, 3): dim, with a window and a small lamp."""
    window = np.exp(10 * (w @ _unit(0.5, 0.4, 0.77) - 1))
    lamp = np.exp(60 * (w @ _unit(-0.3, -0.5, -0.8) - 1))
    return 0.1 + 2 * window + 8 * lamp


def _unit(*v: float) -> np.ndarray:
    return np.array(v) / np.linalg.norm(v)


def estimates(mi: Any, bsdf: Any, theta_r: float, draws: int, seed: int) -> np.ndarray:
    """(2, draws) single estimates of the light towards theta_r: constant radiance, then contrasted."""
    rng = np.random.default_rng(seed)
    numbers = rng.random((draws, 4), dtype=np.float32)
    numbers[:, 3] = np.arcsin(0.998 * (2 * numbers[:, 3] - 1))
    si, context, point = mi.SurfaceInteraction3f(), mi.BSDFContext(), mi.Point2f
    weight, wo = np.empty(draws), np.empty((draws, 3))
    for n, (a, b, c, gamma) in enumerate(numbers.tolist()):
        si.wi = direction(mi, theta_r, gamma)
        sample, value = bsdf.sample(context, si, a, point(b, c))
        weight[n], w = sum(value) / 3, sample.wo
        wo[n] = w.x, w.y, w.z
    return np.stack([weight, weight * contrasted(wo)])


def compare(mi: Any, name: str, folder: Path, draws: int, pictures: Path) -> dict:
    """All numbers of one hair; its fit as pictures/fit_<name>.png."""
    strands = folder / "strands.txt"
    write_strands(strand_points(Hair(strands=STRANDS)), strands)
    nested = {"type": "hair", **HAIRS[name]}
    start = perf_counter()
    values = evaluate(mi, mi.load_dict(nested))
    evaluated = perf_counter()
    found = fit(of_grid(THETA_R, THETA_I, PHI, far_field(values), per_steradian=True))
    fitted = perf_counter()
    write_whole(pictures / f"fit_{name}.png", plot(found, name))
    tables = bake(found, name, folder)
    baked = perf_counter()
    kinds = samplers(nested, tables, found.split.direct_weight)
    rows = []
    for viewer in VIEWERS:
        drawn = {
            kind: estimates(mi, mi.load_dict(bsdf), math.radians(viewer), draws, seed)
            for seed, (kind, bsdf) in enumerate(kinds.items())
        }
        rows.append({"theta_r_deg": viewer, **{kind: statistics(values) for kind, values in drawn.items()}})
    return {
        "parameters": nested,
        "seconds": {"evaluate": evaluated - start, "fit": fitted - evaluated, "bake": baked - fitted},
        "bytes": sum(path.stat().st_size for path in tables.glob("*.exr")),
        "direct_weight": found.split.direct_weight,
        "predicted": {
            "uniform": float(found.uniform.mean()),
            "marginals": float(found.marginal.mean()),
            "masses": float(found.masses.mean()),
            "per_offset": per_offset(values),
        },
        "viewers": rows,
        "render": render(mi, kinds, strands),
    }


def render(mi: Any, kinds: dict[str, dict], strands: Path) -> dict:
    """One scattering found by BSDF sampling alone, sky and lamps: the image's mean, its standard error,
    and the mean variance of a pixel at one sample, relative to the square of the image's mean."""
    report = {}
    for kind, bsdf in kinds.items():
        integrator = {"type": "direct", "emitter_samples": 0, "bsdf_samples": 1}
        scene = mi.load_dict({**scene_dict(mi, strands, bsdf, IMAGE, True), "integrator": integrator})
        images = np.array([np.array(mi.render(scene, spp=SPP, seed=k)).mean(axis=2) for k in range(BATCHES)])
        means = images.mean(axis=(1, 2))
        report[kind] = {
            "mean": float(means.mean()),
            "standard_error": float(means.std(ddof=1) / np.sqrt(BATCHES)),
            "relative_variance": float(SPP * images.var(axis=0, ddof=1).mean() / means.mean() ** 2),
        }
    return report


def statistics(values: np.ndarray) -> dict:
    """Mean, standard error and relative variance of (2, draws) estimates."""
    mean, spread = values.mean(axis=1), values.var(axis=1)
    return {
        light: {
            "mean": float(mean[k]),
            "standard_error": float(np.sqrt(spread[k] / values.shape[1])),
            "relative_variance": float(spread[k] / mean[k] ** 2),
        }
        for k, light in enumerate(("constant", "contrasted"))
    }


def main() -> int:
    from hairscene.plugin import load_engine

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=100_000)
    parser.add_argument("--hair", action="append", choices=HAIRS, help="may be repeated (default: all)")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.json")
    args = parser.parse_args()
    mi = load_engine()
    with tempfile.TemporaryDirectory() as folder:
        report = {
            name: compare(mi, name, Path(folder), args.draws, args.out.parent) for name in args.hair or HAIRS
        }
    args.out.write_text(json.dumps(report, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
