# SPDX-License-Identifier: BSD-3-Clause
"""Each table's density integrates to 1, on its rows and between them."""

import numpy as np
import pytest
from runtime.c_library import AXES, ROOT
from runtime.quadrature import integrate, panels

from hairlut import exr, interpolant


@pytest.fixture(scope="module", params=AXES)
def axis(request) -> str:
    return request.param


@pytest.fixture(scope="module")
def table(model, axis):
    return exr.read(ROOT / "luts" / model.name / f"{axis}.exr")[0]


def inclinations(table) -> np.ndarray:
    """Rows, and points between rows: the ends, the middle, and a random choice."""
    random = np.random.default_rng(20)
    rows = np.linspace(*table.theta_r_range, table.height)
    between = random.uniform(*table.theta_r_range, 7)
    return np.float32(np.concatenate([rows[[0, 1, -2, -1]], rows[len(rows) // 2 :][:2], between]))


def test_density_integrates_to_one_by_quadrature(model, axis, table):
    knots = table.warp.u(table.width)
    for theta_r in inclinations(table):
        total = integrate(model, axis, theta_r, panels(model, axis, theta_r, knots)).sum()
        assert total == pytest.approx(1, abs=1e-6 + sum_error(model, axis, theta_r, knots)), theta_r


def sum_error(model, axis, theta_r, knots) -> float:
    """What a sum over floats cannot know: where between two floats a cell of a few floats begins."""
    x, _ = model.axis_sample(axis, theta_r, knots)
    floats = np.diff(x) / np.spacing(np.abs(x[1:]))
    return float((np.diff(knots) / floats)[floats < 64].sum())


def test_the_sums_own_error_matters_only_for_printed_near_the_poles(model, axis, table):
    knots = table.warp.u(table.width)
    errors = [sum_error(model, axis, theta_r, knots) for theta_r in inclinations(table)]
    assert max(errors) < (1e-5 if model.name == "printed" and axis == "direct_theta" else 1e-6)


def test_mass_of_every_cell_is_the_difference_of_its_knots(model, axis, table):
    knots = table.warp.u(table.width).astype(np.float32).astype(float)  # as they are drawn
    compared = 0
    for theta_r in inclinations(table):
        x, _ = model.axis_sample(axis, theta_r, knots)
        ends = panels(model, axis, theta_r, knots)
        masses = np.bincount(
            np.searchsorted(x, ends[:-1], side="right") - 1, integrate(model, axis, theta_r, ends)
        )
        wide = np.diff(x) > 1e-2  # a narrower cell's flat end lies within the rounding of its knot
        np.testing.assert_allclose(masses[wide], np.diff(knots)[wide], rtol=2e-3)
        compared += wide.sum()
    assert compared > 5 * table.width


def test_cells_join_and_run_through_the_whole_domain(table):
    """The density is du/dx of a map that runs through the domain as u runs from 0 to 1. Within a cell u is
    linear in f, so that cells that join, and widths in u that add up to 1, are all that its integral
    needs."""
    f = np.linspace(0, 1, 257)
    for theta_r in inclinations(table):
        cells = interpolant.cells(table, theta_r)
        x = cells.angle(f)[0]
        assert (np.diff(x, axis=1) > 0).all()
        np.testing.assert_allclose(x[1:, 0], x[:-1, -1], atol=1e-14)
        np.testing.assert_allclose((x[0, 0], x[-1, -1]), np.float32(table.domain), atol=1e-14)
        assert cells.h.sum() == pytest.approx(1, abs=1e-15)
        np.testing.assert_allclose(cells.h, np.diff(table.warp.u(table.width)), rtol=1e-9)


def test_a_density_with_one_cell_too_many_does_not_integrate_to_one(model, axis, table):
    theta_r = np.float32(0.3)
    ends = panels(model, axis, theta_r, table.warp.u(table.width))
    wrong = integrate(model, axis, theta_r, ends).sum() * table.width / (table.width - 1)
    assert abs(wrong - 1) > 1e-6
