# SPDX-License-Identifier: BSD-3-Clause
"""Hard cases: each one works with a stated error, or is refused with a stated message."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from hairlut import interpolant
from hairlut.errors import HairlutError
from hairlut.exact import Exact
from hairlut.lobes import FITTED, HALF_PI, PRINTED, Array, Lobe
from hairlut.measure import narrowest_cell
from hairlut.size import Choice, table_of_size
from hairlut.table import Table
from report.markdown import table

SIDE = 64
ENDS = 2.0 ** -np.array([24.0, 28.0, 32.0])


@dataclass(frozen=True)
class Case:
    """name, lobe, and whether a table of it is expected (or a refusal)."""

    name: str
    lobe: Lobe
    works: bool = True


@dataclass(frozen=True)
class Outcome:
    """The outcome of a case: a choice, or the message of its refusal."""

    case: Case
    choice: Choice | None
    message: str = ""


def _lobe(log_density: Callable[[Array, Array], Array], breakpoints=()) -> Lobe:
    """A lobe over theta_i that is the same for every theta_r, unless log_density says otherwise."""

    def broadcast(x, theta_r):
        with np.errstate(divide="ignore", invalid="ignore"):
            return log_density(x, theta_r) + np.zeros_like(theta_r)

    return replace(
        FITTED.direct_theta,
        model="hard",
        log_density=broadcast,
        formula="hard case",
        breakpoints=breakpoints,
        moments=None,
    )


def normal(mean: float, sigma: float, breakpoints=()) -> Lobe:
    return _lobe(lambda x, theta_r: -0.5 * ((x - mean) / sigma) ** 2, breakpoints)


def moving(sigma: float) -> Lobe:
    """A narrow lobe whose mean follows theta_r over a sixth of the domain."""
    return _lobe(lambda x, theta_r: -0.5 * ((x - theta_r / 6) / sigma) ** 2)


def _mixture(*parts: tuple[float, float, float], breakpoints=()) -> Lobe:
    """Gaussians (mass, mean, sigma)."""

    def log_density(x, theta_r):
        return np.log(sum(w / s * np.exp(-0.5 * ((x - m) / s) ** 2) for w, m, s in parts))

    return _lobe(log_density, breakpoints)


def _between(low: float, high: float, inside: float = 0.0, outside: float = -np.inf) -> Callable:
    return lambda x, theta_r: np.where((x >= low) & (x < high), inside, outside)


CASES = (
    Case("printed, theta_r to +-90 deg: the mean 5.3 sigma outside", PRINTED.direct_theta),
    Case("sigma = 1e-4", normal(0.3, 1e-4, (0.3,))),
    Case("sigma = 1e-4 at 89 deg", normal(1.5533, 1e-4, (1.5533,))),
    Case("sigma = 1e-3", normal(0.3, 1e-3)),
    Case("sigma = 1e-2", normal(0.3, 1e-2)),
    Case("sigma = 10", normal(0.3, 10.0)),
    Case("sigma = 0.02, the mean moving with theta_r", moving(0.02)),
    Case("mean 40 sigma outside, sigma = 0.29", normal(HALF_PI + 40 * 0.29, 0.29)),
    Case("mean 40 sigma outside, sigma = 0.01", normal(HALF_PI + 40 * 0.01, 0.01)),
    Case("both ends cut at 0.5 sigma", normal(0.0, 2 * HALF_PI)),
    Case("narrow spike: a tenth of the mass in sigma = 1e-3", _mixture((0.9, 0.0, 0.4), (0.1, 0.7, 1e-3))),
    Case("two modes", _mixture((0.5, -0.8, 0.1), (0.5, 0.8, 0.1))),
    Case("two modes, a hundred times as heavy as each other", _mixture((0.99, -0.8, 0.1), (0.01, 0.8, 0.1))),
    Case("zero over the lower half of the domain", _lobe(_between(0.0, 2.0), (0.0,))),
    Case("zero over the middle third", _lobe(_between(-0.5, 0.5, -np.inf, 0.0), (-0.5, 0.5))),
    Case("a step by a factor of 10", _lobe(_between(0.2, 2.0, 0.0, np.log(0.1)), (0.2,))),
    Case(
        "a step by a factor of 10 that is not named a breakpoint", _lobe(_between(0.2, 2.0, 0.0, np.log(0.1)))
    ),
    Case(
        "unbounded at an end: 1/sqrt(distance)", _lobe(lambda x, t: -0.5 * np.log(x + HALF_PI)), works=False
    ),
    Case("sigma = 1e-6", normal(0.3, 1e-6, (0.3,))),
    Case("sigma = 1e-4 that is not named a breakpoint", normal(0.3, 1e-4)),
    Case("zero everywhere", _lobe(_between(9.0, 9.0)), works=False),
    Case("NaN", _lobe(lambda x, t: np.where(x > 0.5, np.nan, 0.0)), works=False),
    Case("infinite", _lobe(lambda x, t: np.where(x > 0.5, np.inf, 0.0)), works=False),
)


def attempt(case: Case) -> Outcome:
    try:
        return Outcome(case, table_of_size(case.lobe, SIDE, SIDE))
    except HairlutError as error:
        return Outcome(case, None, str(error))


@dataclass(frozen=True)
class End:
    """A draw at u = m from one end: the angle, the lobe's own quantile, and the density, per rad."""

    table: str
    m: float
    upper: bool
    angle: float
    quantile: float
    density: float


def ends(baked: Table, lobe: Lobe) -> list[End]:
    """Draws within 2^-32 of both ends, at the inclination where they miss the quantile the most."""
    exact = Exact(lobe, baked.theta_r)
    found = []
    for m in ENDS:
        for upper in (False, True):
            angle, density = interpolant.sample_tail(
                baked, baked.theta_r, np.full(baked.height, m), np.full(baked.height, upper)
            )
            quantile = exact.quantiles(np.array([m]), np.array([upper]))[:, 0]
            j = int(abs(angle - quantile).argmax())
            label = f"{baked.model}/{baked.name}"
            found.append(
                End(label, float(m), upper, float(angle[j]), float(quantile[j]), float(density.min()))
            )
    return found


TEXT = f"""# Hard cases

Each case is baked at {SIDE}x{SIDE}, with the e that suits it best, and measured on every row and at three
points between rows; or it is refused, with the message given. The same cases are tests
(`tests/report/test_hard.py`), and the narrowest lobes pass chi-squared tests there, drawn by the C
library in single precision.

V is the relative variance that the table adds to an estimate, `heavy` the probability of a weight above 4.
Every table reaches its whole domain, so the estimate is unbiased in every row of this page, also where V is
large.
"""

COMMENT = """
What this says:

- **Narrow lobes** work down to sigma = 1e-4 (0.006 degrees). Their largest weights are large and almost never
  drawn: the first and last cell reach from the lobe to the ends of the domain, 15000 sigma away, because a
  direction that the table can never sample is energy that no weight restores.
- **A valley** is what this design does worst. Two separate modes, or a gap of zero density, put a jump into
  the inverse CDF at a probability where the warp has its widest cells. Make such a distribution two lobes of
  a model, with their masses as shares.
- **A jump** of the density costs one badly fitting cell: V falls as 1/width, not as 1/width^4.
- **Ends that are cut**, and means far outside, cost little until the density falls off within a few hundred
  float steps of the domain's end: the mean 40 sigma outside with sigma = 0.01 decays over 2.5e-4 rad, and
  floats near pi/2 are 1.2e-7 apart.
"""

TAILS = """The shipped tables, in the row where the sample is farthest from the lobe's quantile. The end cells
reach to the domain's end, so samples this rare lie farther out than the lobe's, with a density to match.
"""


CASE_COLUMNS = (
    "case", "V", "largest weight", "heavy", "TV", "quantile error, u in [2^-12, 1-2^-12]", "narrowest cell",
)  # fmt: skip
END_COLUMNS = "table", "u", "angle sampled", "exact quantile", "least density"


def page(outcomes: list[Outcome], draws: list[End]) -> str:
    """The page as Markdown."""
    refused = [f"- {each.case.name}: `{each.message}`" for each in outcomes if not each.choice]
    parts = [
        TEXT,
        table(CASE_COLUMNS, map(_case_row, outcomes)) + COMMENT,
        "## Refused\n",
        "\n".join(refused) + "\n",
        "## u within 2^-32 of both ends\n",
        TAILS,
        table(END_COLUMNS, map(_end_row, draws)),
    ]
    return "\n".join(parts)


def _case_row(outcome: Outcome) -> tuple[str, ...]:
    if outcome.choice is None:
        return outcome.case.name, "refused", "", "", "", "", ""
    errors = outcome.choice.errors
    return (
        outcome.case.name,
        f"{errors.relative_variance:.1e}",
        f"{errors.largest_weight:.3g}",
        f"{errors.heavy_probability:.0e}",
        f"{errors.total_variation:.1e}",
        f"{errors.inner_quantile_error:.1e} rad",
        f"{narrowest_cell(outcome.choice.table.texels):.0f} float steps",
    )


def _end_row(end: End) -> tuple[str, ...]:
    u = f"{'1 - ' if end.upper else ''}2^{np.log2(end.m):.0f}"
    return end.table, u, f"{end.angle:.6f}", f"{end.quantile:.6f}", f"{end.density:.1e}"
