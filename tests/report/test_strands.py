# SPDX-License-Identifier: BSD-3-Clause
"""The lock whose strands all differ: no way to draw directions changes its mean, and a wrong density does."""

import numpy as np
import pytest
from shaders.models import HALF_PI, NODES, OCTAVES, PARAMETERS, SPREAD, Sheet, logistic, phi, varying

from hairlut import exr
from hairlut.axes import Axis
from hairlut.mixture import Mixture
from hairlut.model import BakedLobe, BakedModel
from hairlut.table import Table
from report.engine import lack_of_llvm
from report.hairscene.perception import colour_difference

LIGHT = "even sky"
SIZE, BATCHES, LOCK = (24, 32), 16, 500
MIX = 0.5  # half of the draws from the authors' sampler: no weight is above 2, and means are nearly normal


def groom() -> BakedModel:
    """Two lobes, roughly those of hair: light spreads along the fibre with beta_m, around it with beta_n, and
    its even part depends on the absorption."""

    def along(name: str, wider: float) -> Table:
        def sheet(scale: float, _: float) -> Sheet:
            beta = (scale - 0.02) / SPREAD["beta_m"]
            spread = wider * (0.726 * beta + 0.812 * beta**2)
            return logistic(30, 16, OCTAVES, (-HALF_PI, HALF_PI), lambda theta_r: -theta_r, 0.7 * spread)

        return varying(name, ("beta_m",), sheet)

    around = varying("far_phi", ("beta_n",), lambda scale, _: phi(24, 4, OCTAVES, "difference", 4 * scale))
    share = np.array([[1.0, 0.5, 0.1], [1.0, 1.0, 1.0]])[:, :, None, None]
    axis = Axis("absorption", np.array(NODES["absorption"]))
    mixture = Mixture(("far", "even"), np.zeros(1), np.zeros(1), share, np.zeros_like(share), False, (axis,))
    lobes = BakedLobe("far", along("far_theta", 1), around), BakedLobe("even", along("even_theta", 2), None)
    return BakedModel("strands", lobes, mixture, {}, PARAMETERS[:3])


@pytest.fixture(scope="module")
def strands(tmp_path_factory):
    """(report.strands, directory of the model) in variant llvm_ad_rgb, which is the former one afterwards."""
    if lack := lack_of_llvm():
        pytest.skip(lack)
    import mitsuba as mi

    from report import strands

    before = mi.variant()
    strands.start_engine()
    directory = tmp_path_factory.mktemp("groom")
    exr.write_model(directory, groom())
    yield strands, directory
    mi.set_variant(before or "scalar_rgb")


def render(strands):
    module, directory = strands
    return module.render_all(directory, LOCK, SIZE, BATCHES, MIX, [LIGHT])[LIGHT]


@pytest.fixture(scope="module")
def rendered(strands):
    return render(strands)


def test_noise_is_seen_as_a_difference_of_colour(strands, rendered):
    """Lightness alone, as the hair has one channel; uniform directions make the noisiest picture."""
    module, _ = strands
    seen = module.differences(rendered)
    assert 0 < seen[module.REFERENCE] < seen[module.SPHERE]
    assert 0 < seen[module.ONE_MODEL] < seen[module.SPHERE]
    assert colour_difference(rendered[module.SPHERE].image, rendered[module.SPHERE].image, 1.0).max() == 0


def test_all_pictures_have_one_mean(strands, rendered):
    """With the probability ALPHA one would be off by chance; seeds are fixed."""
    module, _ = strands
    off = module.deviations(rendered)
    assert len(off) == 4
    assert max(map(abs, off.values())) < module.limit(len(off)), off
    assert max(one.error for kind, one in rendered.items() if kind != module.SPHERE) < 0.02


def test_a_density_at_other_parameters_is_seen(strands, rendered, monkeypatch):
    """Directions drawn at the strand's parameters, with the density of rougher hair."""
    from hairlut.mitsuba.sampler import Sampler

    module, _ = strands
    pdf = Sampler.pdf

    def wrong(self, *arguments):
        *place, values = arguments
        return pdf(self, *place, [1.6 * value for value in values])

    monkeypatch.setattr(Sampler, "pdf", wrong)
    monkeypatch.setattr(module, "shapes", lambda *given: only(module, *given))
    off = module.deviations(rendered | render(strands))
    assert abs(off[module.ONE_MODEL]) > module.limit(len(off)), off


def only(module, strands, directory, folder, mix):
    names = [each.name for each in groom().parameters]
    curves = module.shape(
        strands, folder, "one", {"type": "hairlut", "model": str(directory), "mix": mix}, names
    )
    return {module.ONE_MODEL: [curves]}


def test_each_strand_has_a_group_of_similar_ones(strands, tmp_path):
    module, _ = strands
    lock = module.lock(tmp_path, LOCK)
    groups = module.groups(lock)
    assert sorted(np.concatenate(groups).tolist()) == list(range(LOCK))
    assert min(map(len, groups)) > LOCK / 25
    logs = np.log(np.column_stack(list(lock.values.values())))
    within = np.mean([logs[group].var(axis=0) for group in groups], axis=0)
    assert (within < 0.6 * logs.var(axis=0)).all()


@pytest.mark.parametrize("parameters", [(0.3, 0.3, 0.6), (0.15, 0.5, 3.0)])
def test_values_are_those_of_the_example(strands, parameters):
    import sys

    import mitsuba as mi
    from engine import vectors

    from report.places import ROOT

    sys.path.insert(0, str(ROOT / "precompute" / "examples"))
    import chiang_parameters

    given = dict(zip(("beta_m", "beta_n", "absorption"), parameters, strict=True))
    bsdf = mi.load_dict({"type": "chiang", **given})
    random = np.random.default_rng(4).uniform((-1.4, -1.5, -1.4, -3.1), (1.4, 1.5, 1.4, 3.1), (5000, 4))
    theta_r, phi_r, theta_i, phi_i = random.T
    si, wo = vectors.interactions(mi, theta_r, phi_r), vectors.directions(mi, theta_i, phi_i)
    got = np.array(bsdf.eval(mi.BSDFContext(), si, wo))[0]
    want = chiang_parameters.bsdf(theta_r, theta_i, phi_i - phi_r, np.sin(phi_r), **given) * np.cos(theta_i)
    assert got == pytest.approx(want, rel=2e-2, abs=1e-5)
    assert np.quantile(abs(got / want - 1), 0.99) < 1e-3


def test_the_authors_sampler_draws_what_its_density_says(strands):
    import mitsuba as mi
    from engine import chisquare, vectors

    bsdf = mi.load_dict({"type": "chiang", "beta_m": 0.3, "beta_n": 0.4, "absorption": 0.6})
    si, context = vectors.interactions(mi, [0.5], [0.7]), mi.BSDFContext()
    angles = vectors.sample_angles(mi, bsdf, si, 700_000, seed=1)
    masses = vectors.cell_masses(mi, lambda wo: bsdf.pdf(context, si, wo), 10, 20)
    assert chisquare.p_value(mi, angles, masses, 700_000) > 0.01
    assert chisquare.p_value(mi, angles, 1.02 * masses, 700_000) < 0.01
