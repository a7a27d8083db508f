# SPDX-License-Identifier: BSD-3-Clause
"""From a hair to a baked model: cells, lobes, tables, and again with finer cells where that gains.

A fit has five axes: rows of theta_r, offsets, cells of theta_i and of phi, and lobes. It starts coarse. What
the baked model loses is measured on its nodes, between rows, and between offsets. The axis whose loss stands
out is refined, until what is measured at random viewers is within the tolerance of what so many lobes can
reach, or the budget is spent.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

from ..errors import HairlutError
from ..exr import write_model
from ..lobes import Array
from ..mixture import Mixture, wrap
from ..model import BakedLobe, BakedModel
from . import cells, promise, smooth, tables
from . import effort as efforts
from .cells import Cells
from .effort import Effort
from .factor import variance
from .hair import Hair
from .lobesfit import Row, first_row, next_row, one_more, same_shapes
from .turning import TWO_PI

MAX_LOBES = 8
USUAL_LOBES = 3  # reflected, transmitted, and reflected inside: so many are tried however late it is
SEED = 0  # of the places by which rounds are compared
GAIN = 0.0005
"""Lobes are worth their memory if they lower V by this much, and"""
PART = 0.2
"""by this part of the least V of all numbers of lobes."""
HEAVIEST = 10.0  # a weight that is a firefly
FITTED_OFFSETS = 13  # offsets by which shapes are fitted; shares and turns are at all
LIMITS = {"theta_r": 145, "offset": 65, "theta_i": 128, "phi": 512}
FARTHEST = 0.5  # rad by which a turn is expected to go on from row to row
GRAZING, UNSEEN = 0.1, 0.1
"""Below this cosine of theta_r a fibre is hardly seen: tables may lose more, up to this part's inverse."""
TABLE_PART = 0.15  # of the tolerance that each table may lose
EASES = 1.0, 1.5, 2.0, 3.0, 5.0  # times as much, where the textures would be too large
PROMISE = 256  # bytes that a promise takes in a header, at most
SHARE_OF_AXIS = 0.2  # of the tolerance above which an axis is refined
WEIGHT_PARTS = 5.0  # what a weight that is too large counts, or a viewer whose V is
LARGEST_STEP = 2.0
ROWS, GAPS = (
    3 / 8,
    5,
)  # of the viewers and, for each, of the offset, on and between which losses are told apart


@dataclass(frozen=True)
class Axes:
    """How many rows of theta_r, offsets, and cells of theta_i and phi."""

    theta_r: int
    offset: int
    theta_i: int
    phi: int


@dataclass(frozen=True)
class Fitted:
    """A baked model; reach: V that so many lobes have on the cells they were fitted to, the mean over
    theta_r and the worst; loss: V and largest weight by where they were measured ("nodes", "theta_r",
    "offset": between those); promised: losses at random viewers, in `repeats` independent groups of as
    many; too_large: whether the textures take more memory than they may; untried_lobes: whether more lobes
    were not tried, and out_of_time, whether they or finer cells were not, for want of time."""

    model: BakedModel
    axes: Axes
    reach: float
    worst_reach: float
    loss: dict[str, tuple[float, float]]
    promised: promise.Losses
    repeats: int = 1
    too_large: bool = False
    untried_lobes: bool = False
    out_of_time: bool = False


Report = Callable[[str, float], None]


def fit(
    hair: Hair,
    name: str,
    tolerance: float,
    lobes: int | None,
    budget: float,
    report: Report,
    size: float = np.inf,
) -> Fitted:
    """The model of a hair. lobes: how many, or None to choose; budget: seconds that it may take, about; size:
    bytes that its textures may take, for which tables lose more where they must."""
    start = perf_counter()
    random = np.random.default_rng(0)
    best: Fitted | None = None
    least = True, np.inf  # score of the best

    def left() -> float:
        return budget - (perf_counter() - start)

    def so_far(stage: str, share: float) -> None:
        reached = f"V {best.promised.variance.mean():.4f} so far, " if best else ""
        report(f"{reached}{stage}", share)

    axes, effort = _first(hair, budget)
    count, untried = (
        (lobes, False) if lobes else _lobes(hair, axes, effort, report, lambda: left() < budget / 2)
    )
    turning = hair.offsets and _turns(hair, axes, effort, count)
    while True:
        began = perf_counter()
        found = _fit_once(hair, name, axes, effort, count, turning, tolerance, size, random, so_far)
        seconds = perf_counter() - began
        score = _score(found, tolerance)  # of the same places in all rounds
        if not limits(found, tolerance):
            found = _measured(found, hair, effort, random, so_far)
        if best is None or score < least:
            best, least = found, score
        finer = _finer(found, hair, tolerance)
        growth = np.prod([getattr(finer, axis) / getattr(axes, axis) for axis in LIMITS])
        if finer == axes or found.too_large or growth * seconds > left():
            late = untried or (finer != axes and not found.too_large)
            best = replace(best, untried_lobes=untried, out_of_time=late)
            return best if best.repeats > 1 else _measured(best, hair, effort, random, so_far)
        axes = finer


def _first(hair: Hair, budget: float) -> tuple[Axes, Effort]:
    """The axes that a fit starts from, and what it may look at."""
    pace = efforts.pace(hair)
    theta_r, offset = hair.rows(9)[[1, 4, 7]], np.sin(hair.angles(5))[:4]
    if pace.value * cells.phi_values(theta_r, offset) > budget / 10:
        theta_r, offset = theta_r[1:2], offset[:1]
    phi = cells.phi_count(hair.density, theta_r, offset)
    effort = efforts.affordable(hair, pace, phi, budget)
    rows, offsets = hair.row_count(effort.intervals), hair.offset_count(effort.offset)
    return Axes(rows, offsets, effort.theta_i, efforts.phi_cells(effort, phi)), effort


def limits(found: Fitted, tolerance: float) -> list[str]:
    """What keeps a fit from the tolerance: the names of axes, "size", "lobes", or nothing."""
    viewers = found.promised.variance.mean(axis=1)
    means = [viewers.mean(), *(variance for variance, _ in found.loss.values())]
    weights = [found.promised.weight.max(), *(weight for _, weight in found.loss.values())]
    near = max(means) <= found.reach + tolerance and viewers.max() <= found.worst_reach + 2 * tolerance
    size = ["size"] if found.too_large else []
    lobes = ["lobes"] if found.untried_lobes else []
    if near and max(weights) <= HEAVIEST:
        return [*size, *lobes]
    return [*_standing_out(found, tolerance), *size, *lobes] or ["lobes"]


def _measured(
    found: Fitted, hair: Hair, effort: Effort, random: np.random.Generator, report: Report
) -> Fitted:
    """The fit with its promise measured again, at more places."""
    groups = []
    for k in range(effort.repeats):
        report("measuring", k / effort.repeats)
        theta_r, offset = _random_places(hair, effort, random)
        around = effort.around * found.axes.phi
        groups.append(promise.losses(found.model, hair.density, theta_r, offset, around, random))
    parts = (
        np.concatenate([getattr(group, name) for group in groups])
        for name in ("theta_r", "offset", "variance", "weight", "light")
    )
    return replace(found, promised=promise.Losses(*parts), repeats=effort.repeats)


def _score(found: Fitted, tolerance: float) -> tuple[bool, float]:
    """What is lower for a better fit."""
    viewers = found.promised.variance.mean(axis=1)
    too_heavy = max(0.0, found.promised.weight.max() / HEAVIEST - 1)
    return found.too_large, float(viewers.mean() + viewers.max() / 4 + tolerance * too_heavy)


def _lobes(
    hair: Hair, axes: Axes, effort: Effort, report: Report, late: Callable[[], bool]
) -> tuple[int, bool]:
    """How many lobes gain, on three viewers, and whether it was late before two more of them gained
    nothing."""
    theta_r = hair.rows(13)[[2, 6, 9]]
    data = _cells(hair, theta_r, hair.angles(axes.offset), axes, effort)
    angle = hair.angles(axes.offset)
    reached: list[float] = []
    rows: list[Row | None] = [None] * len(data.mass)
    for count in range(1, MAX_LOBES + 1):
        report("choosing lobes", count / MAX_LOBES)
        rows = [one_more(row, mass, angle, hair.offsets) for row, mass in zip(rows, data.mass, strict=True)]
        reached.append(np.mean([row.variance(mass) for row, mass in zip(rows, data.mass, strict=True)]))
        if reached[-1] < GAIN or _enough(reached) < count - 1:
            break
        if count >= USUAL_LOBES and late():
            return _enough(reached), True
    return _enough(reached), False


def _enough(reached: list[float]) -> int:
    """The least number of lobes than which more gain too little; reached: V of 1, 2, 3... of them."""
    least = min(reached)
    return next(k + 1 for k, v in enumerate(reached) if v <= least + max(GAIN, PART * least))


def _turns(hair: Hair, axes: Axes, effort: Effort, count: int) -> bool:
    """Whether so many lobes lose more where they may not turn."""
    angle = hair.angles(axes.offset)
    mass = _cells(hair, hair.rows(3)[1:2], angle, axes, effort).mass[0]
    free, fixed = (first_row(mass, angle, count, turning).variance(mass) for turning in (True, False))
    return fixed > free + GAIN


def _cells(hair: Hair, theta_r: Array, angle: Array, axes: Axes, effort: Effort) -> Cells:
    offset = np.sin(angle)
    some = offset[np.unique([len(offset) // 2, 0, max(len(offset) - 2, 0)][: effort.edge_offsets])]
    edges = cells.theta_edges(hair.density, theta_r, some, axes.theta_i, effort.edge_azimuths)
    data = cells.of_density(hair.density, theta_r, offset, edges, axes.phi)
    if dark := data.dark():
        raise HairlutError(
            f"f is 0 {dark}: no light, or only between the directions tried; expected some for each theta_r"
        )
    return data


def _fit_once(
    hair: Hair,
    name: str,
    axes: Axes,
    effort: Effort,
    count: int,
    turning: bool,
    tolerance: float,
    size: float,
    random: np.random.Generator,
    report: Report,
) -> Fitted:
    report("evaluating", 0.0)
    angle = hair.angles(axes.offset)
    data = _cells(hair, hair.rows(axes.theta_r), angle, axes, effort)
    rows = fit_rows(data, angle, count, turning, lambda share: report("fitting lobes", share))
    reach = np.array([row.variance(mass) for row, mass in zip(rows, data.mass, strict=True)])
    for ease in EASES:
        model = bake(data, rows, name, hair.mirrored, TABLE_PART * tolerance, ease)
        too_large = stored(model) > size
        if not too_large:
            break
    report("measuring", 0.0)
    loss = _losses(hair, model, axes, effort, random)
    theta_r, offset = _random_places(hair, effort, np.random.default_rng(SEED))
    promised = promise.losses(model, hair.density, theta_r, offset, effort.around * axes.phi, random)
    if not np.isfinite(promised.variance).all():
        raise HairlutError("the fit has numbers that are not finite")
    return Fitted(model, axes, float(reach.mean()), float(reach.max()), loss, promised, too_large=too_large)


def fit_rows(
    data: Cells, angle: Array, count: int, turning: bool, report: Callable[[float], None] = lambda share: None
) -> list[Row]:
    """The lobes at all theta_r and offsets. The shapes are fitted at some offsets, from the middle row
    outwards; shares and turns then at all."""
    some = np.unique(np.linspace(0, len(angle) - 1, min(FITTED_OFFSETS, len(angle))).round().astype(int))
    rows: dict[int, Row] = {}
    middle, last = len(data.theta_r) // 2, len(data.theta_r)
    for j in sorted(range(last), key=lambda j: abs(j - middle)):
        mass = data.mass[j][some]
        if j == middle:
            rows[j] = first_row(mass, angle[some], count, turning)
        else:
            rows[j] = next_row(
                _expected(data, rows, j, j - int(np.sign(j - middle))), mass, angle[some], turning
            )
        report(len(rows) / last)
    if len(some) == len(angle):
        return [rows[j] for j in range(last)]
    return [_at_all(rows[j], data.mass[j], angle[some], angle, turning) for j in range(last)]


def _expected(data: Cells, rows: dict[int, Row], j: int, before: int) -> Row:
    """What the rows before j let expect there: inclinations that move with the mirror direction, and turns
    that go on as they went."""
    last, second = rows[before], rows.get(2 * before - j)
    moved = data.theta_r[j] - data.theta_r[before]
    old, new = data.theta_edges[before], data.theta_edges[j]
    theta = cells.rebinned(last.theta, old, new, moved)
    went = 0.0 if second is None else np.clip(last.turn - second.turn, -FARTHEST, FARTHEST)
    return replace(last, theta=theta, turn=last.turn + went)


def _at_all(row: Row, mass: Array, some: Array, angle: Array, turning: bool) -> Row:
    """The row of some offsets at all of them."""
    share, turn = (
        np.stack([np.interp(angle, some, part[:, k]) for k in range(part.shape[1])], axis=1).astype(
            part.dtype
        )
        for part in (row.share, row.turn)
    )
    return same_shapes(replace(row, share=share, turn=turn), mass, angle, turning)


def bake(
    data: Cells, rows: list[Row], name: str, mirrored: bool, loss: float, ease: float = 1.0
) -> BakedModel:
    """The textures of the rows, each table losing at most `loss` of V, times ease."""
    lobes = []
    around = np.tile(np.linspace(0, TWO_PI, rows[0].phi.shape[1] + 1), (len(rows), 1))
    seen = np.clip(np.cos(data.theta_r) / GRAZING, UNSEEN, 1.0)
    share = np.stack([row.share for row in rows]).transpose(2, 0, 1)
    turn = wrap(np.stack([row.turn for row in rows]).transpose(2, 0, 1))
    bright = bright_parts(data.theta_edges, rows)
    for k in range(len(share)):
        lobe, need = f"lobe{k}", tables.Need(seen * share[k].mean(axis=1), bright[k], loss).eased(ease)
        inclinations, azimuths = (
            np.stack(part) for part in zip(*((r.theta[:, k], r.phi[k]) for r in rows), strict=True)
        )
        theta = smooth.rows(data.theta_r, data.theta_edges, inclinations, False)
        phi = None
        if not _uniform(azimuths, need):
            phi = tables.smallest(
                f"{lobe}_phi", name, smooth.rows(data.theta_r, around, azimuths, True), need
            )
        lobes.append(BakedLobe(lobe, tables.smallest(f"{lobe}_theta", name, theta, need), phi))
    mixture = Mixture(tuple(one.name for one in lobes), data.theta_r, data.offset, share, turn, mirrored)
    return BakedModel(name, tuple(lobes), mixture)


def stored(model: BakedModel) -> int:
    """Bytes of the model's files, with the promise in a header."""
    with TemporaryDirectory() as folder:
        return PROMISE + sum(path.stat().st_size for path in write_model(Path(folder), model))


def bright_parts(theta_edges: Array, rows: list[Row]) -> Array:
    """(K, J) part of a lobe's own peak of f cos(theta_i) that is BRIGHT of the brightest lobe's."""
    size = np.diff(theta_edges) * np.cos((theta_edges[:, 1:] + theta_edges[:, :-1]) / 2)
    peak = [
        (row.theta / at[:, None]).max(axis=0) * row.phi.max(axis=1) * row.share.max(axis=0)
        for row, at in zip(rows, size, strict=True)
    ]
    peak = np.array(peak).T
    return promise.BRIGHT * peak.max(axis=0) / peak


def _uniform(azimuths: Array, need: tables.Need) -> bool:
    """Whether uniform draws lose no more for azimuths (J, m) than a table may."""
    return bool((need.importance * variance(azimuths, np.full(azimuths.shape, 1.0), 1)).max() <= need.loss)


def _losses(
    hair: Hair, model: BakedModel, axes: Axes, effort: Effort, random: np.random.Generator
) -> dict[str, tuple[float, float]]:
    """V and the largest weight on nodes, between rows, and between offsets."""
    theta_r, angle = hair.rows(axes.theta_r), hair.angles(axes.offset)
    count = round(ROWS * effort.viewers)
    rows = ((np.arange(count) + 0.5) * ((axes.theta_r - 1) / count) - 0.5).round().astype(int)
    gaps = max(axes.offset - 1, 1)
    each = min(GAPS, gaps)  # of a row; together the rows see all, since lobes that cross do so in one
    gap = np.arange(count * each).reshape(count, each) % gaps
    at = {
        "nodes": (theta_r[rows + 1], angle[gap]),
        "theta_r": ((theta_r[rows] + theta_r[rows + 1]) / 2, angle[gap]),
    }
    models = {}
    if hair.offsets and hair.nodes is None:
        at["offset"] = theta_r[rows + 1], (angle[gap] + angle[gap + 1]) / 2
    elif axes.offset >= 5:
        at["offset"] = theta_r[rows + 1], np.tile(angle[1:-1:2], (count, 1))
        models["offset"] = _without(model, np.arange(1, axes.offset - 1, 2))
    found = {}
    for where, (viewers, angles) in at.items():
        model_there = models.get(where, model)
        around = effort.around * axes.phi
        loss = promise.losses(model_there, hair.density, viewers, np.sin(angles), around, random)
        found[where] = float(loss.variance.mean()), float(loss.weight.max())
    return found


def _without(model: BakedModel, offsets: Array) -> BakedModel:
    """The model as if some nodes of its offsets were not there."""
    mixture = model.mixture
    axis = {name: np.delete(getattr(mixture, name), offsets, axis=-1) for name in ("offset", "share", "turn")}
    return replace(model, mixture=replace(mixture, **axis))


def _random_places(hair: Hair, effort: Effort, random: np.random.Generator) -> tuple[Array, Array]:
    """Viewers (R,) and offsets (R, N), random in even strata."""
    low, high = hair.theta_r
    viewers, offsets = effort.viewers, effort.measured_offsets
    theta_r = low + (high - low) * (np.arange(viewers) + random.random(viewers)) / viewers
    if hair.nodes is not None:
        return theta_r, np.tile(np.sin(hair.nodes), (viewers, 1))
    if not hair.offsets:
        return theta_r, np.zeros((viewers, 1))
    offset = (np.arange(offsets) + random.random((viewers, offsets))) / offsets
    return theta_r, offset if hair.mirrored else 2 * offset - 1


def _standing_out(found: Fitted, tolerance: float) -> dict[str, float]:
    """The axes that lose more than their part of the tolerance, and what they lose, in such parts; theta_r
    where a viewer loses too much; and the axis between whose nodes weights are too large."""
    base = found.loss["nodes"][0]
    lost = {axis: found.loss[axis][0] - base for axis in ("theta_r", "offset") if axis in found.loss}
    lost |= {"theta_i": (base - found.reach) / 2, "phi": (base - found.reach) / 2}
    parts = {axis: v / (SHARE_OF_AXIS * tolerance) for axis, v in lost.items()}
    parts = {axis: part for axis, part in parts.items() if part > 1}
    viewers = found.promised.variance.mean(axis=1)
    if viewers.max() > found.worst_reach + 2 * tolerance and not parts:  # a few viewers, at grazing theta_r
        parts["theta_r"] = WEIGHT_PARTS
    weight, worst = max((weight, axis) for axis, (_, weight) in found.loss.items() if axis != "nodes")
    if worst not in parts and (weight > HEAVIEST or (not parts and found.promised.weight.max() > HEAVIEST)):
        parts[worst] = WEIGHT_PARTS
    return parts


def _finer(found: Fitted, hair: Hair, tolerance: float) -> Axes:
    """The axes with those refined whose loss stands out, or the same if the tolerance is met."""
    axes = found.axes
    if not limits(found, tolerance):
        return axes
    counts = {}
    for axis, parts in _standing_out(found, tolerance).items():
        step = float(np.clip(parts**0.25, 1.25, LARGEST_STEP))
        counts[axis] = _count(axis, getattr(axes, axis), step, hair)
    if hair.nodes is not None:
        counts.pop("offset", None)
    return replace(axes, **counts)


def _count(axis: str, now: int, step: float, hair: Hair) -> int:
    """A count about step times as large: with rows that tables can share out, and cells in eights."""
    if axis == "theta_r":
        count = hair.row_count((now - 1) * step)
    elif axis == "offset":
        count = 2 * int(np.ceil((now - 1) * step / 2 - 1e-9)) + 1
    else:
        count = 8 * int(np.ceil(now * step / 8 - 1e-9))
    return count if count <= LIMITS[axis] else now
