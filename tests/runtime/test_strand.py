# SPDX-License-Identifier: BSD-3-Clause
"""Models over parameters: read as in double precision, and all that holds of any model at every strand."""

import numpy as np
import pytest
from runtime.strands import PARAMETERS

from runtime import strands

SHAPES = {
    "as fitted": {},
    "nothing depends": {"theta": (), "phi": (), "mixture": ()},
    "one table's axis": {"theta": ("beta_m",), "phi": (), "mixture": ()},
    "two axes a table": {"theta": ("beta_m", "absorption"), "phi": ("beta_n", "beta_m")},
    "four axes": {"mixture": ("beta_m", "beta_n", "absorption", "unused"), "lobes": 2},
    "six lobes": {"lobes": 6},
    "no turns": {"turned": False},
}


def viewers(n: int, seed: int = 5) -> tuple[np.ndarray, ...]:
    """theta_r, phi_r, offset, (n, 3) u"""
    random = np.random.default_rng(seed)
    theta_r, phi_r = np.float32(random.uniform(-1.55, 1.55, n)), np.float32(random.uniform(-3, 3, n))
    return theta_r, phi_r, np.float32(random.uniform(-1.2, 1.2, n)), random.random((n, 3), np.float32)


@pytest.mark.parametrize("shape", SHAPES)
def test_strands_are_read_as_in_double_precision(shape):
    baked, model = strands.baked(**SHAPES[shape]), strands.model(**SHAPES[shape])
    n = 5_000
    theta_r, phi_r, offset, u = viewers(n)
    given = strands.strands(n)
    named = {p.name: given[:, k] for k, p in enumerate(PARAMETERS)}
    s = model.sample_strand(given, theta_r, phi_r, *u.T, offset=offset)
    theta_i, phi_i, _ = baked.sample(theta_r, phi_r, u, offset, parameters=named)
    apart = np.abs(s["phi_i"] - phi_i)
    same = (np.abs(s["theta_i"] - theta_i) < 1e-5) & (np.minimum(apart, 2 * np.pi - apart) < 1e-4)
    assert same.mean() > 0.999  # the rest drew another lobe: u_lobe lies within rounding of a limit
    exact = baked.pdf(theta_r, phi_r, s["theta_i"], s["phi_i"], offset, parameters=named)
    pdf = model.pdf_strand(given, theta_r, phi_r, s["theta_i"], s["phi_i"], offset)
    for density in (s["pdf_angle"], pdf):
        assert np.quantile(np.abs(density / exact - 1), 0.999) < 1e-3
        assert np.median(np.abs(density / exact - 1)) < 1e-5
    wrong = {**named, "beta_m": named["beta_m"] + 0.05}
    wrong = baked.pdf(theta_r, phi_r, s["theta_i"], s["phi_i"], offset, parameters=wrong)
    assert shape == "nothing depends" or np.median(np.abs(s["pdf_angle"] / wrong - 1)) > 1e-3
