"""The files of a family (family.py): a model file for each lobe of each offset, and one text file of weights.

A directory holds `offset_00_lobe_0.npz` and so on, models whose direct lobes are drawn from (their multiple
lobe is even, and nobody draws from it), and `family.txt`, which `hairlut bake DIRECTORY` copies to where the
textures are baked. Words of its lines are separated by spaces, angles are in radians:

    hairlut-family 1            the format's version
    mirrored 1                  1: models for offsets from 0 on; at -offset the azimuth is mirrored
    theta_r -1.396 -1.222 ...   increasing; weights are linear between them, and held outside
    offset 0.0980171            increasing; the lines below it, up to the next offset, are its lobes
    lobe offset_01_lobe_0 0.41 0.44 ...    a model's directory, and its weight at each theta_r

At each theta_r the weights of an offset sum to 1. At another offset h, draw from the lobes of both
neighbours with weights times 1 - t and t, t = (asin h - asin low) / (asin high - asin low), in [0, 1].
"""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np

from .family import Family
from .files import write_whole
from .lobes import HALF_PI

NAME = "family.txt"
VERSION = 1


def write_family(family: Family, folder: Path) -> list[Path]:
    """Writes the model files, and then family.txt, into folder; their paths."""
    paths = []
    for o in range(len(family.data.offset)):
        for k in range(family.theta.shape[1]):
            paths.append(write_whole(folder / f"{model_name(o, k)}.npz", _npz(family, o, k)))
    return [*paths, write_whole(folder / NAME, contents(family).encode())]


def model_name(offset: int, lobe: int) -> str:
    """The name of the model of a lobe at an offset, both counted from 0."""
    return f"offset_{offset:02d}_lobe_{lobe}"


def contents(family: Family) -> str:
    """The text of family.txt."""
    data = family.data
    lines = [
        f"hairlut-family {VERSION}",
        f"mirrored {int(data.mirrored)}",
        f"theta_r {_numbers(data.at[0].theta_r)}",
    ]
    for o, (offset, weight) in enumerate(zip(data.offset, family.weight, strict=True)):
        lines.append(f"offset {offset:.9g}")
        lines += [f"lobe {model_name(o, k)} {_numbers(row)}" for k, row in enumerate(weight.T)]
    return "\n".join(lines) + "\n"


def _numbers(values) -> str:
    return " ".join(f"{v:.9g}" for v in values)


def _npz(family: Family, o: int, k: int) -> bytes:
    one = family.data.at[o]
    lobes = {
        "direct_theta": (one.theta_edges, one.theta_r, family.theta[:, k]),
        "direct_phi": (one.phi_edges, one.theta_r, family.phi[o, :, k]),
        "multiple_theta": (np.array([-HALF_PI, HALF_PI]), np.zeros(1), np.ones((1, 1))),
    }
    arrays = {
        f"{name}.{part}": values
        for name, lobe in lobes.items()
        for part, values in zip(("edges", "theta_r", "mass"), lobe, strict=True)
    }
    file = BytesIO()
    np.savez_compressed(file, azimuth=np.array("difference"), **arrays)
    return file.getvalue()


def text(family: Family) -> str:
    """The fit for a terminal."""
    data = family.data
    at, between = family.variance(), family.variance_between()
    lines = [
        f"{len(data.offset)} offsets from {data.offset[0]:.4g} to {data.offset[-1]:.4g}"
        + (", the other half of the fibre their mirror image" if data.mirrored else "")
        + f"; {family.theta.shape[1]} lobes at each",
        "",
        "relative variance of drawing this data, the offset known (0 is perfect, 1 costs twice the samples):",
        "at the offsets, and drawn from the two neighbours of an offset, which lie twice as far apart",
        f"{'theta_r [deg]':>14} {'at offsets':>10} {'neighbours':>10}",
    ]
    angles = [f"{angle:14.4g}" for angle in np.degrees(data.at[0].theta_r)]
    rows = zip([*angles, f"{'all rows':>14}"], [*at, at.mean()], [*between, between.mean()], strict=True)
    return "\n".join([*lines, *(f"{angle} {a:10.4f} {b:10.4f}" for angle, a, b in rows)])
