# SPDX-License-Identifier: BSD-3-Clause
"""Normalising masses, tails, and densities that are hard to integrate."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from hairlut import analytic
from hairlut.errors import HairlutError
from hairlut.integrate import integrate, rows_of_lobe
from hairlut.lobes import HALF_PI, PRINTED, gaussian
from hairlut.table import bake_table, row_angles
from hairlut.warp import Warp
from precompute import truth
from precompute.numerical import quantiles

WARP = Warp("octaves", 2.0**-20)
ONE_ROW = np.zeros(1)


def test_mass_of_every_row(lobe):
    theta_r = row_angles(lobe.theta_r_range, 64)
    integral = integrate(rows_of_lobe(lobe, theta_r))
    for j, theta in enumerate(theta_r):
        exact = truth.Row(lobe.model, lobe.name, theta).mass
        found = mp.mpf(float(integral.mantissa[j])) * mp.exp(mp.mpf(float(integral.log_scale[j])))
        assert abs(found / exact - 1) <= 1e-13


def test_printed_lobe_leaves_its_domain():
    mass = np.exp(integrate(rows_of_lobe(PRINTED.direct_theta, np.array([-HALF_PI, HALF_PI]))).log_mass)
    assert mass == pytest.approx([1.5393e-8, 5.913e-8], rel=1e-3)


def constant_gaussian(mean, sigma):
    return gaussian(
        lambda t: (np.full_like(t, mean), np.full_like(t, sigma)),
        model="test",
        name="direct_theta",
        angle="theta_i",
        azimuth="none",
        domain=(-HALF_PI, HALF_PI),
        formula="",
    )


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("sigma", [0.29, 0.01])
def test_mean_forty_sigma_outside(side, sigma):
    mean = side * (HALF_PI + 40 * sigma)
    lobe = constant_gaussian(mean, sigma)
    table = bake_table(lobe, 16, 4, Warp("octaves", 2.0**-14))
    exact = truth.gaussian_mass(mp.mpf(mean), mp.mpf(sigma), mp.mpf(-HALF_PI), mp.mpf(HALF_PI))
    assert float(exact) == 0.0  # the mass underflows a double
    assert table.log_mass == pytest.approx(float(mp.log(exact)), rel=1e-14)
    m, upper = WARP.knots(64)
    numerical, _ = quantiles(lobe, ONE_ROW, m, upper)
    np.testing.assert_allclose(numerical[0], analytic.quantile(lobe, 0.0, m, upper), rtol=0, atol=1e-12)


@settings(deadline=None, max_examples=60)
@example(mean=-10.5, log_sigma=-7.0, m=2.0**-24, upper=True)  # 10^4 sigma outside
@example(mean=0.0, log_sigma=np.log(1e-4), m=0.3, upper=False)  # a peak between two first panels
@given(
    mean=st.floats(-12, 12),
    log_sigma=st.floats(np.log(1e-4), np.log(30)),
    m=st.floats(2.0**-60, 0.5),
    upper=st.booleans(),
)
def test_any_gaussian(mean, log_sigma, m, upper):
    sigma = np.exp(log_sigma)
    lobe = constant_gaussian(mean, sigma)
    x, log_mass = quantiles(lobe, ONE_ROW, np.array([m]), np.array([upper]))
    closed = analytic.log_mass(lobe, 0.0)
    # both forms round (x - mean)/sigma: what that alone can do to the logarithm
    outside = max(abs(mean) - HALF_PI, 0) / sigma
    slack = 1e-12 + 16 * np.finfo(float).eps * (outside + 6) * (abs(mean) + HALF_PI) / sigma
    assert log_mass[0] == pytest.approx(closed, abs=slack)
    below, above = (float(np.squeeze(t)) for t in analytic.tails(lobe, 0.0, x[0, 0]))
    error = abs((above if upper else below) - m) / float(np.squeeze(analytic.density(lobe, 0.0, x[0, 0])))
    assert error <= 1e-12 + sigma * slack


def angles(lobe, u):
    u = np.asarray(u, float)
    upper = u > 0.5
    return quantiles(lobe, ONE_ROW, np.where(upper, 1 - u, u), upper)[0][0]


U = np.linspace(0, 1, 41)


def test_uniform(make_lobe):
    flat = make_lobe(lambda x, t: 0 * x)
    np.testing.assert_allclose(angles(flat, U), -HALF_PI + np.pi * U, rtol=0, atol=1e-14)


def test_step_without_a_breakpoint(make_lobe):
    # density 1 below 0.3, 3 above it: the CDF is two straight lines
    lobe = make_lobe(lambda x, t: np.where(x < 0.3, 0.0, np.log(3.0)), domain=(-1, 1))
    split = 1.3 / (1.3 + 3 * 0.7)
    expected = np.where(split > U, -1 + U / split * 1.3, 0.3 + (U - split) / (1 - split) * 0.7)
    np.testing.assert_allclose(angles(lobe, U), expected, rtol=0, atol=1e-12)


def test_zero_over_part_of_the_domain(make_lobe):
    # a triangle on [0.2, 0.7], nothing elsewhere; the end columns still reach the domain's ends
    def log_density(x, theta_r):
        return np.log(np.clip(x - 0.2, 0, None) * (x < 0.7))

    lobe = make_lobe(log_density)
    inner = U[1:-1]
    np.testing.assert_allclose(angles(lobe, inner), 0.2 + 0.5 * np.sqrt(inner), rtol=0, atol=1e-12)
    np.testing.assert_array_equal(angles(lobe, [0, 1]), [-HALF_PI, HALF_PI])


def test_gap_in_the_middle(make_lobe):
    lobe = make_lobe(lambda x, t: np.where(abs(x) > 0.5, 0.0, -np.inf), domain=(-1, 1))
    np.testing.assert_allclose(angles(lobe, [0.25, 0.75]), [-0.75, 0.75], rtol=0, atol=1e-12)


def test_two_modes_far_apart(make_lobe):
    # a third of the mass in a spike of sigma 2e-4, hardly wider than 1/2000 of the domain, the rest broad
    def log_density(x, theta_r):
        narrow = np.log(1 / 3) - 0.5 * ((x + 0.7) / 2e-4) ** 2 - np.log(2e-4)
        broad = np.log(2 / 3) - 0.5 * ((x - 0.5) / 0.05) ** 2 - np.log(0.05)
        return np.logaddexp(narrow, broad)

    x = angles(make_lobe(log_density), [1 / 6, 2 / 3])
    np.testing.assert_allclose(x, [-0.7, 0.5], rtol=0, atol=1e-12)


def test_hidden_spike_needs_its_breakpoint(make_lobe):
    def log_density(x, theta_r):
        spike = np.log(0.5) - 0.5 * ((x - 0.1234567) / 1e-7) ** 2 - np.log(1e-7 * np.sqrt(2 * np.pi))
        return np.logaddexp(spike, np.log(0.5 / np.pi))

    found = angles(make_lobe(log_density, breakpoints=(0.1234567,)), [0.5])
    # half below: all the broad mass below the spike, then into the spike for the rest
    rest = 0.5 - 0.5 * (0.1234567 + HALF_PI) / np.pi
    z = float(mp.erfinv(2 * mp.mpf(rest) / mp.mpf(0.5) - 1) * mp.sqrt(2))
    np.testing.assert_allclose(found, 0.1234567 + 1e-7 * z, rtol=0, atol=1e-12)


def test_breakpoints_may_move_with_theta_r(make_lobe):
    def log_density(x, theta_r):
        return np.where(x < theta_r, 0.0, -np.inf)

    lobe = make_lobe(log_density, domain=(-2, 2), breakpoints=lambda theta_r: theta_r[:, None])
    theta_r = np.array([-1.0, 0.123, 1.5])
    x, _ = quantiles(lobe, theta_r, np.array([0.5]), np.array([False]))
    np.testing.assert_allclose(x[:, 0], (theta_r - 2) / 2, rtol=0, atol=1e-13)


def test_integrable_singularity_and_exponential(make_lobe):
    root = make_lobe(lambda x, t: -0.5 * np.log(x), domain=(0, 1))
    np.testing.assert_allclose(angles(root, U), U**2, rtol=1e-11, atol=1e-14)
    steep = make_lobe(lambda x, t: -1000 * x, domain=(0, 1))
    np.testing.assert_allclose(angles(steep, U[:-1]), -np.log1p(-U[:-1]) / 1000, rtol=1e-13, atol=0)


@pytest.mark.parametrize(
    ("log_density", "reason"),
    [
        (lambda x, t: np.where(x > 1, np.nan, 0.0), "log-density is nan at x = 1"),
        (lambda x, t: np.where(x > 1, np.inf, 0.0), "log-density is inf at x = 1"),
        (lambda x, t: np.full_like(x, -np.inf), "zero over the whole domain"),
        (lambda x, t: np.random.default_rng(1).normal(size=x.shape), "does not converge between"),
    ],
)
def test_what_cannot_be_integrated_is_named(make_lobe, log_density, reason):
    with pytest.raises(HairlutError, match=rf"^test/direct_theta at theta_r = 0 rad: .*{reason}"):
        bake_table(make_lobe(log_density, theta_r_range=(0, 1)), 16, 2, WARP)


def test_flat_cells_are_refused(make_lobe, normal):
    lobe = make_lobe(normal(1.0, 1e-7))
    with pytest.raises(HairlutError, match=r"round to the same float .* fewer columns or a larger e"):
        bake_table(lobe, 64, 2, WARP)


def test_rows_do_not_depend_on_each_other(lobe):
    theta_r = row_angles(lobe.theta_r_range, 9)
    m, upper = WARP.knots(16)
    together, _ = quantiles(lobe, theta_r, m, upper)
    for j in (0, 4, 8):
        alone, _ = quantiles(lobe, theta_r[j : j + 1], m, upper)
        np.testing.assert_allclose(alone[0], together[j], rtol=0, atol=4e-16 * np.pi)
