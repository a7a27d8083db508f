# SPDX-License-Identifier: BSD-3-Clause
"""A small model over parameters of the hair, of random contents, for tests."""

from dataclasses import replace

import numpy as np

from hairlut.axes import Axis, Parameter, node_count
from hairlut.lobes import NO_FORMULA, Array
from hairlut.mixture import Mixture
from hairlut.model import BakedLobe, BakedModel
from hairlut.slopes import derived
from hairlut.table import Table
from hairlut.warp import Warp

PARAMETERS = (
    Parameter("beta_m", 0.1, 0.9, 0.3),
    Parameter("absorption", 0.0, 5.0, 0.5),
    Parameter("tilt", -4.0, 4.0, -1.0),
)
NODES = {
    "beta_m": np.array([0.1, 0.25, 0.9]),
    "absorption": np.array([0.0, 0.7, 1.5, 5.0]),
    "tilt": np.array([-4.0, 4.0]),
}
WIDTH, HEIGHT = 9, 5


def axes(*names: str) -> tuple[Axis, ...]:
    return tuple(Axis(name, NODES[name]) for name in names)


def table(name: str, depends: tuple[Axis, ...], random: np.random.Generator) -> Table:
    """A table of a random increasing row for each theta_r and node."""
    is_phi = name.endswith("_phi")
    domain = (0.0, 2 * np.pi) if is_phi else (-np.pi / 2, np.pi / 2)
    warp, rows = Warp("octaves", 2.0**-6), node_count(depends) * HEIGHT
    low, high = np.float32(domain).astype(float)
    steps = np.cumsum(random.uniform(0.2, 1.0, (rows, WIDTH - 1)), axis=1)
    texels = np.empty((rows, WIDTH), np.float32)
    texels[:, 0], texels[:, 1:] = low, low + (high - low) * steps / steps[:, -1:]
    texels[:, -1] = high
    slopes = derived(texels, warp.widths(WIDTH)) * random.uniform(0.8, 1.25, texels.shape)
    return Table(
        model="parametric",
        name=name,
        angle="phi" if is_phi else "theta_i",
        azimuth="difference" if is_phi else "none",
        domain=domain,
        theta_r_range=(-np.pi / 2, np.pi / 2),
        parameters=NO_FORMULA,
        warp=warp,
        texels=texels,
        slopes=slopes.astype(np.float32),
        log_mass=np.zeros(rows),
        axes=depends,
    )


def model(seed: int = 5) -> BakedModel:
    """Three lobes: tables over none, one and two parameters, and a mixture over two of the three."""
    random = np.random.default_rng(seed)
    theta_r, offset = np.array([-1.5, 0.0, 0.25, 1.5]), np.array([0.0, 0.5, 1.0])
    depends = axes("beta_m", "absorption")
    shape = 3, *(len(axis.nodes) for axis in depends), len(theta_r), len(offset)
    share = random.uniform(0.1, 1.0, shape).astype(np.float32).astype(float)
    turn = random.uniform(-4.0, 4.0, shape).astype(np.float32).astype(float)
    mixture = Mixture(("r", "tt", "rest"), theta_r, offset, share, turn, True, depends)
    wide = table("r_theta", axes("tilt"), random)
    narrow = table("tt_theta", axes("absorption", "beta_m"), random)
    lobes = (
        BakedLobe("r", wide, table("r_phi", axes("beta_m", "tilt"), random)),
        BakedLobe("tt", narrow, replace(table("tt_phi", (), random), azimuth="sum")),
        BakedLobe("rest", wide, None),
    )
    return BakedModel("parametric", lobes, mixture, {}, PARAMETERS)


def values(count: int, seed: int = 6) -> dict[str, Array]:
    """Random values of every parameter, some beyond its range."""
    random = np.random.default_rng(seed)
    return {
        p.name: random.uniform(p.least - 0.1 * (p.most - p.least), p.most + 0.1 * (p.most - p.least), count)
        for p in PARAMETERS
    }
