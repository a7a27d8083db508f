# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of the page."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hairlut import figures
from report.hairscene.lobes import Marginals
from report.hairscene.perception import Array, delta_e_2000, delta_e_itp, encoded
from report.hairscene.samplers import LABELS, SAMPLERS, SETTINGS

COLOURS = {
    "uniform": figures.GREY,
    "printed": figures.RED,
    "fitted": figures.BLUE,
    "own": figures.GREEN,
    "mix": figures.PURPLE,
}
ENLARGED = 3  # screen pixels per rendered pixel
DPI = 110


def _grid(rows: int, columns: int, shape: tuple[int, int]) -> tuple[Any, Any]:
    width, height = shape[1] * ENLARGED / DPI, shape[0] * ENLARGED / DPI
    return figures.new(rows, columns, size=(width * columns, (height + 0.25) * rows))


def _bare(axis: Any, title: str) -> None:
    axis.set_title(title, fontsize=8)
    axis.set_xticks([])
    axis.set_yticks([])


def images(rows: Mapping[int, Mapping[str, Array]], reference: Array, path: Path) -> None:
    """One row per sample count, one column per sampler and the reference last; sRGB."""
    figure, axes = _grid(len(rows), len(SAMPLERS) + 1, reference.shape[:2])
    for line, (count, images) in zip(axes, rows.items(), strict=True):
        for axis, sampler in zip(line, SAMPLERS, strict=False):
            axis.imshow(encoded(images[sampler]), interpolation="nearest")
            _bare(axis, f"{LABELS[sampler]}, {count} spp")
        line[-1].imshow(encoded(reference), interpolation="nearest")
        _bare(line[-1], "reference")
    figures.save(figure, path, DPI)


def differences(images: Mapping[str, Array], reference: Array, count: int, path: Path) -> None:
    """Maps of delta E 2000 above maps of delta E ITP, a common scale in each row."""
    figure, axes = _grid(2, len(SAMPLERS), reference.shape[:2])
    for line, (name, measure, top) in zip(
        axes, (("delta E 2000", delta_e_2000, 30.0), ("delta E ITP", delta_e_itp, 90.0)), strict=True
    ):
        for axis, sampler in zip(line, SAMPLERS, strict=True):
            map_ = measure(images[sampler], reference)
            shown = axis.imshow(map_, vmin=0.0, vmax=top, cmap="magma", interpolation="nearest")
            _bare(axis, f"{LABELS[sampler]}, mean {map_.mean():.1f}")
        figure.colorbar(shown, ax=line[-1])
        line[0].set_ylabel(f"{name}, {count} spp")
    figures.save(figure, path, DPI)


Curves = Mapping[str, Mapping[str, list[tuple[int, float, float]]]]


def variances(curves: Curves, path: Path) -> None:
    """Per setting a row: variance against samples, and against time. Points are (spp, seconds, variance)."""
    figure, axes = figures.new(len(curves), 2, size=(9, 3 * len(curves)), sharey="row")
    for line, (setting, samplers) in zip(axes, curves.items(), strict=True):
        for sampler, points in samplers.items():
            count, seconds, value = np.array(points).T
            for axis, x in zip(line, (count, seconds), strict=True):
                axis.loglog(x, value, "o-", ms=3, lw=1, color=COLOURS[sampler], label=LABELS[sampler])
        line[0].set(xlabel="samples per pixel", ylabel="variance of luminance", title=SETTINGS[setting].title)
        line[1].set(xlabel="processor seconds per image")
        line[0].title.set_fontsize(8)
    axes[0, 0].legend(fontsize=7)
    figures.save(figure, path, DPI)


STYLES = {
    "nested BSDF": ("#222222", "-"),
    "direct lobe": (figures.BLUE, "--"),
    "multiple lobe": (figures.RED, ":"),
    "both, 0.5 each": (figures.PURPLE, "-"),
}


def lobes(panels: Mapping[str, Marginals], path: Path) -> None:
    """Per panel a row: the densities of theta_i, and those of phi_i - phi_r."""
    figure, axes = figures.new(len(panels), 2, size=(9, 2.2 * len(panels)))
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
    figures.save(figure, path, DPI)
