"""The smallest table that meets a tolerance, found by measuring tables.

The tolerance bounds the relative variance V (measure.py) on every row and between rows. V falls with the
width until the rows themselves are exact enough, and then only with the height. So widths are tried from the
narrowest that meets the tolerance on rows alone up to WIDEST times that (a wider table would have to make do
with half its rows); for each the lowest height is found by bisection, and the fewest texels win.

The warp's e is measured too: a small e serves the tails and starves the end cells of floating-point steps.
Only tables whose narrowest cell spans MIN_STEPS steps of a float are considered, and among the powers of two
that meet the tolerance at the size found the largest is taken: its end cells are the widest.

For a table of given size, V is judged for every e, as it rises and falls with e where a lobe has two peaks: a
cell that spans the gap between them costs more or less as knots meet its ends. Of the e that are within SLACK
of the least V the one whose largest weight f/q is least is taken, as a large weight is a firefly.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from .errors import HairlutError
from .exact import Exact, exact_at
from .invert import ALL
from .lobes import Lobe
from .measure import BETWEEN, ON_ROWS, Errors, estimate, inclinations, measure, narrowest_cell
from .table import Table, check_size, row_angles, tabulate
from .warp import Warp

DEFAULT_TOLERANCE = 1e-4
DEFAULT_LIMIT = 256
MIN_STEPS = 2.0
EXPONENTS = range(-34, 1)  # of e
FIRST_EXPONENT = -16
PROBE_HEIGHT = 33  # rows on which a width alone is judged
WIDEST = 2
SEARCHED_BETWEEN = 1  # midway between rows is the worst place
FEW = 7  # every so many inclinations are measured first; odd, so that rows and places between them take turns
SLACK = 1.1  # an e is as good as the best if its variance is within this factor


class ToleranceError(HairlutError):
    """A tolerance that no table within the size limit meets. The message says how close the best one came."""


@dataclass(frozen=True)
class Choice:
    """A table, its errors, and in words why it is what it is."""

    table: Table
    errors: Errors
    reason: str


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
    if not tolerance > 0:
        raise HairlutError(
            f"tolerance {tolerance!r}: expected a relative variance above 0, such as {DEFAULT_TOLERANCE:g}"
        )
    trials = _Trials(lobe)
    width, height, exponent = _smallest_size(trials, tolerance, limit)
    while (variance := trials.variance(width, height, exponent, BETWEEN)) > tolerance:
        taller = [side for side in heights(lobe, limit) if side > height]
        if not taller:
            raise _unmet(lobe, tolerance, limit, variance, width, height)
        height = taller[0]
    exponent = trials.largest_exponent(width, height, BETWEEN, exponent, tolerance)
    reason = f"smallest with V <= {tolerance:g}, and largest e that keeps it"
    return trials.choice(width, height, exponent, reason)


def table_of_size(lobe: Lobe, width: int, height: int) -> Choice:
    """The table of a given size; HairlutError where some cell is too narrow for float32 with every e."""
    check_size(width, height)
    exact = exact_at(lobe, inclinations(lobe.theta_r_range, height, BETWEEN))
    tables = {e: _usable(lobe, exact, width, e, ON_ROWS) for e in EXPONENTS}
    tables = {e: table for e, table in tables.items() if table}
    if not tables:
        raise HairlutError(
            f"{lobe.model}/{lobe.name}: at {width}x{height} some cell is narrower than {MIN_STEPS:g} steps "
            "of a float with every e: use fewer columns"
        )
    table = tables[_lightest(tables, lobe, exact)]
    return Choice(
        table, measure(table, lobe, exact=exact), "size as asked, lightest e within 10% of the least V"
    )


def _usable(lobe: Lobe, exact: Exact, width: int, exponent: int, rows: slice = ALL) -> Table | None:
    """The table whose rows are these of the exact lobe's; None if a cell is flat or too narrow for
    float32."""
    try:
        table = tabulate(lobe, exact, width, Warp("octaves", 2.0**exponent), rows)
    except HairlutError:  # flat cells
        return None
    return table if narrowest_cell(table.texels) >= MIN_STEPS else None


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


class _Trials:
    """Tables of one lobe, on integrals that are worked out once for each height."""

    def __init__(self, lobe: Lobe):
        self.lobe = lobe
        self.rows = cache(self._rows)
        self.exact = cache(self._exact)
        self.variance = cache(self._variance)

    def _rows(self, height: int) -> Exact:
        return exact_at(self.lobe, row_angles(self.lobe.theta_r_range, height))

    def _exact(self, height: int, between: int) -> Exact:
        return exact_at(self.lobe, inclinations(self.lobe.theta_r_range, height, between))

    def table(self, width: int, height: int, exponent: int) -> Table | None:
        return _usable(self.lobe, self.rows(height), width, exponent)

    def _variance(self, width: int, height: int, exponent: int, between: int) -> float:
        """V at the worst inclination; infinite where a cell is flat or too narrow for float32."""
        table = self.table(width, height, exponent)
        if not table:
            return np.inf
        return measure(table, self.lobe, between, False, self.exact(height, between)).relative_variance

    def best_exponent(self, width: int, height: int, between: int, start: int) -> int:
        """The exponent of e with the least variance, walking downhill from start."""
        here = start
        while True:
            near = [e for e in (here, here + 1, here - 1) if e in EXPONENTS]
            best = min(near, key=lambda e: (self.variance(width, height, e, between), -e))
            if best == here:
                return here
            here = best

    def largest_exponent(self, width: int, height: int, between: int, start: int, bound: float) -> int:
        """The largest exponent of e above start up to which V stays within bound."""
        while start + 1 in EXPONENTS and self.variance(width, height, start + 1, between) <= bound:
            start += 1
        return start

    def choice(self, width: int, height: int, exponent: int, reason: str) -> Choice:
        table = self.table(width, height, exponent)
        return Choice(table, measure(table, self.lobe, exact=self.exact(height, BETWEEN)), reason)


def _smallest_size(trials: _Trials, tolerance: float, limit: int) -> tuple[int, int, int]:
    """(width, height, exponent) of the fewest texels, judged on rows and midway between them."""
    widths = _widths(trials, tolerance, limit)
    best, closest = None, (np.inf, limit, limit)
    height = heights(trials.lobe, limit)[0]
    for width, exponent in reversed(widths):
        tallest = limit if best is None else (best[0] * best[1] - 1) // width
        among = [side for side in heights(trials.lobe, limit) if height <= side <= tallest]
        found = _lowest(partial(_searched, trials, width, exponent), tolerance, among)
        if found is None:
            if best is None:
                closest = min(closest, (_searched(trials, width, exponent, limit), width, limit))
            continue
        best, height = (width, found, exponent), found
    if best is None:
        raise _unmet(trials.lobe, tolerance, limit, *closest)
    return best


def _searched(trials: _Trials, width: int, exponent: int, height: int) -> float:
    return trials.variance(width, height, exponent, SEARCHED_BETWEEN)


def _widths(trials: _Trials, tolerance: float, limit: int) -> list[tuple[int, int]]:
    """(width, best exponent) of the widths to try, ascending; ToleranceError if rows alone miss the tolerance
    at all."""
    height = min(PROBE_HEIGHT, limit)
    exponent, widths, closest = FIRST_EXPONENT, [], (np.inf, 0, height)
    for width in ladder(limit):
        exponent = trials.best_exponent(width, height, 0, exponent)
        variance = trials.variance(width, height, exponent, 0)
        closest = min(closest, (variance, width, height))
        if variance <= tolerance:
            widths.append((width, exponent))
        if widths and width >= WIDEST * widths[0][0]:
            break
    if not widths:
        raise _unmet(trials.lobe, tolerance, limit, *closest)
    return widths


def _lowest(variance: Callable[[int], float], tolerance: float, heights: list[int]) -> int | None:
    """The lowest of these ascending heights that meets the tolerance; None if the last does not."""
    low, high, step = 0, 0, 1
    while high < len(heights) and variance(heights[high]) > tolerance:
        low, high, step = high + 1, high + step, 2 * step
    if high >= len(heights):
        high = len(heights) - 1
        if high < low or variance(heights[high]) > tolerance:
            return None
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if variance(heights[middle]) <= tolerance else (middle + 1, high)
    return heights[high]


def _unmet(
    lobe: Lobe, tolerance: float, limit: int, variance: float, width: int, height: int
) -> ToleranceError:
    closest = (
        f"the closest, {width}x{height}, has {variance:.2e}"
        if width
        else "their cells are too narrow for floats"
    )
    return ToleranceError(
        f"{lobe.model}/{lobe.name}: no table of up to {limit}x{limit} has V <= {tolerance:g}; {closest}: "
        "raise --tolerance, or the limit with --max-size"
    )
