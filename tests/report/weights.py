# SPDX-License-Identifier: BSD-3-Clause
"""The largest weights that K lobes can reach, on cells; a part of the fit page, pages/fit_weights.md.

    PYTHONPATH=tests .venv/bin/python -m report.weights

A sampler q of mass 1 has weights p / q of at most W where p <= W q, so the least W is the least mass of
W q >= p. With the inclinations A_k of K lobes, W q = sum of A_k(theta_i) b_k(phi, h), and for each azimuth
and offset the least mass of b >= 0 with A b >= p is a linear program. Its value is exact for these
inclinations, whatever the azimuths are, turned or not. For others it is not a bound, so they are fitted with
powers of p / q (factor.py) that care for large weights more and more.

Textures have larger weights than these. A second table says why: the weights of a fit's rows on their cells,
and those of the textures baked from them, by what these may lose.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.optimize import linprog

from hairlut.exr import write_model
from hairlut.files import write_whole
from hairlut.fit import factor, hair, lobesfit, promise, refine
from hairlut.fit.effort import EFFORTS
from report import fits
from report.hairs import Subject, near_field
from report.markdown import table
from report.places import PAGES

HAIRS = "chiang 0.3 0.3 0.6", "chiang 0.1 0.1 0.6"
VIEWERS = np.radians([-60.0, 0.0, 35.0])
LOBES = 1, 2, 3, 4, 5
POWERS = 4, 8, 16
STEPS = 300
AXES = refine.Axes(3, 7, 32, 96)
TEXTURES = "chiang 0.3 0.3 0.6"
TEXTURE_LOBES = 3
TEXTURE_AXES = refine.Axes(37, 11, 32, 56), refine.Axes(73, 21, 64, 112)  # hairlut fit's, and twice as fine
EASES = 1.0, 1 / 4, 1 / 16, 1 / 64  # times what a table may lose; its largest weight by the square root

TEXT = """
## The largest weight that lobes can reach

Where f cos(theta_i) is above 1e-4 of its peak, on {theta_i} x {phi} cells at {offsets} offsets and three
viewers; mean and worst over viewers and offsets. "Fitted" is what the products of a fit reach that cares for
p / q to the power of 4, as `hairlut fit` does, 8 or 16. "Least" is the least possible with the inclinations
of that fit and azimuths of any shape at every offset, by linear programs (weights.py has the derivation).
Each lobe of Chiang's hair is a product of an inclination and an azimuth that turns with the offset, so that
four lobes can reach 1. A sampler keeps more than that: a part of {fill} of each inclination has the shape of
all light and the same part of each azimuth is even, so that no direction is without samples. Textures add the
weights of the next table, and those of the tables above.

"""

TEXTURES_TEXT = """
## The largest weight that textures reach, by their size

{hair}, {lobes} lobes. "Weight" and V are of the textures, read through the C library by the
quadrature of the tables above. "Lobes" is the largest weight of the fit's lobes themselves, on their cells,
at the rows nearest to the quadrature's viewers and the offsets up to its outermost, mean and worst: what
textures without a loss of their own would have there. "At the rim" is the same at the offsets beyond, which
the quadrature does not see. The first line of each fineness lets tables lose what `hairlut fit` does, each
further one a quarter of the line before and half as large a weight.

"""


def main() -> int:
    parser = argparse.ArgumentParser(prog="report.weights", description=__doc__.splitlines()[0])
    parser.parse_args()
    subjects = {subject.name: subject for subject in near_field()}
    rows = [row for name in HAIRS for row in of_hair(subjects[name])]
    columns = "hair", "lobes", *(f"fitted, power {power}" for power in POWERS), "least"
    text = TEXT.format(
        theta_i=AXES.theta_i, phi=AXES.phi, offsets=AXES.offset, fill=f"{factor.FILL:g}"
    ) + table(columns, rows)
    text += of_textures(subjects[TEXTURES])
    print(write_whole(PAGES / "fit_weights.md", text.encode()))
    return 0


def of_hair(subject: Subject) -> list[tuple]:
    """A row for each number of lobes."""
    given = hair.of_density(subject.density, True)
    data = refine._cells(given, VIEWERS, given.angles(AXES.offset), AXES, EFFORTS[0])
    found = []
    for count in LOBES:
        cells, least = [subject.name, count], []
        for power in POWERS:
            fitted = []
            for mass, edges in zip(data.mass.astype(float), data.theta_edges, strict=True):
                bright = above(mass, edges)
                theta, azimuth = products(lobesfit._flat(mass), count, power)
                q = (theta @ azimuth).reshape(len(theta), len(mass), -1).swapaxes(0, 1)
                fitted.append(_weights(mass, edges, q / q.sum(axis=(1, 2), keepdims=True)))
                if power == POWERS[-1]:
                    least.append([least_weight(p, theta, at) for p, at in zip(mass, bright, strict=True)])
            cells.append(shown(fitted))
        found.append((*cells, shown(least)))
        print(*found[-1], flush=True)
    return found


def of_textures(subject: Subject) -> str:
    """The second table: what textures of one hair reach, by what each may lose."""
    given = hair.of_density(subject.density, True)
    found = []
    for axes in TEXTURE_AXES:
        angle = given.angles(axes.offset)
        data = refine._cells(given, given.rows(axes.theta_r), angle, axes, EFFORTS[0])
        rows = refine.fit_rows(data, angle, TEXTURE_LOBES, True)
        near = [int(abs(data.theta_r - viewer).argmin()) for viewer in fits.VIEWERS]
        on_cells = np.array([_weights(data.mass[j], data.theta_edges[j], rows[j].drawn()) for j in near])
        inside = np.sin(angle) < fits.OFFSETS[-1]
        for ease in EASES:
            baked = refine.bake(data, rows, "hair", given.mirrored, refine.TABLE_PART * fits.TOLERANCE, ease)
            with tempfile.TemporaryDirectory() as folder:
                size = sum(path.stat().st_size for path in write_model(Path(folder), baked))
                kept = fits.through_library(subject, folder)
            cells = f"{axes.theta_r} x {axes.offset} x {axes.theta_i} x {axes.phi}"
            v = f"{np.mean(kept['variance']):.4f}"
            found.append(
                (
                    cells,
                    shown(on_cells[:, inside]),
                    shown(on_cells[:, ~inside]),
                    f"1/{round(1 / ease)}",
                    f"{size / 1024:.0f}",
                    v,
                    f"{kept['weight']:.2f}",
                )
            )
            print(*found[-1], flush=True)
    columns = "rows, offsets, theta_i, phi", "lobes", "at the rim", "loss allowed", "KB", "V", "weight"
    text = TEXTURES_TEXT.format(hair=subject.name.capitalize(), lobes=TEXTURE_LOBES)
    return text + table(columns, found)


def shown(weights: list) -> str:
    return f"{np.mean(weights):.2f} ({np.max(weights):.2f})"


def _weights(mass: np.ndarray, edges: np.ndarray, q: np.ndarray) -> np.ndarray:
    """(N,) the largest weight at each offset, of the bright cells of the masses, drawn by q."""
    return np.where(above(mass, edges), mass / q, 0.0).max(axis=(1, 2))


def above(mass: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Where f cos(theta_i) of the masses (N, n, m) is bright."""
    light = mass / (np.diff(edges) * np.cos((edges[1:] + edges[:-1]) / 2))[:, None]
    return light > promise.BRIGHT * light.max(axis=(1, 2), keepdims=True)


def products(p: np.ndarray, count: int, power: int) -> tuple[np.ndarray, np.ndarray]:
    """As factor.products, then with p / q to another power."""
    theta, azimuth = factor.products(p, count)
    light = p.sum(axis=1, keepdims=True) / p.sum()
    for _ in range(STEPS):
        ratio = np.minimum(p / np.maximum(theta @ azimuth, factor.TINY), factor.LARGEST) ** power
        gain = (ratio @ azimuth.T) / azimuth.sum(axis=1)
        azimuth = azimuth * (theta.T @ ratio) ** (1 / power)
        theta = factor.filled(theta * gain ** (1 / power), light)
        azimuth *= p.sum() / azimuth.sum()
    return theta, azimuth


def least_weight(p: np.ndarray, theta: np.ndarray, bright: np.ndarray) -> float:
    """The least largest weight of the bright cells of p (n, m), of sum 1, for inclinations theta (n, K)."""
    total = 0.0
    for column, at in zip(p.T, bright.T, strict=True):
        if at.any():
            scale = column[at].max()
            total += (
                scale * linprog(np.ones(theta.shape[1]), -theta[at], -column[at] / scale, method="highs").fun
            )
    return total


if __name__ == "__main__":
    sys.exit(main())
