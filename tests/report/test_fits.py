# SPDX-License-Identifier: BSD-3-Clause
"""The authors' samplers that fits are held against, and what the page calls a miss."""

import numpy as np
import pytest
from scipy import stats

from report import fits, fits_page, weights
from report.hairs import Chiang, Huang, Subject, far_field, near_field

DRAWS = 40_000
ALPHA = 1e-3
CELLS = 12, 12


@pytest.mark.parametrize("settings", [(0.3, 0.3, 0.6), (0.1, 0.6, 0.1)])
@pytest.mark.parametrize("place", [(0.2, 0.3), (-1.1, 0.7)])
def test_chiangs_sampler_draws_its_density(settings, place):
    """Chi-squared of draws in cells, each of whose masses is a sum over the density."""
    hair = Chiang(*settings)
    assert p_value(hair, place, hair.sample) > ALPHA


def test_a_sampler_of_another_width_would_fail():
    hair, broader = Chiang(0.3, 0.3, 0.6), Chiang(0.33, 0.3, 0.6)
    assert p_value(hair, (0.2, 0.3), broader.sample) < ALPHA


def p_value(hair, place, sample):
    theta_r, offset = place
    theta_i, phi = sample(theta_r, offset, np.random.default_rng(1).random((DRAWS, 4)))
    edges = np.linspace(-np.pi / 2, np.pi / 2, CELLS[0] + 1), np.linspace(0, 2 * np.pi, CELLS[1] + 1)
    count, _, _ = np.histogram2d(theta_i, phi, bins=edges)
    fine = 60
    t = ((np.arange(CELLS[0] * fine) + 0.5) / (CELLS[0] * fine) - 0.5) * np.pi
    p = (np.arange(CELLS[1] * fine) + 0.5) / (CELLS[1] * fine) * 2 * np.pi
    mass = hair.own(theta_r, t[:, None], p, offset) * (np.pi / t.size) * (2 * np.pi / p.size)
    mass = mass.reshape(CELLS[0], fine, CELLS[1], fine).sum(axis=(1, 3))
    assert mass.sum() == pytest.approx(1, abs=1e-3)
    expected = (DRAWS * mass / mass.sum()).ravel()
    kept = expected > 8
    found = np.append(count.ravel()[kept], count.ravel()[~kept].sum())
    merged = np.append(expected[kept], max(expected[~kept].sum(), 1e-9))
    return (
        stats.chisquare(found, merged).pvalue
        if merged[-1] > 1
        else stats.chisquare(found[:-1], merged[:-1] * found[:-1].sum() / merged[:-1].sum()).pvalue
    )


@pytest.mark.parametrize("theta_r", [0.3, -1.1])
def test_huangs_sampler_scatters_its_light(theta_r):
    """Sums of weights in cells against sums over the light, with the variances of the sums."""
    assert p_of_weights(Huang(0.3, 0.3, 1024), theta_r, Huang(0.3, 0.3)) > ALPHA


def test_huangs_sampler_of_another_roughness_would_fail():
    assert p_of_weights(Huang(0.3, 0.3, 1024), 0.3, Huang(0.33, 0.3)) < ALPHA


def p_of_weights(hair, theta_r, sampler):
    cells, fine = 6, 6
    theta_i, phi, weight = sampler.draws(theta_r, np.random.default_rng(1).random((DRAWS, 8)))
    edges = np.linspace(-np.pi / 2, np.pi / 2, cells + 1), np.linspace(0, 2 * np.pi, cells + 1)
    first, second = (np.histogram2d(theta_i, phi, edges, weights=weight**k)[0] / DRAWS for k in (1, 2))
    t, p, size = fits.directions((cells * fine, cells * fine))
    light = hair.density(theta_r, t, p, 0.0) * size
    expected = light.reshape(cells, fine, cells, fine).sum(axis=(1, 3))
    lit = expected > 1e-3 * expected.sum()
    distance = (first - expected) ** 2 / ((second - first**2) / DRAWS)
    return stats.chi2.sf(distance[lit].sum(), lit.sum())


def test_every_hair_is_a_density():
    for subject in [*near_field()[::7], *far_field()]:
        values = subject.density(0.3, np.array([[-1.2], [0.1]]), np.array([0.5, 3.0]), 0.2)
        assert values.shape == (2, 2)
        assert np.isfinite(values).all()
        assert (values >= 0).all()


def near_row(**changes):
    row = {
        "variance": [0.005] * 4,
        "weight": 3.0,
        "lamps": [5.0] * 4,
        "own": {"variance": [0.0] * 4, "weight": 1.0, "lamps": [5.0] * 4},
        "promise": 0.006,
        "promise_low": 0.005,
        "promise_high": 0.007,
        "promise_weight": 3.5,
        "lobes": 3,
        "seconds": 5.0,
        "bytes": 100_000,
        "limits": [],
    }
    return row | changes


@pytest.mark.parametrize(
    ("changes", "missed"),
    [
        ({}, "none"),
        ({"variance": [0.05] * 4, "promise": 0.05}, "samples"),
        ({"weight": 11.0}, "weight"),
        ({"promise": 0.001}, "promise"),
        ({"bytes": 300_000}, "size"),
        ({"seconds": 30.0}, "time"),
        ({"lamps": [5.4] * 4}, "lamps"),
    ],
)
def test_a_target_that_is_missed_is_named(changes, missed):
    line = fits_page.page({"chiang 0.3 0.3 0.6": near_row(**changes)}).splitlines()[-2]
    assert line.split(" | ")[-1].removesuffix(" |") == missed


def test_a_random_offset_costs_the_spread_of_its_light():
    """Two offsets, of which one scatters three times the light of the other, each drawn perfectly."""

    def parts(theta_r, theta_i, phi):
        for light in (1.0, 3.0):
            p = np.broadcast_to(light * np.cos(theta_i) / (4 * np.pi), Subject.points)
            yield p, p / light

    found = fits.at_random_offsets(Subject("two", None, False, parts=parts))
    assert found["variance"] == pytest.approx([(1 + 9) / 2 / 2**2 - 1] * len(fits.VIEWERS), rel=1e-4)


def test_the_least_weight_is_the_least_mass_above_the_light():
    p = np.array([[0.4, 0.1], [0.0, 0.5]])
    one = np.array([[0.5], [0.5]])
    every = np.ones((2, 2), bool)
    assert weights.least_weight(p, one, every) == pytest.approx(0.4 / 0.5 + 0.5 / 0.5)
    assert weights.least_weight(p, np.eye(2), every) == pytest.approx(1)
    assert weights.least_weight(p, one, p < 0.45) == pytest.approx(0.4 / 0.5 + 0.1 / 0.5)


def test_a_pixel_wider_than_a_fibre_is_on_the_page():
    row = {k: v for k, v in near_row(lamps=[1.0] * 4).items() if k != "own"}
    row["parts"] = {"variance": [0.34] * 4, "lamps": [1.0, 3.0, 3.0, 1.0]}
    line = fits_page.page({"averaged": row}).split("## A pixel wider")[1]
    assert "| averaged | 0.750 (0.750 to 0.750) | 0.667 (0.500 to 1.000) |" in line


def test_a_far_field_hair_that_one_viewer_sees_badly_misses():
    row = {k: v for k, v in near_row(variance=[0.002, 0.011]).items() if k != "own"}
    assert "| V |" in fits_page.page({"karis 0.3": row})
