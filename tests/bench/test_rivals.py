# SPDX-License-Identifier: BSD-3-Clause
"""The rivals do what they are timed for: samples follow the density, which integrates to 1."""

import runpy

import numpy as np
import pytest
from bench.rivals.library import Rival, rivals
from numpy.testing import assert_allclose
from runtime.c_library import ROOT
from scipy import stats

VIEWERS = ((0.3, 0.5), (-1.2, -2.8))
OFFSET = 0.4
SAMPLES, BINS, FINE = 40_000, (12, 12), 10
SIGNIFICANCE = 1e-5  # of each test; some hundred are made
LOBES = ("direct", "multiple", "hair")


def listed(samples: str) -> list[Rival]:
    return [rival for rival in rivals() if samples in rival.calls]


def label(value) -> str:
    return f"{value.name}-{value.how}" if isinstance(value, Rival) else str(value)


EVERY = [(rival, lobe) for rival in rivals() for lobe in LOBES if f"sample_{lobe}" in rival.calls]


def density_of(rival: Rival) -> Rival:
    """Whose densities go with a rival's samples: Box-Muller's are the hybrid's."""
    if "pdf_hair" in rival.calls:
        return rival
    return next(other for other in rivals() if (other.name, other.how) == ("hybrid", rival.how))


def edges() -> tuple[np.ndarray, np.ndarray]:
    return tuple(np.linspace(-end, end, bins + 1) for end, bins in zip((np.pi / 2, np.pi), BINS, strict=True))


def masses(rival: Rival, lobe: str, viewer, offset=OFFSET) -> np.ndarray:
    """(BINS) the integral of the density over each bin: Gauss-Legendre of FINE x FINE points."""
    x, w = np.polynomial.legendre.leggauss(FINE)
    centres = [0.5 * (e[1:] + e[:-1])[:, None] + 0.5 * np.diff(e)[:, None] * x for e in edges()]
    weights = [0.5 * np.diff(e)[:, None] * w for e in edges()]
    axes, weights = ([each.ravel() for each in both] for both in (centres, weights))
    density = rival.run(f"pdf_{lobe}", theta_r=viewer[0], phi_r=viewer[1], offset=offset,
                        theta_light=axes[0][:, None], phi_light=axes[1][None, :])["pdf_light"]  # fmt: skip
    weighed = density * weights[0][:, None] * weights[1][None, :]
    return weighed.reshape(BINS[0], FINE, BINS[1], FINE).sum(axis=(1, 3))


def drawn(rival: Rival, lobe: str, viewer, offset=OFFSET) -> dict[str, np.ndarray]:
    u = np.random.default_rng(7).random((3, SAMPLES), np.float32)
    return rival.run(f"sample_{lobe}", theta_r=viewer[0], phi_r=viewer[1], offset=offset,
                     u_lobe=u[0], u_theta=u[1], u_phi=u[2])  # fmt: skip


def p_value(samples: dict[str, np.ndarray], expected: np.ndarray) -> float:
    """Of chi^2 over the bins; bins of less than 5 samples are put together."""
    counts, *_ = np.histogram2d(samples["theta_i"], samples["phi_i"], edges())
    few = expected * SAMPLES < 5
    observed = np.append(counts[~few], counts[few].sum())
    wanted = np.append(expected[~few], expected[few].sum()) * SAMPLES
    kept = wanted > 1e-3
    return stats.chi2.sf(((observed - wanted)[kept] ** 2 / wanted[kept]).sum(), kept.sum() - 1)


@pytest.mark.parametrize(("rival", "lobe"), EVERY, ids=label)
def test_samples_follow_the_density(rival, lobe):
    for viewer in VIEWERS:
        expected = masses(density_of(rival), lobe, viewer)
        assert expected.sum() == pytest.approx(1, abs=2e-3)  # the hybrid's rows are interpolated
        assert p_value(drawn(rival, lobe, viewer), expected) > SIGNIFICANCE


@pytest.mark.parametrize("rival", listed("sample_hair"), ids=label)
def test_a_wrong_viewer_is_rejected(rival):
    viewer = VIEWERS[0]
    nearby = (viewer[0] + 0.05, viewer[1])
    assert p_value(drawn(rival, "hair", viewer), masses(density_of(rival), "hair", nearby)) < SIGNIFICANCE


@pytest.mark.parametrize(("rival", "lobe"), EVERY, ids=label)
def test_a_sample_comes_with_its_density(rival, lobe):
    for viewer in VIEWERS:
        samples = drawn(rival, lobe, viewer)
        inside = np.abs(samples["theta_i"]) < 1.55  # float rounds beside the pole
        again = density_of(rival).run(f"pdf_{lobe}", theta_r=viewer[0], phi_r=viewer[1], offset=OFFSET,
                                      theta_light=samples["theta_i"], phi_light=samples["phi_i"])  # fmt: skip
        assert_allclose(again["pdf_light"][inside], samples["pdf_angle"][inside], rtol=2e-3)
        per_angle = samples["pdf_solid_angle"] * np.cos(samples["theta_i"])
        assert_allclose(per_angle[inside], samples["pdf_angle"][inside], rtol=1e-3)


def test_a_vertex_is_a_sample_and_a_density():
    for rival in listed("vertex"):
        u = np.random.default_rng(8).random((8, 999), np.float32)
        viewer = {"theta_r": 3 * u[0] - 1.5, "phi_r": 6 * u[1] - 3, "offset": u[2]}
        light = {"theta_light": 3 * u[6] - 1.5, "phi_light": 6 * u[7] - 3}
        numbers = {"u_lobe": u[3], "u_theta": u[4], "u_phi": u[5]}
        both = rival.run("vertex", **viewer, **light, **numbers)
        sample, density = (
            rival.run("sample_hair", **viewer, **numbers),
            density_of(rival).run("pdf_hair", **viewer, **light),
        )
        for name, values in both.items():
            apart = density if name == "pdf_light" else sample
            assert (
                np.quantile(abs(values - apart[name]), 0.99) < 1e-3
            )  # the fastest flags may round otherwise


def test_a_hit_is_a_sample_and_four_densities():
    hits = listed("hit")
    assert [rival.name for rival in hits] == ["Chiang"] * 2
    for rival in hits:
        u = np.random.default_rng(4).random((8, 50), np.float32)
        viewer = {"theta_r": u[0] - 0.5, "phi_r": 6 * u[1] - 3, "offset": 1.8 * u[2] - 0.9}
        numbers = {"u_lobe": u[3], "u_theta": u[4], "u_phi": u[5]}
        hit = rival.run("hit", **viewer, **numbers, theta_light=u[6] - 0.5, phi_light=6 * u[7] - 3)
        one = rival.run("sample_hair", **viewer, **numbers)
        for name in ("theta_i", "phi_i", "pdf_angle", "pdf_solid_angle"):
            assert_allclose(hit[name], one[name], rtol=1e-4, atol=1e-6)
        lights = [np.roll(u[6:], -k, axis=1) for k in range(4)]
        each = [
            rival.run("pdf_hair", **viewer, theta_light=theta - 0.5, phi_light=6 * phi - 3)["pdf_light"]
            for theta, phi in lights
        ]
        assert_allclose(hit["pdf_light"], sum(each), rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize(
    "rival", [each for each in listed("pdf_direct") if "logistic" not in each.name], ids=label
)
def test_the_closed_form_is_that_of_fitted(rival):
    from hairlut.lobes import FITTED

    theta_r, phi_r = 0.7, -2.0
    theta_i, phi_i = np.linspace(-1.5, 1.5, 41)[:, None], np.linspace(-3.1, 3.1, 43)[None, :]
    exact = {lobe.name: lobe for lobe in FITTED.lobes}
    relative = np.mod(phi_i - phi_r, 2 * np.pi)
    direct = truth(exact["direct_theta"], theta_r, theta_i) * truth(exact["direct_phi"], theta_r, relative)
    multiple = truth(exact["multiple_theta"], theta_r, theta_i) / (2 * np.pi) + 0 * phi_i
    for lobe, wanted in {"direct": direct, "multiple": multiple, "hair": (direct + multiple) / 2}.items():
        got = rival.run(f"pdf_{lobe}", theta_r=theta_r, phi_r=phi_r, theta_light=theta_i, phi_light=phi_i)
        assert_allclose(got["pdf_light"], wanted, rtol=2e-2, atol=1e-4)


@pytest.mark.parametrize("rival", [each for each in rivals() if each.name == "Chiang"], ids=label)
def test_chiang_samples_the_hair_that_brown_is_fitted_to(rival):
    """With one channel of absorption its sampler's density is that BSDF times cosine, normalised."""
    hair = runpy.run_path(str(ROOT / "precompute" / "examples" / "chiang2016.py"))["bsdf"]
    theta_r, phi_r, offset = -0.6, 0.3, -0.7
    (theta_i, w_theta), (phi_i, w_phi) = (midpoints(end, n) for end, n in ((np.pi / 2, 400), (np.pi, 300)))
    at = theta_i[:, None], phi_i[None, :]
    wanted = hair(theta_r, at[0], at[1] - phi_r, offset) * np.cos(at[0]) ** 2  # per steradian to per rad^2
    wanted /= (wanted * w_theta * w_phi).sum()
    got = rival.run(
        "pdf_hair", theta_r=theta_r, phi_r=phi_r, offset=offset, theta_light=at[0], phi_light=at[1]
    )
    assert_allclose(got["pdf_light"], wanted, rtol=1e-3, atol=1e-6)


def midpoints(end: float, n: int) -> tuple[np.ndarray, float]:
    """(n midpoints of [-end, end], their weight)"""
    step = 2 * end / n
    return -end + step * (np.arange(n) + 0.5), step


def truth(lobe, theta_r: float, x: np.ndarray) -> np.ndarray:
    """The Gaussian of a lobe, cut to its domain and normalised there."""
    mean, sigma = (float(value[0]) for value in lobe.moments(np.array([theta_r])))
    low, high = ((end - mean) / sigma for end in lobe.domain)
    return stats.truncnorm.pdf(x, low, high, mean, sigma)
