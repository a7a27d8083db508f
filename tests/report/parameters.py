# SPDX-License-Identifier: BSD-3-Clause
"""One model over all roughnesses and absorptions of Chiang's hair: its textures held against the paper's
sampler at random parameters, by a quadrature that the fit has no part in; sizes against losses; and two ways
to read between the nodes of a parameter.

    PYTHONPATH=tests .venv/bin/python -m report.parameters           half an hour of one core
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from functools import cache
from pathlib import Path
from time import process_time

import numpy as np

import hairlut
from hairlut import exr
from hairlut.axes import corners
from hairlut.files import write_whole
from hairlut.fit import bsdf
from hairlut.fit.strands import box, fit, summary
from hairlut.model import BakedLobe, BakedModel
from report import parameters_page
from report.places import PAGES, ROOT

EXAMPLE = ROOT / "precompute" / "examples" / "chiang_parameters.py"
TOLERANCES = 0.03, 0.01, 0.003
BUDGET, SIZE = 1200.0, 2.0**20  # seconds, bytes
PLACES, OFFSETS = 1000, 1
POINTS = 256, 256  # of theta_i around the mirror direction and over the sphere, and of phi
WAYS = 48  # places at which the two ways are compared
BRIGHT = 1e-4
DATA = PAGES / "parameters.json"


def fitted(tolerance: float, given: box.Box) -> dict:
    """What a fit costs and promises, and what its files keep at random parameters."""
    start = process_time()
    found = fit.fit(given, "hair", tolerance, None, BUDGET, lambda stage, share: None, SIZE)
    with tempfile.TemporaryDirectory() as folder:
        paths = exr.write_model(Path(folder), summary.with_errors(found))
        seconds = process_time() - start
        reported = summary.data(found, tolerance)
        model = hairlut.load(folder)

        def drawn(place, theta_r, theta_i, phi, offset):
            return model.pdf(theta_r, 0.0, theta_i, phi, offset=offset, **place)

        kept = at_random_places(given, drawn)
        row = {
            "tolerance": tolerance,
            "seconds": seconds,
            "bytes": sum(path.stat().st_size for path in paths),
            "texels": sum(table.nbytes for table in found.model.tables) + 8 * found.model.mixture.share.size,
            "lobes": reported["lobes"],
            "axes": {name: {a: len(n) for a, n in axes.items()} for name, axes in reported["axes"].items()},
            "limits": reported["limits"],
            "promise": [reported["relative_variance"], reported["low"], reported["high"]],
            **kept,
        }
        ways = two_ways(given, exr.read_model(Path(folder)))
    return {**row, "ways": ways}


def at_random_places(given: box.Box, drawn, count: int = PLACES, seed: int = 7) -> dict:
    """Samples over the own sampler's, and the largest weight, at random parameters, viewers and offsets."""
    samples, weights = [], []
    for place, theta_r, offset in random_places(given, count, seed):
        v, own, weight = np.mean([quadrature(given, drawn, place, theta_r, h) for h in offset], axis=0)
        samples.append((1 + v) / (1 + own))
        weights.append(weight)
    shown = np.quantile(samples, [0.5, 0.9, 0.99, 1.0])
    heaviest = np.quantile(weights, [0.5, 0.99, 1.0])
    return {"samples": shown.tolist(), "mean": float(np.mean(samples)), "weights": heaviest.tolist()}


def random_places(given: box.Box, count: int, seed: int):
    random = np.random.default_rng(seed)
    for _ in range(count):
        place = {p.name: float(random.uniform(p.least, p.most)) for p in given.parameters}
        yield place, float(random.uniform(*given.hair.theta_r)), random.uniform(-1, 1, OFFSETS)


def quadrature(given: box.Box, drawn, place: dict, theta_r: float, offset: float) -> tuple:
    """(V, V of the own sampler, the largest weight) of the density drawn, by a midpoint rule whose angles
    theta_i are dense where the hair is bright."""
    n, m = POINTS
    edges = np.sort(
        np.concatenate([np.linspace(-1, 1, n // 2 + 1), _near(theta_r, n // 2)[1:-1]]) * np.pi / 2
    )
    theta_i, size = ((edges[1:] + edges[:-1]) / 2)[:, None], np.diff(edges)[:, None] * (2 * np.pi / m)
    phi = (np.arange(m) + 0.5) / m * 2 * np.pi
    p = np.broadcast_to(given.density(theta_r, theta_i, phi, offset, **place), (theta_i.size, m))
    q = np.asarray(drawn(place, theta_r, theta_i, phi, offset), float)
    attenuation = sum(own_attenuations(theta_r, offset, place["absorption"]))
    total = (p * size).sum()
    square, own = (p * (p / np.maximum(q, 1e-300)) * size).sum(), (p * size).sum() * attenuation
    light = p / np.cos(theta_i)
    weight = (p / total / np.maximum(q, 1e-300))[light > BRIGHT * light.max()].max()
    return square / total**2 - 1, own / total**2 - 1, weight


def _near(theta_r: float, n: int) -> np.ndarray:
    """(n + 1,) edges, in units of pi / 2, dense around the mirror direction."""
    x = np.linspace(-1, 1, n + 1) ** 3 * 2
    edges = np.clip(-theta_r / (np.pi / 2) + x, -1, 1)
    return np.concatenate([[-1], np.unique(edges[(edges > -1) & (edges < 1)]), [1]])


def own_attenuations(theta_r: float, offset: float, absorption: float):
    """What the paper's sampler chooses its lobes by."""
    return _example()["attenuations"](theta_r, offset, absorption)


@cache
def _example() -> dict:
    space: dict = {}
    exec(compile((EXAMPLE.parent / "chiang2016.py").read_text(), "chiang2016.py", "exec"), space)
    return space


def two_ways(given: box.Box, model: BakedModel) -> dict:
    """Median, 99th percentile and mean of V where quantiles are blended over the nodes of a table, and where
    a random node is read, chosen with the blend's parts: then the density is the blend of the nodes'."""
    found = {"blended": [], "chosen": []}
    ways = {
        "blended": lambda *at: model.pdf(at[1], 0.0, at[2], at[3], at[4], at[0]),
        "chosen": lambda *at: chosen_pdf(model, *at),
    }
    for place, theta_r, offset in random_places(given, WAYS, 8):
        for name, drawn in ways.items():
            found[name].append(quadrature(given, drawn, place, theta_r, offset[0])[0])
    return {
        name: [float(np.median(v)), float(np.quantile(v, 0.99)), float(np.mean(v))]
        for name, v in found.items()
    }


def chosen_pdf(model: BakedModel, place: dict, theta_r: float, theta_i, phi, offset: float):
    """Density of draws for which each table reads one of the nodes around, chosen at random."""
    mixture = model.mixture.parameters_at(place)
    total = 0.0
    for k, lobe in enumerate(model.lobes):
        phi_nodes = _nodes(lobe.phi, place) if lobe.phi else [(1.0, None)]
        weight = mixture.at(np.array(theta_r), np.array(offset))[0][k]
        alone = _only(mixture, k)
        for part_theta, table_theta in _nodes(lobe.theta, place):
            for part_phi, table_phi in phi_nodes:
                one = BakedModel(model.name, (BakedLobe(lobe.name, table_theta, table_phi),), alone)
                total = total + weight * part_theta * part_phi * one.pdf(theta_r, 0.0, theta_i, phi, offset)
    return total


def _only(mixture, k: int):
    """The mixture of one lobe, with its turns."""
    return type(mixture)(
        mixture.lobes[k : k + 1],
        mixture.theta_r,
        mixture.offset,
        np.ones_like(mixture.share[k : k + 1]),
        mixture.turn[k : k + 1],
        mixture.mirrored,
    )


def _nodes(table, place: dict):
    """(part, table without axes) of each node around the parameters."""
    if not table.axes:
        return [(1.0, table)]
    node, part = corners(table.axes, place)
    grid = np.stack(np.meshgrid(*(axis.nodes for axis in table.axes), indexing="ij"), -1)
    values = grid.reshape(-1, len(table.axes))
    names = [axis.name for axis in table.axes]
    return [
        (float(w), table.at(dict(zip(names, values[i], strict=True))))
        for i, w in zip(node, part, strict=True)
    ]


def main() -> int:
    parser = argparse.ArgumentParser(prog="report.parameters", description=__doc__.splitlines()[0])
    parser.add_argument("--tolerance", type=float, action="append", help="this one alone; may be repeated")
    parser.add_argument("--data", type=Path, default=DATA, metavar="FILE", help="default: %(default)s")
    args = parser.parse_args()
    results = json.loads(args.data.read_text()) if args.data.exists() else {}
    own = bsdf.load(EXAMPLE)
    given = box.of_parameters(own.density, own.parameters, bool(own.offset))
    for tolerance in args.tolerance or TOLERANCES:
        results[f"{tolerance:g}"] = row = fitted(tolerance, given)
        print(f"tolerance {tolerance:g}: {row['bytes']} bytes, samples {row['samples']}", flush=True)
        write_whole(args.data, f"{json.dumps(results, indent=1)}\n".encode())
    print(write_whole(PAGES / "parameters.md", parameters_page.page(results, PLACES, POINTS[0]).encode()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
