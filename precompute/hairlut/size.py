# SPDX-License-Identifier: BSD-3-Clause
"""The smallest table that meets a tolerance.

The tolerance bounds the relative variance V (measure.py) on every row and between rows. V falls with the
width until the rows themselves are exact enough, and then only with the height. sketch.py estimates both; of
the widths from the narrowest that meets the tolerance on rows alone up to WIDEST times that, the one with the
fewest texels is taken, at the lowest height that does. The table is then measured, and grows by a step
where the estimate was too good. Tables of one model take the same number of rows where that costs at most
SHARING of their texels: a renderer then computes the row of theta_r once.

The warp's e is the power of two of the least V on rows. Only tables whose narrowest cell spans MIN_STEPS
steps of a float are considered.

For a table of given size, V is judged for every e, as it rises and falls with e where a lobe has two peaks: a
cell that spans the gap between them costs more or less as knots meet its ends. Of the e that are within SLACK
of the least V the one whose largest weight f/q is least is taken, as a large weight is a firefly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .errors import HairlutError
from .exact import Exact, exact_at
from .lobes import Array, Lobe
from .measure import BETWEEN, ON_ROWS, Errors, estimate, inclinations, measure
from .sketch import EXPONENTS, MIN_STEPS, Sketch, usable
from .table import Table, check_size, tabulate
from .warp import Warp

DEFAULT_TOLERANCE = 2e-5
DEFAULT_LIMIT = 256
FIRST_WIDTH = 24
ORDER = 4.5  # V falls about as this power of the width on rows, and as
BLEND_ORDER = 4.0  # this one of the height between them
WIDEST = 2
SHARING = 1.25
SEARCHED_BETWEEN = 1  # midway between rows is the worst place
FEW = 7  # every so many inclinations are measured first; odd, so that rows and places between them take turns
SLACK = 1.1  # an e is as good as the best if its variance is within this factor


class ToleranceError(HairlutError):
    """A tolerance that no table of this lobe within the size limit meets. The message says how close the best
    one came."""

    def __init__(self, lobe: Lobe, message: str) -> None:
        super().__init__(message)
        self.lobe = lobe


@dataclass(frozen=True)
class Choice:
    """A table, its errors, and in words why it is what it is."""

    table: Table
    errors: Errors
    reason: str


@dataclass(frozen=True)
class Plan:
    """The size of a table, chosen by estimates. places: theta_r where the blend of rows costs most."""

    sketch: Sketch
    width: int
    height: int
    exponent: int
    places: Array

    @property
    def texels(self) -> int:
        return self.width * self.height

    @property
    def variance(self) -> float:
        return self.sketch.between(self.width, self.exponent, self.height, self.places)

    def resized(self, width: int, height: int) -> Plan:
        return replace(
            self, width=width, height=height, exponent=self.sketch.best_exponent(width, self.exponent)
        )


def ladder(limit: int) -> list[int]:
    """Sides considered, up to limit: multiples of 4 to 64, then 16 steps an octave."""
    sides = list(range(8, 64, 4))
    octave = 64
    while octave <= limit:
        sides += range(octave, 2 * octave, octave // 16)
        octave *= 2
    return [side for side in sides if side <= limit]


def heights(lobe: Lobe, limit: int) -> list[int]:
    """Heights considered, up to limit: the ladder, or those whose rows fall on the lobe's own rows if it has
    any."""
    if lobe.own_height and lobe.own_height <= limit:
        return list(range(lobe.own_height, limit + 1, lobe.own_height - 1))
    return ladder(limit)


def smallest_table(lobe: Lobe, tolerance: float, limit: int = DEFAULT_LIMIT) -> Choice:
    """The table of fewest texels with V <= tolerance and sides of the ladder up to limit, or
    ToleranceError."""
    return smallest_tables([lobe], tolerance, limit)[0]


def smallest_tables(lobes: Sequence[Lobe], tolerance: float, limit: int = DEFAULT_LIMIT) -> list[Choice]:
    """The same for the lobes of a model, with equal heights where they cost little."""
    if not tolerance > 0:
        raise HairlutError(
            f"tolerance {tolerance!r}: expected a relative variance above 0, such as {DEFAULT_TOLERANCE:g}"
        )
    plans = [_plan(lobe, tolerance, limit) for lobe in lobes]
    return [_measured(plan, tolerance, limit) for plan in _with_equal_heights(plans, tolerance)]


def _plan(lobe: Lobe, tolerance: float, limit: int) -> Plan:
    """The smallest size by the estimates."""
    sketch, sides = Sketch(lobe), ladder(limit)
    narrowest, exponent = _narrowest(sketch, tolerance, sides)
    widths = [side for side in sides if narrowest <= side <= WIDEST * narrowest]
    widest = widths[-1]
    cost, places = sketch.blend(widest, sketch.best_exponent(widest, exponent))
    on_rows = sketch.on_rows(narrowest, exponent)

    def height(width: int) -> float:
        """At which the blend takes what the width leaves of the tolerance."""
        rest = tolerance - min(on_rows * (narrowest / width) ** ORDER, 0.95 * tolerance)
        return 1 + (sketch.height - 1) * max(cost / rest, 0.0) ** (1 / BLEND_ORDER)

    width = min(widths, key=lambda side: side * max(height(side), sides[0]))
    plan = Plan(sketch, width, 0, sketch.best_exponent(width, exponent), places)
    plan = _lowest(plan, tolerance, heights(lobe, limit), height(width))
    while (narrower := _narrower(plan, tolerance, sides)) is not None:
        plan = _lowest(narrower, tolerance, heights(lobe, limit), narrower.height)
    return plan


def _narrowest(sketch: Sketch, tolerance: float, sides: list[int]) -> tuple[int, int]:
    """(width, exponent of e) of the narrowest table that meets the tolerance on rows alone."""
    exponent = sketch.best_exponent(min(FIRST_WIDTH, sides[-1]))

    def variance(width: int) -> float:
        return sketch.on_rows(width, sketch.best_exponent(width, exponent))

    first = variance(min(FIRST_WIDTH, sides[-1]))
    guess = FIRST_WIDTH * (first / tolerance) ** (1 / ORDER) if np.isfinite(first) else sides[-1]
    n = _first_within(variance, tolerance, sides, guess)
    if n is None:
        raise _unmet(sketch.lobe, tolerance, sides[-1], variance(sides[-1]), sides[-1], sketch.height)
    return sides[n], sketch.best_exponent(sides[n], exponent)


def _lowest(plan: Plan, tolerance: float, sides: list[int], guess: float) -> Plan:
    """The plan at the lowest of these heights that meets the tolerance."""
    n = _first_within(lambda height: replace(plan, height=height).variance, tolerance, sides, guess)
    if n is None:
        last = replace(plan, height=sides[-1])
        lobe = plan.sketch.lobe
        raise _unmet(lobe, tolerance, sides[-1], last.variance, last.width, last.height)
    return replace(plan, height=sides[n])


def _narrower(plan: Plan, tolerance: float, sides: list[int]) -> Plan | None:
    """The plan with the next narrower width, if that meets the tolerance."""
    below = [side for side in sides if side < plan.width]
    if not below:
        return None
    narrower = plan.resized(below[-1], plan.height)
    return narrower if narrower.variance <= tolerance else None


def _first_within(
    variance: Callable[[int], float], tolerance: float, sides: list[int], guess: float
) -> int | None:
    """The number of the first of these ascending sides whose variance is within the tolerance, going up or
    down from a guess in doubling steps and then by bisection; None if that of the last is not."""
    start = min(int(np.searchsorted(sides, guess)), len(sides) - 1)
    step, low, high = 1, -1, len(sides)  # beyond low: not within; high: within
    n = start
    while high - low > 1:
        if variance(sides[n]) <= tolerance:
            high = n
            n = max(high - step, low + 1) if low < 0 else (low + high) // 2
        else:
            low = n
            n = min(low + step, high - 1) if high == len(sides) else (low + high) // 2
        step *= 2
    return high if high < len(sides) else None


def _with_equal_heights(plans: list[Plan], tolerance: float) -> list[Plan]:
    """The plans at the height of the tallest, if all lobes can have it and it costs little."""
    tallest = max(plan.height for plan in plans)
    if any(plan.sketch.lobe.own_height for plan in plans):
        return plans
    equal = [
        plan if plan.height == tallest else _narrowest_of(replace(plan, height=tallest), tolerance)
        for plan in plans
    ]
    before, after = (sum(plan.texels for plan in each) for each in (plans, equal))
    return equal if after <= SHARING * before else plans


def _narrowest_of(plan: Plan, tolerance: float) -> Plan:
    while (narrower := _narrower(plan, tolerance, ladder(plan.width))) is not None:
        plan = narrower
    return plan


def _measured(plan: Plan, tolerance: float, limit: int) -> Choice:
    """The plan's table, or the next wider or taller one that meets the tolerance when it is measured."""
    lobe = plan.sketch.lobe
    while True:
        exact = exact_at(lobe, inclinations(lobe.theta_r_range, plan.height, BETWEEN))
        table = tabulate(lobe, exact, plan.width, Warp("octaves", 2.0**plan.exponent), ON_ROWS)
        errors = measure(table, lobe, exact=exact)
        if errors.relative_variance <= tolerance:
            return Choice(table, errors, f"smallest with V <= {tolerance:g}")
        wider = [side for side in ladder(limit) if side > plan.width]
        taller = [side for side in heights(lobe, limit) if side > plan.height]
        if errors.variance[ON_ROWS].max() > tolerance and wider:
            plan = plan.resized(wider[0], plan.height)
        elif taller:
            plan = plan.resized(plan.width, taller[0])
        else:
            raise _unmet(lobe, tolerance, limit, errors.relative_variance, plan.width, plan.height)


def table_of_size(lobe: Lobe, width: int, height: int) -> Choice:
    """The table of a given size; HairlutError where some cell is too narrow for float32 with every e."""
    check_size(width, height)
    exact = exact_at(lobe, inclinations(lobe.theta_r_range, height, BETWEEN))
    tables = {e: usable(lobe, exact, width, e, ON_ROWS) for e in EXPONENTS}
    tables = {e: table for e, table in tables.items() if table}
    if not tables:
        raise HairlutError(
            f"{lobe.model}/{lobe.name}: at {width}x{height} some cell is narrower than {MIN_STEPS:g} steps "
            "of a float with every e: use fewer columns"
        )
    table = tables[_lightest(tables, lobe, exact)]
    return Choice(
        table,
        measure(table, lobe, exact=exact),
        "size as requested, e of the least largest weight within 10% of the least V",
    )


def _lightest(tables: dict[int, Table], lobe: Lobe, exact: Exact) -> int:
    """The exponent of e with the least largest weight, among those whose V is within SLACK of the least.

    V is judged on rows and midway between them. What it is on few of these bounds it from below, which most
    e do not survive; then it matters little how many there are.
    """
    searched = np.arange(0, len(exact.theta_r), (BETWEEN + 1) // (SEARCHED_BETWEEN + 1))
    few = searched[::FEW]

    bound = {e: estimate(table, lobe, exact, few)[0] for e, table in tables.items()}
    found: dict[int, tuple[float, float]] = {}
    least = np.inf
    for e in sorted(bound, key=bound.get):
        if bound[e] > SLACK * least:
            break
        found[e] = estimate(tables[e], lobe, exact, searched)
        least = min(least, found[e][0])
    good = [e for e, (variance, _) in found.items() if variance <= SLACK * least]
    return min(good, key=lambda e: found[e][1])


def _unmet(
    lobe: Lobe, tolerance: float, limit: int, variance: float, width: int, height: int
) -> ToleranceError:
    closest = (
        f"the closest, {width}x{height}, has {variance:.2e}"
        if np.isfinite(variance)
        else "their cells are too narrow for floats"
    )
    return ToleranceError(
        lobe,
        f"{lobe.model}/{lobe.name}: no table of up to {limit}x{limit} has V <= {tolerance:g}; {closest}: "
        "raise --tolerance, or the limit with --max-size",
    )
