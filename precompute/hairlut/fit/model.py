"""Gaussian lobes for a distribution, how well they and its own masses sample it, and which of them it needs.

A model that draws q where the light is f has the relative variance V = sum f^2/q - 1 over the cells of a
row, and needs 1 + V times the samples of a perfect one. All variances here are of tables without error;
baking adds its tolerance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.special import ndtr

from ..lobes import DIRECT_PHI, Array
from .decompose import Split, decompose, marginals
from .distribution import Distribution

FAILS = 0.1
"""A row whose Gaussian has a higher relative variance than this against its marginal is named."""

SUFFICES = 1.05
"""Gaussians that need at most this many times the samples of the masses themselves are enough."""

MAX_DEGREE = 4
SIGMA_RANGE = np.radians(0.5), 10.0


@dataclass(frozen=True)
class GaussianFit:
    """One lobe's Gaussians.

    centre: polynomial of theta_r, highest power first, for the mean of theta_i + theta_r, or of phi; rad.
    log_sigma: likewise for log(sigma / rad). mean, sigma (J,): their values at the rows, rad. row_mean,
    row_sigma (J,): what each row's own least squares found. r_squared, variance (J,): of the smooth
    Gaussian against the row's marginal density. peaks, skewness (J,): of that marginal.
    """

    name: str
    centre: Array
    log_sigma: Array
    mean: Array
    sigma: Array
    row_mean: Array
    row_sigma: Array
    r_squared: Array
    variance: Array
    peaks: Array
    skewness: Array


@dataclass(frozen=True)
class Fit:
    """Variances (J,) of drawing the data: uniformly over the sphere, with the marginals, with the split's
    own masses, with its Gaussians."""

    data: Distribution
    split: Split
    gaussians: tuple[GaussianFit, GaussianFit, GaussianFit]
    uniform: Array
    marginal: Array
    masses: Array
    gaussian: Array

    @property
    def needed(self) -> str:
        """ "gaussians" or "masses": what the scene needs."""
        return "gaussians" if self.ratio <= SUFFICES else "masses"

    @property
    def ratio(self) -> float:
        """Samples that the Gaussians need for one of the masses', over all rows."""
        return float((1 + self.gaussian).mean() / (1 + self.masses).mean())


def fit(
    data: Distribution,
    lobes: str = "both",
    degree: int = MAX_DEGREE,
    report: Callable[[str, float], None] = lambda stage, share: None,
) -> Fit:
    """Fits both kinds of model. report(stage, share done) is called now and then."""
    split = decompose(data, lobes, lambda share: report("splitting into direct and multiple", share))
    parts = split.tables(data)
    gaussians = []
    for k, (name, mass, edges) in enumerate(parts):
        report("fitting Gaussians", k / len(parts))
        gaussians.append(fit_gaussians(name, data.theta_r, edges, mass, degree))
    report("fitting Gaussians", 1.0)
    as_cells = [cells(g.mean, g.sigma, edges) for g, (_, _, edges) in zip(gaussians, parts, strict=True)]
    return Fit(
        data=data,
        split=split,
        gaussians=tuple(gaussians),
        uniform=variance(data, np.diff(np.sin(data.theta_edges))[:, None] / 2 * data.even),
        marginal=variance(data, marginals(data).drawn(data)),
        masses=variance(data, split.drawn(data)),
        gaussian=variance(data, Split(split.direct_weight, *as_cells).drawn(data, floor=0.0)),
    )


def variance(data: Distribution, drawn: Array) -> Array:
    """(J,) relative variance of estimating the light with cells drawn by masses (J, n, m) or (n, m)."""
    return (data.mass**2 / np.maximum(drawn, 1e-300)).sum(axis=(1, 2)) - 1


def cells(mean: Array, sigma: Array, edges: Array) -> Array:
    """(J, n) masses of the cells of Gaussians with mean and sigma (J,), cut to the edges' range."""
    z = (edges - np.asarray(mean)[:, None]) / np.asarray(sigma)[:, None]
    flip = (
        z[:, :-1] > 0
    )  # the difference of two upper tails keeps its digits where that of two lower ones does not
    low, high = np.where(flip, -z[:, 1:], z[:, :-1]), np.where(flip, -z[:, :-1], z[:, 1:])
    mass = ndtr(high) - ndtr(low) + 1e-300
    return mass / mass.sum(axis=1, keepdims=True)


def fit_gaussians(
    name: str, theta_r: Array, edges: Array, mass: Array, degree: int = MAX_DEGREE
) -> GaussianFit:
    """Least squares of a cut Gaussian to each row of masses (J, n), then polynomials through the rows."""
    rows = np.array([_fit_row(edges, row) for row in mass])
    row_mean, log_sigma, mean_error, sigma_error = rows.T
    moving = theta_r if name != DIRECT_PHI else 0.0
    centre = _polynomial(theta_r, row_mean + moving, mean_error, degree)
    width = _polynomial(theta_r, log_sigma, sigma_error, degree)
    mean, sigma = np.polyval(centre, theta_r) - moving, np.exp(np.polyval(width, theta_r))
    fitted = cells(mean, sigma, edges)
    size = np.diff(edges)
    middle = (edges[1:] + edges[:-1]) / 2
    away = mass / size - (mass / size).mean(axis=1, keepdims=True)
    moment = [(mass * (middle - row_mean[:, None]) ** k).sum(axis=1) for k in (1, 2, 3)]
    spread = np.maximum(moment[1] - moment[0] ** 2, 1e-12)
    return GaussianFit(
        name=name,
        centre=centre,
        log_sigma=width,
        mean=mean,
        sigma=sigma,
        row_mean=row_mean,
        row_sigma=np.exp(log_sigma),
        r_squared=1 - (((mass - fitted) / size) ** 2).sum(axis=1) / np.maximum((away**2).sum(axis=1), 1e-300),
        variance=(mass**2 / fitted).sum(axis=1) - 1,
        peaks=np.array([_peaks(row / size) for row in mass]),
        skewness=(moment[2] - 3 * moment[0] * moment[1] + 2 * moment[0] ** 3) / spread**1.5,
    )


def _fit_row(edges: Array, mass: Array) -> tuple[float, float, float, float]:
    """(mean, log sigma, their standard errors) of one row; weights 1/sqrt(mass + a hundredth of the peak)."""
    middle = (edges[1:] + edges[:-1]) / 2
    mean = float((mass * middle).sum())
    sigma = float(np.sqrt(max((mass * (middle - mean) ** 2).sum(), SIGMA_RANGE[0] ** 2)))
    peak = float(middle[np.argmax(mass / np.diff(edges))])
    weight = 1 / np.sqrt(mass + 0.01 * mass.max())

    def misfit(p):
        return weight * (cells(p[:1], np.exp(p[1:]), edges)[0] - mass)

    span = edges[-1] - edges[0]
    low = [edges[0] - span, np.log(SIGMA_RANGE[0])]
    high = [edges[-1] + span, np.log(SIGMA_RANGE[1])]
    starts = ([mean, np.log(sigma)], [peak, np.log(sigma / 2)], [peak, np.log(sigma / 8)])
    results = [
        least_squares(misfit, np.clip(start, low, high), bounds=(low, high), x_scale=(0.1, 0.1))
        for start in starts
    ]
    best = min(results, key=lambda result: result.cost)
    noise = 2 * best.cost / max(len(mass) - 2, 1)
    error = np.sqrt(np.diag(np.linalg.pinv(best.jac.T @ best.jac)) * noise)
    return (*best.x, *np.maximum(error, 1e-6))


def _polynomial(theta_r: Array, values: Array, error: Array, degree: int) -> Array:
    """Weighted polynomial whose degree predicts a left-out row best; the lowest within 5 % of that."""
    weight = 1 / np.sqrt(error**2 + np.median(error) ** 2)
    highest = min(degree, len(theta_r) - 2)
    if highest < 1:
        return np.array([np.average(values, weights=weight**2)])
    scores = [_left_out(theta_r, values, weight, d) for d in range(highest + 1)]
    enough = int(np.argmax(np.array(scores) <= 1.05 * min(scores) + 1e-18))
    return np.polyfit(theta_r, values, enough, w=weight)


def _left_out(theta_r: Array, values: Array, weight: Array, degree: int) -> float:
    """Weighted mean square of what the polynomial through the other rows misses each row by."""
    basis = np.vander(theta_r, degree + 1) * weight[:, None]
    hat = basis @ np.linalg.pinv(basis)
    missed = weight * values - hat @ (weight * values)
    return float(np.mean((missed / np.maximum(1 - np.diag(hat), 1e-9)) ** 2))


def _peaks(density: Array) -> int:
    """How many maxima above a tenth of the highest remain after a moving average over three cells."""
    smooth = np.convolve(np.pad(density, 1, mode="edge"), np.ones(3) / 3, mode="valid")
    rises = np.diff(np.concatenate([[0.0], smooth, [0.0]])) > 0
    tops = np.flatnonzero(rises[:-1] & ~rises[1:])
    kept: list[int] = []
    for top in tops[smooth[tops] > 0.1 * smooth.max()]:
        if kept and smooth[kept[-1] : top + 1].min() > 0.9 * min(smooth[kept[-1]], smooth[top]):
            kept[-1] = max(kept[-1], top, key=lambda k: smooth[k])
        else:
            kept.append(int(top))
    return len(kept)
