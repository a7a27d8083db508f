# SPDX-License-Identifier: BSD-3-Clause
"""phi_r has no axis in a texture: the same azimuth row for every phi_r, shifted."""

from dataclasses import replace

import numpy as np
import pytest

from hairlut.lobes import HALF_PI, MODELS
from hairlut.warp import Warp
from precompute import azimuth

THETA_R = np.linspace(-HALF_PI, HALF_PI, 9)
PHI_R = np.linspace(-np.pi, np.pi, 25)
KNOTS = Warp("octaves", 2.0**-20).knots(64)


@pytest.mark.parametrize("name", MODELS)
def test_every_phi_r_gives_the_same_row(name):
    assert azimuth.largest_shift_error(MODELS[name].direct_phi, THETA_R, PHI_R, *KNOTS) <= 1e-12


@pytest.mark.parametrize(("name", "sign"), [("printed", -1), ("fitted", 1)])
def test_the_shift_has_the_sign_of_the_convention(name, sign):
    # the median of phi_i lies opposite the viewer: phi_i + phi_r = pi, or phi_i - phi_r = pi
    lobe = MODELS[name].direct_phi
    half = np.array([0.5]), np.array([False])
    phi_i = azimuth.quantiles_of_phi_i(lobe, 0.4, PHI_R, *half)[:, 0]
    np.testing.assert_allclose(phi_i, np.pi + sign * PHI_R, rtol=0, atol=1e-13)


def test_a_lobe_of_phi_i_alone_is_noticed(monkeypatch):
    rows_of_phi_r = azimuth.rows_of_phi_r

    def tilted(*args):
        rows = rows_of_phi_r(*args)
        log_density = rows.log_density
        return replace(rows, log_density=lambda x, row: log_density(x, row) + 1e-9 * np.cos(x))

    monkeypatch.setattr(azimuth, "rows_of_phi_r", tilted)
    assert azimuth.largest_shift_error(MODELS["fitted"].direct_phi, THETA_R[:2], PHI_R, *KNOTS) > 1e-11
