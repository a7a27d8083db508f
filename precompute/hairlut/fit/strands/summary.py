# SPDX-License-Identifier: BSD-3-Clause
"""The result of a fit of a hair with parameters: as text, as plain data, and in a header."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace

import numpy as np

from ...axes import MAX_AXES
from ...lobes import Array
from ...model import BakedModel
from ..summary import QUANTILE, lobes_text
from . import losses
from .fit import FittedBox, limits, near_enough

BANDS = 5  # of a parameter in the text
NOISY, FIREFLY = 0.5, 100.0  # V and a weight above which a place is warned of


@dataclass(frozen=True)
class Promise:
    """V of a draw whose offset is known, over random parameters, viewers and offsets: the mean with its 95 %
    confidence interval, the median and the 99th percentile over places; the largest weight where f is above
    1e-4 of its peak, and the 99th percentile of the places'."""

    relative_variance: float
    low: float
    high: float
    median_relative_variance: float
    percentile99_relative_variance: float
    edge_relative_variance: float
    worst_edge_relative_variance: float
    largest_weight: float
    percentile99_largest_weight: float


def promise(found: FittedBox) -> Promise:
    """The numbers of a fit's measurement."""
    v, weight = found.measured.variance.mean(axis=1), found.measured.weight.max(axis=1)
    edges = found.edges.variance.mean(axis=1)
    error = QUANTILE * v.std(ddof=1) / np.sqrt(len(v))
    return Promise(
        relative_variance=float(v.mean()),
        low=float(max(v.mean() - error, 0.0)),
        high=float(v.mean() + error),
        median_relative_variance=float(np.median(v)),
        percentile99_relative_variance=float(np.quantile(v, 0.99)),
        edge_relative_variance=float(edges.mean()),
        worst_edge_relative_variance=float(edges.max()),
        largest_weight=float(max(weight.max(), found.edges.weight.max())),
        percentile99_largest_weight=float(np.quantile(weight, 0.99)),
    )


def data(found: FittedBox, tolerance: float) -> dict:
    """Everything as plain data."""
    model, everywhere = found.model, losses.joined(found.measured, found.edges)
    worst = int(everywhere.variance.mean(axis=1).argmax())
    return {
        **asdict(promise(found)),
        "places": found.measured.count,
        "edge_places": found.edges.count,
        "reach": found.reach,
        "tolerance": tolerance,
        "limits": limits(found, tolerance),
        "lobes": len(model.lobes),
        "parameters": {p.name: [p.least, p.most, p.standard] for p in model.parameters},
        "rows": found.counts,
        "tables": {t.name: [t.width, t.height] for t in model.tables},
        "axes": {
            **{t.name: {axis.name: axis.nodes.tolist() for axis in t.axes} for t in model.tables},
            "mixture": {axis.name: axis.nodes.tolist() for axis in model.mixture.axes},
        },
        "relative_variance_by_axis": found.lost,
        "worst_place": {
            **found.box.named(everywhere.parameters[worst].tolist()),
            "theta_r_deg": float(np.degrees(everywhere.theta_r[worst])),
            "relative_variance": float(everywhere.variance[worst].mean()),
            "largest_weight": float(everywhere.weight[worst].max()),
            "relative_variance_by_axis": found.lost_at_worst,
        },
    }


def text(found: FittedBox, tolerance: float) -> str:
    """The fit for a terminal."""
    model, errors = found.model, promise(found)
    lines = [f"{lobes_text(len(model.lobes))}; what depends on which parameter, with how many nodes:"]
    for p in model.parameters:
        where = [t.name for t in model.tables if p.name in [axis.name for axis in t.axes]]
        where += ["mixture"] * (p.name in [axis.name for axis in model.mixture.axes])
        nodes = sorted({len(a.nodes) for a in _axes(model) if a.name == p.name})
        count = f" ({' or '.join(map(str, nodes))} nodes)" if nodes else ""
        lines.append(f"  {p.name}: {', '.join(where) or 'nothing'}{count}")
    lines += [
        "",
        "relative variance of drawing this hair, the offset known (0 is perfect, 1 costs twice the samples),",
        f"measured in the baked textures at {len(found.measured.theta_r)} random parameters, viewers and "
        "offsets; weights where f is",
        "above 1e-4 of its peak",
    ]
    v, weight = found.measured.variance.mean(axis=1), found.measured.weight.max(axis=1)
    for number, p in enumerate(found.box.parameters):
        lines.append(f"{p.name:>24} {'variance':>10} {'99 %':>8} {'weight':>8}")
        for low, high, inside in _bands(found.measured.parameters[:, number], p.least, p.most):
            lines.append(
                f"{f'{low:.3g} to {high:.3g}':>24} {v[inside].mean():10.4f} "
                f"{np.quantile(v[inside], 0.99):8.4f} {weight[inside].max():8.2f}"
            )
    lines.append(
        f"{'all':>24} {errors.relative_variance:10.4f} {errors.percentile99_relative_variance:8.4f} "
        f"{weight.max():8.2f} (95 %: {errors.low:.4f} to {errors.high:.4f}; "
        f"median {errors.median_relative_variance:.4f})"
    )
    v, weight = found.edges.variance.mean(axis=1), found.edges.weight.max(axis=1)
    lines.append(
        f"{'corners and grazing':>24} {v.mean():10.4f} {np.quantile(v, 0.99):8.4f} {weight.max():8.2f} "
        f"(at {found.edges.count} corners of the box, and viewers beyond 80 deg)"
    )
    return "\n".join([*lines, "", _verdict(found, tolerance)])


def warnings(found: FittedBox) -> list[str]:
    """Warnings of parameters without an axis, and of the worst place, where that is bad."""
    warned = []
    for p in found.left_out:
        parameter = found.box.parameters[p]
        warned.append(
            f"shares and turns depend on more parameters than the {MAX_AXES} a texture may have: they are "
            f"those of {parameter.name} = {parameter.standard:g} at all its values"
        )
    everywhere = losses.joined(found.measured, found.edges)
    v, weight = everywhere.variance.mean(axis=1), everywhere.weight.max(axis=1)
    if v.max() <= NOISY and weight.max() <= FIREFLY:
        return warned
    worst = int((v / NOISY if v.max() > NOISY else weight).argmax())
    at = ", ".join(f"{name} = {x:.4g}" for name, x in found.box.named(everywhere.parameters[worst]).items())
    axis, lost = max(found.lost_at_worst.items(), key=lambda one: one[1])
    why = f": the nodes of {axis} are too far apart there" if lost > v.max() / 2 > NOISY / 2 else ""
    bad = int(((v > NOISY) | (weight > FIREFLY)).sum())
    return [
        *warned,
        f"at {bad} of {len(v)} places V is above {NOISY:g} or a weight above {FIREFLY:g}: V is "
        f"{v[worst]:.3g} and the largest weight {weight[worst]:.3g} at {at}, theta_r = "
        f"{np.degrees(everywhere.theta_r[worst]):.3g} deg{why}",
    ]


def _axes(model: BakedModel) -> list:
    return [*model.mixture.axes, *(axis for table in model.tables for axis in table.axes)]


def _bands(values: Array, least: float, most: float) -> list[tuple[float, float, Array]]:
    edges = np.linspace(least, most, BANDS + 1)
    at = np.clip(np.digitize(values, edges) - 1, 0, BANDS - 1)
    return [(edges[b], edges[b + 1], at == b) for b in range(BANDS) if (at == b).any()]


def _verdict(found: FittedBox, tolerance: float) -> str:
    what = limits(found, tolerance)
    if not what:
        best = lobes_text(len(found.model.lobes))
        return f"meets the tolerance: within {tolerance:g} of what {best} can reach"
    if not near_enough(found, tolerance):
        return f"stops short of the tolerance {tolerance:g}; what limits it: {', '.join(what)}"
    met = f"V is within the tolerance {tolerance:g}"
    if what == ["size"]:
        return f"{met}, but the textures take more than --size"
    return (
        f"{met}, but weights are large, or corners and grazing viewers lose more; "
        f"what limits it: {', '.join(what)}"
    )


def with_errors(found: FittedBox) -> BakedModel:
    """The model with its measured errors, as its mixture's header has them."""
    return replace(found.model, errors={"mixture": asdict(promise(found))})
