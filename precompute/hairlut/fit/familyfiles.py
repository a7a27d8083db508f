"""The files of a family (family.py): a model file for each lobe, and one text file of weights and turns.

A directory holds `shape_0_lobe_0.npz` and so on, models whose direct lobes are drawn from (their multiple
lobe is even, and nobody draws from it), and `family.txt`, which `hairlut bake DIRECTORY` copies to where the
textures are baked. Words of its lines are separated by spaces, angles are in radians:

    hairlut-family 2            the format's version
    mirrored 1                  1: models for offsets from 0 on; at -offset the azimuth is mirrored
    theta_r -1.396 -1.222 ...   increasing; weights and turns are linear between them, and held outside
    offset 0.0980171            increasing; the lines below it, up to the next offset, are its lobes
    lobe shape_0_lobe_0 0.41 0.44 ...    a model's directory, and its weight at each theta_r
    turn -0.098 -0.102 ...               of the lobe above: what is added to its azimuth, at each theta_r

All offsets have as many lobes. At each theta_r the weights of an offset sum to 1. At another offset h,
between two, draw from the models of the nearer one in the angle asin(offset), with weights and turns, lobe by
lobe, times 1 - t and t of both, t = (asin h - asin low) / (asin high - asin low), in [0, 1].
"""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np

from ..files import write_whole
from ..lobes import DIFFERENCE, DIRECT_PHI, DIRECT_THETA, HALF_PI, MULTIPLE_THETA, Array
from .family import Family

NAME = "family.txt"
VERSION = 2


def write_family(family: Family, folder: Path) -> list[Path]:
    """Writes the model files, and then family.txt, into folder; their paths."""
    paths = []
    for shape, azimuths in enumerate(family.phi):
        for k in range(azimuths.shape[1]):
            path = folder / f"{model_name(shape, k)}.npz"
            paths.append(write_whole(path, _npz(family, family.theta[:, k], azimuths[:, k])))
    return [*paths, write_whole(folder / NAME, contents(family).encode())]


def model_name(shape: int, lobe: int) -> str:
    """The name of the model of a lobe with one of its azimuths, both counted from 0."""
    return f"shape_{shape}_lobe_{lobe}"


def contents(family: Family) -> str:
    """The text of family.txt."""
    data = family.data
    lines = [
        f"hairlut-family {VERSION}",
        f"mirrored {int(data.mirrored)}",
        f"theta_r {_numbers(data.at[0].theta_r)}",
    ]
    for o, offset in enumerate(data.offset):
        lines.append(f"offset {offset:.9g}")
        for k in range(family.theta.shape[1]):
            lines.append(f"lobe {model_name(family.shape[o], k)} {_numbers(family.weight[o, :, k])}")
            lines.append(f"turn {_numbers(family.turn[o, :, k])}")
    return "\n".join(lines) + "\n"


def _numbers(values) -> str:
    return " ".join(f"{v:.9g}" for v in values)


def _npz(family: Family, theta: Array, phi: Array) -> bytes:
    one = family.data.at[0]
    lobes = {
        DIRECT_THETA: (one.theta_edges, one.theta_r, theta),
        DIRECT_PHI: (one.phi_edges, one.theta_r, phi),
        MULTIPLE_THETA: (np.array([-HALF_PI, HALF_PI]), np.zeros(1), np.ones((1, 1))),
    }
    arrays = {
        f"{name}.{part}": values
        for name, lobe in lobes.items()
        for part, values in zip(("edges", "theta_r", "mass"), lobe, strict=True)
    }
    file = BytesIO()
    np.savez_compressed(file, azimuth=np.array(DIFFERENCE), **arrays)
    return file.getvalue()


def text(family: Family) -> str:
    """The fit for a terminal."""
    data = family.data
    at, between = family.variance(), family.variance_between()
    lines = [
        f"{len(data.offset)} offsets from {data.offset[0]:.4g} to {data.offset[-1]:.4g}"
        + (", the other half of the fibre their mirror image" if data.mirrored else "")
        + f"; {family.theta.shape[1]} lobes, each with {len(family.phi)} of azimuth",
        "",
        "relative variance of drawing this data, the offset known (0 is perfect, 1 costs twice the samples):",
        "at the offsets, and drawn as if an offset were not there: its neighbours lie twice as far apart",
        f"{'theta_r [deg]':>14} {'at offsets':>10} {'neighbours':>10}",
    ]
    angles = [f"{angle:14.4g}" for angle in np.degrees(data.at[0].theta_r)]
    rows = zip([*angles, f"{'all rows':>14}"], [*at, at.mean()], [*between, between.mean()], strict=True)
    return "\n".join([*lines, *(f"{angle} {a:10.4f} {b:10.4f}" for angle, a, b in rows)])
