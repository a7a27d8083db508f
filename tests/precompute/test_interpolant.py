# SPDX-License-Identifier: BSD-3-Clause
"""The reading of a table: sample, density and inverse belong to each other, on the rows and between them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hairlut import analytic, interpolant
from hairlut.lobes import FITTED, HALF_PI, MODELS
from hairlut.table import Table, bake_table
from hairlut.warp import Warp
from report.cells import LINEAR, PARABOLA, RATIONAL

U = np.concatenate(
    [[0, 2.0**-32, 2.0**-24, 1e-5], np.linspace(0.001, 0.999, 400), [1 - 1e-5, 1 - 2.0**-24, 1]]
)


def rough_table(seed, width, height, warp, bend):
    """A table of random increasing rows, far from any lobe, and slopes up to exp(bend) times the secants."""
    rng = np.random.default_rng(seed)
    steps = rng.exponential(size=(height, width - 1)) + 1e-3
    x = np.concatenate([np.zeros((height, 1)), np.cumsum(steps, axis=1)], axis=1)
    texels = (-HALF_PI + np.pi * x / x[:, -1:]).astype(np.float32)
    secants = np.diff(texels.astype(float), axis=1) / warp.widths(width)
    slopes = np.pad(secants, ((0, 0), (0, 1)), mode="edge") * np.exp(bend * rng.uniform(-1, 1, texels.shape))
    return Table(
        "test",
        "direct_theta",
        "theta_i",
        "none",
        (-HALF_PI, HALF_PI),
        (-HALF_PI, HALF_PI),
        "",
        warp,
        texels,
        slopes.astype(np.float32),
        np.zeros(height),
    )


tables = st.builds(
    rough_table,
    st.integers(0, 1000),
    st.integers(4, 70),
    st.integers(2, 9),
    st.sampled_from([Warp("uniform"), Warp("octaves", 2.0**-20), Warp("octaves", 0.01)]),
    st.sampled_from([0.0, 1.0, 4.0]),
)
inclinations = st.floats(-2, 2)


@settings(deadline=None)
@given(table=tables, theta_r=inclinations)
def test_invert_undoes_sample_and_pdf_agrees(table, theta_r):
    x, density = interpolant.sample(table, theta_r, U)
    assert (np.diff(x) > 0).all()
    assert (density > 0).all()
    m, upper = interpolant.invert_tail(table, theta_r, x)
    # an angle is resolved to 4e-16: that much of u is lost
    lost = 4e-16 * density * 4
    assert (abs(np.where(upper, 1 - m, m) - U) <= 1e-14 + lost).all()
    inner = slice(1, -1)
    again = interpolant.pdf(table, theta_r, x)
    np.testing.assert_allclose(again[inner], density[inner], rtol=1e-6)


@settings(deadline=None)
@given(table=tables, theta_r=inclinations)
def test_density_integrates_to_one_in_every_cell(table, theta_r):
    nodes, weights = np.polynomial.legendre.leggauss(8)
    f = (nodes + 1) / 2
    read = interpolant.cells(table, theta_r)
    mass = (read.density(f) * read.slope(f) * weights / 2).sum(axis=2)[0] * read.h
    np.testing.assert_allclose(mass, np.diff(table.warp.u(table.width)), rtol=1e-10)
    ends = read.angle(np.array([0.0, 1.0]))[0]
    np.testing.assert_allclose(ends[1:, 0], ends[:-1, 1], atol=1e-15)


@settings(deadline=None)
@given(table=tables, theta_r=inclinations, part=st.floats(0.01, 0.99), i=st.integers(0, 2))
def test_density_is_the_derivative_of_the_inverse(table, theta_r, part, i):
    c = np.array([(i + part - 1e-5), (i + part + 1e-5)])
    f = c - i
    read = interpolant.cells(table, theta_r)
    x = read.angle(f)[0, i]
    u = interpolant.invert(table, theta_r, x)
    middle = interpolant.pdf(table, theta_r, x.mean())
    assert (u[1] - u[0]) / (x[1] - x[0]) == pytest.approx(middle[0], rel=1e-4)


def test_rows_are_met_exactly_and_blended_linearly(shipped):
    table, _, _, _ = shipped
    u = table.warp.u(table.width)
    rows = np.array([interpolant.sample(table, theta, u)[0] for theta in table.theta_r])
    np.testing.assert_allclose(rows, table.texels, atol=1e-12)
    between = (table.theta_r[:-1] + table.theta_r[1:]) / 2
    blended = np.array([interpolant.sample(table, theta, u)[0] for theta in between])
    np.testing.assert_allclose(blended, (rows[:-1] + rows[1:]) / 2, atol=1e-12)


@pytest.mark.parametrize("warp", [Warp("uniform"), Warp("octaves", 2.0**-8)], ids=str)
def test_a_quotient_of_linear_functions_is_met_everywhere(warp):
    """Cells through its values and slopes are pieces of it, as s^2 = d0 d1 in each of them."""

    def quantile(u):
        return u / (3 - 2 * u)

    def slope(u):
        return 3 / (3 - 2 * u) ** 2

    table = rough_table(3, 33, 2, warp, 0.0)
    knots = warp.u(33)
    table = replace(table, texels=np.stack([quantile(knots)] * 2), slopes=np.stack([slope(knots)] * 2))
    x, density = interpolant.sample(table, 0.3, U)
    np.testing.assert_allclose(x, quantile(U), atol=1e-14)
    np.testing.assert_allclose(density, 1 / slope(U), rtol=1e-10)


@settings(deadline=None)
@given(table=tables, theta_r=inclinations)
def test_angle_and_density_are_continuous_and_the_given_ones_at_knots(table, theta_r):
    read = interpolant.cells(table, theta_r)
    ends = np.array([0.0, 1.0])
    for values, slopes in ((read.angle(ends)[0], read.x[0]), (read.slope(ends)[0], read.slopes[0])):
        np.testing.assert_allclose(values[:, 0], slopes[:-1], rtol=1e-12, atol=1e-15)
        np.testing.assert_allclose(values[:, 1], slopes[1:], rtol=1e-12, atol=1e-15)


@settings(deadline=None)
@given(table=tables, theta_r=inclinations)
def test_whole_cells_and_single_angles_are_read_alike(table, theta_r):
    u = U[2:-2]
    i, f = table.warp.place(np.minimum(u, 1 - u), u > 0.5, table.width)
    read = interpolant.cells(table, theta_r)
    np.testing.assert_array_equal(read.read_at(0, i, f)[0], interpolant.sample(table, theta_r, u)[0])
    x = interpolant.sample(table, theta_r, u)[0]
    column = read.column(x[None, :])[0]
    place, part, _ = interpolant.locate(table, np.full(len(u), theta_r), x)
    np.testing.assert_allclose(column, place + part, atol=1e-12)


def test_what_lies_outside_is_clamped_or_has_no_density():
    table = bake_table(FITTED.direct_theta, 32, 16, Warp("octaves", 2.0**-18))
    for inside, outside in ((HALF_PI, 10.0), (-HALF_PI, -np.inf), (HALF_PI, np.inf), (-HALF_PI, np.nan)):
        np.testing.assert_array_equal(
            interpolant.sample(table, outside, U), interpolant.sample(table, inside, U)
        )
    np.testing.assert_array_equal(interpolant.sample(table, 0.0, [-1, 2])[0], np.float32([-HALF_PI, HALF_PI]))
    np.testing.assert_array_equal(interpolant.pdf(table, 0.0, [-2.0, 2.0, np.nan, np.inf]), 0.0)


@pytest.mark.parametrize("name", MODELS)
def test_curved_cells_follow_the_lobe_better_than_straight_ones(name):
    lobe = MODELS[name].direct_theta
    table = bake_table(lobe, 64, 64, Warp("octaves", 2.0**-20))
    errors = []
    for cell in (RATIONAL, PARABOLA, LINEAR):
        read = cell.read(table, table.theta_r[20:21])
        i, f = table.warp.place(np.minimum(U, 1 - U)[4:-3], U[4:-3] > 0.5, 64)
        x, slope = read.read_at(0, i, f)
        errors.append(np.median(abs(1 / (slope * analytic.density(lobe, table.theta_r[20], x)) - 1)))
    assert errors[0] < errors[1] / 4
    assert errors[1] < errors[2] / 4
