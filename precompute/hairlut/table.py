# SPDX-License-Identifier: BSD-3-Clause
"""A table: a lobe's inverse CDF at the knots of a warp, a row for each inclination of the viewer. Where it
depends on parameters of the hair, it has such rows for each node of theirs."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from .axes import Axis, check_axes, corners, node_count
from .digest import digest
from .errors import HairlutError
from .exact import Exact, exact_at
from .invert import ALL
from .lobes import Array, Lobe
from .slopes import fitted
from .warp import Warp

MIN_WIDTH, MIN_HEIGHT, MAX_SIDE = 4, 2, 4096


@dataclass(frozen=True)
class Table:
    """A table and all that its file's header says of it.

    texels      (rows, width) float32, rad, strictly increasing along each row; `height` rows of theta_r
                for each node of the axes, the first axis slowest: rows = nodes * height
    slopes      (rows, width) float32, dx/du at each texel, rad per unit of u, positive
    log_mass    (rows,) logarithm of the lobe's mass inside its domain, by which each row was normalised
    parameters  Lobe.formula; the other fields as in Lobe
    axes        an axis of nodes for each of the hair's parameters on which the table depends
    """

    model: str
    name: str
    angle: str
    azimuth: str
    domain: tuple[float, float]
    theta_r_range: tuple[float, float]
    parameters: str
    warp: Warp
    texels: Array
    slopes: Array
    log_mass: Array
    axes: tuple[Axis, ...] = ()

    def __post_init__(self) -> None:
        check_axes(self.axes)
        if self.axes and len(self.texels) % node_count(self.axes):
            raise HairlutError(
                f"{self.model}/{self.name}: has {len(self.texels)} rows, expected a multiple of the "
                f"{node_count(self.axes)} nodes of {', '.join(axis.name for axis in self.axes)}"
            )

    @property
    def width(self) -> int:
        return self.texels.shape[1]

    @property
    def height(self) -> int:
        """Rows of theta_r of one node."""
        return self.texels.shape[0] // node_count(self.axes)

    @property
    def nbytes(self) -> int:
        """Bytes of the angles and slopes."""
        return self.texels.nbytes + self.slopes.nbytes

    @property
    def digest(self) -> str:
        """What mixture.exr names the table's contents by."""
        return digest([self.texels, self.slopes])

    @property
    def theta_r(self) -> Array:
        """(height,) viewer inclination of each row of one node."""
        return row_angles(self.theta_r_range, self.height)

    def at(self, parameters: Mapping[str, float]) -> "Table":
        """The table at fixed parameters, without axes: the blend of its texels, in double precision."""
        if not self.axes:
            return self
        node, part = corners(self.axes, parameters)

        def blend(rows: Array) -> Array:
            by_node = np.asarray(rows, float).reshape(-1, self.height, *rows.shape[1:])
            return np.tensordot(part, by_node[node], 1)

        texels, slopes, log_mass = (blend(rows) for rows in (self.texels, self.slopes, self.log_mass))
        return replace(self, texels=texels, slopes=slopes, log_mass=log_mass, axes=())


def row_angles(theta_r_range: tuple[float, float], height: int) -> Array:
    """theta_r of each row: the first and last row lie on the ends of the range."""
    return np.linspace(*theta_r_range, height)


def check_size(width: int, height: int) -> None:
    if not (MIN_WIDTH <= width <= MAX_SIDE and MIN_HEIGHT <= height <= MAX_SIDE):
        raise HairlutError(
            f"size {width}x{height}: expected a width of {MIN_WIDTH} to {MAX_SIDE} "
            f"and a height of {MIN_HEIGHT} to {MAX_SIDE}"
        )


def bake_table(lobe: Lobe, width: int, height: int, warp: Warp) -> Table:
    """Integrates, normalises, inverts and rounds a lobe once; HairlutError if a cell comes out flat."""
    return tabulate(lobe, exact_at(lobe, row_angles(lobe.theta_r_range, height)), width, warp)


def tabulate(lobe: Lobe, exact: Exact, width: int, warp: Warp, rows: slice | Array = ALL) -> Table:
    """The table whose rows are these of the exact lobe's, evenly spaced over the lobe's range of theta_r."""
    theta_r = exact.theta_r[rows]
    check_size(width, len(theta_r))
    x, slopes = exact_knots(exact, width, warp, rows)
    texels = x.astype(np.float32)
    _refuse_flat_cells(lobe, theta_r, texels, warp)
    return Table(
        model=lobe.model,
        name=lobe.name,
        angle=lobe.angle,
        azimuth=lobe.azimuth,
        domain=lobe.domain,
        theta_r_range=lobe.theta_r_range,
        parameters=lobe.formula,
        warp=warp,
        texels=texels,
        slopes=slopes.astype(np.float32),
        log_mass=exact.log_mass[rows],
    )


def exact_knots(exact: Exact, width: int, warp: Warp, rows: slice | Array = ALL) -> tuple[Array, Array]:
    """(x, slopes), each (R, width): the knots of these rows in double precision."""
    m, upper = warp.knots(width)
    middle = (m[0] + m[1]) / 2  # of the first cell, and of the last one from its end
    quantiles = exact.quantiles(np.append(m, [middle, middle]), np.append(upper, [False, True]), rows)
    x, middles = quantiles[:, :-2], (quantiles[:, -2], quantiles[:, -1])
    return x, fitted(x, warp.widths(width), density_at(exact, x, rows), middles)


def density_at(exact: Exact, x: Array, rows: slice | Array) -> Array:
    """(R, K) density of the lobe at the angles x (R, K) of these rows, per rad."""
    numbers = np.arange(len(exact.theta_r))[rows]
    return exact.density(x.reshape(1, -1), np.repeat(numbers, x.shape[1])).reshape(x.shape)


def _refuse_flat_cells(lobe: Lobe, theta_r: Array, texels: Array, warp: Warp) -> None:
    flat = np.argwhere(np.diff(texels, axis=1) <= 0)
    if len(flat):
        j, i = flat[0]
        raise HairlutError(
            f"{lobe.model}/{lobe.name} at theta_r = {theta_r[j]:.9g} rad: columns {i} and {i + 1} of "
            f"{texels.shape[1]} round to the same float {texels[j, i]:.9g} ({len(flat)} such cells) "
            f"with the warp {warp}: use fewer columns or a larger e"
        )
