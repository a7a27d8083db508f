"""One look for all figures: colours that colour-blind readers can tell apart, and files that are the same
every time."""

from pathlib import Path

import matplotlib

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
    """(figure, axes) in the style of the report."""
    plt.rcParams.update(STYLE)
    return plt.subplots(rows, columns, figsize=size, layout="constrained", **options)


def save(figure, path: Path) -> Path:
    """Writes the figure and lets go of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    metadata = {"Date": None} if path.suffix == ".svg" else {}
    figure.savefig(path, dpi=150, metadata=metadata)
    plt.close(figure)
    return path
