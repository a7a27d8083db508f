# SPDX-License-Identifier: BSD-3-Clause
"""Scattering data from a file: the values of a grid, or draws from the scattering. Which of them is a rule.

Values of a coordinate that lie within TOLERANCE of each other are one. Let P be the product of the numbers of
different coordinates, over theta_r, theta_i and phi, and D the number of different points. The data are a

    grid     where D > P / 2, in the file or around most of its theta_r: theta_i and phi repeat there, which
             those of draws do not. Each of the P points must be there, and once.
    draws    otherwise; value is the weight of each, and without a column value all weigh the same.

A column offset is one more coordinate of both. Arrays of an npz file whose value has an axis for each
coordinate are always a grid.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import HairlutError
from ..lobes import HALF_PI, Array
from .columns import ROUNDED, TWO_PI, Columns, read_columns

COORDINATES = ("theta_r", "theta_i", "phi")
TOLERANCE = 1e-6
"""Coordinates closer than this, rad (or radii for an offset), are one."""

SAME_VALUE = 1e-5
"""Relative difference of two values at phi = 0 and 2 pi that are still one."""

LEAST_DRAWS = 64
LEAST_THETA_I = 4
MOST_BEYOND = 0.01  # share of draws whose theta_i lies beyond 90 deg: what a Gaussian loses there


@dataclass(frozen=True)
class Grid:
    """theta_r (J,), theta_i (n,), phi (m,): increasing, rad, phi in [0, 2 pi) and without a gap of more than
    a quarter of the circle. value (J, n, m): finite, not negative, above 0 somewhere for each theta_r.

    Where the data depend on it, offset (N,): increasing, in [-1, 1], and then value is (N, J, n, m).
    """

    theta_r: Array
    theta_i: Array
    phi: Array
    value: Array
    offset: Array | None = None

    def __str__(self) -> str:
        names = COORDINATES if self.offset is None else ("offset", *COORDINATES)
        return f"grid of {_product(self.value.shape)} ({_product(names)})"


@dataclass(frozen=True)
class Draws:
    """theta_r, theta_i, phi, weight, and offset where the data depend on it: all (N,), rad, phi in [0, 2 pi),
    weights finite and not negative; at least LEAST_DRAWS weigh more than 0. note: what was left out."""

    theta_r: Array
    theta_i: Array
    phi: Array
    weight: Array
    offset: Array | None = None
    note: str = ""

    def __str__(self) -> str:
        weighed = " weighed by value" if np.ptp(self.weight) > 0 else ""
        return f"{len(self.weight):,} draws{weighed}{self.note}"


def read(path: Path) -> Grid | Draws:
    """The data in a CSV or npz file; HairlutError naming the file, the place and what was expected."""
    path = Path(path)
    columns = read_columns(path)
    try:
        names = ("offset", *COORDINATES) if "offset" in columns else COORDINATES
        if "value" in columns and columns.by_base["value"].values.ndim > 1:
            return checked_grid(**{name: columns.radians(name) for name in (*names, "value")})
        return _of_rows(columns, names)
    except HairlutError as error:
        raise HairlutError(f"{path}: {error}") from None


def checked_grid(theta_r, theta_i, phi, value, offset=None) -> Grid:
    """The grid of value (J, n, m), or (N, J, n, m) with offset (N,), at increasing points; HairlutError
    where it is none. phi may be any one period, or one whose ends are the same."""
    theta_r, theta_i, phi, value = (np.asarray(a, float) for a in (theta_r, theta_i, phi, value))
    axes = {"theta_r": theta_r, "theta_i": theta_i, "phi": phi}
    if offset is not None:
        axes = {"offset": np.asarray(offset, float), **axes}
    _check_shape(axes, value)
    for name in axes:
        if name != "phi":
            _check_increasing(name, axes[name])
    _check_axes(axes)
    _check_values(value)
    phi, value = _one_period(phi, value)
    _check_circle(phi)
    _check_light(theta_r, axes.get("offset"), value)
    theta_r, theta_i = (np.clip(angle, -HALF_PI, HALF_PI) for angle in (theta_r, theta_i))
    return Grid(theta_r, theta_i, phi, value, axes.get("offset"))


# ---- rows of columns


def _of_rows(columns: Columns, names: tuple[str, ...]) -> Grid | Draws:
    _check_lengths(columns)
    axes, places = zip(*(_distinct(columns.radians(name)) for name in names), strict=True)
    return _grid(columns, names, axes, places) if _is_grid(columns, axes, places) else _draws(columns)


def _check_lengths(columns: Columns) -> None:
    shapes = {column.name: column.values.shape for column in columns.by_base.values()}
    if len(set(shapes.values())) > 1 or any(len(shape) != 1 for shape in shapes.values()):
        found = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
        raise HairlutError(
            f"arrays of the shapes {found}: expected value to have an axis for each of theta_r, theta_i and "
            "phi (offset first, if there is one), or one row for each draw, as many in each array"
        )


def _distinct(values: Array) -> tuple[Array, Array]:
    """(points, place): the different values, increasing, and which of them each value is."""
    different, place = np.unique(values, return_inverse=True)
    start = np.append(True, np.diff(different) > TOLERANCE)
    first = np.flatnonzero(start)
    last = np.append(first[1:], len(different)) - 1
    for a, b in zip(first, last, strict=True):  # of a long chain of near values, a new one at each TOLERANCE
        if different[b] - different[a] > TOLERANCE:
            chain = different[a : b + 1].tolist()
            k = 0
            while (k := bisect_right(chain, chain[k] + TOLERANCE, k)) < len(chain):
                start[a + k] = True
    return different[start], (np.cumsum(start) - 1)[place]


def _is_grid(columns: Columns, axes, places) -> bool:
    count = places[0].size
    if count < 2:
        return False
    product = np.prod([float(axis.size) for axis in axes])
    whole = product < 2 * count and product < 2 * _different_points(axes, places)
    if "value" not in columns:
        return whole and count == _different_points(axes, places) and min(a.size for a in axes[-2:]) > 1
    return whole or _mostly_grids(axes, places)


def _different_points(axes, places) -> int:
    return np.unique(np.ravel_multi_index(places, tuple(a.size for a in axes))).size


def _mostly_grids(axes, places) -> bool:
    """Whether most of the points lie around a viewer whose theta_i and phi repeat as those of a grid."""
    count = places[0].size
    viewer = np.ravel_multi_index(places[:-2], tuple(a.size for a in axes[:-2]))
    if np.unique(viewer).size > count / 4:
        return False
    order = np.argsort(viewer, kind="stable")
    gridded = 0
    for rows in np.split(order, np.flatnonzero(np.diff(viewer[order])) + 1):
        theta_i, phi = (np.unique(place[rows], return_inverse=True) for place in places[-2:])
        product = theta_i[0].size * phi[0].size
        if min(theta_i[0].size, phi[0].size) > 1 and product < 2 * rows.size:
            different = np.unique(theta_i[1] * phi[0].size + phi[1]).size
            gridded += rows.size * (product < 2 * different)
    return gridded > count / 2


def _grid(columns: Columns, names: tuple[str, ...], axes, places) -> Grid:
    columns.refuse_beyond("theta_i")
    shape = tuple(axis.size for axis in axes)
    what = f"a grid of {_product(shape)} ({_product(names)})"
    if "value" not in columns:
        raise HairlutError(
            f"the points are those of {what}, but there is no column value: expected its values"
        )
    flat = np.ravel_multi_index(places, shape)
    times = np.bincount(flat, minlength=int(np.prod(shape)))

    def point(index: int) -> str:
        at = np.unravel_index(index, shape)
        numbers = {name: axis[k] for name, axis, k in zip(names, axes, at, strict=True)}
        return columns.point(**numbers)

    if times.max() > 1:
        twice = int(np.argmax(times > 1))
        first, second = np.flatnonzero(flat == twice)[:2]
        raise HairlutError(
            f"{what} has the point {point(twice)} {times[twice]} times, on {columns.place((first,))} and "
            f"{columns.place((second,))}: expected each point once"
        )
    if times.min() < 1:
        raise HairlutError(
            f"{what} needs {times.size:,} points, found {flat.size:,}: the first one missing is "
            f"{point(int(np.argmin(times)))}: each theta_r needs the same theta_i and phi, and value 0 where "
            "there is no light"
        )
    value = np.empty(times.size)
    value[flat] = columns.radians("value")
    return checked_grid(**dict(zip(names, axes, strict=True)), value=value.reshape(shape))


def _draws(columns: Columns) -> Draws:
    beyond = columns.beyond("theta_i")
    if beyond.mean() > MOST_BEYOND:
        columns.refuse_beyond("theta_i")
    kept = {name: columns.radians(name)[~beyond] for name in columns.by_base}
    kept["phi"] = np.mod(kept["phi"], TWO_PI)
    weight = kept.pop("value", np.ones(kept["phi"].size))
    heavy = int(np.count_nonzero(weight))
    if heavy < LEAST_DRAWS:
        found = f"{heavy} draw{'s' * (heavy != 1)}" + (" of weight above 0" if heavy < weight.size else "")
        raise HairlutError(
            f"{found}: expected at least {LEAST_DRAWS} of them, or the values of a grid with each point once"
        )
    for name in ("theta_i", "phi"):
        if np.ptp(kept[name]) <= TOLERANCE:
            at = columns.point(**{name: kept[name][0]})
            raise HairlutError(f"all {weight.size:,} draws have {at}: expected draws of theta_i and of phi")
    return Draws(**kept, weight=weight, note=_left_out(columns, beyond))


def _left_out(columns: Columns, beyond: Array) -> str:
    if not beyond.any():
        return ""
    first = columns.place((int(np.argmax(beyond)),))
    return f", without {beyond.sum():,} whose theta_i lies beyond 90 deg, the first on {first}"


# ---- grids


def _check_shape(axes: dict[str, Array], value: Array) -> None:
    for name, points in axes.items():
        if points.ndim != 1 or not points.size:
            raise HairlutError(f"{name} has shape {points.shape}, expected one axis of increasing numbers")
    expected = tuple(points.size for points in axes.values())
    if value.shape != expected:
        raise HairlutError(
            f"value has shape {value.shape}, expected {expected}, one value for each {_product(axes)}"
        )


def _check_increasing(name: str, points: Array) -> None:
    step = np.diff(points)
    if (step > TOLERANCE).all():
        return
    k = int(np.argmax(~(step > TOLERANCE)))
    if abs(step[k]) <= TOLERANCE:
        raise HairlutError(f"{name} has {points[k]:.9g} twice, at {k} and {k + 1}: expected each point once")
    raise HairlutError(
        f"{name} falls from {points[k]:.6g} to {points[k + 1]:.6g}: expected increasing numbers: sort them, "
        "and value with them"
    )


def _check_axes(axes: dict[str, Array]) -> None:
    for name in ("theta_r", "theta_i"):
        outside = abs(axes[name]) > HALF_PI + ROUNDED
        if outside.any():
            raise HairlutError(
                f"{name} = {axes[name][outside][0]:.6g} rad, expected angles within [-pi/2, pi/2]: are they "
                "degrees?"
            )
    if axes["theta_i"].size < LEAST_THETA_I:
        raise HairlutError(
            f"{axes['theta_i'].size} theta_i: expected at least {LEAST_THETA_I}, over all of the light"
        )
    offset = axes.get("offset")
    if offset is not None and (offset.size < 2 or abs(offset).max() > 1):
        raise HairlutError(
            f"{offset.size} offsets from {offset[0]:.6g} to {offset[-1]:.6g}: expected at least two within "
            "[-1, 1], distances from the fibre's axis in radii"
        )


def _check_values(value: Array) -> None:
    for wrong, expected in ((~np.isfinite(value), "a finite number"), (value < 0, "0 or more")):
        if wrong.any():
            index = tuple(map(int, np.argwhere(wrong)[0]))
            raise HairlutError(
                f"value is {value[index]:.6g} at {list(index)}, counted from 0: expected {expected}"
            )


def _one_period(phi: Array, value: Array) -> tuple[Array, Array]:
    """phi in [0, 2 pi), increasing; of two points a period apart, which must have the same values, one."""
    wrapped = np.mod(phi, TWO_PI)
    wrapped = np.where(TWO_PI - wrapped < ROUNDED, 0.0, wrapped)
    order = np.argsort(wrapped, kind="stable")
    phi, wrapped, value = phi[order], wrapped[order], value[..., order]
    kept = np.append(True, np.diff(wrapped) > TOLERANCE)
    for k in np.flatnonzero(~kept):
        if abs(phi[k] - phi[k - 1]) <= TOLERANCE:
            raise HairlutError(f"phi has {phi[k]:.9g} rad twice: expected each point once")
        one, other = value[..., k - 1], value[..., k]
        if (abs(one - other) > SAME_VALUE * np.maximum(one, other)).any():
            raise HairlutError(
                f"phi = {phi[k - 1]:.6g} and {phi[k]:.6g} rad are one direction, but have different values: "
                "expected one of them"
            )
    return wrapped[kept], value[..., kept]


def _check_circle(phi: Array) -> None:
    gap = np.diff(np.append(phi, phi[0] + TWO_PI))
    k = int(np.argmax(gap))
    if gap[k] > HALF_PI + ROUNDED:
        raise HairlutError(
            f"phi has no point between {np.degrees(phi[k]):.5g} and {np.degrees(phi[k] + gap[k]):.5g} deg: "
            "expected all of the circle, and no gap above 90 deg"
        )


def _check_light(theta_r: Array, offset: Array | None, value: Array) -> None:
    dark = ~(value > 0).any(axis=(-2, -1))
    if dark.any():
        *o, j = np.argwhere(dark)[0]
        where = f"offset {offset[o[0]]:.4g}, " if o else ""
        raise HairlutError(
            f"{where}theta_r = {np.degrees(theta_r[j]):.4g} deg: value is 0 everywhere: leave this angle out"
        )


def _product(parts) -> str:
    return " x ".join(map(str, parts))
