# SPDX-License-Identifier: BSD-3-Clause
"""The two readings against the tables from which the source text's author took the equations."""

import csv
from pathlib import Path

import numpy as np
import pytest

from hairlut.lobes import FITTED, MODELS, PRINTED

DATA = Path(__file__).parents[1] / "data"


def column(file, *names):
    """Columns of a table as floats; empty fields are NaN."""
    lines = [line for line in (DATA / file).read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    return [np.array([float(row[name] or "nan") for row in rows]) for name in names]


def rms(x):
    return np.sqrt(np.mean(np.square(x)))


def mean_error(lobe, file, name):
    """Root mean square, in degrees, of the lobe's mean of theta_i + theta_r minus the tabulated peak."""
    theta_r, mu = column(file, "theta_r_deg", name)
    mean, _ = lobe.moments(np.radians(theta_r))
    return rms(np.degrees(mean) + theta_r - mu)


def test_direct_mean_follows_the_data_in_one_reading_only():
    assert mean_error(FITTED.direct_theta, "fit_direct.csv", "mu_L_deg") <= 0.5
    assert mean_error(PRINTED.direct_theta, "fit_direct.csv", "mu_L_deg") > 100


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_multiple_mean_follows_the_data(model):
    assert mean_error(model.multiple_theta, "fit_multiple.csv", "mu_deg") <= 1.6


def test_widths_follow_the_data():
    theta_r, sigma_a, sigma_l = column("fit_direct.csv", "theta_r_deg", "sigma_A_rad", "sigma_L_rad")
    theta_m, sigma_m = column("fit_multiple.csv", "theta_r_deg", "sigma_rad")
    assert rms(FITTED.direct_phi.moments(np.radians(theta_r))[1] - sigma_a) <= 0.04
    assert rms(FITTED.direct_theta.moments(np.radians(theta_r))[1] - sigma_l) <= 0.01
    assert rms(FITTED.multiple_theta.moments(np.radians(theta_m))[1] - sigma_m) <= 0.01


def azimuth_error(model):
    """Largest distance, in degrees, of a tabulated azimuth peak from the model's."""
    phi_r, phi_i = column("peaks_direct.csv", "phi_r_deg", "phi_i_deg")
    relative = phi_i + phi_r if model.direct_phi.azimuth == "sum" else phi_i - phi_r
    known = np.isfinite(relative)
    assert known.sum() == 11
    return abs(np.mod(relative[known], 360) - 180).max()


def test_azimuth_peaks_follow_the_data_in_one_reading_only():
    assert azimuth_error(FITTED) <= 5
    assert azimuth_error(PRINTED) > 90


def test_inclination_peaks_follow_the_data_in_one_reading_only():
    theta_r, theta_i = column("peaks_direct.csv", "theta_r_deg", "theta_i_deg")
    fitted, printed = (np.degrees(m.direct_theta.moments(np.radians(theta_r))[0]) for m in (FITTED, PRINTED))
    assert abs(fitted - theta_i).max() <= 2
    assert abs(printed - theta_i).max() > 100


def test_printed_reading_is_the_text():
    theta_r = np.array([-0.5, 0.0, 1.2])
    two_degrees = 2 * np.pi / 180
    np.testing.assert_allclose(
        PRINTED.direct_theta.moments(theta_r)[0], 2 * theta_r - two_degrees, atol=1e-15
    )
    assert PRINTED.direct_phi.azimuth == "sum"
    assert FITTED.direct_phi.azimuth == "difference"
