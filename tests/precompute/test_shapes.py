# SPDX-License-Identifier: BSD-3-Clause
"""Lobes that are not cut Gaussians: baked to a tolerance, and measured here against their own closed form or
quadrature, by nothing that the bake uses."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy import integrate, interpolate, special

from hairlut import interpolant, modelfile
from hairlut.lobes import HALF_PI
from hairlut.size import smallest_table
from hairlut.tabulated import FLOOR

EXAMPLES = Path(__file__).parents[2] / "precompute" / "examples"
TOLERANCE = 1e-3
ANGLES = np.radians([-90.0, -71.3, -30.0, -3.1, 0.0, 17.7, 45.0, 68.2, 90.0])


@pytest.fixture(scope="module")
def bake():
    """The table that the tolerance picks, baked once for the tests of a module."""
    done = {}

    def of(file, name):
        if (file, name) not in done:
            model = modelfile.find(str(EXAMPLES / file))
            done[file, name] = smallest_table(getattr(model, name), TOLERANCE).table
        return done[file, name]

    return of


def variance(table, density, theta_r, points=1000):
    """integral of f^2/q over the domain, less 1, by the midpoint rule; density(x) is normalised.

    q jumps where cells meet, so each cell is summed by itself: one grid over all of them would be off by
    2 % of V. The middle of u, where the warp folds, ends a cell too.
    """
    u = np.union1d(table.warp.u(table.width), [0.5])
    ends, _ = interpolant.sample(table, np.full(u.size, theta_r), u)
    ends[[0, -1]] = table.domain
    step = np.repeat(np.diff(ends) / points, points)
    x = (ends[:-1, None] + np.diff(ends)[:, None] * (np.arange(points) + 0.5) / points).ravel()
    q = interpolant.pdf(table, np.full(1, theta_r), x)
    f = density(x)
    assert (f * step).sum() == pytest.approx(1.0, abs=1e-6)
    assert (q * step).sum() == pytest.approx(1.0, abs=1e-6)
    return float((f * f / q * step).sum() - 1)


def truncated(cdf, pdf, low, high):
    mass = cdf(high) - cdf(low)
    return lambda x: pdf(x) / mass


def normal(x, mean, sigma):
    return np.exp(-0.5 * ((x - mean) / sigma) ** 2) / (sigma * np.sqrt(2 * np.pi))


def wrapped_gaussian(theta_r):
    """What wrapping a Gaussian gives, as a Fourier series, where the example sums over periods."""
    sigma = theta_r**4 / 4 + 0.59
    k = np.arange(1, 40)[:, None]
    return lambda x: (
        (1 + 2 * (np.exp(-0.5 * (k * sigma) ** 2) * np.cos(k * (x - np.pi))).sum(axis=0)) / (2 * np.pi)
    )


def energy_conserving(theta_r, v=0.15**2):
    """The closed form is already normalised: d'Eon et al. chose its factor so."""

    def density(x):
        a, b = np.cos(x) * np.cos(theta_r) / v, np.sin(x) * np.sin(theta_r) / v
        return np.exp(a - b - 1 / v) * special.ive(0, a) / (v * -np.expm1(-2 / v)) * np.cos(x)

    return density


def trimmed_logistic(theta_r):
    s = np.sqrt(np.pi / 8) * (0.265 * 0.5 + 1.194 * 0.25 + 5.372 * 0.5**22)
    return truncated(
        lambda x: special.expit((x - np.pi) / s),
        lambda x: special.expit((x - np.pi) / s) * special.expit((np.pi - x) / s) / s,
        0.0,
        2 * np.pi,
    )


def two_peaks(theta_r):
    tilt = np.radians(3)
    parts = ((-2 * tilt, 0.08, 0.4), (4 * tilt, 0.16, 0.6))
    return truncated(
        lambda x: sum(w * special.ndtr((x + theta_r - m) / s) for m, s, w in parts),
        lambda x: sum(w * normal(x + theta_r, m, s) for m, s, w in parts),
        -HALF_PI,
        HALF_PI,
    )


SHAPES = {
    "wrapped": ("wrapped_azimuth.py", "direct_phi", wrapped_gaussian),
    "energy conserving": ("energy_conserving.py", "direct_theta", energy_conserving),
    "trimmed logistic": ("trimmed_logistic.py", "direct_phi", trimmed_logistic),
    "two peaks": ("two_peaks.py", "direct_theta", two_peaks),
}


@pytest.mark.parametrize("shape", SHAPES, ids=lambda name: name.replace(" ", "-"))
def test_a_shape_costs_no_more_variance_than_its_tolerance(shape, bake):
    file, name, reference = SHAPES[shape]
    table = bake(file, name)
    worst = max(variance(table, reference(theta_r), theta_r) for theta_r in ANGLES)
    assert 1e-6 < worst <= TOLERANCE


@pytest.mark.parametrize("shape", SHAPES, ids=lambda name: name.replace(" ", "-"))
def test_the_measure_rejects_a_shape_five_percent_off(shape, bake):
    """The same table against a reference moved by a twentieth of a radian misses the tolerance."""
    file, name, reference = SHAPES[shape]
    table = bake(file, name)
    density = reference(0.0)
    moved = lambda x: density(x - 0.05)  # noqa: E731
    low, high = table.domain
    x = np.linspace(low, high, 20_001)
    mass = np.trapezoid(moved(x), x)
    assert variance(table, lambda x: moved(x) / mass, 0.0) > 2 * TOLERANCE


def test_the_energy_conserving_lobe_is_normalised_in_closed_form(bake):
    """The mass that the bake integrated is 1 in every row, as the factor csch(1/v)/(2v) makes it."""
    np.testing.assert_allclose(bake("energy_conserving.py", "direct_theta").log_mass, 0.0, atol=1e-12)


def test_the_trimmed_logistic_has_the_quantiles_of_its_closed_inverse(bake):
    table = bake("trimmed_logistic.py", "direct_phi")
    s = np.sqrt(np.pi / 8) * (0.265 * 0.5 + 1.194 * 0.25 + 5.372 * 0.5**22)
    ends = special.expit(np.array([-np.pi, np.pi]) / s)
    u = table.warp.u(table.width)[1:-1]
    expected = np.pi + s * special.logit(ends[0] + u * np.diff(ends))
    np.testing.assert_allclose(table.texels[0, 1:-1], expected, atol=1e-6)


def test_wrapping_matters_where_the_lobe_is_broad(bake):
    """Of their mass, wrapped and cut Gaussian differ by over 5 % at 90 deg, by under 1e-5 at 0."""
    x = np.linspace(0, 2 * np.pi, 20_001)
    differences = []
    for theta_r in (0.0, HALF_PI):
        sigma = theta_r**4 / 4 + 0.59
        cut = normal(x, np.pi, sigma) / (1 - 2 * special.ndtr(-np.pi / sigma))
        differences.append(0.5 * np.trapezoid(abs(wrapped_gaussian(theta_r)(x) - cut), x))
    assert differences[0] < 1e-5
    assert 0.05 < differences[1] < 0.3


# ---- a density that is known as cells only


def skewed(x, theta_r):
    """A smooth density with no name: a broad highlight that leans towards the root and moves with theta_r."""
    y = x + 0.8 * theta_r
    return np.exp(-0.5 * (y / (0.25 + 0.05 * np.tanh(3 * y))) ** 2) * np.cos(x)


@pytest.fixture(scope="module")
def cells():
    """edges, theta_r and masses of `skewed`, as a measurement of 2.8 deg cells every 5 deg has them."""
    edges, theta_r = np.linspace(-HALF_PI, HALF_PI, 65), np.radians(np.arange(-90.0, 91.0, 5.0))
    fine = (edges[:-1, None] + np.diff(edges)[:, None] * (np.arange(40) + 0.5) / 40).ravel()
    return edges, theta_r, skewed(fine, theta_r[:, None]).reshape(len(theta_r), 64, 40).sum(axis=2)


def test_a_density_tabulated_from_cells_samples_the_density_itself(cells):
    """At the angles that were measured, and half-way between them, where the rows are blended."""
    lobe = modelfile.tabulated("direct_theta", *cells)
    assert lobe.own_height == 37
    table = smallest_table(lobe, TOLERANCE / 4).table
    for theta_r in np.radians([-60.0, -32.5, 0.0, 2.5, 40.0]):
        mass = integrate.quad(skewed, -HALF_PI, HALF_PI, args=(theta_r,), points=[-0.8 * theta_r])[0]
        assert variance(table, lambda x, t=theta_r, m=mass: skewed(x, t) / m, theta_r) <= TOLERANCE


def test_measured_cells_from_a_file_meet_the_tolerance(bake):
    """Against the monotone cubic through the file's own cumulative shares, put together here."""
    table = bake("measured_cells.py", "direct_theta")
    rows = np.loadtxt(EXAMPLES / "brown_hair_cells.csv", delimiter=",", skiprows=3)
    edges = np.linspace(-HALF_PI, HALF_PI, rows.shape[1])
    for row in rows[[4, 9, 16]]:
        share = (1 - FLOOR) * row[1:] / row[1:].sum() + FLOOR / 32
        cumulative = interpolate.PchipInterpolator(edges, np.concatenate([[0.0], np.cumsum(share)]))
        assert variance(table, lambda x, c=cumulative: c(x, 1), np.radians(row[0])) <= TOLERANCE


def test_cells_keep_their_mass(cells):
    edges, theta_r, mass = cells
    lobe = modelfile.tabulated("direct_theta", edges, theta_r, mass)
    for j in (0, 7, 20):
        share = (1 - FLOOR) * mass[j] / mass[j].sum() + FLOOR / 64
        kept = [
            integrate.quad(lambda x, t=theta_r[j]: np.exp(lobe.log_density(x, np.array(t))), a, b)[0]
            for a, b in pairwise(edges)
        ]
        np.testing.assert_allclose(kept, share, atol=1e-9)


def test_a_narrow_peak_moves_between_rows_and_does_not_split():
    edges, theta_r = np.linspace(-HALF_PI, HALF_PI, 181), np.radians([-10.0, 10.0])
    mass = np.diff(special.ndtr((edges + theta_r[:, None]) / 0.03), axis=1)
    lobe = modelfile.tabulated("direct_theta", edges, theta_r, mass)
    x = np.linspace(-0.5, 0.5, 2001)
    density = np.exp(lobe.log_density(x, np.zeros(1)))
    assert abs(x[np.argmax(density)]) < 0.01
    assert density.max() == pytest.approx(normal(0.0, 0.0, 0.03), rel=0.05)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            lambda m: m.__setitem__((3, 5), -1e-3),
            r"direct_theta at theta_r = -75 deg: negative density in cell 5",
        ),
        (
            lambda m: m.__setitem__((3, 5), np.nan),
            r"direct_theta at theta_r = -75 deg: the mass of a cell is not",
        ),
        (lambda m: m.__setitem__(3, 0.0), r"direct_theta at theta_r = -75 deg: no mass in the domain"),
    ],
)
def test_bad_cells_are_named(cells, change, said):
    edges, theta_r, mass = cells
    mass = mass.copy()
    change(mass)
    with pytest.raises(modelfile.HairlutError, match=said):
        modelfile.tabulated("direct_theta", edges, theta_r, mass)


def test_cells_must_span_the_domain(cells):
    edges, theta_r, mass = cells
    with pytest.raises(modelfile.HairlutError, match=r"expected the domain's 0 to 6\.28319 rad"):
        modelfile.tabulated("direct_phi", edges, theta_r, mass)
