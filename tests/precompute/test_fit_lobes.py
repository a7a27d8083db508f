# SPDX-License-Identifier: BSD-3-Clause
"""The lobes of a hair's cells: products, highlights that turn, shapes that change."""

import numpy as np
import pytest
from scipy import special, stats

from hairlut import interpolant
from hairlut.fit import smooth, tables
from hairlut.fit.cells import Cells
from hairlut.fit.factor import most_different, products, variance
from hairlut.fit.highlights import highlights
from hairlut.fit.lobesfit import first_row, improved, next_row, same_shapes
from hairlut.fit.refine import fit_rows
from hairlut.fit.turning import track, turned

GAMMA = np.linspace(0, np.pi / 2, 13)
EDGES = np.linspace(-np.pi / 2, np.pi / 2, 46)
THETA_I = (EDGES[1:] + EDGES[:-1]) / 2
PHI = np.radians(np.arange(2.5, 360, 5))
WIDTHS = 0.12, 0.4  # of the two highlights along the fibre, rad


def azimuth(phi, centre, kappa=8.0):
    return np.exp(kappa * (np.cos(phi - centre) - 1)) / (2 * np.pi * special.ive(0, kappa))


def share(gamma):
    """Of the narrow highlight's light."""
    return 0.7 - 0.4 * np.sin(gamma)


def unit(value):
    return (value / value.sum(axis=(-2, -1), keepdims=True)).astype(np.float32)


def hair(gamma, theta_r=0.0):
    """(N, n, m) masses: a narrow highlight behind the fibre, a broad one mirrored from it."""
    g, x = np.asarray(gamma)[:, None, None], THETA_I[:, None]
    narrow = stats.norm.pdf(x, -theta_r, WIDTHS[0]) * azimuth(PHI, np.pi - 0.7 * g)
    broad = stats.norm.pdf(x, 0.1 - theta_r, WIDTHS[1]) * azimuth(PHI, -2 * g)
    return unit(share(g) * narrow + (1 - share(g)) * broad)


@pytest.fixture(scope="module")
def row():
    return first_row(hair(GAMMA), GAMMA, 2, True)


def order(row):
    """The lobes, the narrower first."""
    mean = THETA_I @ row.theta
    width = np.sqrt((THETA_I**2) @ row.theta - mean**2)
    return np.argsort(width), width


def test_both_highlights_are_separated(row):
    at, width = order(row)
    np.testing.assert_allclose(width[at], WIDTHS, rtol=0.1)
    np.testing.assert_allclose(row.share[:, at[0]], share(GAMMA), atol=0.02)
    assert row.variance(hair(GAMMA)) < 0.005


def test_each_lobe_turns_with_its_highlight(row):
    """The fit and the hair may measure turns from different zeros, the same for all offsets."""
    at, _ = order(row)
    for k, speed in zip(at, (-0.7, -2.0), strict=True):
        np.testing.assert_allclose(row.turn[:, k] - row.turn[0, k], speed * GAMMA, atol=0.01)


def test_the_masses_are_masses(row):
    assert (row.theta >= 0).all()
    assert (row.phi >= 0).all()
    np.testing.assert_allclose(row.theta.sum(axis=0), 1, rtol=1e-5)
    np.testing.assert_allclose(row.phi.sum(axis=1), 1, rtol=1e-5)
    np.testing.assert_allclose(row.share.sum(axis=1), 1, rtol=1e-5)
    np.testing.assert_allclose(row.drawn().sum(axis=(1, 2)), 1, rtol=1e-3)


def test_one_lobe_does_not_draw_two_highlights():
    assert first_row(hair(GAMMA), GAMMA, 1, True).variance(hair(GAMMA)) > 0.2


def test_more_lobes_than_highlights_do_no_harm():
    assert first_row(hair(GAMMA), GAMMA, 3, True).variance(hair(GAMMA)) < 0.005


def test_offsets_between_those_of_the_fit_take_its_shapes(row):
    between = (GAMMA[1:] + GAMMA[:-1]) / 2
    parts = [
        np.stack([np.interp(between, GAMMA, part[:, k]) for k in range(2)], axis=1)
        for part in (row.share, row.turn)
    ]
    there = same_shapes(type(row)(row.theta, row.phi, *parts), hair(between), between, True)
    assert there.variance(hair(between)) < row.variance(hair(GAMMA)) + 0.002


def test_a_highlight_that_no_shape_has_leaves_the_shares_alone(row):
    """Of a hundred-thousandth of the light, where no lobe draws much: its weights decided all shares."""
    between = (GAMMA[1:] + GAMMA[:-1]) / 2
    parts = [
        np.stack([np.interp(between, GAMMA, part[:, k]) for k in range(2)], axis=1)
        for part in (row.share, row.turn)
    ]
    mass = hair(between)
    faint = mass.copy()
    faint[:, 2, 9] += 1e-5
    expected = type(row)(row.theta, row.phi, *parts)
    assert (faint / expected.drawn())[:, 2, 9].min() > 100
    alone, beside = (same_shapes(expected, light, between, True) for light in (mass, faint))
    np.testing.assert_allclose(beside.share, alone.share, atol=0.01)
    assert beside.variance(mass) < alone.variance(mass) + 0.001


def test_the_next_theta_r_goes_on_from_the_last(row):
    moved = type(row)(np.roll(row.theta, -2, axis=0), row.phi, row.share, row.turn)
    there = next_row(moved, hair(GAMMA, 2 * np.pi / 45), GAMMA, True)
    assert there.variance(hair(GAMMA, 2 * np.pi / 45)) < 0.005
    assert abs(there.turn - row.turn).max() < 0.02


def test_narrow_azimuths_stay_finite():
    """Of a twentieth of a radian: their powers overflowed, and the models were NaN."""
    phi = (np.arange(72) + 0.5) * (2 * np.pi / 72)
    g, x = np.linspace(0, np.pi / 2, 5), np.radians(np.arange(-84, 85, 8.0))

    def wrap(angle):
        return abs((angle + np.pi) % (2 * np.pi) - np.pi)

    at = g[:, None]
    around = np.exp(-wrap(phi + 2 * at) / 0.05) + np.exp(-wrap(phi - np.pi - at) / 0.05)
    mass = unit(np.exp(-0.5 * (x[:, None] / 0.2) ** 2) * around[:, None, :])
    found = first_row(mass, g, 2, True)
    assert np.isfinite(found.variance(mass))
    assert found.variance(mass) < 0.05


def test_an_azimuth_that_changes_its_shape_takes_several_lobes():
    kappa = (20 - 18 * GAMMA / GAMMA[-1])[:, None, None]
    mass = unit(stats.norm.pdf(THETA_I[:, None], 0, 0.3) * azimuth(PHI, 1.0, kappa))
    cost = [first_row(mass, GAMMA, count, True).variance(mass) for count in (1, 2, 3)]
    assert cost[0] > 0.05
    assert cost[1] < 0.3 * cost[0]
    assert cost[2] < 0.01


def test_turns_of_two_symmetric_peaks_go_on_over_theta_r():
    """A lobe of two equal peaks fits its neighbour half a circle away as well, but not between."""
    theta_r = np.linspace(-0.6, 0.6, 7)
    rows = []
    for t in theta_r:
        g = GAMMA[:, None, None] + 0.3 * t
        rows.append(
            unit(
                stats.norm.pdf(THETA_I[:, None], -t, 0.2)
                * (azimuth(PHI, g, 20) + azimuth(PHI, g + np.pi, 20))
            )
        )
    edges = np.tile(EDGES, (len(theta_r), 1))
    data = Cells(theta_r, np.sin(GAMMA), edges, np.array(rows), np.ones((len(theta_r), len(GAMMA))))
    found = fit_rows(data, GAMMA, 1, True)
    assert max(row.variance(mass) for row, mass in zip(found, rows, strict=True)) < 0.02
    turn = np.array([row.turn[:, 0] for row in found])
    assert abs(np.diff(turn, axis=0) - 0.3 * np.diff(theta_r)[:, None]).max() < 0.05


def test_without_turns_lobes_are_products():
    p = hair(GAMMA[:1])
    row = first_row(p, GAMMA[:1], 2, False)
    assert not row.turn.any()
    assert row.variance(p) < 0.005


# ---- products


def test_products_find_a_matrix_of_their_rank():
    random = np.random.default_rng(1)
    theta, azimuth = random.random((40, 3)) ** 4, random.random((3, 200)) ** 4
    p = theta @ azimuth
    p /= p.sum()
    assert variance(p, np.matmul(*products(p, 3, 2000))) < 0.005
    assert variance(p, np.matmul(*products(p, 1))) > 0.1


def test_the_most_different_columns_are_the_pure_ones():
    random = np.random.default_rng(2)
    pure = random.random((30, 3))
    p = pure @ np.concatenate([np.eye(3), random.random((3, 50))], axis=1)
    found = most_different(p, 3)
    for column in (pure / pure.sum(axis=0)).T:
        assert abs(found.T - column).max(axis=1).min() < 1e-12


def test_parts_of_two_products_that_move_together_are_one_highlight():
    """A highlight whose inclination is half of each product's, beside one that only one of them has."""
    random = np.random.default_rng(3)
    theta = random.random((30, 2))
    theta /= theta.sum(axis=0)
    mine, other = azimuth(PHI, 1 + GAMMA[:, None], 40), azimuth(PHI, 4.3 - 0.3 * GAMMA[:, None], 40)
    azimuths = np.stack([mine + other, mine], axis=1)
    found = highlights(theta, azimuths)
    assert sum(one.strength > 0.05 * found[0].strength for one in found) == 2
    np.testing.assert_allclose(found[0].theta, theta.mean(axis=1), rtol=0.05)
    np.testing.assert_allclose(found[1].theta, theta[:, 0], rtol=0.05)


# ---- turning


def test_masses_are_turned_by_any_angle():
    mass = azimuth(PHI, 2.0)
    for angle in (-7.0, -0.3, 0.0, np.radians(5), 0.61, 9.0):
        np.testing.assert_allclose(turned(mass, np.array(angle)), azimuth(PHI, 2.0 + angle), atol=2e-3)


def test_turning_leaves_no_cell_empty_beside_a_steep_peak():
    mass = np.full(64, 1e-4)
    mass[20] = 1.0
    assert turned(mass, np.array(0.04)).min() >= 1e-4


def test_a_highlight_is_followed_through_the_dark_and_across_another():
    """Between them they cross: the fainter, which is followed, does not jump onto the other; nor where it has
    no light at all."""
    angle = np.linspace(0, 3, 25)
    mine, other = azimuth(PHI, 1.0 + angle[:, None]), azimuth(PHI, 2.6 - angle[:, None])
    light = np.where(angle > 2.6, 0.0, 0.2)
    mass = np.where(light[:, None] > 0, mine + 0.3 * other, other)
    np.testing.assert_allclose(track(mass, light, azimuth(PHI, 0.0)), 1.0 + angle, atol=0.15)


# ---- smooth rows


def test_smooth_rows_keep_the_masses_and_come_close_to_the_density():
    edges = np.linspace(-np.pi / 2, np.pi / 2, 33)[None]
    mass = np.diff(stats.norm.cdf(edges, 0.1, 0.25), axis=1)
    rows = smooth.rows(np.zeros(1), edges, mass, False)
    x = np.linspace(-1, 1, 200)
    exact = stats.norm.pdf(x, 0.1, 0.25)
    bright = exact > 1e-2 * exact.max()
    np.testing.assert_allclose(rows.density(x, 0)[bright], exact[bright], rtol=0.05)
    u = np.cumsum(mass[0])[:-1]
    inside = (u > 0.01) & (u < 0.99)
    np.testing.assert_allclose(
        rows.quantiles(u, np.zeros(31, bool))[0][inside], edges[0, 1:-1][inside], atol=1e-3
    )


def test_the_table_of_a_faint_lobe_has_its_tails():
    """Its variance would allow anything; at azimuths where no other lobe draws, its weights count."""
    theta_r = np.linspace(-1, 1, 13)
    edges = np.tile(np.linspace(-np.pi / 2, np.pi / 2, 33), (13, 1))
    mass = np.diff(stats.norm.cdf(edges, -0.5 * theta_r[:, None], 0.4), axis=1)
    exact = smooth.rows(theta_r, edges, mass, False)
    need = tables.Need(np.full(13, 1e-3), np.full(13, 1e-3), 1e-3)
    table = tables.smallest("faint_theta", "hair", exact, need)
    read = interpolant.cells(table, theta_r)
    f = np.linspace(0.01, 0.99, 50)
    x = read.angle(f)
    light = exact.density(x, np.arange(13)[:, None, None])
    bright = light / np.cos(x) > 2e-3 * (light / np.cos(x)).max(axis=(1, 2), keepdims=True)
    assert (light * read.slope(f))[bright].max() < 1.2 * tables.HEAVIEST


def test_improving_an_exact_row_changes_nothing_much(row):
    again = improved(row, row.drawn(), GAMMA, 4, True)
    assert again.variance(row.drawn()) < 5e-4
