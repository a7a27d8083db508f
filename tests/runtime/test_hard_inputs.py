# SPDX-License-Identifier: BSD-3-Clause
"""No finite input gives NaN or infinity; what the others give is what hairlut.h says."""

import itertools

import numpy as np
import pytest
from runtime.c_library import LOBES, SAMPLE

HALF_PI = np.float32(np.pi / 2)
PI = np.float32(np.pi)
U = [0.0, 2.0**-32, 2.0**-24, 0.5, 1 - 2.0**-24, 1.0, -1.0, 2.0, 1e-45, 3e38, -3e38]
BEYOND = np.nextafter(HALF_PI, np.float32(4))
THETA = [0.0, -0.0, 1e-45, 0.7, HALF_PI, -HALF_PI, BEYOND, -BEYOND, 10.0, -10.0, 3e38, -3e38]
PHI = [0.0, -0.0, 1.0, PI, -PI, 7.0, -100.0, 1e8, -1e8, 3e38, -3e38]
INFINITE = [np.inf, -np.inf]


def grid(*axes) -> list[np.ndarray]:
    """Every combination, as float32 arrays."""
    return list(np.array(list(itertools.product(*axes)), np.float32).T)


def assert_valid_angles(s: np.ndarray) -> None:
    assert (np.abs(s["theta_i"]) <= HALF_PI).all()
    assert ((s["phi_i"] >= -PI) & (s["phi_i"] < PI)).all()


@pytest.fixture(params=LOBES)
def lobe(request) -> str:
    return request.param


def test_finite_inputs_give_finite_samples_with_a_density(model, lobe):
    s = model.sample(lobe, *grid(THETA, PHI, U, U))
    for name in SAMPLE.names:
        assert np.isfinite(s[name]).all(), name
    assert_valid_angles(s)
    assert (s["pdf_angle"] > 0).all()
    assert (s["pdf_solid_angle"] >= s["pdf_angle"] * (1 - 1e-6)).all()


def test_finite_directions_give_finite_densities(model, lobe):
    theta_r, phi_r, theta_i, phi_i = grid(THETA, PHI, THETA, PHI)
    pdf = model.pdf(lobe, theta_r, phi_r, theta_i, phi_i)
    assert np.isfinite(pdf).all()
    inside = np.abs(theta_i) <= HALF_PI
    assert (pdf[inside] > 0).all()
    assert (pdf[~inside] == 0).all()


def test_finite_directions_invert_into_the_unit_interval(model, lobe):
    for u in model.invert(lobe, *grid(THETA, PHI, THETA, PHI)):
        assert ((u >= 0) & (u <= 1)).all()


def test_values_outside_their_range_are_clamped(model, lobe):
    ends = {-np.inf: 0.0, -1.0: 0.0, 2.0: 1.0, np.inf: 1.0}
    for outside, end in ends.items():
        beyond, at = (model.sample(lobe, 0.3, 0.5, u, 0.25) for u in (outside, end))
        assert beyond.tobytes() == at.tobytes()
        beyond, at = (model.sample(lobe, 0.3, 0.5, 0.25, u) for u in (outside, end))
        assert beyond.tobytes() == at.tobytes()
    for outside in (BEYOND, 10.0, np.inf):
        for sign in (-1, 1):
            beyond = model.sample(lobe, sign * outside, 0.5, 0.25, 0.25)
            assert beyond.tobytes() == model.sample(lobe, sign * HALF_PI, 0.5, 0.25, 0.25).tobytes()
            beyond = model.pdf(lobe, sign * outside, 0.5, 0.25, 0.25)
            assert beyond == model.pdf(lobe, sign * HALF_PI, 0.5, 0.25, 0.25)


def test_a_direction_one_float_beyond_the_pole_has_no_density(model, lobe):
    for sign in (-1, 1):
        assert model.pdf(lobe, 0.3, 0.5, sign * HALF_PI, 0.25) > 0
        assert model.pdf(lobe, 0.3, 0.5, sign * BEYOND, 0.25) == 0
        assert model.pdf(lobe, 0.3, 0.5, sign * np.inf, 0.25) == 0


def test_nan_and_infinite_azimuth_give_zero_density_and_valid_angles(model, lobe):
    for position, bad in [(p, np.nan) for p in range(4)] + [(1, value) for value in INFINITE]:
        arguments = [0.3, 0.5, 0.25, 0.75]
        arguments[position] = bad
        s = model.sample(lobe, *arguments)
        assert_valid_angles(s)
        assert (s["pdf_angle"] == 0).all()
        assert (s["pdf_solid_angle"] == 0).all()
    for position, bad in [(p, np.nan) for p in range(4)] + [(p, value) for p in (1, 3) for value in INFINITE]:
        arguments = [0.3, 0.5, 0.25, 0.75]
        arguments[position] = bad
        assert model.pdf(lobe, *arguments) == 0


def test_inverting_nan_gives_zero(model, lobe):
    nan = np.nan
    assert model.invert(lobe, 0.3, 0.5, nan, 0.75)[0] == 0
    assert model.invert(lobe, 0.3, 0.5, 0.25, nan)[1] == 0
    for arguments in ((nan, 0.5, 0.25, 0.75), (0.3, nan, 0.25, 0.75), (0.3, np.inf, 0.25, 0.75)):
        for u in model.invert(lobe, *arguments):
            assert 0 <= u <= 1


def test_smallest_u_reaches_the_domains_end_and_neighbours_stay_apart(model, lobe):
    s = model.sample(lobe, 0.3, 0.0, [0.0, 2.0**-32, 2.0**-24, 2.0**-20], 0.5)
    step = np.spacing(HALF_PI)  # of blending two rows that both begin at the domain's end
    assert -HALF_PI <= s["theta_i"][0] <= -HALF_PI + step
    assert (np.diff(s["theta_i"]) >= 0).all()
    assert s["theta_i"][3] > -HALF_PI
    s = model.sample(lobe, 0.3, 0.0, [1 - 2.0**-20, 1 - 2.0**-24, 1.0], 0.5)
    assert HALF_PI - step <= s["theta_i"][2] <= HALF_PI
    assert s["theta_i"][0] < HALF_PI


def test_solid_angle_density_is_finite_at_the_pole():
    from runtime.c_library import core

    convert = core().hairlut_pdf_to_solid_angle
    for theta in (0.0, 1.0, HALF_PI, -HALF_PI):
        cosine = max(np.cos(float(theta)), 4.3e-8)
        assert convert(1.0, float(theta)) == pytest.approx(1 / cosine, rel=0.02)
    assert convert(0.0, float(HALF_PI)) == 0


def test_directions_beyond_the_domain_invert_to_its_nearer_end(model, lobe):
    for beyond in (BEYOND, 10.0, np.finfo(np.float32).max, np.inf):
        assert model.invert(lobe, 0.3, 0.5, beyond, 0.25)[0] == 1
        assert model.invert(lobe, 0.3, 0.5, -beyond, 0.25)[0] == 0
