# SPDX-License-Identifier: BSD-3-Clause
"""Fixtures: the shipped tables, and lobes that no formula of the project has."""

from pathlib import Path

import numpy as np
import pytest

from hairlut import exr
from hairlut.lobes import HALF_PI, MODELS, Lobe

ROOT = Path(__file__).parents[2]
LUTS = ROOT / "luts"
SHIPPED = [f"{model.name}/{lobe.name}" for model in MODELS.values() for lobe in model.lobes]


@pytest.fixture(scope="session")
def luts():
    """The directory of the shipped models."""
    return LUTS


@pytest.fixture(scope="session", params=SHIPPED)
def shipped(request):
    """A shipped table, its path and its lobe."""
    model, name = request.param.split("/")
    path = LUTS / model / f"{name}.exr"
    table, errors = exr.read(path)
    return table, path, getattr(MODELS[model], name), errors


@pytest.fixture(scope="session", params=SHIPPED)
def lobe(request):
    model, name = request.param.split("/")
    return getattr(MODELS[model], name)


@pytest.fixture(scope="session")
def make_lobe():
    """A lobe of any log-density on [-pi/2, pi/2], or of another domain."""

    def make(log_density, **fields):
        defaults = {
            "model": "test",
            "name": "direct_theta",
            "angle": "theta_i",
            "azimuth": "none",
            "domain": (-HALF_PI, HALF_PI),
            "formula": "as the test says",
        }
        return Lobe(log_density=log_density, **(defaults | fields))

    return make


@pytest.fixture(scope="session")
def normal():
    """A log-density of constant mean and sigma, not normalised."""

    def make(mean, sigma):
        return lambda x, theta_r: -0.5 * ((x - mean) / sigma) ** 2 + np.zeros_like(theta_r)

    return make
