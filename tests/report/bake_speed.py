# SPDX-License-Identifier: BSD-3-Clause
"""How long the bake takes, beside scipy's two ways to the same quantiles of the same rows."""

from dataclasses import dataclass
from time import process_time

import numpy as np

from hairlut import analytic
from hairlut.lobes import Lobe
from hairlut.table import Table
from report.markdown import table as markdown_table

REPEATS = 3  # of which the fastest counts, for all
ROWS = 12  # of each table on which the rivals are timed


@dataclass(frozen=True)
class Baking:
    """Seconds for whole tables, and the largest error of an angle in double precision, rad, at the same
    nodes."""

    name: str
    seconds: float
    error: float


def compare(tables: list[tuple[Table, Lobe]], rows: int = ROWS) -> list[Baking]:
    """hairlut, NumericalInversePolynomial and truncnorm.ppf on the nodes of the tables. Rivals are timed on
    `rows` rows of each table, and their seconds scaled to all of them."""
    import scipy.stats  # noqa: F401  its import takes seconds

    seconds, error = np.zeros(3), np.zeros(3)
    for table, lobe in tables:
        picked = np.unique(np.linspace(0, table.height - 1, rows).round().astype(int))
        m, upper = table.warp.knots(table.width)
        inner = slice(1, -1)  # the ends are the domain's, for all
        exact = analytic.quantile(lobe, table.theta_r[picked][:, None], m[inner], upper[inner])
        for k, way in enumerate((_ours, _polynomial, _truncnorm)):
            took = []
            for _ in range(REPEATS):
                started = process_time()
                angles, share = way(table, lobe, picked)
                took.append((process_time() - started) * share)
            seconds[k] += min(took)
            error[k] = max(error[k], float(abs(angles - exact).max()))
    names = "hairlut", "scipy NumericalInversePolynomial", "scipy truncnorm.ppf"
    return [Baking(*row) for row in zip(names, seconds.tolist(), error.tolist(), strict=True)]


def _ours(table: Table, lobe: Lobe, picked) -> tuple[np.ndarray, float]:
    from hairlut.integrate import integrate, rows_of_lobe
    from hairlut.invert import invert

    angles = invert(integrate(rows_of_lobe(lobe, table.theta_r)), *table.warp.knots(table.width))
    return angles[picked][:, 1:-1], 1.0


def _polynomial(table: Table, lobe: Lobe, picked) -> tuple[np.ndarray, float]:
    from scipy.stats.sampling import NumericalInversePolynomial

    u, angles = table.warp.u(table.width)[1:-1], []
    for theta_r in table.theta_r[picked]:
        density = _Density(lobe, theta_r)
        rng = NumericalInversePolynomial(density, domain=lobe.domain, center=density.mode, u_resolution=1e-12)
        angles.append(rng.ppf(u))
    return np.array(angles), table.height / len(picked)


class _Density:
    """One row as scipy wants it: a density of a scalar that does not underflow."""

    def __init__(self, lobe: Lobe, theta_r: float):
        mean, sigma = (float(x[0]) for x in lobe.moments(np.array([theta_r])))
        self.mean, self.sigma = mean, sigma
        self.mode = min(max(mean, lobe.domain[0]), lobe.domain[1])

    def logpdf(self, x: float) -> float:
        return ((self.mode - self.mean) ** 2 - (x - self.mean) ** 2) / (2 * self.sigma**2)

    def pdf(self, x: float) -> float:
        return float(np.exp(self.logpdf(x)))


def _truncnorm(table: Table, lobe: Lobe, picked) -> tuple[np.ndarray, float]:
    from scipy.stats import truncnorm

    mean, sigma = lobe.moments(table.theta_r[picked][:, None])
    low, high = ((end - mean) / sigma for end in lobe.domain)
    m, upper = (each[1:-1] for each in table.warp.knots(table.width))
    angles = np.where(
        upper, truncnorm.isf(m, low, high, mean, sigma), truncnorm.ppf(m, low, high, mean, sigma)
    )
    return angles, table.height / len(picked)


def section(results: list[Baking]) -> str:
    ours = results[0]
    rows = [
        (each.name, f"{each.seconds:.3f} s", f"{each.seconds / ours.seconds:.1f}", f"{each.error:.1e} rad")
        for each in results
    ]
    text = """## Baking

All six shipped tables, computing only: integration and inversion at the same nodes, and the largest error of
a node in double precision against the closed form. hairlut integrates any density; truncnorm.ppf knows that
it is a Gaussian.

"""
    return text + markdown_table(("way", "six tables", "times hairlut", "largest error"), rows)
