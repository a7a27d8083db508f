# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of a table: the texture, the lobe that it samples, and its error in every row."""

from pathlib import Path

import numpy as np

from . import figures
from .interpolant import cells
from .lobes import Array, Lobe
from .measure import Errors, measure
from .table import Table

COLOURS = "viridis"
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


def plot_table(table: Table, errors: Errors, path: Path) -> Path:
    """Texture, lobe, a few rows, and V along theta_r."""
    figure, panels = figures.new(2, 2, size=(11, 8))
    texture(panels[0, 0], table)
    lobe_map(panels[0, 1], table)
    rows(panels[1, 0], table)
    variance(panels[1, 1], errors)
    figure.suptitle(
        f"{table.model}/{table.name}, {table.width}x{table.height}, {table.warp}", fontweight="bold"
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
    colours = figures.BLUE, figures.GREEN, figures.ORANGE, figures.RED, figures.PURPLE
    for share, colour in zip((0.05, 0.275, 0.5, 0.725, 0.95), colours, strict=True):
        theta_r = low + share * (high - low)
        x, q = curve(table, theta_r)
        panel.plot(np.degrees(x), q, color=colour, label=f"theta_r = {np.degrees(theta_r):.0f} deg")
    panel.set(
        xlabel=f"{NAMES[table.angle]} [deg]", ylabel="density [1/rad]", title="Rows of it", ylim=(0, None)
    )
    panel.legend(fontsize=8)


def variance(panel, errors: Errors) -> None:
    panel.plot(np.degrees(errors.theta_r), errors.variance, color=figures.BLUE, label="relative variance V")
    panel.plot(np.degrees(errors.theta_r), errors.variation, color=figures.ORANGE, label="total variation")
    panel.plot(np.degrees(errors.theta_r), errors.inner, color=figures.GREEN, label="quantile error [rad]")
    panel.set(xlabel="theta_r [deg]", yscale="log", title="Its errors, on rows and between")
    panel.legend(fontsize=8, frameon=True)


def plot_file(path: Path, lobe: Lobe, out: Path) -> Path:
    """Reads a table and writes out/<model>_<table>.png."""
    from . import exr

    table, _ = exr.read(path)
    return plot_table(table, measure(table, lobe), out / f"{table.model}_{table.name}.png")
