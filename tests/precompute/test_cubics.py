# SPDX-License-Identifier: BSD-3-Clause
"""Masses of cells in closed form: the density and the quantiles of numerical integration, at less cost."""

from dataclasses import replace

import numpy as np
import pytest

from hairlut import modelfile
from hairlut.cubics import Cubics
from hairlut.exact import Exact, exact_at
from hairlut.lobes import HALF_PI
from hairlut.measure import estimate, measure
from hairlut.table import tabulate
from hairlut.warp import Warp

ROWS = np.radians(np.arange(-80.0, 81.0, 20.0))
BETWEEN = np.radians([-90.0, -80.0, -71.3, -20.0, -19.9, 0.0, 5.0, 12.5, 60.0, 79.9, 85.0])


def two_peaked(name="direct_phi"):
    """A lobe of 36 cells whose two peaks move apart with theta_r, with next to nothing between them."""
    edges = np.linspace(*{"direct_phi": (0, 2 * np.pi), "direct_theta": (-HALF_PI, HALF_PI)}[name], 37)
    middle = (edges[1:] + edges[:-1]) / 2 - (edges[0] + edges[-1]) / 2
    apart = (0.6 + 0.4 * abs(ROWS))[:, None]
    share = (0.4 + 0.1 * np.sin(ROWS))[:, None]
    mass = share * np.exp(-20 * (middle - apart) ** 2) + (1 - share) * np.exp(-30 * (middle + apart) ** 2)
    mass[:, 5] = 0.0
    return modelfile.tabulated(name, edges, ROWS, mass)


@pytest.fixture(scope="module")
def lobe():
    return two_peaked()


@pytest.fixture(scope="module")
def both(lobe):
    """The closed form, and the integration of the same density."""
    return exact_at(lobe, BETWEEN), Exact(lobe, BETWEEN)


def test_the_density_is_what_integration_makes_of_it(both, lobe):
    closed, integrated = both
    x = np.linspace(*lobe.domain, 999)[:, None] + np.zeros(len(BETWEEN))
    x[0], x[-1] = lobe.domain[0] - 1e-7, lobe.domain[1] + 1e-7  # a texel rounds to just outside
    row = np.arange(len(BETWEEN))
    found = np.concatenate([closed.density(x[k : k + 1], row) for k in range(len(x))])
    np.testing.assert_allclose(found, integrated.density(x, row), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(closed.log_mass, integrated.log_mass, atol=1e-12)


def test_quantiles_are_those_of_the_integral(both):
    closed, integrated = both
    m = np.tile(np.concatenate([[0.0], np.exp2(np.arange(-24, 0)), np.linspace(0.01, 0.49, 60)]), 2)
    upper = np.repeat([False, True], m.size // 2)
    np.testing.assert_allclose(closed.quantiles(m, upper), integrated.quantiles(m, upper), rtol=0, atol=1e-10)
    some = slice(1, None, 3)
    assert (closed.quantiles(m, upper, some) == closed.quantiles(m, upper)[some]).all()
    np.testing.assert_array_equal(integrated.quantiles(m, upper, some), integrated.quantiles(m, upper)[some])


def test_the_ends_of_the_domain_are_exact(both, lobe):
    ends = both[0].quantiles(np.zeros(2), np.array([False, True]))
    assert (ends == lobe.domain).all()


def test_knots_that_crowd_at_an_end_leave_the_end_where_it_is():
    edges = np.concatenate([[-HALF_PI, 1e-4 - HALF_PI], np.linspace(-1, 1, 9), [HALF_PI - 1e-4, HALF_PI]])
    mass = 1.0 + np.arange(24).reshape(2, 12) % 5
    lobe = modelfile.tabulated("direct_theta", edges, ROWS[[0, -1]], mass)
    rows = lobe.exact(BETWEEN)
    assert (rows.knots[:, [0, -1]] == lobe.domain).all()
    ends = rows.quantiles(np.zeros(2), np.array([False, True]))
    assert (ends == lobe.domain).all()


def test_an_angle_that_rounding_moved_has_the_row_of_the_data(lobe):
    own, moved = (lobe.exact(angles).knots for angles in (ROWS, np.nextafter(ROWS, 9)))
    np.testing.assert_array_equal(own, moved)
    assert len(np.unique(own[3])) == 37


def test_rows_do_not_depend_on_each_other(lobe):
    whole = lobe.exact(BETWEEN).quantiles(np.linspace(0, 0.5, 33), np.zeros(33, bool))
    for j, angle in enumerate(BETWEEN):
        alone = lobe.exact(np.array([angle])).quantiles(np.linspace(0, 0.5, 33), np.zeros(33, bool))
        np.testing.assert_array_equal(alone[0], whole[j])


def test_a_slope_that_would_turn_back_is_lowered():
    row = Cubics(np.array([[0.0, 1.0, 2.0]]), np.array([[0.0, 0.9, 1.0]]), np.array([[0.5, 9.0, 0.0]]))
    x = np.linspace(0, 2, 501)
    assert (row.density(x, np.zeros(1, int)) >= 0).all()
    assert row.density(np.array([1.0]), np.zeros(1, int)) == pytest.approx(0.3)
    u = np.linspace(0, 1, 77)
    below = [
        np.trapezoid(row.density(np.linspace(0, q, 2001), np.zeros(1, int)), dx=q / 2000)
        for q in row.quantile(u, np.zeros(1, int))
    ]
    np.testing.assert_allclose(below, u, atol=1e-6)


@pytest.mark.parametrize("exponent", [-20, -12, -4, 0])
def test_a_table_costs_what_its_measurement_by_integration_says(lobe, exponent):
    """The panels between knots, and the few places that a search evaluates, against bisected cells."""
    by_integration = replace(lobe, exact=None)
    exact = exact_at(lobe, np.linspace(*lobe.theta_r_range, 73))
    table = tabulate(lobe, exact, 48, Warp("octaves", 2.0**exponent), slice(None, None, 2))
    expected = measure(table, by_integration, between=1)
    found = measure(table, lobe, exact=exact)
    for name, value in expected.summary().items():
        assert found.summary()[name] == pytest.approx(value, rel=2e-3, abs=1e-5), name
    variance, weight = estimate(table, lobe, exact, np.arange(73))
    assert variance == pytest.approx(expected.relative_variance, rel=0.03)
    assert weight == pytest.approx(expected.largest_weight, rel=0.03)
    few = np.arange(0, 73, 9)
    assert estimate(table, lobe, exact, few)[0] <= variance
