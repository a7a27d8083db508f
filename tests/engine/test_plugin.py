# SPDX-License-Identifier: BSD-3-Clause
"""The BSDF plugin alone: what it draws is what its density says, at every viewer direction."""

import math

import numpy as np
import pytest
from engine.chisquare import cell_masses, interaction, p_value, sample_angles

from report.hairscene.nearfield import direction
from report.hairscene.shares import with_shares

HAIR = {"type": "hair", "longitudinal_roughness": 0.5, "azimuthal_roughness": 0.5}
# (theta_r, phi_r) in degrees: facing, tilted both ways, across the fibre's edge, along the fibre, from behind
VIEWERS = [(0, 0), (0, 89), (30, -45), (-30, 45), (60, 10), (-60, -80), (80, 89), (-85, 20), (40, 170)]
MODELS = ("printed", "fitted", "brown")
SETTINGS = {**{name: {"model": name} for name in MODELS}, "uniform": {"uniform": True}}
CASES = [(name, viewer) for name in MODELS for viewer in VIEWERS] + [("uniform", (30, -45))]
COUNT = 700_000
ROWS, COLUMNS = 10, 20
SIGNIFICANCE = 0.01 / len(CASES)


def make(mi, nested=HAIR, **parameters):
    return mi.load_dict({"type": "hairlut", "nested": nested, **parameters})


@pytest.fixture(scope="module")
def drawn(mi):
    """Samples and cell masses of a setting at a viewer direction, drawn once for the tests below."""
    cache = {}

    def draw(name, viewer):
        if (name, viewer) not in cache:
            bsdf = make(mi, **SETTINGS[name])
            si = interaction(mi, *map(math.radians, viewer))
            context = mi.BSDFContext()
            masses = cell_masses(mi, lambda wo: bsdf.pdf(context, si, wo), ROWS, COLUMNS)
            cache[name, viewer] = sample_angles(mi, bsdf, si, COUNT, seed=17), masses
        return cache[name, viewer]

    return draw


@pytest.mark.parametrize(("name", "viewer"), CASES, ids=str)
def test_chi_square_accepts_the_plugin(mi, drawn, name, viewer):
    angles, masses = drawn(name, viewer)
    assert masses.sum() == pytest.approx(1.0, abs=1e-3)
    assert p_value(mi, angles, masses, COUNT) > SIGNIFICANCE


@pytest.mark.parametrize(("name", "viewer"), CASES, ids=str)
def test_chi_square_rejects_a_density_off_by_two_percent(mi, drawn, name, viewer):
    angles, masses = drawn(name, viewer)
    assert p_value(mi, angles, 1.02 * masses, COUNT) < SIGNIFICANCE


@pytest.mark.parametrize(("name", "viewer"), CASES, ids=str)
def test_chi_square_rejects_two_percent_moved_around_the_fibre(mi, drawn, name, viewer):
    """The integral stays 1, so only the shape of the density shows the error."""
    angles, masses = drawn(name, viewer)
    before = np.cumsum(masses.T).reshape(masses.T.shape).T  # column by column, around the fibre
    half = np.where(before < masses.sum() / 2, 1.0, -1.0)
    half -= (masses * half).sum() / masses.sum()
    assert p_value(mi, angles, masses * (1.0 + 0.02 * half), COUNT) < SIGNIFICANCE


@pytest.mark.parametrize("mix", [0.0, 0.5])
@pytest.mark.parametrize("name", SETTINGS)
def test_weight_is_value_over_density(mi, name, mix):
    """The density returned with a sample is that of pdf, to the rounding of its direction."""
    bsdf = make(mi, mix=mix, **SETTINGS[name])
    nested = mi.load_dict(HAIR)
    context, off = mi.BSDFContext(), []
    for viewer in VIEWERS:
        si = interaction(mi, *map(math.radians, viewer))
        for u, v, w in np.random.default_rng(3).random((200, 3)).tolist():
            sample, weight = bsdf.sample(context, si, u, mi.Point2f(v, w))
            if sample.pdf == 0.0:
                assert np.all(np.array(weight) == 0.0)
                continue
            value, density = bsdf.eval_pdf(context, si, sample.wo)
            assert density == bsdf.pdf(context, si, sample.wo)
            off.append(abs(sample.pdf / density - 1))
            assert np.array(value) == pytest.approx(np.array(nested.eval(context, si, sample.wo)), rel=1e-5)
            assert np.array(weight) == pytest.approx(np.array(value) / sample.pdf, rel=1e-5)
    assert np.quantile(off, 0.99) < 1e-4
    assert np.median(off) < 1e-6


def test_mix_of_one_is_the_nested_sampler_unchanged(mi):
    bsdf, nested = make(mi, mix=1.0), mi.load_dict(HAIR)
    context = mi.BSDFContext()
    for viewer in VIEWERS:
        si = interaction(mi, *map(math.radians, viewer))
        for u, v, w in np.random.default_rng(3).random((200, 3)).tolist():
            sample, weight = bsdf.sample(context, si, u, mi.Point2f(v, w))
            expected, expected_weight = nested.sample(context, si, u, mi.Point2f(v, w))
            assert np.all(np.array(sample.wo) == np.array(expected.wo))
            assert sample.pdf == expected.pdf
            assert np.all(np.array(weight) == np.array(expected_weight))


def test_mixture_density_is_the_weighted_sum(mi):
    tables, own = make(mi), mi.load_dict(HAIR)
    mixed = make(mi, mix=0.3)
    context, si = mi.BSDFContext(), interaction(mi, 0.4, -0.7)
    for theta, phi in [(-0.5, 2.4), (0.1, 0.0), (1.2, -2.0)]:
        wo = direction(mi, theta, phi)
        expected = 0.3 * own.pdf(context, si, wo) + 0.7 * tables.pdf(context, si, wo)
        assert mixed.pdf(context, si, wo) == pytest.approx(expected, rel=1e-5)


def test_both_sides_and_all_azimuths_are_drawn(mi):
    angles = sample_angles(mi, make(mi), interaction(mi, 0.2, 0.3), 20_000, seed=5)
    octants = np.unique((angles[:, 0] > 0) * 4 + np.floor((angles[:, 1] + np.pi) / (np.pi / 2)).astype(int))
    assert octants.size == 8


def test_fitted_proposes_the_far_side_mirrored_along_the_fibre(mi, tmp_path):
    """theta_i near -theta_r and phi_i near phi_r + pi: swapped axes, signs, or wi and wo would move it."""
    theta_r, phi_r = math.radians(35.0), math.radians(20.0)
    bsdf = make(mi, model=str(with_shares("fitted", (1, 0), tmp_path)))
    angles = sample_angles(mi, bsdf, interaction(mi, theta_r, phi_r), 20_000, seed=6)
    around = np.angle(np.mean(np.exp(1j * (angles[:, 1] - phi_r))))
    assert np.median(angles[:, 0]) == pytest.approx(-theta_r + math.radians(3 * theta_r - 2.0), abs=0.01)
    assert abs(around) == pytest.approx(math.pi, abs=0.02)


def test_a_directory_of_tables_is_the_compiled_in_model(mi, tables):
    context, si = mi.BSDFContext(), interaction(mi, 0.4, -0.7)
    loaded, builtin = make(mi, model=str(tables / "fitted")), make(mi, model="fitted")
    for u, v, w in np.random.default_rng(8).random((200, 3)).tolist():
        a, _ = loaded.sample(context, si, u, mi.Point2f(v, w))
        b, _ = builtin.sample(context, si, u, mi.Point2f(v, w))
        assert np.array(a.wo) == pytest.approx(np.array(b.wo), abs=2e-6)
        assert a.pdf == pytest.approx(b.pdf, rel=1e-4)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"model": "no_such_model"}, "printed.*fitted.*directory"),
        ({"mix": 1.5}, "mix is 1.5.*expected a probability"),
        ({"mix": -0.1}, "mix is -0.1.*expected a probability"),
        ({"mix": math.nan}, "mix is nan.*expected a probability"),
        ({"nested": {"type": "dielectric"}}, "Dirac"),
        ({"second": {"type": "hair"}}, "one nested BSDF"),
    ],
    ids=str,
)
def test_wrong_parameters_are_named(mi, parameters, message):
    with pytest.raises(RuntimeError, match=message):
        make(mi, **parameters)


def test_a_nested_bsdf_is_required(mi):
    with pytest.raises(RuntimeError, match="expected a nested BSDF"):
        mi.load_dict({"type": "hairlut"})


def test_a_plugin_that_does_not_build_is_no_reason_to_skip(monkeypatch, tmp_path):
    """Where the wheels are, a broken source fails the tests."""
    import plugin

    from report.engine import PluginBroken

    (tmp_path / "wheels.py").write_text((plugin.PLUGIN_SOURCE / "wheels.py").read_text())
    (tmp_path / "CMakeLists.txt").write_text(
        'project(broken NONE)\nmessage(FATAL_ERROR "no such function")\n'
    )
    monkeypatch.setattr(plugin, "PLUGIN_SOURCE", tmp_path)
    with pytest.raises(PluginBroken, match="no such function"):
        plugin.load_engine(tmp_path / "build")
