# SPDX-License-Identifier: BSD-3-Clause
"""Grids and draws come in by the same door as functions: what they become, and what it promises."""

import json

import numpy as np
import pytest
from scipy import stats

from hairlut import cli, exr
from hairlut.fit import draws, grid
from hairlut.fit.read import Draws, checked_grid, read

INPUTS = "tests/data/inputs"
THETA_R = np.radians(np.arange(-80, 81, 20.0))
THETA_I = np.radians(np.arange(-88, 89, 4.0))
PHI = np.radians(np.arange(2.5, 360, 5.0))


def two_highlights(theta_r, theta_i, phi):
    """One separable highlight behind the fibre, and a broader one before it."""
    x = theta_i + theta_r
    narrow = np.exp(-0.5 * (x / 0.05) ** 2) / 0.05 * np.exp(8 * (np.cos(phi - np.pi) - 1))
    return narrow + np.exp(-0.5 * (x / 0.3) ** 2) / 0.3 * np.exp(3 * (np.cos(phi) - 1))


def values(function, offset=None):
    t, i, p = THETA_R[:, None, None], THETA_I[:, None], PHI
    return function(t, i, p) if offset is None else np.stack([function(t, i, p, h) for h in offset])


def fitted(path, out, capsys, *options):
    assert cli.main(["fit", str(path), "--out", str(out), "--json", *options]) == cli.OK
    said = capsys.readouterr()
    return exr.read_model(out / path.stem), json.loads(said.out), said.err


def relative_variance(model, function, theta_r, offset=0.0, count=(720, 360)):
    """V at one theta_r, by a dense midpoint rule."""
    n, m = count
    theta_i, phi = ((np.arange(n) + 0.5) / n - 0.5) * np.pi, (np.arange(m) + 0.5) / m * 2 * np.pi
    p = function(theta_r, theta_i[:, None], phi)
    q = model.pdf(theta_r, 0.0, theta_i[:, None], phi, offset)
    size = np.pi / n * 2 * np.pi / m
    return float((p * p / q).sum() * size / (p.sum() * size) ** 2 - 1)


def test_a_far_field_grid_of_two_highlights_takes_two_lobes(tmp_path, capsys):
    path = tmp_path / "two.npz"
    np.savez(path, theta_r=THETA_R, theta_i=THETA_I, phi=PHI, value=values(two_highlights))
    model, told, err = fitted(path, tmp_path / "out", capsys)
    assert told["lobes"] == 2
    assert told["data"] == "grid of 9 x 45 x 72 (theta_r x theta_i x phi)"
    assert err == ""
    for theta_r in (THETA_R[1], 0.0, np.radians(50.0)):  # on a row, and between rows
        assert relative_variance(model, two_highlights, theta_r) < 0.01


def test_a_grid_per_steradian_gains_the_cosine():
    data = checked_grid(THETA_R, THETA_I, PHI, values(two_highlights))
    angle, solid = grid.of_grid(data, False), grid.of_grid(data, True)
    at = 0.0, THETA_I[:, None], PHI, 0.0
    np.testing.assert_allclose(solid.density(*at), angle.density(*at) * np.cos(THETA_I)[:, None], rtol=1e-12)


def test_a_grid_keeps_its_values_and_moves_highlights_between_its_rows():
    given = grid.of_grid(checked_grid(THETA_R, THETA_I, PHI, values(two_highlights)), False)
    np.testing.assert_allclose(
        given.density(THETA_R[3], THETA_I[:, None], PHI, 0.0), values(two_highlights)[3], rtol=1e-9, atol=1e-9
    )
    theta_r, theta_i, phi = (
        np.radians(10.0),
        np.radians(np.arange(-40, 20, 1.7)),
        np.radians(np.arange(0, 360, 7.0)),
    )
    exact = two_highlights(theta_r, theta_i[:, None], phi)
    found = given.density(theta_r, theta_i[:, None], phi, 0.0)
    bright = exact > 1e-2 * exact.max()
    np.testing.assert_allclose(found[bright], exact[bright], rtol=0.15)


def turning(theta_r, theta_i, phi, offset):
    gamma = np.arcsin(offset)
    return np.exp(-0.5 * ((theta_i + theta_r) / 0.2) ** 2) * np.exp(6 * (np.cos(phi + 2 * gamma) - 1))


@pytest.mark.parametrize("low", [0.0, -np.pi / 2])
def test_a_grid_with_offsets_turns_its_lobes(tmp_path, capsys, low):
    offset = np.sin(np.linspace(low, np.pi / 2, 9 if low == 0 else 17))
    path = tmp_path / "near.npz"
    value = values(turning, offset)[:, 1:-1:2, :, ::2]
    np.savez(path, theta_r=THETA_R[1:-1:2], theta_i=THETA_I, phi=PHI[::2], offset=offset, value=value)
    model, told, _ = fitted(path, tmp_path / "out", capsys, "--lobes", "1", "--budget", "1")
    assert told["relative_variance"] < 0.01
    assert model.mixture.mirrored == (low == 0)
    for h in (offset[3], (offset[3] + offset[4]) / 2, -offset[3]):
        cost = relative_variance(model, lambda *at, h=h: turning(*at, h), np.radians(13.0), h)
        assert cost < 0.02


def test_azimuths_narrower_than_the_cells_give_no_nan(tmp_path, capsys):
    """Two peaks of 3 degrees in cells of 10, as hair after Chiang et al. with beta_n = 0.1 has them."""
    theta_i, phi = np.radians(np.arange(-84, 85, 8.0)), np.radians(np.arange(5, 360, 10.0))
    gamma = np.linspace(0, np.pi / 2, 5)

    def peak(angle):
        return np.exp(-abs((angle + np.pi) % (2 * np.pi) - np.pi) / 0.05)

    rows = [peak(phi + 2 * g) + peak(phi - np.pi - g) for g in gamma]
    value = np.exp(-0.5 * (theta_i / 0.2) ** 2)[:, None] * np.array(rows)[:, None, None]
    path = tmp_path / "narrow.npz"
    np.savez(path, theta_r=[0.0], theta_i=theta_i, phi=phi, offset=np.sin(gamma), value=value)
    model, told, _ = fitted(path, tmp_path / "out", capsys, "--budget", "2")
    assert np.isfinite(told["relative_variance"])
    for table in model.tables:
        assert np.isfinite(table.texels).all()
        assert np.isfinite(table.slopes).all()
    for h in (0.0, 0.4, -1.0):
        q = model.pdf(0.0, 0.0, theta_i[:, None], phi, h)
        assert (q > 0).all()
        assert np.isfinite(q).all()


# ---- draws


def test_draws_of_a_product_are_one_lobe_and_their_noise_is_no_dependence(tmp_path, capsys):
    path = f"{INPUTS}/draws_of_two_gaussians.csv"
    assert cli.main(["fit", path, "--out", str(tmp_path), "--name", "two", "--json"]) == cli.OK
    told = json.loads(capsys.readouterr().out)
    assert told["lobes"] == 1
    assert told["low"] <= 0.03
    assert told["relative_variance"] < 0.3
    assert exr.read_model(tmp_path / "two").errors["mixture"]["relative_variance"] == pytest.approx(
        told["relative_variance"], rel=1e-3
    )


def drawn(count, seed, correlated=False):
    random = np.random.default_rng(seed)
    theta_r = random.choice(np.radians([-40.0, -20, 0, 20, 40]), count)
    first = random.random(count) < 0.5
    theta_i = -theta_r + np.where(first, 0.08, 0.4) * random.standard_normal(count)
    phi = np.where(first if correlated else random.random(count) < 0.5, 0.0, np.pi)
    phi = np.mod(phi + 0.4 * random.standard_normal(count), 2 * np.pi)
    kept = abs(theta_i) < np.pi / 2
    return Draws(theta_r[kept], theta_i[kept], phi[kept], np.ones(kept.sum()))


def test_draws_whose_angles_depend_on_each_other_take_more_lobes():
    assert draws.fit(drawn(8_000, 1, correlated=True), None).choice.lobes >= 2
    assert draws.fit(drawn(8_000, 1), None).choice.lobes == 1


def test_the_variance_of_draws_left_out_is_that_of_the_light():
    """Not that of the cells, which the noise of few draws fills with peaks."""
    for count in (1_000, 10_000):
        found = draws.fit(drawn(count, 2), None)
        assert found.variance == pytest.approx(0.0, abs=max(3 * found.error, 0.02))
    assert draws.fit(drawn(1_000, 2), 1).apparent > 0.5


def test_one_lobe_for_dependent_draws_shows_what_it_costs():
    found = draws.fit(drawn(8_000, 3, correlated=True), 1)
    x = np.linspace(-1.5, 1.5, 3001)
    narrow, broad = stats.norm.pdf(x, 0, 0.08), stats.norm.pdf(x, 0, 0.4)
    each = [((a * a) / ((narrow + broad) / 2)).mean() * 3.0 for a in (narrow, broad)]
    exact = sum(each) / 2 - 1  # the azimuths hardly overlap: sum of (1/2)^2 a^2 / ((narrow + broad) / 2 / 2)
    assert found.variance == pytest.approx(exact, rel=0.15)


def test_few_or_wide_rows_of_draws_still_bake(tmp_path, capsys):
    data = drawn(3000, 4)
    path = tmp_path / "one.npz"
    np.savez(path, theta_r=np.zeros(data.theta_i.size), theta_i=data.theta_i, phi=data.phi)
    model, told, _ = fitted(path, tmp_path / "out", capsys)
    assert np.isfinite(told["relative_variance"])
    assert model.pdf(0.0, 0.0, 0.0, 0.0) > 0


def test_draws_with_offsets_turn(tmp_path, capsys):
    random = np.random.default_rng(5)
    count = 40_000
    offset = np.sin(random.choice(np.linspace(0, np.pi / 2, 7), count))
    theta_r = random.choice(np.radians([-30.0, 0.0, 30.0]), count)
    theta_i = -theta_r + 0.25 * random.standard_normal(count)
    phi = np.mod(-2 * np.arcsin(offset) + 0.5 * random.standard_normal(count), 2 * np.pi)
    path = tmp_path / "near.npz"
    np.savez(path, theta_r=theta_r, theta_i=theta_i, phi=phi, offset=offset)
    model, told, _ = fitted(path, tmp_path / "out", capsys)
    assert model.mixture.mirrored
    assert told["relative_variance"] < 0.1
    turn = np.unwrap(model.mixture.turn[0, len(model.mixture.theta_r) // 2])
    np.testing.assert_allclose(turn - turn[0], -2 * np.arcsin(model.mixture.offset), atol=0.1)


def test_the_data_are_named_and_a_missing_file_refused(tmp_path, capsys):
    assert cli.main(["fit", str(tmp_path / "none.csv"), "--out", str(tmp_path)]) == cli.WRONG_USE
    assert "none.csv" in capsys.readouterr().err
    assert str(read(f"{INPUTS}/grid_whole.csv")).startswith("grid of 1 x 4 x 4")
