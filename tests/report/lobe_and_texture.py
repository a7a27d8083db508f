# SPDX-License-Identifier: BSD-3-Clause
"""The picture of the README: a lobe, its texture, and samples drawn through it."""

from pathlib import Path

import numpy as np

from hairlut import figures, interpolant, plot
from hairlut.table import Table


def draw(table: Table, path: Path) -> Path:
    """The README's picture: a lobe over all directions, its texture, and samples drawn through one row of
    it."""
    figure, (left, middle, right) = figures.new(1, 3, size=(14, 4.3), width_ratios=(1.05, 1.05, 1.0))
    plot.lobe_map(left, table)
    left.set_title(f"A lobe: {table.model}/{table.name}")
    plot.texture(middle, table)
    middle.set_title(f"Its texture: {table.width}x{table.height} texels, {table.nbytes / 1024:.0f} KB")
    _samples(right, table)
    return figures.save(figure, path)


def _samples(panel, table: Table, theta_r: float = np.radians(35.0)) -> None:
    """Ten thousand samples drawn through one row, against the lobe."""
    u = (np.arange(10_000) + 0.5) / 10_000
    x, _ = interpolant.sample(table, np.full(u.shape, theta_r), np.random.default_rng(1).permutation(u))
    panel.hist(np.degrees(x), bins=60, density=True, color=figures.ORANGE, alpha=0.6, label="10,000 samples")
    angles, q = plot.curve(table, theta_r)
    panel.plot(np.degrees(angles), np.radians(q), color=figures.BLUE, label="density of the table")
    panel.set(
        xlabel=f"{plot.NAMES[table.angle]} [deg]", ylabel="density [1/deg]",
        xlim=np.degrees(table.domain), ylim=(0, None),
        title=f"Samples at theta_r = {np.degrees(theta_r):.0f} deg",
    )  # fmt: skip
    panel.legend(fontsize=8.5)
