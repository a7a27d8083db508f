"""The lobes: equations (2) to (4) of the source text, in its two readings.

Every lobe is a density of one angle x given the viewer's inclination theta_r: x is the incident inclination
theta_i, or the relative azimuth phi. It is cut to its domain, not wrapped, and need not be normalised. All
angles are in radians.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

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

_INCLINATION = {"angle": "theta_i", "domain": (-HALF_PI, HALF_PI)}
SPACE = {
    DIRECT_THETA: _INCLINATION,
    DIRECT_PHI: {"angle": "phi", "domain": (0.0, 2 * np.pi)},
    MULTIPLE_THETA: _INCLINATION,
}
"""The angle of each table and the range of it that the table spans, rad."""


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
    """The three lobes of a hair: direct scattering is the product of the first two, eq. (1)."""

    name: str
    direct_theta: Lobe
    direct_phi: Lobe
    multiple_theta: Lobe

    @property
    def lobes(self) -> tuple[Lobe, Lobe, Lobe]:
        return self.direct_theta, self.direct_phi, self.multiple_theta


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
    return Model(
        name,
        gaussian(
            direct_theta,
            model=name,
            name=DIRECT_THETA,
            azimuth=NO_AZIMUTH,
            **SPACE[DIRECT_THETA],
            formula=f"Gaussian of theta_i; mean = {mean_text} - theta_r; sigma = 0.29",
        ),
        gaussian(
            _direct_phi,
            model=name,
            name=DIRECT_PHI,
            azimuth=azimuth,
            **SPACE[DIRECT_PHI],
            formula=f"Gaussian of phi = {relative} modulo 2 pi; mean = pi; sigma = theta_r^4 / 4 + 0.59",
        ),
        gaussian(
            _multiple_theta,
            model=name,
            name=MULTIPLE_THETA,
            azimuth=NO_AZIMUTH,
            **SPACE[MULTIPLE_THETA],
            formula="Gaussian of theta_i; mean = (33.5 sin(1.25 theta_r) - 1) * pi/180 - theta_r; "
            "sigma = theta_r^4 / 20 + 0.49",
        ),
    )


PRINTED = _model("printed", SUM, _printed_direct_theta, "(3 theta_r - 2 * pi/180)")
FITTED = _model("fitted", DIFFERENCE, _fitted_direct_theta, "(3 theta_r - 2) * pi/180")
MODELS = {model.name: model for model in (PRINTED, FITTED)}
