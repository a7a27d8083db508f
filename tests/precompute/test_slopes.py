# SPDX-License-Identifier: BSD-3-Clause
"""Slopes of knots: exact inside, bounded in gaps, fitted at the ends, and derived where a file has none."""

from dataclasses import replace

import numpy as np
import pytest

from hairlut import analytic, interpolant, slopes
from hairlut.exact import exact_at
from hairlut.lobes import FITTED, HALF_PI
from hairlut.measure import measure
from hairlut.table import bake_table
from hairlut.warp import Warp
from report import study

WARP = Warp("octaves", 2.0**-18)


def test_inner_slopes_are_one_over_the_density_rounded_once(lobe):
    table = bake_table(lobe, 32, 9, WARP)
    x = exact_at(lobe, table.theta_r).quantiles(*WARP.knots(32))
    for j, theta_r in enumerate(table.theta_r):
        expected = 1 / analytic.density(lobe, theta_r, np.clip(x[j, 1:-1], *lobe.domain))
        np.testing.assert_allclose(table.slopes[j, 1:-1], expected, rtol=1e-7)


def test_end_cells_have_the_true_quantile_in_the_middle(lobe):
    table = bake_table(lobe, 32, 9, WARP)
    m, _ = WARP.knots(32)
    middle = np.full(2, (m[0] + m[1]) / 2)
    upper = np.array([False, True])
    for theta_r in table.theta_r:
        x, _ = interpolant.sample_tail(table, np.full(2, theta_r), middle, upper)
        secants = np.diff(interpolant.cells(table, theta_r).x[0])[[0, -1]] / WARP.widths(32)[[0, -1]]
        ends = interpolant.cells(table, theta_r).slopes[0, [0, -1]]
        free = (ends > 1.01 * slopes.END_RANGE[0] * secants) & (ends < 0.99 * slopes.END_RANGE[1] * secants)
        assert free.any() or lobe.model == "printed"
        expected = analytic.quantile(lobe, np.full(2, theta_r), middle, upper)
        np.testing.assert_allclose(x[free], expected[free], atol=1e-5)


def test_a_bounded_slope_in_a_gap_beats_the_exact_one():
    """A knot between two modes: the exact slope leaves the cells beside it almost empty."""
    lobe = study.two_modes(0.5)
    found = {
        largest: measure(
            study.tabulate_any(lobe, 33, 17, Warp("octaves", 2.0**-8), largest=largest), lobe, quantiles=False
        )
        for largest in (slopes.LARGEST_INNER, np.inf)
    }
    assert found[slopes.LARGEST_INNER].relative_variance < 0.2
    assert found[slopes.LARGEST_INNER].largest_weight < 5
    assert found[np.inf].relative_variance > 1


def test_a_density_of_zero_in_a_gap_gives_finite_slopes(make_lobe):
    def two_boxes(x, theta_r):
        inside = (abs(abs(x) - 1.0) < 0.4) & (abs(x) < HALF_PI)
        return np.where(inside, 0.0, -np.inf) + np.zeros_like(theta_r)

    lobe = make_lobe(two_boxes, breakpoints=(-1.4, -0.6, 0.6, 1.4))
    table = bake_table(lobe, 17, 3, Warp("uniform"))
    assert np.isfinite(table.slopes).all()
    assert (table.slopes > 0).all()


@pytest.mark.parametrize("warp", [Warp("uniform"), Warp("octaves", 2.0**-8)], ids=str)
def test_derived_slopes_are_those_of_a_density_that_is_linear_in_x(warp):
    u = warp.u(65)
    x = np.sqrt(0.01 + 0.99 * u)  # F(x) = (x^2 - 0.01) / 0.99, density 2 x / 0.99
    derived = slopes.derived(np.stack([x, x]), warp.widths(65))
    np.testing.assert_allclose(derived[:, 1:-1], np.stack([0.99 / (2 * x)] * 2)[:, 1:-1], rtol=0.02)


def test_derived_slopes_at_the_ends():
    """Twice the secant less the inner slope, between an eighth of the secant and eight times it."""
    h = np.full(4, 0.25)
    inner = 1.1 / (0.1 / 1.0 + 1.0 / 0.1) / 0.25
    derived = slopes.derived(np.array([[0.0, 1.0, 1.1, 1.2, 1.3]]), h)
    assert derived[0, :2] == pytest.approx([8.0 - inner, inner])
    assert derived[0, 2:] == pytest.approx([0.4, 0.4, 0.4])
    uneven = np.array([0.4, 0.0004, 0.2998, 0.2998])  # an inner slope of ten times the end's secant
    assert slopes.derived(np.array([[0.0, 1.0, 1.1, 1.2, 1.3]]), uneven)[0, 0] == pytest.approx(2.5 / 8)


def test_a_table_of_derived_slopes_is_nearly_as_good_as_parabolas():
    lobe = FITTED.direct_theta
    table = bake_table(lobe, 44, 32, Warp("octaves", 2.0**-18))
    given = slopes.derived(table.texels, table.warp.widths(44)).astype(np.float32)
    assert measure(replace(table, slopes=given), lobe, quantiles=False).relative_variance < 2e-4
