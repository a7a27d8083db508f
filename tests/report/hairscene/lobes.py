# SPDX-License-Identifier: BSD-3-Clause
"""The nested hair BSDF against the tables, by quadrature over the sphere: which lobe is met, which is missed.

Viewers are named by theta_r and by h = sin(phi_r), the place across the fibre that is hit. f is the
luminance of value times cosine, q a sampler's density, both per steradian; the relative variance of the
estimate of the albedo is integral(f^2/q) / integral(f)^2 - 1: the noise that is left when the light is
the same from everywhere.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from report.hairscene.luminance import luminance
from report.hairscene.nearfield import direction
from report.hairscene.samplers import Parameters
from report.hairscene.scene import light_hair
from report.hairscene.shares import with_shares

Array = NDArray[np.float64]

VIEWERS = [(theta, h) for theta in (0, 30, 60, 80) for h in (0.0, 0.5, 0.9)]  # theta_r in degrees
MODELS = ("printed", "fitted")


def _hair(**parameters: object) -> Parameters:
    return {**light_hair(), **parameters}


HAIRS = {
    "light hair of this page (0.5, 0.55)": _hair(),
    "rougher around the fibre (0.5, 0.8)": _hair(azimuthal_roughness=0.8),
    "smoother around the fibre (0.5, 0.3)": _hair(azimuthal_roughness=0.3),
    "smoother both ways, the engine's default (0.3, 0.3)": _hair(
        longitudinal_roughness=0.3, azimuthal_roughness=0.3
    ),
    "brown (0.5, 0.55), eumelanin 1.3": _hair(eumelanin=1.3, pheomelanin=0.2),
    "scales tilted the other way (0.5, 0.55), -2 degrees": _hair(scale_tilt=-2.0),
}


@dataclass(frozen=True)
class Sphere:
    """Midpoints of a grid of (theta, phi), phi measured from `phi_zero`."""

    rows: int = 90
    columns: int = 120
    phi_zero: float = 0.0
    theta: Array = field(init=False)
    phi: Array = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "theta", (np.arange(self.rows) + 0.5) / self.rows * np.pi - np.pi / 2)
        object.__setattr__(self, "phi", (np.arange(self.columns) + 0.5) / self.columns * 2 * np.pi)

    @property
    def solid_angle(self) -> Array:
        """Steradians of each cell (rows, 1)."""
        return np.cos(self.theta)[:, None] * (np.pi / self.rows) * (2 * np.pi / self.columns)

    def tabulate(self, mi: Any, function: Callable[[Any], float]) -> Array:
        """function(wo) at every midpoint (rows, columns)."""
        phi = (self.phi + self.phi_zero).tolist()
        return np.array([[function(direction(mi, t, p)) for p in phi] for t in self.theta.tolist()])


def _interaction(mi: Any, theta_r: float, h: float) -> Any:
    si = mi.SurfaceInteraction3f()
    si.wi = direction(mi, math.radians(theta_r), math.asin(h))
    return si


def _values(mi: Any, bsdf: Any, si: Any, sphere: Sphere) -> Array:
    context = mi.BSDFContext()
    return sphere.tabulate(mi, lambda wo: float(luminance(bsdf.eval(context, si, wo))))


def _density(mi: Any, bsdf: Any, si: Any, sphere: Sphere) -> Array:
    context = mi.BSDFContext()
    return sphere.tabulate(mi, lambda wo: bsdf.pdf(context, si, wo))


def _plugin(mi: Any, hair: Parameters, **parameters: object) -> Any:
    return mi.load_dict({"type": "hairlut", "nested": hair, **parameters})


def _lone(mi: Any, hair: Parameters, model: str, direct: float) -> Any:
    """The plugin with the direct lobe (1) or the multiple lobe (0) of a model alone."""
    with TemporaryDirectory() as folder:
        return _plugin(mi, hair, model=str(with_shares(model, (direct, 1 - direct), Path(folder))))


def relative_variances(mi: Any, hair: Parameters, direct_shares: tuple[float, ...]) -> dict[str, float]:
    """Means over VIEWERS, weighted by the fibre's projected length, per sampler."""
    nested = mi.load_dict(hair)
    tables = {(model, lobe): _lone(mi, hair, model, lobe) for model in MODELS for lobe in (0, 1)}
    sphere, total, sums = Sphere(), 0.0, dict[str, float]()
    for theta, h in VIEWERS:
        si = _interaction(mi, theta, h)
        f = _values(mi, nested, si, sphere)
        q = {key: _density(mi, table, si, sphere) for key, table in tables.items()}
        densities = {"uniform": np.full_like(f, 0.25 / np.pi)}
        for model in MODELS:
            for w in direct_shares:
                densities[f"{model} {w:g}"] = w * q[model, 1] + (1 - w) * q[model, 0]
        weight = math.cos(math.radians(theta))
        total += weight
        for name, density in densities.items():
            ratio = (f**2 / density * sphere.solid_angle).sum() / (f * sphere.solid_angle).sum() ** 2
            sums[name] = sums.get(name, 0.0) + weight * (ratio - 1.0)
    return {name: value / total for name, value in sums.items()}


@dataclass(frozen=True)
class Marginals:
    """Densities per rad in theta_i (over all phi) and in phi_i - phi_r (over all theta), per curve."""

    theta: Array
    phi: Array
    by_theta: dict[str, Array]
    by_phi: dict[str, Array]


def marginals(mi: Any, theta_r: float, places: tuple[float, ...]) -> Marginals:
    """The light hair's value, averaged over the `places` h, beside both lobes of `fitted`."""
    hair = light_hair()
    curves = {"nested BSDF": mi.load_dict(hair)}
    curves |= {name: _lone(mi, hair, "fitted", w) for name, w in (("direct lobe", 1), ("multiple lobe", 0))}
    curves["both, 0.5 each"] = _plugin(mi, hair, model="fitted")
    by_theta, by_phi = {}, {}
    for name, bsdf in curves.items():
        tabulate = _values if name == "nested BSDF" else _density
        mass = np.zeros(())
        for h in places:
            sphere = Sphere(phi_zero=math.asin(h))
            mass = mass + tabulate(mi, bsdf, _interaction(mi, theta_r, h), sphere) * sphere.solid_angle
        mass = mass / mass.sum()
        by_theta[name] = mass.sum(axis=1) * sphere.rows / np.pi
        by_phi[name] = mass.sum(axis=0) * sphere.columns / (2 * np.pi)
    return Marginals(sphere.theta, sphere.phi, by_theta, by_phi)


def second_moment_by_side(mi: Any) -> dict[str, tuple[float, float]]:
    """Shares of the far side, |phi_i - phi_r - pi| < pi/2: (of f, of f^2/q), q of `fitted`, per h."""
    hair = light_hair()
    nested, table = mi.load_dict(hair), _plugin(mi, hair, model="fitted")
    shares = {}
    for h in (0.0, 0.5, 0.9):
        sphere = Sphere(phi_zero=math.asin(h))
        si = _interaction(mi, 0.0, h)
        f = _values(mi, nested, si, sphere)
        far = np.broadcast_to(np.abs(sphere.phi - np.pi) < np.pi / 2, f.shape)
        moment = f**2 / _density(mi, table, si, sphere) * sphere.solid_angle
        mass = f * sphere.solid_angle
        shares[f"{h:g}"] = float(mass[far].sum() / mass.sum()), float(moment[far].sum() / moment.sum())
    return shares


def draws_on_the_normal_plane(mi: Any, count: int = 20_000) -> dict[str, float]:
    """Share of the nested BSDF's own draws at theta_i = 0 exactly, where no density has mass; by theta_r."""
    nested, context = mi.load_dict(light_hair()), mi.BSDFContext()
    shares = {}
    for theta_r in (0, 30, 60):
        si = _interaction(mi, theta_r, 0.5)
        numbers = np.random.default_rng(1).random((count, 3)).tolist()
        drawn = (nested.sample(context, si, u, mi.Point2f(v, w))[0].wo.y for u, v, w in numbers)
        shares[f"{theta_r}"] = sum(y == 0.0 for y in drawn) / count
    return shares
