# SPDX-License-Identifier: BSD-3-Clause
"""A model in TOML: Gaussians as numbers, one for each tabulated theta_r, or one number for all of them.

    azimuth = "difference"
    [direct_theta]
    theta_r_deg = [-60, 0, 60]
    sigma_rad = 0.29
    shift_deg = [-5, -3, 1]     # mean of theta_i + theta_r; mean_deg would be the mean of theta_i itself
    [direct_phi]                # likewise, and [multiple_theta], or lobes of other names
    [shares]                    # a number for each lobe, if they are not equal

Each angle's name ends in `_deg` or `_rad`. Between the numbers runs a monotone cubic, which does not
overshoot; outside them the nearest number stands. Keys of other names, and numbers that cannot be in their
name's unit, are refused: whoever really has such an angle gives it in the other unit.
"""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from .errors import HairlutError
from .lobes import DIFFERENCE, HALF_PI, space
from .text import read_text

UNITS = {"deg": np.pi / 180, "rad": 1.0}
KEYS = ("theta_r", "sigma", "mean", "shift")
EXPECTED = "expected theta_r_deg, sigma_deg and either mean_deg or shift_deg (each ends in _deg or _rad)"
ROUNDED = 1e-4  # rad by which an angle written with few digits may exceed its range
NARROWEST = np.radians(0.5)
"""No lobe of a hair is narrower, rad: a sigma in degrees below it is one in radians."""


def read_document(path: Path) -> tuple[dict[str, dict], object, object]:
    """(tables by name, azimuth, shares or None) of the file; HairlutError for a key that is not known."""
    try:
        document = tomllib.loads(read_text(path, "a TOML file"))
    except tomllib.TOMLDecodeError as error:
        raise HairlutError(f"{path}: {error}") from None
    azimuth, shares = document.pop("azimuth", DIFFERENCE), document.pop("shares", None)
    for key, value in document.items():
        if not isinstance(value, dict):
            raise HairlutError(
                f"{path}: {key} is not known{_near(key, ('azimuth', 'shares'))}: expected azimuth, "
                "[shares], and a table [<lobe>_theta] or [<lobe>_phi] for each density"
            )
    return document, azimuth, shares


def curves(where: str, name: str, table: dict) -> tuple[Callable, Callable, str]:
    """(mean, sigma, formula): two functions of theta_r, and what they are in words."""
    try:
        domain = space(name)
    except HairlutError as error:
        raise HairlutError(f"{where}: {error}") from None
    values, keys = _values(where, table, domain["domain"])
    theta_r, sigma = np.atleast_1d(values["theta_r"]), values["sigma"]
    if not (np.diff(theta_r) > 0).all():
        raise HairlutError(f"{where}: {keys['theta_r']} must increase strictly")
    key = "shift" if "shift" in values else "mean"
    centre, width = (_through(f"{where}: {keys[k]}", theta_r, values[k]) for k in (key, "sigma"))
    for row in np.flatnonzero(np.atleast_1d(sigma) <= 0):
        raise HairlutError(f"{where} at theta_r = {np.degrees(theta_r[row]):.4g} deg: sigma must be above 0")
    mean, of = ((lambda t: centre(t) - t), " + theta_r") if key == "shift" else (centre, "")
    text = f"Gaussian of {domain['angle']}; mean{of} and sigma by monotone cubics"
    return mean, width, f"{text} through {theta_r.size} values of theta_r"


def _values(
    where: str, table: dict, domain: tuple[float, float]
) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """(angles in radians, keys as written), both by what they are ("sigma")."""
    values: dict[str, np.ndarray] = {}
    keys: dict[str, str] = {}
    for key, value in table.items():
        base = key.rpartition("_")[0]
        if base not in KEYS:
            known = [f"{k}_{unit}" for k in KEYS for unit in UNITS]
            raise HairlutError(f"{where}: {key} is not known{_near(key, known)}: {EXPECTED}")
        if base in values:
            raise HairlutError(f"{where}: {keys[base]} and {key} are both there: expected one of them")
        keys[base], values[base] = key, _radians(where, key, value)
        _check_unit(where, key, values[base], domain)
    if set(values) not in ({"theta_r", "sigma", "mean"}, {"theta_r", "sigma", "shift"}):
        raise HairlutError(f"{where}: contains {', '.join(table) or 'nothing'}: {EXPECTED}")
    return values, keys


def _near(key: str, known: Sequence[str]) -> str:
    near = difflib.get_close_matches(key, known, 1)
    return f", did you mean {near[0]}?" if near else ""


def _radians(where: str, key: str, value) -> np.ndarray:
    unit = UNITS.get(key.rpartition("_")[2])
    numbers = value if isinstance(value, list) else [value]
    if unit is None or not numbers or not all(map(_is_number, numbers)):
        raise HairlutError(
            f"{where}: {key}: expected a number or a list of numbers, and a name ending in _deg or _rad"
        )
    return np.array(value, float) * unit


def _is_number(value) -> bool:
    try:
        return type(value) in (int, float) and bool(np.isfinite(float(value)))
    except OverflowError:
        return False


def _check_unit(where: str, key: str, angle: np.ndarray, domain: tuple[float, float]) -> None:
    """HairlutError if an angle cannot be in the unit that its key names."""
    base, _, unit = key.rpartition("_")
    size = abs(angle) / UNITS[unit]
    if unit == "rad" and _are_degrees(base, angle, domain):
        raise HairlutError(
            f"{where}: {key} has {size.max():.6g}, too much for radians: in degrees? name it {base}_deg"
        )
    if unit == "deg" and _are_radians(base, angle):
        raise HairlutError(
            f"{where}: {key} has {size.max():.6g} at most, little for degrees: in radians? name it "
            f"{base}_rad, as may be an angle that is really so small"
        )
    largest = {"theta_r": 90, "sigma": np.inf, "mean": 360, "shift": 360}[base]
    if abs(angle).max() > np.radians(largest) + ROUNDED:
        raise HairlutError(f"{where}: {key} has {size.max():.6g}: expected at most {largest} degrees")


def _are_degrees(base: str, angle: np.ndarray, domain: tuple[float, float]) -> bool:
    """Whether angles that are said to be in radians have the numbers of degrees."""
    size, span = abs(angle), domain[1] - domain[0]
    if base == "sigma":
        return bool(size.min() > span / 2 or size.max() > span)
    return bool(size.max() > (HALF_PI if base == "theta_r" else 2 * np.pi) + ROUNDED)


def _are_radians(base: str, angle: np.ndarray) -> bool:
    """Whether angles that are said to be in degrees have the numbers of radians."""
    if base == "sigma":
        return bool(0 < angle.max() < NARROWEST)
    degrees = np.degrees(angle)
    wide = np.ptp(degrees) > HALF_PI / 4
    return base == "theta_r" and bool(wide and abs(degrees).max() <= HALF_PI + ROUNDED)


def _through(where: str, theta_r: np.ndarray, values: np.ndarray) -> Callable:
    """A monotone cubic through the values, which stand outside their range too."""
    if values.ndim == 0 or (values.shape == theta_r.shape and theta_r.size == 1):
        number = float(np.atleast_1d(values)[0])
        return lambda t: np.full_like(t, number, dtype=float)
    if values.shape != theta_r.shape:
        raise HairlutError(
            f"{where}: {values.size} numbers for {theta_r.size} theta_r: expected one each, or one for all"
        )
    from scipy.interpolate import PchipInterpolator  # slow to import

    cubic = PchipInterpolator(theta_r, values)
    return lambda t: cubic(np.clip(t, theta_r[0], theta_r[-1]))
