# SPDX-License-Identifier: BSD-3-Clause
"""Checks of a lobe from a model file, before it is baked; an error names the lobe, theta_r and the reason."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from .errors import HairlutError
from .exact import exact_at
from .lobes import Array, Lobe
from .userfile import line_of, reason

ANGLES = 37  # odd: the middle one is theta_r = 0
POINTS = 513
JUMP = 1e-3
HALVINGS = 48
TURN = 2 * np.pi
VECTORISE = "the density is not vectorised: use NumPy's functions (np.exp, np.where), which take arrays"
SCALAR = ("only length-1", "only 0-dim", "truth value of an array", "must be real number", "broadcast")
"""What NumPy and the standard library say of a function that cannot take arrays."""


def check_lobe(lobe: Lobe, where: str) -> None:
    """HairlutError naming the lobe, theta_r and the reason, if the lobe's density cannot be tabulated."""
    theta_r = np.linspace(*lobe.theta_r_range, ANGLES)
    x = _points(lobe)
    values = _evaluate(lobe, where, x[None, :], theta_r[:, None])
    for angle, row in zip(theta_r, values, strict=True):
        _check_row(lobe, f"{where}: {lobe.name} at theta_r = {_both(angle)}", x, angle, row)
    _check_elementwise(lobe, where, x, theta_r, values)


def check_units(lobe: Lobe, where: str) -> None:
    """HairlutError for a Gaussian, or breakpoints, that have the numbers of degrees instead of radians."""
    theta_r = np.linspace(*lobe.theta_r_range, ANGLES)
    low, high = lobe.domain
    if not callable(lobe.breakpoints):
        for point in lobe.breakpoints:
            if not low - TURN <= point <= high + TURN:
                raise HairlutError(
                    f"{where}: {lobe.name}: a breakpoint at {point:.6g} rad lies far outside [{low:.6g}, "
                    f"{high:.6g}]: in degrees? give np.radians({point:.6g})"
                )
    if lobe.moments is None:
        return
    with _named(lobe, where), np.errstate(all="ignore"):
        mean, sigma = (np.broadcast_to(part, theta_r.shape) for part in lobe.moments(theta_r))
    central = theta_r == theta_r[ANGLES // 2]
    for what, values, wrong in (
        ("sigma", sigma, ~(sigma > 0)),
        ("sigma", sigma, (sigma > high - low) | (central & (sigma > (high - low) / 2))),
        ("mean", mean, ~np.isfinite(mean)),
        ("mean", mean, (abs(mean) > TURN) | (central & (lobe.angle == "theta_i") & (abs(mean) > high))),
    ):
        if wrong.any():
            j = int(np.argmax(wrong))
            raise HairlutError(
                f"{where}: {lobe.name} at theta_r = {_both(theta_r[j])}: {what} is {values[j]:.6g} rad"
                f"{_remedy(lobe, what, values[j])}"
            )


def _remedy(lobe: Lobe, what: str, value: float) -> str:
    if not np.isfinite(value) or (what == "sigma" and not value > 0):
        return ": expected a finite number" + " above 0" * (what == "sigma")
    flat = "; give a lobe that is really so flat by its density()" if what == "sigma" else ""
    low, high = lobe.domain
    return f", but {lobe.angle} runs from {low:.4g} to {high:.4g} rad: in degrees? give np.radians(...){flat}"


def find_jump(lobe: Lobe, theta_r: float) -> float | None:
    """Where the density at theta_r jumps by more than a thousandth of its maximum, if it does.

    Each of many intervals is halved towards its steeper half until its ends are neighbouring floats. Where a
    density is merely narrow, these differ little.
    """
    angle = np.array([theta_r])
    edges = np.linspace(*lobe.domain, POINTS)
    low, high = edges[:-1], edges[1:]
    top = -np.inf
    for _ in range(HALVINGS):
        values = lobe.log_density(np.stack([low, (low + high) / 2, high]), angle)
        top = max(top, values.max())
        step = abs(np.diff(np.exp(values - top), axis=0))
        upper = step[1] > step[0]
        middle = (low + high) / 2
        low, high = np.where(upper, middle, low), np.where(upper, high, middle)
    left = abs(np.diff(np.exp(lobe.log_density(np.stack([low, high]), angle) - top), axis=0))[0]
    return float(high[np.argmax(left)]) if left.max() > JUMP else None


def middle_half(lobe: Lobe, theta_r: Array) -> Array:
    """(R,) widths, rad, of the middle half of the density at theta_r (R,)."""
    ends = exact_at(lobe, theta_r).quantiles(np.full(2, 0.25), np.array([False, True]))
    return np.ptp(ends, axis=1)


def _points(lobe: Lobe) -> Array:
    """Points inside the domain, off its ends and its middle, where a formula may have a removable hole."""
    low, high = lobe.domain
    return low + (high - low) * (np.arange(POINTS) + 0.37) / POINTS


def _both(theta_r: float) -> str:
    return f"{np.degrees(theta_r):.4g} deg ({theta_r:.6g} rad)"


@contextmanager
def _named(lobe: Lobe, where: str) -> Iterator[None]:
    """Turns whatever the user's function does wrong into a HairlutError naming the lobe and the line."""
    try:
        yield
    except (HairlutError, KeyboardInterrupt):
        raise
    except BaseException as error:
        remedy = f": {VECTORISE}" if any(sign in str(error) for sign in SCALAR) else ""
        raise HairlutError(f"{where}{line_of(error, where)}: {lobe.name}: {reason(error)}{remedy}") from None


def _evaluate(lobe: Lobe, where: str, x: Array, theta_r: Array) -> Array:
    shape = np.broadcast_shapes(np.shape(x), np.shape(theta_r))
    with _named(lobe, where), np.errstate(all="ignore"):
        values = np.asarray(lobe.log_density(x, theta_r), float)
    try:
        return np.broadcast_to(values, shape)
    except ValueError:
        raise HairlutError(
            f"{where}: {lobe.name}: a result of shape {values.shape} for arrays of shape {shape}: {VECTORISE}"
        ) from None


def _check_row(lobe: Lobe, place: str, x: Array, angle: float, row: Array) -> None:
    if np.isnan(row).any():
        k = int(np.argmax(np.isnan(row)))
        given = getattr(lobe.log_density, "density", None)
        value = np.broadcast_to(given(x[k : k + 1], np.array([angle])), (1,))[0] if given else np.nan
        found = f"negative density {value:.6g}" if value < 0 else "the density is NaN"
        raise HairlutError(f"{place}: {found} at x = {x[k]:.6g} rad")
    if (row == np.inf).any():
        raise HairlutError(f"{place}: the density is infinite at x = {x[int(np.argmax(row))]:.6g} rad")
    if (row == -np.inf).all() and not _mass_near_breakpoints(lobe, angle):
        raise HairlutError(f"{place}: no mass in the domain [{lobe.domain[0]:.6g}, {lobe.domain[1]:.6g}] rad")


def _mass_near_breakpoints(lobe: Lobe, angle: float) -> bool:
    at = np.array([angle])
    points = np.ravel(lobe.breakpoints(at) if callable(lobe.breakpoints) else lobe.breakpoints)
    inside = points[(points > lobe.domain[0]) & (points < lobe.domain[1])]
    return inside.size > 0 and bool((lobe.log_density(inside, at) > -np.inf).any())


def _check_elementwise(lobe: Lobe, where: str, x: Array, theta_r: Array, values: Array) -> None:
    """HairlutError for a density that uses its whole array, say its maximum: a part of the array gives other
    values."""
    for j in (0, ANGLES // 3, ANGLES - 1):
        k = np.array([POINTS // 5, (2 * POINTS) // 3])
        part = _evaluate(lobe, where, x[k], theta_r[j : j + 1])
        whole = values[j, k]
        same = (part == whole) | np.isclose(part, whole, rtol=1e-9, atol=1e-9)
        if not same.all():
            raise HairlutError(
                f"{where}: {lobe.name} at theta_r = {_both(theta_r[j])}: the density is not vectorised: "
                f"log-density {whole[0]:.6g} at x = {x[k[0]]:.6g} in a long array, {part[0]:.6g} in a short: "
                "each element of the result must depend on its own x and theta_r alone"
            )
