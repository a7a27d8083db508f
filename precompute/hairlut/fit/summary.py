# SPDX-License-Identifier: BSD-3-Clause
"""The result of a fit: as text for a person, as plain data for a script, and in a texture's header."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from ..lobes import Array
from ..model import BakedModel
from .drawn import Drawn
from .read import Draws
from .refine import Fitted, limits

BANDS = 12  # of theta_r in the text
QUANTILE = 1.96  # of a normal distribution: 95 % of it lies within


@dataclass(frozen=True)
class Promise:
    """V of a draw whose offset is known, the mean over offsets and viewers, with its 95 % confidence
    interval; the worst viewer's; and the largest weight where f is above 1e-4 of its peak."""

    relative_variance: float
    low: float
    high: float
    worst_viewer_relative_variance: float
    worst_viewer_theta_r_deg: float
    largest_weight: float


def promise(found: Fitted) -> Promise:
    """The numbers of a fit's last measurement."""
    loss = found.promised
    viewers = loss.variance.mean(axis=1)
    groups = np.array([part.mean() for part in np.split(viewers, found.repeats)])
    error = QUANTILE * groups.std(ddof=1) / np.sqrt(len(groups)) if len(groups) > 1 else np.nan
    band = _bands(loss.theta_r, viewers)
    worst = int(np.nanargmax(band[1]))
    return Promise(
        relative_variance=float(viewers.mean()),
        low=float(max(viewers.mean() - error, 0.0)),
        high=float(viewers.mean() + error),
        worst_viewer_relative_variance=float(band[1][worst]),
        worst_viewer_theta_r_deg=float(np.degrees(band[0][worst])),
        largest_weight=float(loss.weight.max()),
    )


def _bands(theta_r: Array, values: Array, reduce=np.mean) -> tuple[Array, Array]:
    """(middles of the bands of theta_r, the values' mean in each)."""
    edges = np.linspace(theta_r.min(), theta_r.max() + 1e-9, BANDS + 1)
    at = np.digitize(theta_r, edges) - 1
    used = np.unique(at)
    return (edges[used] + edges[used + 1]) / 2, np.array([reduce(values[at == b]) for b in used])


def data(found: Fitted, tolerance: float) -> dict:
    """Everything as plain data."""
    loss = found.promised
    middles, variance = _bands(loss.theta_r, loss.variance.mean(axis=1))
    _, weight = _bands(loss.theta_r, loss.weight.max(axis=1), np.max)
    return {
        **asdict(promise(found)),
        "reach": found.reach,
        "tolerance": tolerance,
        "limits": limits(found, tolerance),
        "out_of_time": found.out_of_time,
        "lobes": len(found.model.lobes),
        "cells": asdict(found.axes),
        "tables": {table.name: [table.width, table.height] for table in found.model.tables},
        "theta_r_deg": np.degrees(middles).tolist(),
        "relative_variance_at_theta_r": variance.tolist(),
        "largest_weight_at_theta_r": weight.tolist(),
        "loss": {
            where: {"relative_variance": v, "largest_weight": w} for where, (v, w) in found.loss.items()
        },
    }


def text(found: Fitted, tolerance: float) -> str:
    """The fit for a terminal."""
    errors, axes = promise(found), found.axes
    offsets = f", {axes.offset} offsets" if axes.offset > 1 else ""
    lines = [
        f"{lobes_text(len(found.model.lobes))} from {axes.theta_r} theta_r{offsets}, {axes.theta_i} x "
        f"{axes.phi} cells of theta_i and phi",
        "",
        "relative variance of drawing this hair, the offset known (0 is perfect, 1 costs twice the samples),",
        "measured in the baked textures at random viewers, offsets and directions; weights where f is above",
        "1e-4 of its peak",
        f"{'theta_r [deg]':>14} {'variance':>10} {'weight':>8}",
    ]
    loss = found.promised
    middles, variance = _bands(loss.theta_r, loss.variance.mean(axis=1))
    _, weight = _bands(loss.theta_r, loss.weight.max(axis=1), np.max)
    lines += [
        f"{t:14.3g} {v:10.4f} {w:8.2f}" for t, v, w in zip(np.degrees(middles), variance, weight, strict=True)
    ]
    interval = f" (95 %: {errors.low:.4f} to {errors.high:.4f})"
    lines += [f"{'all':>14} {errors.relative_variance:10.4f} {errors.largest_weight:8.2f}{interval}", ""]
    return "\n".join([*lines, _verdict(found, tolerance)])


def lobes_text(count: int) -> str:
    return f"{count} lobe{'s' if count > 1 else ''}"


def _verdict(found: Fitted, tolerance: float) -> str:
    what = limits(found, tolerance)
    if not what:
        best = lobes_text(len(found.model.lobes))
        return f"meets the tolerance: within {tolerance:g} of what {best} can reach"
    why = ", for want of time (--budget)" if found.out_of_time else ""
    return f"stops short of the tolerance {tolerance:g}{why}; what limits it: {', '.join(what)}"


def with_errors(found: Fitted) -> BakedModel:
    """The model with its measured errors, as its mixture's header has them."""
    return replace(found.model, errors={**found.model.errors, "mixture": asdict(promise(found))})


# ---- draws


def drawn_text(path: Path, data: Draws, found: Drawn) -> str:
    """The fit of draws for a terminal."""
    low, high = _interval(found)
    return "\n".join(
        [
            f"{path}: {data}",
            f"{lobes_text(len(found.model.lobes))}: one more gains nothing beyond the noise of the draws",
            "",
            "relative variance of drawing this hair (0 is perfect, 1 costs twice the samples), measured on",
            "draws left out",
            f"{'variance':>14} {found.variance:10.4f} (95 %: {low:.4f} to {high:.4f})",
            f"cells alone would show {found.apparent:.4f}: the rest is the noise of a finite number of draws",
        ]
    )


def drawn_data(data: Draws, found: Drawn) -> dict:
    """The same as plain data."""
    low, high = _interval(found)
    return {
        "data": str(data),
        "relative_variance": found.variance,
        "low": low,
        "high": high,
        "noise": max(found.apparent - found.variance, 0.0),
        "lobes": len(found.model.lobes),
        "tables": {table.name: [table.width, table.height] for table in found.model.tables},
    }


def with_error(found: Drawn) -> BakedModel:
    """The model with its cross-validated error, as its mixture's header has it."""
    low, high = _interval(found)
    errors = {"relative_variance": found.variance, "low": low, "high": high}
    return replace(found.model, errors={**found.model.errors, "mixture": errors})


def _interval(found: Drawn) -> tuple[float, float]:
    return max(found.variance - QUANTILE * found.error, 0.0), found.variance + QUANTILE * found.error
