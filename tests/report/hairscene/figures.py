"""The pictures of the page. matplotlib is imported when the first one is drawn."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from report.hairscene.lobes import Marginals
from report.hairscene.perception import Array, delta_e_2000, delta_e_itp, encoded
from report.hairscene.samplers import LABELS, SAMPLERS, SETTINGS

COLOURS = {
    "uniform": "#777777",
    "printed": "#c2542d",
    "fitted": "#1f6fb2",
    "own": "#2f8f4e",
    "mix": "#8a5fb0",
}
ENLARGED = 3  # screen pixels per rendered pixel


def _pyplot() -> Any:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    matplotlib.rcParams.update(
        {"font.size": 8, "svg.hashsalt": "hairlut", "axes.grid": True, "grid.alpha": 0.3}
    )
    return plt


def _save(plt: Any, figure: Any, path: Path) -> None:
    metadata = {"Date": None} if path.suffix == ".svg" else None
    figure.savefig(path, metadata=metadata, dpi=110)
    plt.close(figure)


def _grid(plt: Any, rows: int, columns: int, shape: tuple[int, int]) -> tuple[Any, Any]:
    width = shape[1] * ENLARGED / 110
    height = shape[0] * ENLARGED / 110
    return plt.subplots(
        rows, columns, figsize=(width * columns, (height + 0.25) * rows), layout="constrained"
    )


def _bare(axis: Any, title: str) -> None:
    axis.set_title(title, fontsize=8)
    axis.set_xticks([])
    axis.set_yticks([])


def pictures(rows: Mapping[int, Mapping[str, Array]], reference: Array, path: Path) -> None:
    """One row per sample count, one column per sampler and the reference last; sRGB."""
    plt = _pyplot()
    figure, axes = _grid(plt, len(rows), len(SAMPLERS) + 1, reference.shape[:2])
    for line, (count, images) in zip(axes, rows.items(), strict=True):
        for axis, sampler in zip(line, SAMPLERS, strict=False):
            axis.imshow(encoded(images[sampler]), interpolation="nearest")
            _bare(axis, f"{LABELS[sampler]}, {count} spp")
        line[-1].imshow(encoded(reference), interpolation="nearest")
        _bare(line[-1], "reference")
    _save(plt, figure, path)


def differences(images: Mapping[str, Array], reference: Array, count: int, path: Path) -> None:
    """Maps of delta E 2000 above maps of delta E ITP, a common scale in each row."""
    plt = _pyplot()
    figure, axes = _grid(plt, 2, len(SAMPLERS), reference.shape[:2])
    for line, (name, measure, top) in zip(
        axes, (("delta E 2000", delta_e_2000, 30.0), ("delta E ITP", delta_e_itp, 90.0)), strict=True
    ):
        for axis, sampler in zip(line, SAMPLERS, strict=True):
            map_ = measure(images[sampler], reference)
            shown = axis.imshow(map_, vmin=0.0, vmax=top, cmap="magma", interpolation="nearest")
            _bare(axis, f"{LABELS[sampler]}, mean {map_.mean():.1f}")
        figure.colorbar(shown, ax=line[-1])
        line[0].set_ylabel(f"{name}, {count} spp")
    _save(plt, figure, path)


Curves = Mapping[str, Mapping[str, list[tuple[int, float, float]]]]


def variances(curves: Curves, path: Path) -> None:
    """Per setting a row: variance against samples, and against time. Points are (spp, seconds, variance)."""
    plt = _pyplot()
    figure, axes = plt.subplots(
        len(curves), 2, figsize=(9, 3 * len(curves)), layout="constrained", sharey="row"
    )
    for line, (setting, samplers) in zip(axes, curves.items(), strict=True):
        for sampler, points in samplers.items():
            count, seconds, value = np.array(points).T
            for axis, x in zip(line, (count, seconds), strict=True):
                axis.loglog(x, value, "o-", ms=3, lw=1, color=COLOURS[sampler], label=LABELS[sampler])
        line[0].set(xlabel="samples per pixel", ylabel="variance of luminance", title=SETTINGS[setting].title)
        line[1].set(xlabel="processor seconds per image")
        line[0].title.set_fontsize(8)
    axes[0, 0].legend(fontsize=7)
    _save(plt, figure, path)


STYLES = {
    "nested BSDF": ("#222222", "-"),
    "direct lobe": ("#1f6fb2", "--"),
    "multiple lobe": ("#c2542d", ":"),
    "both, 0.5 each": ("#8a5fb0", "-"),
}


def lobes(panels: Mapping[str, Marginals], path: Path) -> None:
    """Per panel a row: the densities of theta_i, and those of phi_i - phi_r."""
    plt = _pyplot()
    figure, axes = plt.subplots(len(panels), 2, figsize=(9, 2.2 * len(panels)), layout="constrained")
    for line, (title, m) in zip(axes, panels.items(), strict=True):
        for name, (colour, style) in STYLES.items():
            line[0].plot(np.degrees(m.theta), m.by_theta[name], style, color=colour, lw=1.2, label=name)
            line[1].plot(np.degrees(m.phi), m.by_phi[name], style, color=colour, lw=1.2)
        line[0].set(ylabel="density per rad", title=title)
        line[0].title.set_fontsize(8)
        line[1].set_xticks(np.arange(0, 361, 60))
    axes[-1, 0].set_xlabel("theta_i, degrees")
    axes[-1, 1].set_xlabel("phi_i - phi_r, degrees")
    axes[0, 0].legend(fontsize=7)
    _save(plt, figure, path)
