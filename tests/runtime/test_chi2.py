"""Samples follow the density that is returned with them: chi-squared tests, each at its own fixed seed.

Expected counts come from integrating the density function over every bin. All tests of this file together
reject a correct library with probability ALPHA (Sidak's correction over TESTS); a sample where the density is
zero fails at once.
"""

import numpy as np
import pytest
from runtime.c_library import AXES, MODELS, ROOT, builtin
from runtime.quadrature import integrate, panels
from scipy.special import chdtrc

from hairlut import exr

SAMPLES = 1_000_000
BINS = 200
INCLINATIONS = np.float32([-np.pi / 2, -1.3, -0.9, -0.4, 0.0, 0.123, 0.6, 1.1, 1.45, np.pi / 2])
TESTS = len(MODELS) * len(AXES) * len(INCLINATIONS) + 2 * len(MODELS) * 3
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


def test_p_values_are_uniform_under_the_hypothesis():
    """The statistic itself: histograms that do follow their expectation reject as often as they should."""
    random = np.random.default_rng(31)
    expected = np.exp(-(np.linspace(-4, 4, 60) ** 2))
    expected *= 5000 / expected.sum()
    rejected = sum(p_value(random.poisson(expected) * 1.0, expected) < 0.05 for _ in range(2000)) / 2000
    assert 0.03 < rejected < 0.09


def test_the_number_of_tests_counted_is_the_number_there_is():
    assert TESTS == 60 + 12
    assert builtin("printed").name in MODELS
