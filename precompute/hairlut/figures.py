# SPDX-License-Identifier: BSD-3-Clause
"""One style for all figures: colours that colour-blind readers can distinguish, and files that are the same
every time."""

from io import BytesIO
from pathlib import Path

import matplotlib

from .files import write_whole

matplotlib.use("Agg")
import matplotlib.pyplot as plt

BLUE, ORANGE, GREEN, RED, PURPLE, BROWN, GREY = (
    "#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#8c5a2b", "#777777",
)  # fmt: skip

STYLE = {
    "figure.facecolor": "white",
    "font.family": "DejaVu Sans",
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.8,
    "axes.axisbelow": True,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "legend.frameon": False,
    "svg.hashsalt": "hairlut",
    "svg.fonttype": "path",
    "lines.linewidth": 1.8,
    "lines.markersize": 5,
}


def new(rows: int = 1, columns: int = 1, size: tuple[float, float] = (8, 5), **options):
    """(figure, axes) in this style."""
    plt.rcParams.update(STYLE)
    return plt.subplots(rows, columns, figsize=size, layout="constrained", **options)


def encoded(figure, kind: str = "png", dpi: int = 150) -> bytes:
    """The figure as a file of this kind, "png" or "svg", the same bytes every time; the figure is closed."""
    data = BytesIO()
    unfixed = "Date" if kind == "svg" else "Software"  # what would change the bytes
    figure.savefig(data, format=kind, dpi=dpi, metadata={unfixed: None})
    plt.close(figure)
    return data.getvalue()


def save(figure, path: Path, dpi: int = 150) -> Path:
    """Writes the figure to a .png or .svg and closes it."""
    return write_whole(path, encoded(figure, path.suffix[1:], dpi))
