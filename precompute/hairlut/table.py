"""A table: a lobe's inverse CDF at the knots of a warp, for a row of viewer inclinations."""

from dataclasses import dataclass

import numpy as np

from .cell import Cell
from .errors import HairlutError
from .exact import Exact, exact_at
from .invert import ALL
from .lobes import Array, Lobe
from .warp import Warp

MIN_WIDTH, MIN_HEIGHT, MAX_SIDE = 4, 2, 16384


@dataclass(frozen=True)
class Table:
    """A table and all that its file's header says of it.

    texels      (height, width) float32, rad, strictly increasing along each row
    log_mass    (height,) logarithm of the lobe's mass inside its domain, by which each row was normalised
    parameters  Lobe.formula; the other fields as in Lobe
    """

    model: str
    name: str
    angle: str
    azimuth: str
    domain: tuple[float, float]
    theta_r_range: tuple[float, float]
    parameters: str
    warp: Warp
    cell: Cell
    texels: Array
    log_mass: Array

    @property
    def width(self) -> int:
        return self.texels.shape[1]

    @property
    def height(self) -> int:
        return self.texels.shape[0]

    @property
    def theta_r(self) -> Array:
        """(height,) viewer inclination of each row."""
        return row_angles(self.theta_r_range, self.height)


def row_angles(theta_r_range: tuple[float, float], height: int) -> Array:
    """theta_r of each row: the first and last row lie on the ends of the range."""
    return np.linspace(*theta_r_range, height)


def check_size(width: int, height: int) -> None:
    if not (MIN_WIDTH <= width <= MAX_SIDE and MIN_HEIGHT <= height <= MAX_SIDE):
        raise HairlutError(
            f"size {width}x{height}: expected a width of {MIN_WIDTH} to {MAX_SIDE} "
            f"and a height of {MIN_HEIGHT} to {MAX_SIDE}"
        )


def bake_table(lobe: Lobe, width: int, height: int, warp: Warp, cell: Cell) -> Table:
    """Integrates, normalises, inverts and rounds a lobe once; HairlutError if a cell comes out flat."""
    return tabulate(lobe, exact_at(lobe, row_angles(lobe.theta_r_range, height)), width, warp, cell)


def tabulate(
    lobe: Lobe, exact: Exact, width: int, warp: Warp, cell: Cell, rows: slice | Array = ALL
) -> Table:
    """The table whose rows are these of the exact lobe's, evenly spaced over the lobe's range of theta_r."""
    theta_r = exact.theta_r[rows]
    check_size(width, len(theta_r))
    texels = exact.quantiles(*warp.knots(width), rows).astype(np.float32)
    _refuse_flat_cells(lobe, theta_r, texels, warp)
    return Table(
        lobe.model,
        lobe.name,
        lobe.angle,
        lobe.azimuth,
        lobe.domain,
        lobe.theta_r_range,
        lobe.formula,
        warp,
        cell,
        texels,
        exact.log_mass[rows],
    )


def _refuse_flat_cells(lobe: Lobe, theta_r: Array, texels: Array, warp: Warp) -> None:
    flat = np.argwhere(np.diff(texels, axis=1) <= 0)
    if len(flat):
        j, i = flat[0]
        raise HairlutError(
            f"{lobe.model}/{lobe.name} at theta_r = {theta_r[j]:.9g} rad: columns {i} and {i + 1} of "
            f"{texels.shape[1]} round to the same float {texels[j, i]:.9g} ({len(flat)} such cells) "
            f"with the warp {warp}: use fewer columns or a larger e"
        )
