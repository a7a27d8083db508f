"""The reading of a table: sample, density and inverse belong to each other, on the rows and between them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hairlut import analytic, interpolant
from hairlut.cell import Cell
from hairlut.errors import HairlutError
from hairlut.lobes import FITTED, HALF_PI, MODELS
from hairlut.table import Table, bake_table
from hairlut.warp import Warp

U = np.concatenate(
    [[0, 2.0**-32, 2.0**-24, 1e-5], np.linspace(0.001, 0.999, 400), [1 - 1e-5, 1 - 2.0**-24, 1]]
)


def rough_table(seed, width, height, warp, cell):
    """A table of random increasing rows, far from any lobe."""
    rng = np.random.default_rng(seed)
    steps = rng.exponential(size=(height, width - 1)) + 1e-3
    x = np.concatenate([np.zeros((height, 1)), np.cumsum(steps, axis=1)], axis=1)
    texels = (-HALF_PI + np.pi * x / x[:, -1:]).astype(np.float32)
    return Table(
        "test",
        "direct_theta",
        "theta_i",
        "none",
        (-HALF_PI, HALF_PI),
        (-HALF_PI, HALF_PI),
        "",
        warp,
        cell,
        texels,
        np.zeros(height),
    )


tables = st.builds(
    rough_table,
    st.integers(0, 1000),
    st.integers(4, 70),
    st.integers(2, 9),
    st.sampled_from([Warp("uniform"), Warp("octaves", 2.0**-20), Warp("octaves", 0.01)]),
    st.sampled_from([Cell("linear"), Cell("parabola", 0.9), Cell("parabola", 0.5)]),
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
    c = table.warp.fold(np.minimum(U, 1 - U), table.width)
    away = abs(c - np.round(c)) > 1e-6  # a density may jump at a knot
    again = interpolant.pdf(table, theta_r, x)
    np.testing.assert_allclose(again[inner][away[inner]], density[inner][away[inner]], rtol=1e-6)


@settings(deadline=None)
@given(table=tables, theta_r=inclinations)
def test_density_integrates_to_one_in_every_cell(table, theta_r):
    nodes, weights = np.polynomial.legendre.leggauss(8)
    f = (nodes + 1) / 2
    read = interpolant.cells(table, theta_r)
    mass = (read.density(f) * read.slope(f) * weights / 2).sum(axis=2)[0]
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
def test_slopes_at_knots_are_those_of_a_density_blended_in_x(warp):
    """A density that is linear in x has the right slope at every inner knot, whatever the knots' spacing, and
    so a curvature is the difference of the slopes at both ends."""
    table = rough_table(3, 33, 2, warp, Cell("parabola", 0.95))
    u = warp.u(33)
    x = np.sqrt(0.01 + 0.99 * u)  # F(x) = (x^2 - 0.01) / 0.99, density 2 x / 0.99
    read = interpolant.cells(replace(table, texels=np.stack([x, x]).astype(np.float32)), 0.0)
    slope = 0.99 / (2 * x)
    expected = read.h * (slope[:-1] - slope[1:]) / 2
    ends = read.h[0] * (slope[0] - slope[1]) / 2, read.h[-1] * (slope[-2] - slope[-1]) / 2
    np.testing.assert_allclose(read.c[0, 1:-1], expected[1:-1], rtol=0.02, atol=1e-6)
    assert abs(read.c[0, [0, -1]] / ends - 1).max() > 0.02  # an end cell has one neighbour only


def test_an_end_cell_has_the_mean_slope_of_the_next_at_its_inner_end():
    table = rough_table(3, 9, 2, Warp("octaves", 2.0**-8), Cell("parabola", 0.95))
    texels = np.array([[0, 1, 2.4, 3.6, 4.7, 5.6, 6.4, 7.1, 7.6]] * 2, np.float32)
    read = interpolant.cells(replace(table, texels=texels), 0.0)
    mean = read.d / read.h
    free = abs(read.c) < 0.95 * read.d
    assert free[0, [0, -1]].any()
    for end, next_one, f in ((0, 1, 1.0), (-1, -2, 0.0)):
        if free[0, end]:
            assert read.slope(np.array([f]))[0, end, 0] / read.h[end] == pytest.approx(mean[0, next_one])


def test_what_lies_outside_is_clamped_or_has_no_density():
    table = bake_table(FITTED.direct_theta, 32, 16, Warp("octaves", 2.0**-18), Cell("parabola", 0.9))
    for inside, outside in ((HALF_PI, 10.0), (-HALF_PI, -np.inf), (HALF_PI, np.inf), (-HALF_PI, np.nan)):
        np.testing.assert_array_equal(
            interpolant.sample(table, outside, U), interpolant.sample(table, inside, U)
        )
    np.testing.assert_array_equal(interpolant.sample(table, 0.0, [-1, 2])[0], np.float32([-HALF_PI, HALF_PI]))
    np.testing.assert_array_equal(interpolant.pdf(table, 0.0, [-2.0, 2.0, np.nan, np.inf]), 0.0)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "cubic",
        "parabola",
        "parabola limit=1",
        "parabola limit=nan",
        "linear limit=1",
        "quadratic bound=0.9",
        "parabola limit=x",
    ],
)
def test_wrong_cell_is_refused(text):
    with pytest.raises(HairlutError, match=r"cell .*expected"):
        Cell.parse(text)


@pytest.mark.parametrize("cell", [Cell("linear"), Cell("parabola", 0.9)], ids=str)
def test_cell_text_round_trip(cell):
    assert Cell.parse(str(cell)) == cell


@pytest.mark.parametrize("name", MODELS)
def test_curved_cells_follow_the_lobe_better_than_straight_ones(name):
    lobe = MODELS[name].direct_theta
    errors = []
    for cell in (Cell("parabola", 0.9), Cell("linear")):
        table = bake_table(lobe, 64, 64, Warp("octaves", 2.0**-20), cell)
        x, q = interpolant.sample(table, table.theta_r[20], U[4:-3])
        errors.append(np.median(abs(q / analytic.density(lobe, table.theta_r[20], x) - 1)))
    assert errors[0] < errors[1] / 4
