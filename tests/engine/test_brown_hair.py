# SPDX-License-Identifier: BSD-3-Clause
"""luts/brown, which hairlut fit made of near-field hair, for the engine's hair of the same parameters: no
bias, and nearly as good as the sampler of the BSDF's authors."""

import math

import numpy as np
import pytest
from engine.chisquare import interaction, sample_angles

from hairlut import exr
from report.hairscene.draws import Draws, corrected, draw
from report.hairscene.nearfield import direction, largest_weight, light
from report.hairscene.owndensity import density, is_atom
from report.hairscene.scene import brown_hair

DRAWS = 20_000
VIEWER = math.radians(30)
ALPHA = 0.01  # of all comparisons with the quadrature below together
TABLES = ("uniform", "fitted", "brown")
OWN = {"half brown, half its own": 0.5, "its own": 1.0}  # share of the engine's own draws
LIGHTS = {"constant": 0, "contrasted": 1}
COMPARISONS = (len(TABLES) + len(OWN)) * len(LIGHTS)
PLACES = [(0, 0), (30, -45), (-30, 45), (60, 10), (-85, 80), (40, 170)]  # theta_r, phi_r in degrees


def bsdf_of(kind):
    """The BSDF dictionary by what proposes directions."""
    plugin = {"type": "hairlut", "nested": brown_hair()}
    return {
        "uniform": {**plugin, "uniform": True},
        "fitted": {**plugin, "model": "fitted"},
        "brown": {**plugin, "model": "brown"},
        "half brown, half its own": {**plugin, "model": "brown", "mix": 0.5},
        "its own": brown_hair(),
    }[kind]


@pytest.fixture(scope="module")
def drawn(mi):
    """Draws by sampler."""
    kinds = (*TABLES, *OWN)
    return {kind: draw(mi, mi.load_dict(bsdf_of(kind)), VIEWER, DRAWS, [kinds.index(kind)]) for kind in kinds}


@pytest.fixture(scope="module")
def exact(mi):
    """(2,) the light by quadrature, and its error."""
    return light(mi, mi.load_dict(brown_hair()), VIEWER)


def deviation(drawn, exact, light):
    """Standard errors by which the mean is off."""
    values, (means, errors) = drawn.estimates()[light], exact
    return (values.mean() - means[light]) / np.hypot(values.std() / np.sqrt(DRAWS), errors[light])


def limit(comparisons):
    from scipy.stats import norm

    return norm.isf((1 - (1 - ALPHA) ** (1 / comparisons)) / 2)


def variance(drawn):
    return drawn.weight.var() / drawn.weight.mean() ** 2


@pytest.mark.parametrize("kind", TABLES)
@pytest.mark.parametrize("light", LIGHTS)
def test_what_draws_from_tables_estimates_the_light_of_the_quadrature(drawn, exact, kind, light):
    assert abs(deviation(drawn[kind], exact, LIGHTS[light])) < limit(COMPARISONS)


@pytest.mark.parametrize("kind", OWN)
@pytest.mark.parametrize("light", LIGHTS)
def test_the_engines_own_draws_do_with_the_density_that_they_have(mi, drawn, exact, kind, light):
    own = corrected(mi, drawn[kind], brown_hair(), VIEWER, OWN[kind])
    assert abs(deviation(own, exact, LIGHTS[light])) < limit(COMPARISONS)


def test_the_engines_own_draws_have_an_atom(drawn):
    assert is_atom(drawn["its own"].wo).mean() > 1e-4
    assert not is_atom(drawn["brown"].wo).any()


def test_the_density_of_the_engines_draws_integrates_to_what_is_not_the_atom(drawn):
    theta, phi = np.meshgrid(
        (np.arange(400) + 0.5) / 400 * np.pi - np.pi / 2, np.arange(200) / 200 * 2 * np.pi, indexing="ij"
    )
    wo = np.stack([np.cos(theta) * np.sin(phi), np.sin(theta), np.cos(theta) * np.cos(phi)], -1).reshape(
        -1, 3
    )
    masses = []
    for gamma in np.arcsin(np.linspace(-0.95, 0.95, 20)):
        of = density(brown_hair(), VIEWER, np.full(len(wo), gamma), wo)
        masses.append((of * np.cos(theta).ravel()).sum() * (np.pi / 400) * (2 * np.pi / 200))
    atom = is_atom(drawn["its own"].wo).mean()
    assert np.mean(masses) == pytest.approx(1 - atom, abs=5 * np.sqrt(atom / DRAWS) + 2e-4)


def test_a_density_three_percent_off_would_be_seen(drawn, exact):
    brown = drawn["brown"]
    wrong = Draws(1.03 * brown.weight, brown.density, brown.gamma, brown.wo, 0.0)
    assert abs(deviation(wrong, exact, 0)) > limit(COMPARISONS)


def test_brown_samples_nearly_as_well_as_the_bsdfs_own_sampler(drawn):
    brown = variance(drawn["brown"])
    assert 1 + brown < 1.02 * (1 + variance(drawn["its own"]))
    assert brown < 0.05 * variance(drawn["fitted"])
    assert variance(drawn["fitted"]) < 0.5 * variance(drawn["uniform"])
    assert variance(drawn["half brown, half its own"]) < 1.5 * brown


def test_brown_has_no_large_weights(mi):
    brown, far_field, own = (
        largest_weight(mi, mi.load_dict(bsdf_of(kind)), VIEWER) for kind in ("brown", "fitted", "its own")
    )
    assert 1 < own < 1.5
    assert brown < 4 < far_field


# ---- what the plugin passes to the library


@pytest.fixture(scope="module")
def brown(mi):
    return mi.load_dict(bsdf_of("brown"))


@pytest.fixture(scope="module")
def written(tables):
    """luts/brown, read in double precision without the plugin."""
    return exr.read_model(tables / "brown")


def test_the_density_of_a_draw_is_the_density_of_its_direction(mi, brown):
    """To the rounding of a drawn direction."""
    context, off = mi.BSDFContext(), []
    for place in PLACES:
        si = interaction(mi, *map(math.radians, place))
        for u, v, w in np.random.default_rng(3).random((200, 3)).tolist():
            sample, weight = brown.sample(context, si, u, mi.Point2f(v, w))
            value, density = brown.eval_pdf(context, si, sample.wo)
            assert density == brown.pdf(context, si, sample.wo)
            assert np.array(weight) == pytest.approx(np.array(value) / sample.pdf, rel=1e-6)
            off.append(abs(sample.pdf / density - 1))
    assert np.quantile(off, 0.99) < 1e-4
    assert np.median(off) < 1e-6


def places(count):
    """theta_r, gamma, theta_i, phi: between nodes, on both sides of the fibre, beyond the last theta_r."""
    random = np.random.default_rng(5)
    chosen = [(0.3, 0.0), (0.3, 0.7), (-0.2, -1.1), (1.5, 1.5), (-1.0, 0.13), (0.9, -1.57)]
    for theta_r, gamma in [*chosen, *random.uniform(-1.5, 1.5, (20, 2)).tolist()]:
        for theta_i, phi in random.uniform((-1.5, 0), (1.5, 2 * math.pi), (count, 2)).tolist():
            yield theta_r, gamma, theta_i, phi


def test_the_plugin_draws_what_the_files_say(mi, brown, written):
    context = mi.BSDFContext()
    for theta_r, gamma, theta_i, phi in places(20):
        density = brown.pdf(context, interaction(mi, theta_r, gamma), direction(mi, theta_i, phi))
        expected = written.pdf(theta_r, gamma, theta_i, phi, math.sin(gamma)) / math.cos(theta_i)
        assert density == pytest.approx(float(expected), rel=2e-3)


def test_an_offset_of_the_other_sign_would_be_seen(mi, brown, written):
    context, off = mi.BSDFContext(), []
    for theta_r, gamma, theta_i, phi in places(20):
        density = brown.pdf(context, interaction(mi, theta_r, gamma), direction(mi, theta_i, phi))
        off.append(density * math.cos(theta_i) / written.pdf(theta_r, gamma, theta_i, phi, -math.sin(gamma)))
    assert np.quantile(np.abs(np.log(off)), 0.75) > 0.5


@pytest.mark.parametrize("kind", ["its own", "brown"])
def test_a_fibre_hit_at_h_reflects_to_minus_two_asin_h(mi, kind):
    """The mirror lobe: of hair too dark for others, and of brown near the rim, where it is strong."""
    dark = {**brown_hair(), "sigma_a": {"type": "rgb", "value": 50.0}}
    own = kind == "its own"
    for gamma in (-1.3, -1.15, 1.2) if not own else (-1.2, -0.5, 0.4, 1.2):
        bsdf = mi.load_dict(dark if own else bsdf_of(kind))
        phi = sample_angles(mi, bsdf, interaction(mi, 0.0, gamma), 20_000, seed=4)[:, 1] - gamma
        around = (phi + 2 * gamma + np.pi) % (2 * np.pi) - np.pi
        near = around[abs(around) < 0.6]
        assert len(near) > (0.9 if own else 0.3) * len(phi)
        assert near.mean() == pytest.approx(0.0, abs=0.03)


def test_the_other_half_of_the_fibre_is_the_mirror_image(mi, brown):
    context = mi.BSDFContext()
    for theta, phi in [(-0.5, 2.4), (0.1, 0.3), (1.2, -2.0)]:
        here = brown.pdf(context, interaction(mi, 0.4, 0.7), direction(mi, theta, phi))
        there = brown.pdf(context, interaction(mi, 0.4, -0.7), direction(mi, theta, -phi))
        assert here == pytest.approx(there, rel=1e-5)


def test_a_viewer_behind_the_surface_has_the_offset_of_one_in_front(mi, brown):
    context = mi.BSDFContext()
    for phi_r, front in [(2.5, math.pi - 2.5), (-1.8, 1.8 - math.pi)]:
        here = brown.pdf(context, interaction(mi, 0.4, phi_r), direction(mi, 0.2, phi_r + 1.0))
        there = brown.pdf(context, interaction(mi, 0.4, front), direction(mi, 0.2, front + 1.0))
        assert here == pytest.approx(there, rel=1e-4)
