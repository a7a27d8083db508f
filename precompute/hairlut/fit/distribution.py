"""A scattering distribution as data: read from a CSV or npz file, from a grid of values or from samples.

It is kept as masses of cells, for each viewer inclination: mass[j, i, k] is the share of the light for
theta_r[j] that comes from theta_i in cell i and the relative azimuth phi in cell k. Every row sums to 1.

A CSV file has a header line naming the columns theta_r, theta_i, phi and value, in radians, or in degrees
where the name ends in `_deg`; lines that start with # are comments. An npz file has arrays of these names.
What the file holds is

- a grid, where every combination of its theta_r, theta_i and phi occurs once (in npz: value has three
axes): value is
  the density at that point, per rad^2 in (theta_i, phi), or per steradian, which is cos(theta_i) times less;
- samples otherwise: each is one draw, and value its weight; without a value all weigh the same.

An npz file with an array `offset` holds such a grid for each offset: offsets.py.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import HairlutError
from ..lobes import HALF_PI, Array

COLUMNS = ("theta_r", "theta_i", "phi", "value")
TWO_PI = 2 * np.pi
ROWS = 19
CELLS = (64, 64)
FEW = 64  # so many different theta_r, or fewer, are rows of their own


@dataclass(frozen=True)
class Distribution:
    """theta_r (J,); theta_edges (n+1,) of theta_i, phi_edges (m+1,), rad; mass (J, n, m), each row summing
    to 1; samples (J,): how many draws a row stands on, infinite for a grid."""

    theta_r: Array
    theta_edges: Array
    phi_edges: Array
    mass: Array
    samples: Array

    @property
    def theta_middles(self) -> Array:
        """(n,) middles of the cells of theta_i."""
        return (self.theta_edges[1:] + self.theta_edges[:-1]) / 2

    @property
    def even(self) -> Array:
        """(m,) share of the circle of each cell of phi."""
        return np.diff(self.phi_edges) / TWO_PI

    @property
    def noise(self) -> Array:
        """(J,) relative variance that finite samples alone make the cells show."""
        return self.mass.shape[1] * self.mass.shape[2] / self.samples


def read(
    path: Path, per_steradian: bool = False, rows: int = ROWS, cells: tuple[int, int] = CELLS
) -> Distribution:
    """The distribution in a file; HairlutError naming the file, the place and what was expected."""
    path = Path(path)
    if not path.is_file():
        raise HairlutError(
            f"{path}: no such file: expected a CSV or npz file of theta_r, theta_i, phi and value"
        )
    columns = arrays_of(path) if path.suffix == ".npz" else _from_csv(path)
    check_finite(path, columns)
    if "offset" in columns:
        raise HairlutError(f"{path}: has a column offset: expected an npz file whose value has four axes")
    try:
        if columns.get("value", np.zeros(0)).ndim == 3:
            return of_grid(*(columns[name] for name in COLUMNS), per_steradian=per_steradian)
        grid = _as_grid(columns)
        if grid:
            return of_grid(*grid, per_steradian=per_steradian)
        return of_samples(*(columns.get(name) for name in COLUMNS), rows=rows, cells=cells)
    except HairlutError as error:
        raise HairlutError(f"{path}: {error}") from None


def of_grid(theta_r, theta_i, phi, value, per_steradian: bool = False) -> Distribution:
    """From values (J, n, m) at the points theta_r (J,), theta_i (n,), phi (m,), each increasing, rad."""
    theta_r, *edges, mass = grid_masses(theta_r, theta_i, phi, value, per_steradian)
    return normalised(theta_r, *edges, mass, np.full(theta_r.size, np.inf))


def grid_masses(
    theta_r, theta_i, phi, value, per_steradian: bool = False
) -> tuple[Array, Array, Array, Array]:
    """(theta_r, theta_edges, phi_edges, mass) of a grid as of_grid takes it, the masses not normalised."""
    theta_r, theta_i, phi, value = (np.asarray(a, float) for a in (theta_r, theta_i, phi, value))
    if value.shape != (theta_r.size, theta_i.size, phi.size):
        raise HairlutError(
            f"value has shape {value.shape}, expected one value for each of "
            f"{theta_r.size} theta_r x {theta_i.size} theta_i x {phi.size} phi"
        )
    phi, value = _one_period(phi, value)
    _check_points("theta_r", theta_r, HALF_PI, 1)
    _check_points("theta_i", theta_i, HALF_PI, 4)
    if phi.size < 4 or np.diff(np.append(phi, phi[0] + TWO_PI)).max() > HALF_PI:
        raise HairlutError(
            "the points in phi leave more than a quarter of the circle out: expected all of it"
        )
    theta_edges = np.concatenate([[-HALF_PI], (theta_i[1:] + theta_i[:-1]) / 2, [HALF_PI]])
    phi_edges = _periodic_edges(phi)
    if phi_edges.size == phi.size + 2:  # the cell around phi = 0 is cut in two
        owner = (
            np.append(np.arange(phi.size), 0)
            if phi[0] < TWO_PI - phi[-1]
            else np.append(phi.size - 1, np.arange(phi.size))
        )
        value = value[:, :, owner]
    measure = np.diff(np.sin(theta_edges)) if per_steradian else np.diff(theta_edges)
    return theta_r, theta_edges, phi_edges, value * measure[:, None] * np.diff(phi_edges)


def of_samples(
    theta_r, theta_i, phi, weight=None, rows: int = ROWS, cells: tuple[int, int] = CELLS
) -> Distribution:
    """From N draws, all (N,), rad.

    More than FEW different theta_r are gathered into `rows` rows; a draw moves to its row with theta_i +
    theta_r kept, as a highlight moves.
    """
    theta_r, theta_i, phi = (np.asarray(a, float).ravel() for a in (theta_r, theta_i, phi))
    weight = np.ones(theta_r.size) if weight is None else np.asarray(weight, float).ravel()
    if not theta_r.size == theta_i.size == phi.size == weight.size:
        raise HairlutError(
            f"columns of {theta_r.size}, {theta_i.size}, {phi.size}, {weight.size} samples: "
            "expected as many in each"
        )
    if (abs(theta_r) > HALF_PI + 1e-6).any() or (abs(theta_i) > HALF_PI + 1e-6).any():
        raise HairlutError(
            "theta_r or theta_i lies outside [-90, 90] deg: are the columns in degrees, named _deg?"
        )
    angles = np.unique(theta_r)
    if len(angles) > FEW:
        angles = np.linspace(angles[0], angles[-1], rows)
    j = np.clip(np.rint(np.interp(theta_r, angles, np.arange(len(angles)))).astype(int), 0, len(angles) - 1)
    theta_i = np.clip(theta_i + theta_r - angles[j], -HALF_PI, HALF_PI)
    edges = np.linspace(-HALF_PI, HALF_PI, cells[0] + 1), np.linspace(0, TWO_PI, cells[1] + 1)
    bins = (np.arange(len(angles) + 1) - 0.5, *edges)
    mass, _ = np.histogramdd((j, theta_i, np.mod(phi, TWO_PI)), bins=bins, weights=weight)
    count = np.bincount(j, minlength=len(angles)).astype(float)
    effective = np.bincount(j, weight, len(angles)) ** 2 / np.maximum(
        np.bincount(j, weight**2, len(angles)), 1e-300
    )
    kept = count > 0
    return normalised(angles[kept], *edges, mass[kept], effective[kept])


def normalised(theta_r, theta_edges, phi_edges, mass, samples) -> Distribution:
    """The masses (J, n, m) as a distribution; HairlutError where one is negative or a row has none."""
    for j, total in enumerate(mass.sum(axis=(1, 2))):
        if (mass[j] < 0).any():
            raise HairlutError(f"negative value at theta_r = {np.degrees(theta_r[j]):.4g} deg")
        if not total > 0:
            raise HairlutError(f"no mass at theta_r = {np.degrees(theta_r[j]):.4g} deg: leave this angle out")
    return Distribution(theta_r, theta_edges, phi_edges, mass / mass.sum(axis=(1, 2), keepdims=True), samples)


def _check_points(name: str, points: Array, bound: float, least: int) -> None:
    if points.size < least or not (np.diff(points) > 0).all() or abs(points).max() > bound + 1e-6:
        raise HairlutError(
            f"{name}: expected at least {least} increasing points in [-90, 90] deg, found {points.size} from "
            f"{np.degrees(points.min()):.4g} to {np.degrees(points.max()):.4g} deg: "
            "is the column in degrees, named _deg?"
        )


def _one_period(phi: Array, value: Array) -> tuple[Array, Array]:
    """phi in [0, 2 pi), increasing; of two points that are a period apart the first is kept."""
    wrapped = np.mod(phi, TWO_PI)
    wrapped = np.where(TWO_PI - wrapped < 1e-9, 0.0, wrapped)
    order = np.argsort(wrapped, kind="stable")
    order = order[np.append(True, np.diff(wrapped[order]) > 1e-9)]
    return wrapped[order], value[:, :, order]


def _periodic_edges(phi: Array) -> Array:
    """Edges in [0, 2 pi] half-way between neighbours on the circle; one cell may be cut by phi = 0."""
    middle = (phi + np.append(phi[1:], phi[0] + TWO_PI)) / 2
    seam = np.mod(middle[-1], TWO_PI)
    inner = np.sort(np.append(middle[:-1], seam))
    if min(seam, TWO_PI - seam) < 1e-9:
        return np.concatenate([[0.0], middle[:-1], [TWO_PI]])
    return np.concatenate([[0.0], inner, [TWO_PI]])


def _as_grid(columns: dict[str, Array]) -> list[Array] | None:
    """The columns as grid points and values (J, n, m), or None if they are not one complete grid."""
    if "value" not in columns:
        return None
    points, places = zip(
        *(np.unique(columns[name], return_inverse=True) for name in COLUMNS[:3]), strict=True
    )
    shape = tuple(p.size for p in points)
    if np.prod(shape) != columns["value"].size or min(shape[1:]) < 2:
        return None
    flat = np.ravel_multi_index(places, shape)
    if np.unique(flat).size != flat.size:
        return None
    value = np.empty(flat.size)
    value[flat] = columns["value"]
    return [*points, value.reshape(shape)]


def _from_csv(path: Path) -> dict[str, Array]:
    with path.open(newline="") as file:
        lines = list(csv.reader(line for line in file if line.strip() and not line.startswith("#")))
    if not lines:
        raise HairlutError(f"{path}: empty: expected a header line theta_r,theta_i,phi,value and numbers")
    names = [name.strip() for name in lines[0]]
    try:
        numbers = np.array([[float(word) for word in line] for line in lines[1:]], float).reshape(
            -1, len(names)
        )
    except ValueError as error:
        raise HairlutError(f"{path}: not a table of numbers with {len(names)} columns: {error}") from None
    return _in_radians(path, dict(zip(names, numbers.T, strict=True)))


def arrays_of(path: Path) -> dict[str, Array]:
    """The columns of an npz file, `offset` too if it has one; angles in radians."""
    try:
        with np.load(path, allow_pickle=False) as arrays:
            return _in_radians(path, {name: np.asarray(arrays[name], float) for name in arrays.files})
    except (OSError, ValueError) as error:
        raise HairlutError(f"{path}: not an npz file of numbers: {error}") from None


def _in_radians(path: Path, given: dict[str, Array]) -> dict[str, Array]:
    columns = {}
    for name, values in given.items():
        base, degrees = name.removesuffix("_deg"), name.endswith("_deg")
        if base in COLUMNS:
            columns[base] = values * (np.pi / 180 if degrees else 1.0)
    if "offset" in given:
        columns["offset"] = given["offset"]
    missing = [name for name in COLUMNS[:3] if name not in columns]
    if missing:
        raise HairlutError(
            f"{path}: found {', '.join(given) or 'nothing'}: "
            f"expected a column {missing[0]} or {missing[0]}_deg"
        )
    return columns


def check_finite(path: Path, columns: dict[str, Array]) -> None:
    """HairlutError naming the first number of a column that is none."""
    for name, values in columns.items():
        if not values.size:
            raise HairlutError(f"{path}: no data below the header")
        if not np.isfinite(values).all():
            where = np.argwhere(~np.isfinite(values))[0].tolist()
            raise HairlutError(f"{path}: {name} is not a finite number at {where}, counted from 0")
