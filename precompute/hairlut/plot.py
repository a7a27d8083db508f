# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of a table: the texture, the density that it samples, and its error in every row where its formula
is known. A table over parameters of the hair is shown at fixed values, and along each of its parameters."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from . import exr, figures, mixturefile
from .axes import Axis, Parameter, completed
from .errors import HairlutError
from .fixed import check_values
from .interpolant import cells
from .lobes import NO_FORMULA, Array, Model
from .measure import Errors, measure
from .table import Table
from .verify import lobe_of

COLOURS = "viridis"
FIVE = figures.BLUE, figures.GREEN, figures.ORANGE, figures.RED, figures.PURPLE
NAMES = {"theta_i": "theta_i", "phi": "relative azimuth phi"}


def curve(table: Table, theta_r: float, points: int = 12) -> tuple[Array, Array]:
    """(angles, densities) of the table at theta_r, `points` to a cell."""
    f = np.linspace(0, 1, points, endpoint=False)
    read = cells(table, np.array([theta_r]))
    return read.angle(f)[0].ravel(), read.density(f)[0].ravel()


def density_map(table: Table, columns: int = 500, rows: int = 300) -> Array:
    """(rows, columns) density of the table over its domain, theta_r upwards, per rad."""
    x = np.linspace(*table.domain, columns)
    return np.array([np.interp(x, *curve(table, t, 6)) for t in np.linspace(*table.theta_r_range, rows)])


def plot_table(table: Table, errors: Errors | None, values: Mapping[str, float], path: Path) -> Path:
    """The texture, its density and a few rows, all at these values of its parameters; V along theta_r, unless
    errors is None; the middle row along each axis."""
    count = 3 + (errors is not None) + len(table.axes)
    height = (count + 1) // 2
    figure, grid = figures.new(height, 2, size=(11, 4 * height))
    panels = iter(grid.ravel())
    fixed = table.at(values)
    texture(next(panels), fixed)
    lobe_map(next(panels), fixed)
    rows(next(panels), fixed)
    if errors is not None:
        variance(next(panels), errors)
    for axis in table.axes:
        along(next(panels), table, axis, values)
    for panel in panels:
        panel.set_axis_off()
    at = "".join(f", {axis.name} = {float(values[axis.name]):g}" for axis in table.axes)
    figure.suptitle(
        f"{table.model}/{table.name}, {table.width}x{table.height}, {table.warp}{at}", fontweight="bold"
    )
    return figures.save(figure, path)


def _degrees(interval: tuple[float, float]) -> tuple[float, float]:
    return tuple(np.degrees(interval))


def texture(panel, table: Table) -> None:
    shown = panel.imshow(
        np.degrees(table.texels), origin="lower", aspect="auto", cmap=COLOURS, interpolation="nearest",
        extent=(-0.5, table.width - 0.5, *_degrees(table.theta_r_range)),
    )  # fmt: skip
    panel.grid(False)
    panel.set(xlabel="column (cumulative probability u, warped)", ylabel="theta_r [deg]", title="The texture")
    panel.figure.colorbar(shown, ax=panel, label=f"{NAMES[table.angle]} [deg]")


def lobe_map(panel, table: Table) -> None:
    shown = panel.imshow(
        density_map(table), origin="lower", aspect="auto", cmap="magma",
        extent=(*_degrees(table.domain), *_degrees(table.theta_r_range)),
    )  # fmt: skip
    panel.grid(False)
    panel.set(
        xlabel=f"{NAMES[table.angle]} [deg]", ylabel="theta_r [deg]", title="The density that it samples"
    )
    panel.figure.colorbar(shown, ax=panel, label="density [1/rad]")


def rows(panel, table: Table) -> None:
    low, high = table.theta_r_range
    for share, colour in zip((0.05, 0.275, 0.5, 0.725, 0.95), FIVE, strict=True):
        theta_r = low + share * (high - low)
        x, q = curve(table, theta_r)
        panel.plot(np.degrees(x), q, color=colour, label=f"theta_r = {np.degrees(theta_r):.0f} deg")
    _label_densities(panel, table, "Rows of it")


def along(panel, table: Table, axis: Axis, values: Mapping[str, float]) -> None:
    """The row of the middle theta_r at five values of one parameter, the others as in values."""
    theta_r = sum(table.theta_r_range) / 2
    for value, colour in zip(np.linspace(axis.nodes[0], axis.nodes[-1], 5), FIVE, strict=True):
        x, q = curve(table.at({**values, axis.name: value}), theta_r)
        panel.plot(np.degrees(x), q, color=colour, label=f"{axis.name} = {value:.3g}")
    _label_densities(panel, table, f"Along {axis.name}, theta_r = {np.degrees(theta_r):.0f} deg")


def _label_densities(panel, table: Table, title: str) -> None:
    panel.set(xlabel=f"{NAMES[table.angle]} [deg]", ylabel="density [1/rad]", title=title, ylim=(0, None))
    panel.legend(fontsize=8)


def variance(panel, errors: Errors) -> None:
    panel.plot(np.degrees(errors.theta_r), errors.variance, color=figures.BLUE, label="relative variance V")
    panel.plot(np.degrees(errors.theta_r), errors.variation, color=figures.ORANGE, label="total variation")
    panel.plot(np.degrees(errors.theta_r), errors.inner, color=figures.GREEN, label="quantile error [rad]")
    panel.set(xlabel="theta_r [deg]", yscale="log", title="Its errors, on rows and between")
    panel.legend(fontsize=8, frameon=True)


def plot_file(path: Path, out: Path, model: Model | None, at: Mapping[str, float]) -> Path:
    """Reads a table and writes out/<model>_<table>.png.

    model: the one it was baked from, where that is not built in; at: values of the parameters of the hair,
    standard ones for those that it does not name.
    """
    table, _ = exr.read(path)
    parameters = _parameters(path, table) if at or table.axes else ()
    check_values(path, parameters, at)
    errors = None if table.parameters == NO_FORMULA else measure(table, lobe_of(path, model))
    values = {name: float(value) for name, value in completed(at, parameters).items()}
    return plot_table(table, errors, values, out / f"{table.model}_{table.name}.png")


def _parameters(path: Path, table: Table) -> tuple[Parameter, ...]:
    """Those of the table's model, from the mixture.exr beside it: a table does not know standard values."""
    file = path.parent / mixturefile.FILE
    if not table.axes and not file.is_file():  # format 1
        return ()
    parameters = mixturefile.read(file).parameters
    names = {parameter.name for parameter in parameters}
    for axis in table.axes:
        if axis.name not in names:
            raise HairlutError(f"{file}: has no parameter {axis.name}, on which {path.name} depends")
    return parameters
