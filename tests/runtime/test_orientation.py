# SPDX-License-Identifier: BSD-3-Clause
"""Signs: which way the lobes lean, and what an azimuth is measured from, at a large tilt."""

import numpy as np
import pytest
from runtime.c_library import MODELS, builtin

MEDIAN = np.float32(0.5)
THETA_R = np.float32(np.radians(40))


def wrapped(phi) -> np.ndarray:
    """phi in [-pi, pi)."""
    return (np.asarray(phi, float) + np.pi) % (2 * np.pi) - np.pi


def test_direct_lobe_leans_as_its_reading_says():
    expected = {
        "printed": 2 * 40
        - 2,  # eq. (2) with 3 theta_r as an angle: beyond the viewer's inclination, on the same side
        "fitted": 3 * THETA_R
        - 2
        - 40,  # with theta_r in radians beside degrees: across, where a highlight is
    }
    for name, degrees in expected.items():
        s = builtin(name).sample("direct", THETA_R, 0.0, MEDIAN, MEDIAN)
        assert np.degrees(s["theta_i"][0]) == pytest.approx(degrees, abs=8 if name == "printed" else 0.5), (
            name
        )


@pytest.mark.parametrize("name", MODELS)
def test_multiple_lobe_leans_across(name):
    s = builtin(name).sample("multiple", THETA_R, 0.0, MEDIAN, MEDIAN)
    assert np.degrees(s["theta_i"][0]) == pytest.approx(33.5 * np.sin(1.25 * THETA_R) - 1 - 40, abs=1.0)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("lobe", ["direct", "multiple"])
def test_inclination_grows_with_u(name, lobe):
    u = np.linspace(0, 1, 1001)
    theta = builtin(name).sample(lobe, THETA_R, 0.5, u, MEDIAN)["theta_i"]
    assert (np.diff(theta) > 0).all()
    assert theta[0] == -np.float32(np.pi / 2)
    assert theta[-1] == np.float32(np.pi / 2)


@pytest.mark.parametrize("phi_r", [-3.0, -1.0, 0.0, 0.25, 2.0, 9.0])
def test_azimuth_is_a_sum_in_printed_and_a_difference_in_fitted(phi_r):
    printed = builtin("printed").sample("direct", THETA_R, phi_r, MEDIAN, MEDIAN)["phi_i"][0]
    fitted = builtin("fitted").sample("direct", THETA_R, phi_r, MEDIAN, MEDIAN)["phi_i"][0]
    assert wrapped(printed - (np.pi - phi_r)) == pytest.approx(0, abs=1e-5)
    assert wrapped(fitted - (np.pi + phi_r)) == pytest.approx(0, abs=1e-5)


@pytest.mark.parametrize("name", MODELS)
def test_quarter_turns_of_the_viewer_turn_the_lobe(name):
    """phi_i follows phi_r one for one: with its sign in fitted, against it in printed."""
    u = np.float32(0.31)
    sign = {"printed": -1, "fitted": 1}[name]
    at = [
        builtin(name).sample("direct", THETA_R, phi_r, u, u)["phi_i"][0] for phi_r in np.arange(4) * np.pi / 2
    ]
    turned = wrapped(np.diff(np.array(at, float)))
    np.testing.assert_allclose(turned, sign * np.pi / 2, atol=2e-6)


@pytest.mark.parametrize("name", MODELS)
def test_density_peaks_where_the_samples_are(name):
    model = builtin(name)
    s = model.sample("direct", THETA_R, 1.0, MEDIAN, MEDIAN)
    theta, phi = s["theta_i"][0], s["phi_i"][0]
    peak = model.pdf("direct", THETA_R, 1.0, theta, phi)[0]
    assert peak > 3 * model.pdf("direct", THETA_R, 1.0, -theta, phi)[0]
    assert peak > 3 * model.pdf("direct", THETA_R, 1.0, theta, phi + np.pi)[0]
    assert peak > 2 * model.pdf("direct", THETA_R, -1.0, theta, phi)[0]


@pytest.mark.parametrize("name", MODELS)
def test_azimuth_of_multiple_scattering_is_uniform_and_starts_at_minus_pi(name):
    u = np.float32([0, 0.25, 0.5, 0.75])
    phi = builtin(name).sample("multiple", THETA_R, 2.0, MEDIAN, u)["phi_i"]
    np.testing.assert_allclose(phi, u * 2 * np.pi - np.pi, atol=1e-6)
