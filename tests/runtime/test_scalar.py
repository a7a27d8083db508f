# SPDX-License-Identifier: BSD-3-Clause
"""Sample, pdf and invert of one direction agree with each other and with the same reading in double.

An angle is a float, and one step of a float moves the density by as much as the density changes over
that step. Where a cell of the table is only a few floats wide (`printed` towards theta_r = +-90 degrees,
where most of the lobe lies beyond the domain's end) this is percents, and no arithmetic behind it can
repair that. So the bounds below are 1e-5 plus the range that the exact density takes within a stated
number of steps, and plain 1e-5 wherever that range is below 5e-6.
"""

import numpy as np
import pytest
from runtime.c_library import AXES, LOBES, MODELS, ROOT, Model, builtin, load

from hairlut import exr, interpolant

RELATIVE = 1e-5  # of a density
DRAWS = 40_000
WIDE = 64  # steps: a narrower cell ends within reach of the angle's rounding


@pytest.fixture(scope="module", params=AXES)
def axis(request) -> str:
    return request.param


@pytest.fixture(scope="module")
def table(model: Model, axis: str):
    return exr.read(ROOT / "luts" / model.name / f"{axis}.exr")[0]


def step(table) -> float:
    """Distance of two floats at the domain's larger end: the rounding that an angle's arithmetic adds."""
    return float(np.spacing(np.float32(np.max(np.abs(table.domain)))))


def draws(seed: int, n: int = DRAWS) -> tuple[np.ndarray, np.ndarray]:
    """(theta_r, u): uniform; a quarter of theta_r at the ends, a quarter of u far in the tails."""
    random = np.random.default_rng(seed)
    theta_r = random.uniform(-np.pi / 2, np.pi / 2, n).astype(np.float32)
    theta_r[: n // 8], theta_r[n // 8 : n // 4] = np.float32(np.pi / 2), -np.float32(np.pi / 2)
    u = random.random(n).astype(np.float32)
    tail = (2.0 ** random.uniform(-30, -1, n // 4)).astype(np.float32)
    u[::4] = np.where(random.random(n // 4) < 0.5, tail, 1 - tail)
    return random.permutation(theta_r), u


def density_range(table, theta_r, x, steps, points=5) -> tuple[np.ndarray, np.ndarray]:
    """The least and the largest density of the table, in double precision, within so many steps of x."""
    low, high = np.float32(table.domain).astype(float)
    at = [np.clip(x + shift * step(table), low, high) for shift in np.linspace(-steps, steps, points)]
    densities = np.array([interpolant.pdf(table, theta_r, there) for there in at])
    return densities.min(axis=0), densities.max(axis=0)


def test_invert_returns_the_u_that_was_drawn(model, axis):
    theta_r, u = draws(1)
    x, _ = model.axis_sample(axis, theta_r, u)
    assert np.abs(model.axis_invert(axis, theta_r, x).astype(float) - u).max() <= 1e-5


def test_invert_keeps_the_relative_precision_of_the_lower_tail(model, axis, table):
    theta_r, u = draws(2)
    x, _ = model.axis_sample(axis, theta_r, u)
    low, high = (interpolant.invert(table, theta_r, x + shift * step(table)) for shift in (-4, 4))
    found = model.axis_invert(axis, theta_r, x).astype(float)
    tail = u < 1e-3
    assert (found >= low * (1 - RELATIVE) - 1e-10)[tail].all()
    assert (found <= high * (1 + RELATIVE) + 1e-10)[tail].all()


def test_angle_is_the_table_read_in_double_precision(model, axis, table):
    theta_r, u = draws(3)
    x, _ = model.axis_sample(axis, theta_r, u)
    exact, _ = interpolant.sample(table, theta_r, u)
    assert np.abs(x - exact).max() <= 8 * step(table)  # the row position rounds too
    assert np.abs(model.axis_invert(axis, theta_r, exact).astype(float) - u).max() <= 1e-5


def test_density_is_the_one_read_in_double_precision(model, axis, table):
    theta_r, u = draws(4)
    x, sampled = model.axis_sample(axis, theta_r, u)
    evaluated = model.axis_pdf(axis, theta_r, x)
    wide = model.axis_cell_width(axis, theta_r, x) >= 2**14 * step(table)
    # 4e-5 is the share of the row position, a float too; narrow cells lie beside others far more dense
    for which, points, tolerance in ((wide, 5, 5e-5), (~wide, 129, 0.1)):
        low, high = density_range(table, theta_r[which], x[which], 8, points)
        for density in (sampled[which], evaluated[which]):
            assert (density >= low * (1 - tolerance)).all()
            assert (density <= high * (1 + tolerance)).all()


def test_density_of_a_sample_is_the_density_evaluated_there(model, axis, table):
    theta_r, u = draws(5)
    x, sampled = model.axis_sample(axis, theta_r, u)
    relative = np.abs(model.axis_pdf(axis, theta_r, x) / sampled.astype(float) - 1)
    wide = model.axis_cell_width(axis, theta_r, x) >= WIDE * step(table)
    low, high = density_range(table, theta_r, x, 2)
    spread = high / low - 1
    assert relative[wide & (spread < 5e-6)].max() <= RELATIVE
    assert (relative <= RELATIVE + spread)[wide].all()
    assert np.mean(wide & (spread < 5e-6)) > 0.4  # and so the first line is about most of them
    assert np.mean(wide) > 0.95


def test_a_density_that_is_off_by_two_in_100000_is_noticed(model, axis, table):
    theta_r, u = draws(5)
    x, sampled = model.axis_sample(axis, theta_r, u)
    relative = np.abs(model.axis_pdf(axis, theta_r, x) * 1.00002 / sampled.astype(float) - 1)
    low, high = density_range(table, theta_r, x, 2)
    assert relative[high / low - 1 < 5e-6].max() > RELATIVE


@pytest.mark.parametrize("lobe", LOBES)
def test_both_angles_invert_to_the_numbers_they_were_drawn_from(model, lobe):
    theta_r, u_theta = draws(6)
    _, u_phi = draws(7)
    phi_r = np.random.default_rng(8).uniform(-7, 7, len(u_phi)).astype(np.float32)
    s = model.sample(lobe, theta_r, phi_r, u_theta, u_phi)
    v_theta, v_phi = model.invert(lobe, theta_r, phi_r, s["theta_i"], s["phi_i"])
    assert np.abs(v_theta.astype(float) - u_theta).max() <= 1e-5
    apart = np.abs(v_phi.astype(float) - u_phi)
    assert np.minimum(apart, 1 - apart).max() <= 1e-5  # the azimuth's two ends are one direction


@pytest.mark.parametrize("lobe", LOBES)
def test_density_of_a_direction_is_the_product_of_its_tables(model, lobe):
    theta_r, u_theta = draws(9)
    _, u_phi = draws(10)
    s = model.sample(lobe, theta_r, 0.0, u_theta, u_phi)
    _, theta = model.axis_sample(f"{lobe}_theta", theta_r, u_theta)
    phi = model.axis_sample("direct_phi", theta_r, u_phi)[1] if lobe == "direct" else 1 / (2 * np.pi)
    np.testing.assert_allclose(s["pdf_angle"], theta.astype(float) * phi, rtol=3e-7)
    cosine = np.maximum(np.cos(s["theta_i"].astype(float)), 4.37113883e-8)
    np.testing.assert_allclose(s["pdf_solid_angle"], s["pdf_angle"] / cosine, rtol=1e-6)


@pytest.mark.usefixtures("loader")
@pytest.mark.parametrize("name", MODELS)
def test_loaded_and_compiled_in_tables_give_the_same_bits(name):
    compiled, loaded = builtin(name), load(ROOT / "luts" / name)
    theta_r, u_theta = draws(11)
    phi_r, u_phi = draws(12)
    for lobe in LOBES:
        one = compiled.sample(lobe, theta_r, phi_r, u_theta, u_phi)
        two = loaded.sample(lobe, theta_r, phi_r, u_theta, u_phi)
        assert one.tobytes() == two.tobytes()
        at = one["theta_i"], np.roll(one["phi_i"], 1)
        assert np.array_equal(compiled.pdf(lobe, theta_r, phi_r, *at), loaded.pdf(lobe, theta_r, phi_r, *at))
        assert np.array_equal(
            compiled.invert(lobe, theta_r, phi_r, *at), loaded.invert(lobe, theta_r, phi_r, *at)
        )
