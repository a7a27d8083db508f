# SPDX-License-Identifier: BSD-3-Clause
"""Mixtures and whole models in numpy: blends, mirrors, draws and densities that belong to each other."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from hairlut import exr
from hairlut.errors import HairlutError
from hairlut.lobes import FITTED
from hairlut.mixture import Mixture, constant, shorter_arc, wrap
from hairlut.model import BakedModel, assemble


def mixture(**changes):
    fields = {
        "lobes": ("a", "b"),
        "theta_r": np.array([-1.0, 1.0]),
        "offset": np.array([0.0, 0.5, 1.0]),
        "share": np.array([[[1, 2, 3], [2, 2, 2]], [[3, 1, 0], [1, 2, 0]]], float),
        "turn": np.array([[[0, -1, -3], [0.25, -1.25, 3]], [[3, 2.5, 0], [-3, 2.75, 0]]]),
        "mirrored": True,
    }
    return Mixture(**(fields | changes))


def test_nodes_are_met_and_continued():
    read = mixture()
    for theta_r in (-1.0, -1.5):
        for n, offset in enumerate(read.offset):
            share, turn, side = read.at(theta_r, offset)
            assert share == pytest.approx(read.share[:, 0, n] / read.share[:, 0, n].sum())
            assert wrap(turn - read.turn[:, 0, n]) == pytest.approx([0, 0], abs=1e-12)
            assert side == 1


def test_shares_are_linear_in_theta_r_and_in_the_arc_of_the_offset():
    read = mixture()
    offset = np.sin((np.arcsin(0.5) + np.arcsin(1.0)) / 2)
    share, _, _ = read.at(0.0, offset)
    first = (2 / 3 + 3 / 3 + 2 / 4 + 2 / 2) / 4
    assert share == pytest.approx([first, 1 - first])


def test_turns_take_the_shorter_arc():
    assert shorter_arc(3.0, -3.0, 0.5) == pytest.approx(np.pi)
    assert shorter_arc(-3.0, 3.0, 0.5) == pytest.approx(-np.pi)
    _, turn, _ = mixture().at(0.0, 1.0)
    assert abs(turn[0]) == pytest.approx(np.pi)  # not 0, half-way between -3 and 3


def test_offsets_are_mirrored_or_not_and_clamped():
    read = mixture()
    for at in (0.2, 0.9):
        there, here = read.at(0.3, -at), read.at(0.3, at)
        for a, b in zip(there[:2], here[:2], strict=True):
            np.testing.assert_array_equal(a, b)
        assert (there[2], here[2]) == (-1, 1)
    np.testing.assert_array_equal(read.at(0.3, 7.0)[0], read.at(0.3, 1.0)[0])
    whole = mixture(offset=np.array([-1.0, 0.0, 1.0]), mirrored=False)
    assert whole.at(0.0, -0.5)[2] == 1
    assert whole.at(0.0, -0.5)[0] != pytest.approx(whole.at(0.0, 0.5)[0])


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"lobes": ("a", "a")}, "every name once"),
        ({"lobes": ("a", "B")}, "lobe 'B': expected a name"),
        ({"theta_r": np.array([1.0, -1.0])}, "axis theta_r: is 1 -1, expected increasing numbers"),
        ({"theta_r": np.array([-90.0, 90.0])}, "axis theta_r"),
        ({"offset": np.array([-0.5, 0.5, 1.0])}, "axis offset"),
        ({"offset": np.array([0.0, 1.0])}, "share has shape"),
        ({"share": -np.ones((2, 2, 3))}, "a.share is -1.0 at theta_r = -1, offset = 0: expected"),
        ({"share": np.zeros((2, 2, 3))}, "all are 0 at theta_r = -1, offset = 0"),
        ({"turn": np.full((2, 2, 3), np.nan)}, "a.turn is nan"),
        ({"turn": np.full((2, 2, 3), 26.0)}, "a.turn is 26.0"),
    ],
)
def test_wrong_mixtures_are_refused(changes, complaint):
    with pytest.raises(HairlutError) as caught:
        mixture(**changes)
    assert complaint in str(caught.value)


@pytest.fixture(scope="module", params=["printed", "fitted", "brown"])
def model(request, luts):
    return exr.read_model(luts / request.param)


VIEWERS = [(0.3, 0.4, 0.35), (-0.9, -2.0, -0.6), (1.2, 3.0, 0.0)]


@pytest.mark.parametrize("viewer", VIEWERS)
def test_density_integrates_to_one_and_is_that_of_the_draws(model, viewer):
    """Chi-squared over equal cells of (theta_i, phi_i), with the mass of each from the density alone."""
    theta_r, phi_r, offset = viewer
    edges = np.linspace(-np.pi / 2, np.pi / 2, 25), np.linspace(-np.pi, np.pi, 25)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    theta, phi = (((e[:-1, None] + e[1:, None]) / 2 + (e[1] - e[0]) / 2 * nodes).ravel() for e in edges)
    density = model.pdf(theta_r, phi_r, theta[:, None], phi[None, :], offset)
    weight = np.tile(weights, 24)
    scale = (edges[0][1] - edges[0][0]) * (edges[1][1] - edges[1][0]) / 4
    mass = (density * weight[:, None] * weight).reshape(24, 24, 24, 24).sum(axis=(1, 3)) * scale
    assert mass.sum() == pytest.approx(1, abs=2e-3)
    count = 40_000
    drawn = model.sample(theta_r, phi_r, np.random.default_rng(3).random((count, 3)), offset)
    seen = np.histogram2d(drawn[0], drawn[1], edges)[0]

    def probability(expected):
        enough = expected > 8
        rest = max(count - expected[enough].sum(), 1e-9), count - seen[enough].sum()
        chi = ((seen - expected)[enough] ** 2 / expected[enough]).sum()
        chi += (rest[1] - rest[0]) ** 2 / rest[0] if rest[0] > 8 else 0
        return stats.chi2.sf(chi, enough.sum() - 1)

    assert probability(mass / mass.sum() * count) > 1e-4
    assert probability(np.roll(mass, 1, axis=1) * count) < 1e-9  # the density of another azimuth


def test_density_of_a_draw_is_the_density_there(model):
    rng = np.random.default_rng(4)
    theta_r, phi_r, offset = rng.uniform(-1.5, 1.5, 500), rng.uniform(-4, 4, 500), rng.uniform(-1.2, 1.2, 500)
    theta_i, phi_i, density = model.sample(theta_r, phi_r, rng.random((500, 3)), offset)
    assert (density > 0).all()
    assert (phi_i >= -np.pi).all()
    assert (phi_i < np.pi).all()
    np.testing.assert_array_equal(model.pdf(theta_r, phi_r, theta_i, phi_i, offset), density)
    turned = model.pdf(theta_r, phi_r, theta_i, phi_i + 2 * np.pi, offset)
    np.testing.assert_allclose(turned, density, rtol=1e-6)


def test_a_lobe_of_share_0_is_never_drawn(luts):
    baked = exr.read_model(luts / "fitted")
    mixed = replace(baked.mixture, share=np.array([1.0, 0.0])[:, None, None])
    model = replace(baked, mixture=mixed)
    u = np.random.default_rng(5).random((4000, 3))
    u[:2, 0] = 0.0, 1.0
    theta_i, phi_i, _ = model.sample(0.2, 0.1, u)
    middle = u.copy()
    middle[:, 0] = 0.5
    for drawn, expected in zip((theta_i, phi_i), model.sample(0.2, 0.1, middle), strict=False):
        np.testing.assert_array_equal(drawn, expected)
    (first_theta, _, _) = replace(model, mixture=replace(mixed, share=mixed.share[::-1])).sample(0.2, 0.1, u)
    assert (first_theta != theta_i).all()


def test_a_model_of_other_lobes_than_its_mixture_is_refused(luts):
    baked = exr.read_model(luts / "fitted")
    with pytest.raises(HairlutError, match="lobes direct, multiple, but a mixture of multiple, direct"):
        BakedModel("fitted", baked.lobes, constant(("multiple", "direct")))


def test_a_whole_model_is_read_as_it_was_written(luts, tmp_path):
    for name in ("fitted", "brown"):
        baked = exr.read_model(luts / name)
        paths = exr.write_model(tmp_path / name, baked)
        assert paths[-1].name == "mixture.exr"
        again = exr.read_model(tmp_path / name)
        for a, b in zip(baked.tables, again.tables, strict=True):
            np.testing.assert_array_equal(a.texels, b.texels)
            np.testing.assert_array_equal(a.slopes, b.slopes)
        np.testing.assert_array_equal(again.mixture.share, baked.mixture.share)
        np.testing.assert_array_equal(again.mixture.turn, baked.mixture.turn)
        assert again.errors == baked.errors


def test_shares_of_a_model_become_its_mixture(luts):
    tables = {table.name: table for table in exr.read_model(luts / "fitted").tables}
    model = assemble(replace(FITTED, shares=(3.0, 1.0)), tables)
    assert model.mixture.share[:, 0, 0] == pytest.approx([0.75, 0.25])
