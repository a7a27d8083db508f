# SPDX-License-Identifier: BSD-3-Clause
"""The closed form itself, against 40-digit arithmetic."""

import mpmath as mp
import numpy as np
import pytest

from hairlut import analytic
from hairlut.errors import HairlutError
from hairlut.lobes import gaussian
from precompute import truth

THETA_R = np.linspace(-np.pi / 2, np.pi / 2, 13)


def test_quantile_and_tails(lobe):
    m = np.array([2.0**-40, 2.0**-24, 1e-5, 0.01, 0.3, 0.5])
    for theta_r in THETA_R:
        row = truth.Row(lobe.model, lobe.name, theta_r)
        for upper in (False, True):
            x = analytic.quantile(lobe, theta_r, m, upper)
            tail = analytic.tails(lobe, theta_r, x)[int(upper)]
            exact = np.array([row.tail(mp.mpf(float(a)), upper) for a in x])
            # as errors of the angle: the ends of the domain are themselves rounded
            slope = analytic.density(lobe, theta_r, x)
            assert abs((exact - m) / slope).max() <= 1e-14
            assert abs((exact - tail) / slope).max() <= 1e-14


def test_log_mass(lobe):
    exact = [float(mp.log(truth.Row(lobe.model, lobe.name, t).mass)) for t in THETA_R]
    np.testing.assert_allclose(analytic.log_mass(lobe, THETA_R), exact, rtol=1e-13, atol=1e-15)


def test_density_is_zero_outside_and_integrates_to_one(lobe):
    low, high = lobe.domain
    np.testing.assert_array_equal(analytic.density(lobe, 0.3, np.array([low - 1e-9, high + 1e-9])), 0.0)
    x, w = np.polynomial.legendre.leggauss(200)
    x = (low + high) / 2 + (high - low) / 2 * x
    assert (analytic.density(lobe, 0.3, x) * w).sum() * (high - low) / 2 == pytest.approx(1, abs=1e-12)


def test_mean_forty_sigma_outside(make_lobe):
    far = gaussian(
        lambda t: (np.full_like(t, 0.5 + 40 * 0.29), np.full_like(t, 0.29)),
        **{f: getattr(make_lobe(None, domain=(-0.5, 0.5)), f) for f in ("model", "name", "angle", "azimuth")},
        domain=(-0.5, 0.5),
        formula="",
    )
    exact = truth.gaussian_mass(mp.mpf(0.5 + 40 * 0.29), mp.mpf(0.29), mp.mpf(-0.5), mp.mpf(0.5))
    assert float(exact) == 0.0  # underflows
    assert analytic.log_mass(far, 0.0) == pytest.approx(float(mp.log(exact)), rel=1e-14)


def test_a_lobe_that_is_no_gaussian_is_refused(make_lobe):
    with pytest.raises(HairlutError, match="test/direct_theta: no closed form"):
        analytic.log_mass(make_lobe(lambda x, t: -abs(x)), 0.0)
