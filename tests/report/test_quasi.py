# SPDX-License-Identifier: BSD-3-Clause
"""The shipped tables under quasi-random numbers: nearly as good as the exact inverse, unlike coarse ones."""

import numpy as np
import pytest

from hairlut import exr, size
from report import quasi
from report.places import ROOT


def shipped():
    return [exr.read(ROOT / "luts" / "fitted" / f"{lobe.name}.exr")[0] for lobe in quasi.AXES]


@pytest.mark.parametrize(("n", "limit"), quasi.LIMITS.items())
def test_the_shipped_tables_are_nearly_as_good_as_the_exact_inverse(n, limit):
    assert quasi.ratios(quasi.through(shipped()), n).max() <= limit


@pytest.mark.parametrize("tolerance", [1e-4, 3e-5])
def test_coarser_tables_are_not(tolerance):
    """What makes the default tolerance what it is."""
    coarse = [choice.table for choice in size.smallest_tables(quasi.AXES, tolerance)]
    draw = quasi.through(coarse)
    assert any(quasi.ratios(draw, n).max() > limit for n, limit in quasi.LIMITS.items())


def test_every_way_is_unbiased():
    """Each draws with the density of its weights: the mean over scramblings is the integral."""
    for draw in (quasi.inverse, quasi.through(shipped()), quasi.alias(256)):
        for theta_r in quasi.THETA_R:
            x, weight = draw(theta_r, quasi._points(2**14, 7))
            found = [(light(x[:, 0], x[:, 1]) * weight).mean() for light in quasi.LIGHTS.values()]
            assert found == pytest.approx(quasi._truth(theta_r), rel=2e-3)
            assert weight.mean() == pytest.approx(1, abs=2e-3)


def test_the_exact_inverse_converges_faster_than_random_numbers():
    few, many = (np.median(quasi.errors(quasi.inverse, n, 32)) for n in (64, 1024))
    assert many < few / 8  # random numbers: a quarter
