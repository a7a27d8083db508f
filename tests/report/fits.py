# SPDX-License-Identifier: BSD-3-Clause
"""Fits every hair of hairs.py and measures the textures through the C library, by a quadrature that the fit
has no part in; the page is fits_page.py's.

    PYTHONPATH=tests .venv/bin/python -m report.fits [--hair NAME]...      five to ten minutes of one core
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path
from time import process_time

import numpy as np
from scipy.stats import qmc

import hairlut
from hairlut.exr import write_model
from hairlut.files import write_whole
from hairlut.fit import hair, refine, summary
from report import fits_page
from report.hairs import Subject, far_field, near_field
from report.places import PAGES

VIEWERS = np.radians(-90 + 30.0 * (np.arange(6) + 0.5) + 2.1)  # even over the hemisphere, between rows
OFFSETS = (np.arange(5) + 0.41) / 5
DRAWS = 1 << 18  # of a sampler whose density is not known, by viewer
BRIGHT = 1e-4
TOLERANCE, BUDGET = 0.01, 1e4  # seconds: whatever else runs, all hairs start from full effort
SIZE = fits_page.KILOBYTES * 1024
DATA = PAGES / "fit.json"
WEIGHTS = PAGES / "fit_weights.md"  # by weights.py


def measured(subject: Subject) -> dict:
    """What a fit costs, promises and keeps."""
    start = process_time()
    given = hair.of_density(subject.density, subject.offsets)
    found = refine.fit(given, "hair", TOLERANCE, None, BUDGET, lambda stage, share: None, SIZE)
    with tempfile.TemporaryDirectory() as folder:
        paths = write_model(Path(folder), summary.with_errors(found))
        seconds = process_time() - start
        size = sum(path.stat().st_size for path in paths)
        kept = through_library(subject, folder)
    promised = summary.promise(found)
    row = {
        "promise": promised.relative_variance,
        "promise_low": promised.low,
        "promise_high": promised.high,
        "promise_weight": promised.largest_weight,
        "lobes": len(found.model.lobes),
        "seconds": seconds,
        "bytes": size,
        "limits": refine.limits(found, TOLERANCE),
        **kept,
    }
    if subject.own:
        row["own"] = quadrature(subject, subject.own)
    if subject.parts:
        row["parts"] = at_random_offsets(subject)
    if subject.draws:
        row["draws"] = of_draws(subject)
    return row


def through_library(subject: Subject, folder: str) -> dict:
    """quadrature() of the model in a folder."""
    model = hairlut.load(folder)
    return quadrature(subject, lambda *at: model.pdf(at[0], 0.0, at[1], at[2], offset=at[3]))


def quadrature(subject: Subject, pdf) -> dict:
    """V at each viewer, the mean over offsets, the largest weight, and the variance of one draw's estimate
    in lamps, at a random offset, by midpoints."""
    theta_i, phi, size = directions(subject.points)
    lamps = light(theta_i, phi)
    offsets = OFFSETS if subject.offsets else np.zeros(1)
    variance, weight, in_lamps = [], 0.0, []
    for theta_r in VIEWERS:
        here, first, second = [], 0.0, 0.0
        for offset in offsets:
            p = np.broadcast_to(subject.density(theta_r, theta_i, phi, offset), subject.points)
            q = np.broadcast_to(np.asarray(pdf(theta_r, theta_i, phi, offset), float), subject.points)
            total = p.sum() * size
            square = p * (p / np.maximum(q, 1e-300))
            here.append(square.sum() * size / total**2 - 1)
            first += (p * lamps).sum() * size
            second += (square * lamps**2).sum() * size
            per_steradian = p / np.cos(theta_i)
            bright = per_steradian > BRIGHT * per_steradian.max()
            weight = max(weight, float((p / total / np.maximum(q, 1e-300))[bright].max()))
        variance.append(float(np.mean(here)))
        in_lamps.append(float(second / first**2 * len(offsets) - 1))
    return {"variance": variance, "weight": weight, "lamps": in_lamps}


def at_random_offsets(subject: Subject) -> dict:
    """V, and the variance in lamps, of one draw by the authors' sampler at a random one of the offsets that a
    hair is the mean of: a pixel that is wider than the fibre."""
    theta_i, phi, size = directions(subject.points)
    found: dict[str, list[float]] = {"variance": [], "lamps": []}
    for theta_r in VIEWERS:
        for name, radiance in (("variance", 1.0), ("lamps", light(theta_i, phi))):
            moments = [
                ((p * radiance).sum() * size, (p * p / np.maximum(q, 1e-300) * radiance**2).sum() * size)
                for p, q in subject.parts(theta_r, theta_i, phi)
            ]
            first, second = np.mean(moments, axis=0)
            found[name].append(float(second / first**2 - 1))
    return found


def of_draws(subject: Subject) -> dict:
    """V, and the variance in lamps, of one draw by a sampler that returns a weight, from many draws."""
    found: dict[str, list[float]] = {"variance": [], "lamps": []}
    u = qmc.Sobol(8, seed=7).random(DRAWS)
    for theta_r in VIEWERS:
        theta_i, phi, weight = subject.draws(theta_r, u)
        for name, value in (("variance", weight), ("lamps", weight * light(theta_i, phi))):
            found[name].append(float((value**2).mean() / value.mean() ** 2 - 1))
    return found


def directions(points: tuple[int, int]):
    """(theta_i (n, 1), phi (m,), the rad^2 of each) by midpoints."""
    n, m = points
    theta_i = ((np.arange(n) + 0.5) / n - 0.5)[:, None] * np.pi
    return theta_i, (np.arange(m) + 0.5) / m * 2 * np.pi, np.pi / n * 2 * np.pi / m


def light(theta_i, phi):
    """Radiance of a dim sky, a bright window, and a small lamp."""
    window = (abs(theta_i - 0.5) < 0.35) & (abs(phi - 2.0) < 0.6)
    lamp = np.exp(-0.5 * ((theta_i + 0.3) ** 2 + (phi - 4.2) ** 2) / 0.05**2)
    return 0.3 + 5.0 * window + 200.0 * lamp


def main() -> int:
    parser = argparse.ArgumentParser(prog="report.fits", description=__doc__.splitlines()[0])
    parser.add_argument("--hair", action="append", help="one hair alone; may be repeated")
    parser.add_argument(
        "--data", type=Path, default=DATA, metavar="FILE", help="the numbers (default: %(default)s)"
    )
    parser.add_argument("--missing", action="store_true", help="only hairs that the last run did not come to")
    args = parser.parse_args()
    results = json.loads(args.data.read_text()) if args.data.exists() else {}
    for subject in far_field() + near_field():
        if (args.hair and subject.name not in args.hair) or (args.missing and subject.name in results):
            continue
        results[subject.name] = measured(subject)
        shown = results[subject.name]
        print(
            subject.name, f"V {np.mean(shown['variance']):.4f}", f"weight {shown['weight']:.1f}", flush=True
        )
        write_whole(args.data, f"{json.dumps(results, indent=1)}\n".encode())
    weights = WEIGHTS.read_text(encoding="utf-8") if WEIGHTS.exists() else ""
    print(write_whole(PAGES / "fit.md", fits_page.page(results, weights).encode()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
