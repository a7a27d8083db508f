# SPDX-License-Identifier: BSD-3-Clause
"""From a hair with parameters to one baked model over all their values.

The lobes are found at one place in the box of parameters and followed from there (shapes.py). Tables get the
axes on which their shapes depend (dependence.py), with as many nodes as blending needs (nodeshapes.py); the
mixture gets those on which shares or turns depend (nodemixture.py). What the baked model loses is measured at
random places in the box (losses.py). Where that is too much, the axes that lose most are refined, as long as
the budget lasts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from ...axes import MAX_AXES
from ...errors import HairlutError
from ...lobes import HALF_PI, Array
from ...model import BakedModel
from .. import cells, effort
from ..refine import HEAVIEST, LARGEST_STEP, SHARE_OF_AXIS, TABLE_PART, WEIGHT_PARTS, stored
from . import dependence, firstround, losses, nodemixture, nodeshapes, nodetables, shapes
from .box import Box, Place, with_value
from .dependence import Dependence
from .firstround import BoxEffort
from .losses import Measured
from .shapes import Shapes

NODE_PART = 0.15  # of the tolerance that blending between the nodes of an axis may cost
LIMITS = {"theta_r": 145, "offset": 65}
TWELVES = 12  # rows of theta_r are so many intervals, times a whole number
LONGER = 384  # bytes that a promise over parameters takes more than one without
SMALLER = 0.8  # where textures are too large even so, nodes are chosen for this part of what would fit
MOST_EASE = 64.0  # times as much as usual that tables may lose, where the textures would be too large
BANDS = 5  # of a coordinate, where the worst places are named
SEED = 0  # of the places that are measured
COMMON = 0.9  # part of the places at edges whose weights may not be too large
RARE = 5.0  # times the tolerance that the worst hundredth of places may lose

Report = Callable[[str, float], None]


@dataclass(frozen=True)
class FittedBox:
    """A baked model over the parameters of a box. counts: rows of theta_r and offsets that were fitted;
    allowed: V that each axis might cost; reach: V that so many lobes have on the cells they were fitted to;
    measured: V and weights at random places; edges: the same at corners of the box and at grazing viewers;
    lost: V that each axis costs (losses.py); lost_at_worst: the same at the worst place of all; taken: bytes
    of the textures; too_large: whether these are more than allowed; left_out: numbers of the parameters for
    which the mixture has no axis left; out_of_time: whether finer axes were not tried for want of time."""

    box: Box
    model: BakedModel
    counts: dict[str, int]
    allowed: dict[str, float]
    reach: float
    measured: Measured
    edges: Measured
    lost: dict[str, float]
    lost_at_worst: dict[str, float]
    taken: int
    too_large: bool
    left_out: tuple[int, ...]
    out_of_time: bool = False


class _OutOfTime(Exception):
    pass


def fit(
    box: Box, name: str, tolerance: float, lobes: int | None, budget: float, report: Report, size: float
) -> FittedBox:
    """The model of a hair with parameters. lobes: how many, or None to choose; budget: seconds that it may
    take, about; size: bytes that its textures may take, for which they lose more where they must."""
    start = perf_counter()
    box = replace(box, effort=_effort(box, budget))
    place, count = shapes.anchor_of(box, lobes, lambda share: report("choosing lobes", share))
    counts = {"theta_r": box.effort.rows, "offset": box.effort.offset}
    full = _at_anchor(box, place, count, counts["theta_r"], report)
    found = _dependence(box, full, report)
    allowed = {axis: NODE_PART * tolerance for axis in (*counts, *(p.name for p in box.parameters))}
    best: FittedBox | None = None
    room, taken = size, np.inf  # by which nodes are chosen, and what was too large
    while True:
        began = perf_counter()
        so_far = _report(report, best)
        until = _until(box, start + budget) if best and not best.too_large else box
        try:
            if full.theta_r.size != counts["theta_r"]:
                full = _at_anchor(until, place, count, counts["theta_r"], so_far)
            fitted = _fit_once(
                until, name, full, found, counts, allowed, tolerance, size, room, start + budget, so_far
            )
        except _OutOfTime:
            return replace(best, out_of_time=True)
        if best is None or _score(fitted, tolerance) < _score(best, tolerance):
            best = fitted
        if fitted.too_large:
            room *= SMALLER * size / fitted.taken
            finer, taken = (counts, allowed) if fitted.taken < taken else None, fitted.taken
        else:
            finer = _finer(fitted, tolerance)
        if finer is None:
            return best
        if perf_counter() + (perf_counter() - began) > start + budget and not best.too_large:
            return replace(best, out_of_time=True)
        counts, allowed = finer


def _effort(box: Box, budget: float) -> BoxEffort:
    """What the budget allows, by the corner that needs most cells of the azimuth."""
    theta_r, offset = np.array([0.4]), np.sin(box.hair.angles(box.effort.fitted_offsets))
    corners = replace(box, effort=firstround.EFFORTS[-1]).corners()
    phi = max(cells.phi_count(box.density_at(place), theta_r, offset[:1]) for place in corners)
    edges = np.linspace(-HALF_PI, HALF_PI, box.effort.theta_i + 1)[None]
    began = perf_counter()
    mass = cells.of_density(box.hair.density, theta_r, offset, edges, phi).mass
    value = (perf_counter() - began) / (mass.size * cells.GAUSS.size**2)
    pace = replace(effort.pace(box.hair), value=value)
    return firstround.affordable(pace, len(box.parameters), box.hair.offsets, phi, budget)


def limits(found: FittedBox, tolerance: float) -> list[str]:
    """What keeps a fit from the tolerance, or from weights that are no fireflies, or nothing: names of
    parameters and axes, "size", "budget"; or where the worst places are."""
    size, budget = ["size"] * found.too_large, ["budget"] * found.out_of_time
    near, heavy = near_enough(found, tolerance), np.quantile(found.measured.weight, 0.99) > HEAVIEST
    if near and not heavy and not _bad_edges(found, tolerance):
        return size
    worst = found.measured.weight.max(axis=1) if near else found.measured.variance.mean(axis=1)
    return [*_standing_out(found, tolerance), *size, *budget] or [_worst_band(found, worst)]


def near_enough(found: FittedBox, tolerance: float) -> bool:
    """Whether V at random places is as near as the tolerance to what so many lobes reach."""
    v = found.measured.variance.mean(axis=1)
    return bool(
        v.mean() <= found.reach + tolerance and np.quantile(v, 0.99) <= found.reach + RARE * tolerance
    )


def _bad_edges(found: FittedBox, tolerance: float) -> bool:
    """Whether corners of the box and grazing viewers, together, lose what a hundredth of all places may."""
    v, weight = found.edges.variance.mean(axis=1), found.edges.weight.max(axis=1)
    return bool(v.mean() > found.reach + RARE * tolerance or np.quantile(weight, COMMON) > HEAVIEST)


def _worst_band(found: FittedBox, values: Array) -> str:
    """The part of a coordinate's range where values of the places are largest, in words."""
    at = found.measured
    coordinates = {p.name: at.parameters[:, i] for i, p in enumerate(found.box.parameters)}
    coordinates["theta_r_deg"] = np.degrees(at.theta_r)
    bands = []
    for name, x in coordinates.items():
        edges = np.linspace(x.min(), x.max(), BANDS + 1)
        band = np.clip(np.digitize(x, edges) - 1, 0, BANDS - 1)
        for b in np.unique(band):
            bands.append((values[band == b].mean(), f"{name} from {edges[b]:.3g} to {edges[b + 1]:.3g}"))
    return max(bands)[1]


def _standing_out(found: FittedBox, tolerance: float) -> dict[str, float]:
    """The axes that lose more than their part of the tolerance, and how many times as much."""
    parts = {axis: v / (SHARE_OF_AXIS * tolerance) for axis, v in found.lost.items()}
    parts = {axis: part for axis, part in parts.items() if part > 1}
    worst = np.quantile(found.measured.variance.mean(axis=1), 0.99)
    if not parts and worst > found.reach + RARE * tolerance:  # a few viewers, at grazing theta_r
        parts["theta_r"] = WEIGHT_PARTS
    if _bad_edges(found, tolerance):
        axis, lost = max(found.lost_at_worst.items(), key=lambda one: one[1])
        parts[axis] = max(parts.get(axis, WEIGHT_PARTS), lost / (RARE * tolerance))
    return parts


def _finer(found: FittedBox, tolerance: float) -> tuple[dict[str, int], dict[str, float]] | None:
    """Counts and what is allowed with the axes refined that stand out, or None if none does."""
    if not limits(found, tolerance):
        return None
    counts, allowed = dict(found.counts), dict(found.allowed)
    for axis, part in _standing_out(found, tolerance).items():
        step = float(np.clip(part**0.25, 1.25, LARGEST_STEP))
        if axis in counts:
            if counts[axis] == LIMITS[axis]:
                continue
            even = TWELVES if axis == "theta_r" else 2
            counts[axis] = min(even * int(np.ceil((counts[axis] - 1) * step / even)) + 1, LIMITS[axis])
        allowed[axis] /= step**4
    return None if (counts, allowed) == (found.counts, found.allowed) else (counts, allowed)


def _score(found: FittedBox, tolerance: float) -> tuple[bool, float]:
    """What is lower for a better fit."""
    v, weight = found.measured.variance.mean(axis=1), found.measured.weight.max(axis=1)
    too_heavy = max(0.0, float(np.quantile(weight, 0.99)) / HEAVIEST - 1)
    rare = (np.quantile(v, 0.99) + found.edges.variance.mean()) / RARE
    return found.too_large, float(v.mean() + rare + tolerance * too_heavy)


def _until(box: Box, last: float) -> Box:
    """The box, with a density that ends the work after the time `last`."""

    def density(*at: Array, **parameters: float) -> Array:
        if perf_counter() > last:
            raise _OutOfTime
        return box.density(*at, **parameters)

    return replace(box, density=density)


def _report(report: Report, best: FittedBox | None) -> Report:
    """Reports V so far."""

    def so_far(stage: str, share: float) -> None:
        reached = f"V {best.measured.variance.mean():.4f} so far, " if best else ""
        report(f"{reached}{stage}", share)

    return so_far


def _at_anchor(box: Box, place: Place, count: int, rows: int, report: Report) -> Shapes:
    """The lobes at the anchor: with turns where those gain."""
    turning = box.hair.offsets and shapes.turns(box, place, count)
    return shapes.at_anchor(box, place, count, turning, rows, lambda share: report("fitting lobes", share))


def _dependence(box: Box, anchor: Shapes, report: Report) -> Dependence:
    some = shapes.of_rows(anchor, shapes.some(len(anchor.theta_r)))
    tied = shapes.with_common_azimuths(some)
    if tied.variance() > some.variance() + dependence.SLACK:
        tied = some
    found = dependence.dependence(box, tied, lambda share: report("finding what depends on what", share))
    for axes, what in ((found.theta, "inclinations"), (found.phi, "azimuths")):
        _check_axes(box, axes, what)
    return found


def _check_axes(box: Box, axes: tuple[int, ...], what: str) -> None:
    if len(axes) > MAX_AXES:
        names = ", ".join(box.parameters[p].name for p in axes)
        raise HairlutError(
            f"{what} depend on {names}: a texture has at most {MAX_AXES} axes of parameters: give one of "
            "them a fixed value"
        )


def _fit_once(
    box: Box,
    name: str,
    anchor: Shapes,
    found: Dependence,
    counts: dict[str, int],
    allowed: dict[str, float],
    tolerance: float,
    size: float,
    room: float,
    last: float,
    report: Report,
) -> FittedBox:
    began = perf_counter()
    start = nodeshapes.start_of(box, anchor, found)
    each = perf_counter() - began
    along = nodeshapes.chosen(
        box,
        found,
        start,
        nodetables.columns(found, TABLE_PART * tolerance),
        allowed,
        room,
        nodeshapes.TIME_PART * (last - perf_counter()) / each,
        lambda share: report("choosing nodes", share),
    )
    theta, phi = nodeshapes.at_nodes(box, start, found, along, lambda share: report("fitting lobes", share))
    reach = float(np.mean([one.variance() for one in (*theta.at.values(), *phi.at.values())]))
    report("baking", 0.0)
    ease, lobes = 1.0, nodetables.lobes(box, name, theta, phi, TABLE_PART * tolerance, 1.0)
    without = nodemixture.depends(box, lobes, start, SHARE_OF_AXIS * tolerance)
    axes = tuple(sorted(sorted(without, key=without.__getitem__)[-MAX_AXES:]))
    place, left_out = start.places[0], tuple(p for p in without if p not in axes)
    for p in left_out:
        place = with_value(place, p, box.standard[p])
    angle = box.hair.angles(counts["offset"])
    mixture = nodemixture.mixture(
        box,
        lobes,
        start,
        place,
        axes,
        nodemixture.viewers(start.theta_r),
        angle,
        allowed,
        room,
        last,
        lambda share: report("fitting shares", share),
    )
    model = BakedModel(name, tuple(lobes), mixture, {}, box.parameters)
    while (taken := stored(model) + LONGER) > size and ease < MOST_EASE:
        ease = min(max(2 * ease, ease * (taken / size) ** 2), MOST_EASE)
        report(f"baking, {taken / 1024:.0f} KB", 0.0)
        smaller = nodetables.lobes(box, name, theta, phi, TABLE_PART * tolerance, ease)
        model = replace(model, lobes=tuple(smaller))
    report("measuring", 0.0)
    random = np.random.default_rng(SEED)  # all rounds are measured at the same places, and so compared
    count = box.effort.places
    anywhere = losses.random_places(box, count, random)
    at_edges = losses.edge_places(box, count // losses.EDGES, random)
    measured = losses.measured(box, model, anywhere, random, lambda share: report("measuring", share))
    edges = losses.measured(box, model, at_edges, random, lambda share: report("measuring corners", share))
    lost = losses.lost(box, model, random)
    at_worst = losses.lost_at(box, model, losses.worst(losses.joined(measured, edges)), random)
    if not np.isfinite(measured.variance).all():
        raise HairlutError("the fit has numbers that are not finite")
    return FittedBox(
        box, model, counts, allowed, reach, measured, edges, lost, at_worst, taken, taken > size, left_out
    )
