# SPDX-License-Identifier: BSD-3-Clause
"""Models that the shaders are compared on: analytic lobes tabulated at many shapes, and mixtures of them."""

import functools
import itertools
from dataclasses import dataclass, field

import numpy as np

from hairlut.axes import Axis, Parameter
from hairlut.mixture import Mixture, constant
from hairlut.model import BakedLobe, BakedModel
from hairlut.slopes import derived
from hairlut.table import Table
from hairlut.warp import Warp

HALF_PI = np.pi / 2


@dataclass(frozen=True)
class Sheet:
    """What a reader needs of a table: as hairlut.table.Table, of an analytic lobe."""

    texels: np.ndarray
    slopes: np.ndarray
    warp: Warp
    domain: tuple[float, float]
    theta_r_range: tuple[float, float]
    azimuth: str = "none"
    axes: tuple = ()

    @property
    def height(self) -> int:
        return self.texels.shape[0]

    @property
    def width(self) -> int:
        return self.texels.shape[1]


@dataclass(frozen=True)
class SheetLobe:
    name: str
    theta: Sheet
    phi: Sheet | None


@dataclass(frozen=True)
class SheetModel:
    name: str
    lobes: tuple[SheetLobe, ...]
    mixture: Mixture = field(repr=False)
    parameters: tuple = ()


def logistic(width: int, height: int, warp: str, domain, mean, scale: float, azimuth: str = "none") -> Sheet:
    """Quantiles of a logistic distribution trimmed to the domain; mean: a function of theta_r."""
    theta_r = np.linspace(-HALF_PI, HALF_PI, height)[:, None]
    rule = Warp.parse(warp)
    low, high = np.float32(domain).astype(float)
    at = mean(theta_r)
    cdf = [1 / (1 + np.exp(-(x - at) / scale)) for x in (low, high)]
    p = cdf[0] + rule.u(width) * (cdf[1] - cdf[0])
    with np.errstate(divide="ignore"):
        x = np.clip(at + scale * np.log(p / (1 - p)), low, high)
        slopes = (cdf[1] - cdf[0]) * scale / (p * (1 - p))
    x[:, 0], x[:, -1] = low, high
    texels = x.astype(np.float32)
    ends = derived(texels, rule.widths(width))
    slopes[:, [0, -1]] = ends[:, [0, -1]]
    return Sheet(texels, slopes.astype(np.float32), rule, (low, high), (-HALF_PI, HALF_PI), azimuth)


def theta(width: int, height: int, warp: str, tilt: float = 0.1, scale: float = 0.12) -> Sheet:
    return logistic(width, height, warp, (-HALF_PI, HALF_PI), lambda t: tilt - 0.8 * t, scale)


def phi(width: int, height: int, warp: str, azimuth: str, scale: float = 0.4) -> Sheet:
    return logistic(width, height, warp, (0, 2 * np.pi), lambda t: np.pi + 0.5 * np.sin(t), scale, azimuth)


OCTAVES = "octaves e=6.103515625e-05"


@functools.cache
def near_field() -> SheetModel:
    """Three lobes, of which two have the same theta table; a mirrored mixture with shares of 0 and turns that
    pass pi."""
    narrow = theta(44, 32, OCTAVES, scale=0.02)
    lobes = (
        SheetLobe("r", narrow, phi(33, 16, OCTAVES, "difference")),
        SheetLobe("tt", theta(24, 32, OCTAVES, -0.1), phi(28, 16, OCTAVES, "sum", 0.05)),
        SheetLobe("rest", narrow, None),
    )
    random = np.random.default_rng(3)
    share = random.random((3, 6, 5))
    share[0, 2:4] = 0
    share[1, :, 2] = 0
    share[:, 5] *= 7
    turn = random.uniform(-np.pi, np.pi, (3, 6, 5))
    nodes = np.array([-1.4, -0.7, 0.1, 0.2, 0.9, 1.5]), np.array([0.0, 0.3, 0.5, 0.9, 1.0])
    return SheetModel("near", lobes, Mixture(("r", "tt", "rest"), *nodes, share, turn, True))


@functools.cache
def sixteen() -> SheetModel:
    """As many lobes as there may be, of the smallest tables and the largest that are quick to make, over
    signed offsets."""
    tables = [
        (theta(4, 2, "octaves e=0.0001"), phi(130, 7, "octaves e=1.52587890625e-05", "sum")),
        (theta(9, 33, "uniform"), phi(9, 33, "uniform", "difference")),
        (theta(5, 3, OCTAVES), None),
        (theta(200, 5, OCTAVES), phi(6, 2, OCTAVES, "difference")),
    ]
    names = tuple(f"lobe_{k}" for k in range(16))
    lobes = tuple(SheetLobe(name, *tables[k % 4]) for k, name in enumerate(names))
    random = np.random.default_rng(4)
    nodes = np.zeros(1), np.linspace(-1, 1, 20)
    return SheetModel(
        "sixteen",
        lobes,
        Mixture(names, *nodes, random.random((16, 1, 20)), random.uniform(-9, 9, (16, 1, 20))),
    )


@functools.cache
def single() -> SheetModel:
    """One lobe, and one node on every axis."""
    lobe = SheetLobe("only", theta(64, 64, OCTAVES, 0.3, 0.3), phi(64, 64, OCTAVES, "difference", 1.0))
    return SheetModel("single", (lobe,), constant(("only",)))


PARAMETERS = (
    Parameter("beta_m", 0.02, 0.6, 0.2),
    Parameter("beta_n", 0.1, 0.9, 0.5),
    Parameter("absorption", 0.0, 50.0, 3.0),
    Parameter("tilt", -0.2, 0.3, 0.0),
    Parameter("unused", -1e20, 1e20, 7.0),
    Parameter("weight", -3.0, -1.0, -3.0),
)
NODES = {
    "beta_m": [0.02, 0.05, 0.06, 0.2, 0.45, 0.6],
    "beta_n": [0.1, 0.2, 0.5, 0.9],
    "absorption": [0.0, 1.0, 50.0],
    "tilt": [-0.2, 0.3],
    "weight": [-3.0, -2.9, -2.0, -1.5, -1.0],
}
SPREAD = {"beta_m": 0.3, "beta_n": 0.5, "absorption": 0.002, "weight": 0.1}


def varying(name: str, names: tuple[str, ...], make) -> Table:
    """A table of model "strands" that depends on these parameters: make(scale, tilt) at each node."""
    axes = tuple(Axis(each, np.array(NODES[each])) for each in names)
    sheets = []
    for node in itertools.product(*(axis.nodes for axis in axes)):
        values = dict(zip(names, node, strict=True))
        tilt = values.pop("tilt", 0.0)
        sheets.append(make(0.02 + sum(SPREAD[each] * abs(value) for each, value in values.items()), tilt))
    first = sheets[0]
    return Table(
        model="strands",
        name=name,
        angle="theta_i" if first.azimuth == "none" else "phi",
        azimuth=first.azimuth,
        domain=first.domain,
        theta_r_range=first.theta_r_range,
        parameters="",
        warp=first.warp,
        texels=np.concatenate([sheet.texels for sheet in sheets]),
        slopes=np.concatenate([sheet.slopes for sheet in sheets]),
        log_mass=np.zeros(sum(sheet.height for sheet in sheets)),
        axes=axes,
    )


@functools.cache
def strands() -> BakedModel:
    """Lobes that depend on none, one, two and four of six parameters, on one of which nothing does; a mixture
    over three, whose turns pass pi."""
    one = varying("one_theta", ("beta_m",), lambda scale, _: theta(30, 8, OCTAVES, scale=scale))
    two = varying("two_theta", ("tilt", "beta_m"), lambda scale, tilt: theta(17, 9, OCTAVES, tilt, scale))
    none = varying("none_theta", (), lambda *_: theta(9, 5, OCTAVES))
    around = varying(
        "around_phi", ("beta_n",), lambda scale, _: phi(33, 6, "uniform", "difference", 3 * scale)
    )
    four = ("absorption", "weight", "tilt", "beta_n")
    four_axes = varying("four_phi", four, lambda scale, _: phi(12, 3, OCTAVES, "sum", scale))
    lobes = (
        BakedLobe("r", one, around),
        BakedLobe("tt", two, four_axes),
        BakedLobe("trt", none, around),
        BakedLobe("rest", one, None),
    )
    axes = tuple(Axis(name, np.array(NODES[name])) for name in ("beta_n", "absorption", "weight"))
    random = np.random.default_rng(6)
    shape = len(lobes), *(len(axis.nodes) for axis in axes), 4, 3
    share = random.random(shape) * random.uniform(0.1, 9, shape[1:])
    share[1, 2] = 0
    mixture = Mixture(
        tuple(lobe.name for lobe in lobes),
        np.array([-1.2, 0.1, 0.5, 1.4]),
        np.array([0.0, 0.4, 1.0]),
        share,
        random.uniform(-7, 7, shape),
        True,
        axes,
    )
    return BakedModel("strands", lobes, mixture, {}, PARAMETERS)


MODELS = {"near field": near_field, "sixteen lobes": sixteen, "one lobe": single, "strands": strands}
