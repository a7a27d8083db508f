# SPDX-License-Identifier: BSD-3-Clause
"""Samples follow the density that is returned with them: chi-squared tests, each at its own fixed seed.

Expected counts come from integrating the density function over every bin. All tests of this file together
reject a correct library with probability ALPHA (Sidak's correction over TESTS); a sample where the density is
zero fails at once.
"""

import dataclasses

import numpy as np
import pytest
from runtime.c_library import AXES, MODELS, ROOT, builtin
from runtime.models import from_baked
from runtime.quadrature import integrate, panels
from scipy.special import chdtrc

from hairlut import exr

SAMPLES = 1_000_000
BINS = 200
INCLINATIONS = np.float32([-np.pi / 2, -1.3, -0.9, -0.4, 0.0, 0.123, 0.6, 1.1, 1.45, np.pi / 2])
VIEWERS = [(theta_r, phi_r) for theta_r in (-1.35, -0.3, 0.8) for phi_r in (-2.5, 0.0, 2.0)]
OFFSETS = (-0.85, 0.1, 0.6)
TESTS = len(MODELS) * len(AXES) * len(INCLINATIONS) + 2 * len(MODELS) * 3 + len(VIEWERS) * len(OFFSETS)
ALPHA = 0.01
LEAST_P = 1 - (1 - ALPHA) ** (1 / TESTS)
LEAST_EXPECTED = 8


def p_value(counts: np.ndarray, expected: np.ndarray) -> float:
    """Of Pearson's statistic; neighbouring bins are pooled until each expects LEAST_EXPECTED. Samples where
    nothing is expected give 0."""
    if counts[expected == 0].any():
        return 0.0
    group = np.floor(np.cumsum(expected) / LEAST_EXPECTED).astype(int)
    group = np.unique(group, return_inverse=True)[1]
    counts, expected = np.bincount(group, counts), np.bincount(group, expected)
    keep = expected >= LEAST_EXPECTED
    counts = np.append(counts[keep], counts[~keep].sum())
    expected = np.append(expected[keep], expected[~keep].sum())
    counts, expected = counts[expected > 0], expected[expected > 0]
    return float(chdtrc(len(counts) - 1, ((counts - expected) ** 2 / expected).sum()))


def histogram(x: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Counts between the edges, and of everything below and above them: (len(edges) + 1,)."""
    return np.bincount(np.searchsorted(edges, x, side="right"), minlength=len(edges) + 1)


def bin_edges(table) -> np.ndarray:
    """Bins of equal width over the domain; the last edge is a float above it: the end can be drawn."""
    low, high = np.float32(table.domain)
    edges = np.linspace(low, high, BINS + 1, dtype=np.float32)
    edges[-1] = np.nextafter(high, np.float32(10))
    return edges


def expected_counts(model, table, theta_r, edges) -> np.ndarray:
    """Of SAMPLES draws, in the bins of histogram()."""
    ends = panels(model, table.name, theta_r, table.warp.u(table.width), edges)
    mass = integrate(model, table.name, theta_r, ends)
    bins = np.bincount(np.searchsorted(edges, ends[:-1], side="right"), mass, minlength=len(edges) + 1)
    return bins * SAMPLES


@pytest.fixture(scope="module", params=AXES)
def table(request, model):
    return exr.read(ROOT / "luts" / model.name / f"{request.param}.exr")[0]


@pytest.mark.parametrize("number", range(len(INCLINATIONS)))
def test_each_table_is_sampled_with_its_density(model, table, number):
    theta_r = INCLINATIONS[number]
    random = np.random.default_rng([MODELS.index(model.name), AXES.index(table.name), number])
    x, _ = model.axis_sample(table.name, theta_r, random.random(SAMPLES, np.float32))
    edges = bin_edges(table)
    assert p_value(histogram(x, edges), expected_counts(model, table, theta_r, edges)) > LEAST_P


WRONG = {
    "half a row off": lambda x, table: (np.diff(table.theta_r_range)[0] / (table.height - 1) / 2, x),
    "2 % too narrow": lambda x, table: (0.0, x * 0.98),
    "shifted by half a degree": lambda x, table: (0.0, np.clip(x + 0.009, *np.float32(table.domain))),
    "beyond the domain": lambda x, table: (0.0, np.append(x[1:], np.float32(table.domain[1]) + 0.01)),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_a_wrong_density_is_rejected(model, table, wrong):
    theta_r = np.float32(0.7)
    x, _ = model.axis_sample(table.name, theta_r, np.random.default_rng(99).random(SAMPLES, np.float32))
    shift, x = WRONG[wrong](x, table)
    edges = bin_edges(table)
    expected = expected_counts(model, table, np.float32(theta_r + shift), edges)
    assert p_value(histogram(x, edges), expected) < LEAST_P


@pytest.mark.parametrize("theta_r", INCLINATIONS[[1, 5, 7]])
@pytest.mark.parametrize("lobe", ["direct", "multiple"])
def test_both_angles_together_follow_the_density_of_a_direction(model, lobe, theta_r):
    """On a grid of 40 x 40 cells whose expected counts are midpoint sums of pdf_direct or pdf_multiple."""
    random = np.random.default_rng([7, MODELS.index(model.name), len(lobe), int(2000 + 1000 * theta_r)])
    phi_r = np.float32(2.0)
    s = model.sample(lobe, theta_r, phi_r, *random.random((2, SAMPLES), np.float32))
    assert p_value(joint_counts(s), joint_expected(model, lobe, theta_r, phi_r)) > LEAST_P
    assert (
        p_value(joint_counts(s), joint_expected(model, lobe, theta_r, -phi_r)) < LEAST_P or lobe == "multiple"
    )


GRID, FINE = 40, 24


def joint_counts(s: np.ndarray) -> np.ndarray:
    theta = np.clip(((s["theta_i"] / np.pi + 0.5) * GRID).astype(int), 0, GRID - 1)
    phi = np.clip(((s["phi_i"] / np.pi + 1) / 2 * GRID).astype(int), 0, GRID - 1)
    return np.bincount(theta * GRID + phi, minlength=GRID * GRID)


def joint_expected(model, lobe: str, theta_r: float, phi_r: float) -> np.ndarray:
    middle = (np.arange(GRID * FINE) + 0.5) / (GRID * FINE)
    theta, phi = np.meshgrid((middle - 0.5) * np.pi, (2 * middle - 1) * np.pi, indexing="ij")
    density = model.pdf(lobe, theta_r, phi_r, theta, phi).astype(float)
    mass = density.reshape(GRID, FINE, GRID, FINE).sum(axis=(1, 3)).ravel() * 2 * (np.pi / (GRID * FINE)) ** 2
    return mass * SAMPLES


# ---- the whole hair: bins of equal solid angle ----


def on_sphere(s: np.ndarray) -> np.ndarray:
    """Counts in GRID x GRID bins of equal solid angle."""
    z = np.sin(s["theta_i"].astype(float))
    i = np.clip(((z + 1) / 2 * GRID).astype(int), 0, GRID - 1)
    phi = np.clip(((s["phi_i"] / np.pi + 1) / 2 * GRID).astype(int), 0, GRID - 1)
    return np.bincount(i * GRID + phi, minlength=GRID * GRID)


def expected_on_sphere(density) -> np.ndarray:
    """The mass of each bin, of density(theta, phi) per rad^2: Gauss-Legendre in theta, midpoints in phi."""
    nodes, weights = np.polynomial.legendre.leggauss(FINE)
    ends = np.arcsin(np.linspace(-1, 1, GRID + 1))
    half = np.diff(ends) / 2
    theta = ((ends[:-1] + ends[1:]) / 2)[:, None] + half[:, None] * nodes
    phi = (2 * (np.arange(GRID * FINE) + 0.5) / (GRID * FINE) - 1) * np.pi
    values = density(*np.meshgrid(theta.ravel(), phi, indexing="ij")).astype(float)
    values *= (half[:, None] * weights).ravel()[:, None] * 2 * np.pi / (GRID * FINE)
    return values.reshape(GRID, FINE, GRID, FINE).sum(axis=(1, 3)).ravel()


def turned(by: float, lobe: int):
    """brown with one lobe turned a little further."""
    baked = exr.read_model(ROOT / "luts" / "brown")
    turn = baked.mixture.turn.copy()
    turn[lobe] += by
    return from_baked(dataclasses.replace(baked, mixture=dataclasses.replace(baked.mixture, turn=turn)))


HAIR_SAMPLES = 400_000


def p_of_hair(viewer: int, offset: float, expected_from) -> float:
    """Of samples of brown seen from a viewer, against expected_from(theta_r, phi_r, offset)(theta, phi)."""
    theta_r, phi_r = np.float32(VIEWERS[viewer])
    u = np.random.default_rng([11, viewer, OFFSETS.index(offset)]).random((3, HAIR_SAMPLES), np.float32)
    s = builtin("brown").sample_hair(theta_r, phi_r, *u, offset=offset)
    return p_value(on_sphere(s), HAIR_SAMPLES * expected_on_sphere(expected_from(theta_r, phi_r, offset)))


def density_of(model, shares=None):
    return lambda theta_r, phi_r, offset: (
        lambda theta, phi: model.pdf_hair(theta_r, phi_r, theta, phi, offset=offset, shares=shares)
    )


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("viewer", range(len(VIEWERS)))
def test_the_whole_hair_follows_its_density_on_the_sphere(viewer, offset):
    assert p_of_hair(viewer, offset, density_of(builtin("brown"))) > LEAST_P


def mirrored(theta_r, phi_r, offset):
    return density_of(builtin("brown"))(theta_r, phi_r, -offset)


def other_shares(theta_r, phi_r, offset):
    """Those of the model at an offset nearby."""
    share = exr.read_model(ROOT / "luts" / "brown").mixture.at(theta_r, offset + 0.1)[0]
    return density_of(builtin("brown"), share)(theta_r, phi_r, offset)


WRONG_HAIR = {
    "shares": other_shares,
    "turn": lambda *at: density_of(turned(0.03, 0))(*at),
    "mirror": mirrored,
}


@pytest.mark.parametrize("wrong", WRONG_HAIR)
@pytest.mark.parametrize("viewer", [1, 5])
def test_a_wrong_hair_is_rejected(wrong, viewer):
    assert p_of_hair(viewer, OFFSETS[2], WRONG_HAIR[wrong]) < LEAST_P


def test_p_values_are_uniform_under_the_hypothesis():
    """The statistic itself: histograms that do follow their expectation reject as often as they should."""
    random = np.random.default_rng(31)
    expected = np.exp(-(np.linspace(-4, 4, 60) ** 2))
    expected *= 5000 / expected.sum()
    rejected = sum(p_value(random.poisson(expected) * 1.0, expected) < 0.05 for _ in range(2000)) / 2000
    assert 0.03 < rejected < 0.09


def test_the_number_of_tests_counted_is_the_number_there_is():
    assert TESTS == 60 + 12 + 27
    assert builtin("printed").name in MODELS
