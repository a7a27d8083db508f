# SPDX-License-Identifier: BSD-3-Clause
"""The lobes: equations (2) to (4) of the source text, in its two readings.

The source text is the chapter "Probability density function" of J. Lemein's thesis draft on importance
sampling for dual scattering (Utrecht University, repository jlemein/hair-rendering-thesis). `direct` is the
light that one fibre scatters towards the viewer, R, TT and TRT together; `multiple` is light that passed
through other fibres before (Zinke et al. 2008). derivation.md beside this file prints the equations; the
README compares the readings.

Every lobe is a density of one angle x given the viewer's inclination theta_r: x is the incident inclination
theta_i, or the relative azimuth phi. It is cut to its domain, not wrapped, and need not be normalised. All
angles are in radians.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from .errors import HairlutError

HALF_PI = np.pi / 2
DEGREE = np.pi / 180

Array = np.ndarray
LogDensity = Callable[[Array, Array], Array]
Moments = Callable[[Array], tuple[Array, Array]]
Breakpoints = tuple[float, ...] | Callable[[Array], Array]

TABLES = DIRECT_THETA, DIRECT_PHI, MULTIPLE_THETA = "direct_theta", "direct_phi", "multiple_theta"
LOBES = DIRECT, MULTIPLE = "direct", "multiple"
AZIMUTHS = DIFFERENCE, SUM = "difference", "sum"  # what phi is: phi_i - phi_r, phi_i + phi_r
NO_AZIMUTH = "none"
NO_FORMULA = "fitted to a hair's BSDF by hairlut fit"
"""The formula of a density that has none: masses of cells, which verify.py cannot compute again."""

MAX_LOBES = 16
LOBE_NAME = r"[a-z][a-z0-9_]{0,30}"
_SPACE = {
    "theta": {"angle": "theta_i", "domain": (-HALF_PI, HALF_PI)},
    "phi": {"angle": "phi", "domain": (0.0, 2 * np.pi)},
}


def space(table: str) -> dict:
    """The angle of a table named <lobe>_theta or <lobe>_phi and the domain that it spans, rad, by the names
    of Lobe's fields; HairlutError for any other name."""
    lobe, _, kind = table.rpartition("_")
    if kind not in _SPACE or not re.fullmatch(LOBE_NAME, lobe):
        raise HairlutError(
            f"table {table!r} is not known: expected <lobe>_theta or <lobe>_phi, with a lobe's name of up to "
            "31 of a-z, 0-9 and _, a letter first"
        )
    return _SPACE[kind]


@dataclass(frozen=True)
class Lobe:
    """One density to be tabulated.

    model, name     "printed", "direct_theta": the table goes to <model>/<name>.exr; lobes that differ only
                    in their model are equal
    angle           what x is: "theta_i" or "phi"
    azimuth         what phi is: "sum" (phi_i + phi_r), "difference" (phi_i - phi_r); "none" for theta_i
    domain          (low, high) of x
    log_density     log_density(x, theta_r), broadcasting; -inf where the density is zero; free in a constant
    formula         the equations as text, for the header of the texture
    theta_r_range   range of theta_r that the rows of a table span
    breakpoints     where the density jumps, or has a spike narrower than 1/2000 of the domain; where these
                    places move with theta_r (R,), a function that returns them as (R, B)
    moments         (mean, sigma) at theta_r if the lobe is a Gaussian; for the closed form, not for the bake
    own_height      for a lobe given as rows, the fewest rows of a table that include them: between its rows
                    such a lobe bends, and only these tables bend with it
    exact           exact(theta_r (R,)) -> what exact.Exact is, if the lobe knows its own integral
    """

    model: str = field(compare=False)
    name: str
    angle: str
    azimuth: str
    domain: tuple[float, float]
    log_density: LogDensity
    formula: str
    theta_r_range: tuple[float, float] = (-HALF_PI, HALF_PI)
    breakpoints: Breakpoints = ()
    moments: Moments | None = None
    own_height: int = 0
    exact: Callable | None = None


@dataclass(frozen=True)
class Model:
    """The densities of a hair's lobes, each an attribute by its table's name: model.direct_theta.

    lobes   the densities, of different names, at least one of them a <lobe>_theta
    shares  each lobe's share, in any unit; None: equal shares
    """

    name: str
    lobes: tuple[Lobe, ...]
    shares: tuple[float, ...] | None = None

    def __getattr__(self, name: str) -> Lobe:
        for lobe in self.__dict__.get("lobes", ()):
            if lobe.name == name:
                return lobe
        raise AttributeError(f"a model without a density {name}")

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the lobes, in order: of their inclination tables."""
        return tuple(lobe.name.removesuffix("_theta") for lobe in self.lobes if lobe.angle == "theta_i")


def _gaussian_log_density(moments: Moments, x: Array, theta_r: Array) -> Array:
    mean, sigma = moments(theta_r)
    z = (x - mean) / sigma
    return -0.5 * z * z - np.log(sigma * np.sqrt(2 * np.pi))


def gaussian(moments: Moments, **fields) -> Lobe:
    """A lobe that is a normal density in x, given the mean and sigma of x as functions of theta_r."""
    return Lobe(log_density=partial(_gaussian_log_density, moments), moments=moments, **fields)


def _printed_direct_theta(theta_r: Array) -> tuple[Array, Array]:
    """Eq. (2), "3 theta_r" taken as an angle."""
    mu = 3 * theta_r - 2 * DEGREE
    return mu - theta_r, np.full_like(theta_r, 0.29)


def _fitted_direct_theta(theta_r: Array) -> tuple[Array, Array]:
    """Eq. (2), "3 theta_r - 2 deg" in degrees with theta_r in radians, as the measured lobes have it."""
    mu = (3 * theta_r - 2) * DEGREE
    return mu - theta_r, np.full_like(theta_r, 0.29)


def _direct_phi(theta_r: Array) -> tuple[Array, Array]:
    """Eq. (3), of the relative azimuth."""
    return np.full_like(theta_r, np.pi), theta_r**4 / 4 + 0.59


def _multiple_theta(theta_r: Array) -> tuple[Array, Array]:
    """Eq. (4), 33.5 in degrees."""
    mu = (33.5 * np.sin(1.25 * theta_r) - 1) * DEGREE
    return mu - theta_r, theta_r**4 / 20 + 0.49


def _model(name: str, azimuth: str, direct_theta: Moments, mean_text: str) -> Model:
    relative = {SUM: "phi_i + phi_r", DIFFERENCE: "phi_i - phi_r"}[azimuth]
    densities = (
        gaussian(
            direct_theta,
            model=name,
            name=DIRECT_THETA,
            azimuth=NO_AZIMUTH,
            **space(DIRECT_THETA),
            formula=f"Gaussian of theta_i; mean = {mean_text} - theta_r; sigma = 0.29",
        ),
        gaussian(
            _direct_phi,
            model=name,
            name=DIRECT_PHI,
            azimuth=azimuth,
            **space(DIRECT_PHI),
            formula=f"Gaussian of phi = {relative} modulo 2 pi; mean = pi; sigma = theta_r^4 / 4 + 0.59",
        ),
        gaussian(
            _multiple_theta,
            model=name,
            name=MULTIPLE_THETA,
            azimuth=NO_AZIMUTH,
            **space(MULTIPLE_THETA),
            formula="Gaussian of theta_i; mean = (33.5 sin(1.25 theta_r) - 1) * pi/180 - theta_r; "
            "sigma = theta_r^4 / 20 + 0.49",
        ),
    )
    return Model(name, densities)


PRINTED = _model("printed", SUM, _printed_direct_theta, "(3 theta_r - 2 * pi/180)")
FITTED = _model("fitted", DIFFERENCE, _fitted_direct_theta, "(3 theta_r - 2) * pi/180")
MODELS = {model.name: model for model in (PRINTED, FITTED)}
