# SPDX-License-Identifier: BSD-3-Clause
"""The BSDF of `import hairlut.mitsuba` in llvm_ad_rgb and scalar_rgb draws what the C library draws."""

import math

import numpy as np
import pytest
from engine import vectors
from engine.chisquare import cell_masses, interaction, p_value, sample_angles
from engine.test_images import ONE_SCATTERING, PATH, SIGMAS, batch_means, deviation
from engine.test_plugin import VIEWERS

import hairlut
from hairlut import exr, slopes
from hairlut.mixture import Mixture
from hairlut.model import BakedLobe, BakedModel
from hairlut.table import Table
from hairlut.warp import Warp
from report.hairscene.nearfield import contrasted, light
from report.hairscene.scene import Hair, brown_hair, scene_dict, strand_points, write_strands
from report.hairscene.shares import with_shares

MODELS = ("printed", "fitted", "brown")
CASES = [(model, viewer) for model in MODELS for viewer in VIEWERS]
COUNT, FEWER = 700_000, 30_000
ROWS, COLUMNS = 10, 20
SIGNIFICANCE = 0.01 / len(CASES)
PLACES = 20_000


@pytest.fixture
def scalar(mi):
    """The engine in variant scalar_rgb, in which the BSDF is "hairlut_drjit" beside the C++ plugin."""
    before = mi.variant()
    mi.set_variant("scalar_rgb")
    import hairlut.mitsuba

    hairlut.mitsuba.register("hairlut_drjit")
    yield mi
    mi.set_variant(before)


def make(mi, nested=None, **parameters):
    return mi.load_dict({"type": "hairlut", "nested": nested or brown_hair(), **parameters})


def places(seed):
    """theta_r, phi_r (PLACES,), rad, and the offset that the plugin takes from phi_r."""
    theta_r, phi_r = np.random.default_rng(seed).uniform((-1.57, -np.pi), (1.57, np.pi), (PLACES, 2)).T
    return theta_r, phi_r, np.sin(phi_r)


# ---- agreement with C


@pytest.mark.parametrize("model", MODELS)
def test_directions_are_those_of_the_c_library(llvm, model):
    theta_r, phi_r, offset = places(1)
    u, v = vectors.numbers(llvm, PLACES, 2)
    si = vectors.interactions(llvm, theta_r, phi_r)
    drawn, _ = make(llvm, model=model).sample(llvm.BSDFContext(), si, u, v)
    expected = hairlut.builtin(model).sample(theta_r, phi_r, np.stack([u, *np.array(v)], -1), offset)
    wo = vectors.directions(llvm, expected.theta_i.astype(float), expected.phi_i.astype(float))
    apart = np.linalg.norm(np.array(drawn.wo) - np.array(wo), axis=0)
    # where rounding decides which of two lobes is drawn, or a wide cell stretches it
    assert np.quantile(apart, 0.999) < 2e-5
    assert np.median(apart) < 1e-6


@pytest.mark.parametrize("model", MODELS)
def test_densities_are_those_of_the_c_library(llvm, model):
    theta_r, phi_r, offset = places(3)
    theta_i, phi_i, _ = places(4)
    si, wo = vectors.interactions(llvm, theta_r, phi_r), vectors.directions(llvm, theta_i, phi_i)
    density = np.array(make(llvm, model=model).pdf(llvm.BSDFContext(), si, wo)) * np.cos(theta_i)
    expected = hairlut.builtin(model).pdf(theta_r, phi_r, theta_i, phi_i, offset)
    off = abs(density / expected - 1)
    # a density jumps where a lobe's domain ends, and rounding moves a direction across
    assert np.quantile(off, 0.999) < 1e-3
    assert np.median(off) < 1e-5


def table(name, domain, azimuth, texels):
    """A table of two rows, whose texels (W,) the second row moves by a tenth of the way to the high end."""
    rows = np.stack([texels, texels + 0.1 * (texels[-1] - texels) * (texels > texels[0])]).astype(np.float32)
    warp = Warp("octaves", 1e-3)
    return Table(
        "odd", name, name.rsplit("_")[-1].replace("theta", "theta_i"), azimuth, domain, (-1.2, 1.4), "none",
        warp, rows, slopes.derived(rows, warp.widths(len(texels))).astype(np.float32), np.zeros(2),
    )  # fmt: skip


@pytest.fixture(scope="module")
def odd():
    """What no shipped model has: narrow domains, sums of azimuths, offsets not mirrored, shares of 0."""
    theta = table("a_theta", (-1.0, 0.8), "none", np.array([-1.0, -0.4, -0.1, 0.0, 0.3, 0.8]))
    phi = table("a_phi", (1.0, 2.5), "sum", np.array([1.0, 1.4, 1.6, 1.7, 2.5]))
    other = table("b_phi", (0.0, 2 * np.pi), "difference", np.array([0.0, 2.0, 3.0, 4.0, 2 * np.pi]))
    lobes = BakedLobe("a", theta, phi), BakedLobe("b", theta, other), BakedLobe("c", theta, None)
    share = np.array([[[0.2, 0.0, 3.0]], [[0.8, 1.0, 0.0]], [[0.0, 1.0, 1.0]]])
    turn = np.array([[[3.0, -3.0, 1.0]], [[0.0, 0.5, 20.0]], [[0.0, 0.0, 0.0]]])
    mixture = Mixture(("a", "b", "c"), np.zeros(1), np.array([-0.9, 0.1, 1.0]), share, turn)
    return BakedModel("odd", lobes, mixture)


def test_an_odd_model_is_read_as_its_files_say(llvm, odd, tmp_path):
    exr.write_model(tmp_path, odd)
    bsdf, context = make(llvm, model=str(tmp_path)), llvm.BSDFContext()
    theta_r, phi_r, offset = places(13)
    theta_i, phi_i, _ = places(14)
    si = vectors.interactions(llvm, theta_r, phi_r)
    wo = vectors.directions(llvm, theta_i, phi_i)
    density = np.array(bsdf.pdf(context, si, wo)) * np.cos(theta_i)
    expected = odd.pdf(theta_r, phi_r, theta_i, phi_i, offset)
    assert 0.2 < (expected == 0).mean() < 0.9
    # but for directions that rounding moves across an end of a domain, or into the next cell
    assert np.mean(abs(density - expected) > 1e-4 * expected + 1e-6) < 1e-3
    u, v = vectors.numbers(llvm, PLACES, 15)
    drawn, _ = bsdf.sample(context, si, u, v)
    theta_i, phi_i, _ = odd.sample(theta_r, phi_r, np.stack([u, *np.array(v)], -1), offset)
    apart = np.linalg.norm(np.array(drawn.wo) - np.array(vectors.directions(llvm, theta_i, phi_i)), axis=0)
    assert np.quantile(apart, 0.999) < 2e-5


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("mix", [0.0, 0.3, 1.0])
def test_scalar_agrees_with_the_cpp_plugin(scalar, model, mix):
    nested = {"nested": brown_hair(), "model": model, "mix": mix}
    one, other = (scalar.load_dict({"type": kind, **nested}) for kind in ("hairlut_drjit", "hairlut"))
    assert "HairlutBSDF" in type(one).__name__
    assert type(other) is not type(one)
    context, off = scalar.BSDFContext(), []
    for viewer in VIEWERS:
        si = interaction(scalar, *map(math.radians, viewer))
        for u, v, w in np.random.default_rng(7).random((20, 3)).tolist():
            (drawn, weight), (expected, right) = (
                bsdf.sample(context, si, u, scalar.Point2f(v, w)) for bsdf in (one, other)
            )
            assert np.array(drawn.wo) == pytest.approx(np.array(expected.wo), abs=2e-5)
            assert np.array(weight) == pytest.approx(np.array(right), rel=2e-3)
            off.append(abs(one.pdf(context, si, expected.wo) / other.pdf(context, si, expected.wo) - 1))
    assert max(off) < 2e-3
    assert np.median(off) < 1e-5


# ---- chi-squared


@pytest.fixture(scope="module")
def drawn(llvm):
    """Samples and cell masses of a model at a viewer direction, drawn once for the tests below."""
    cache = {}

    def draw(model, viewer):
        if (model, viewer) not in cache:
            bsdf, context = make(llvm, model=model), llvm.BSDFContext()
            si = vectors.interactions(llvm, *([math.radians(angle)] for angle in viewer))
            masses = vectors.cell_masses(llvm, lambda wo: bsdf.pdf(context, si, wo), ROWS, COLUMNS)
            cache[model, viewer] = vectors.sample_angles(llvm, bsdf, si, COUNT, seed=17), masses
        return cache[model, viewer]

    return draw


@pytest.mark.parametrize(("model", "viewer"), CASES, ids=str)
def test_chi_square_accepts_what_it_draws(llvm, drawn, model, viewer):
    angles, masses = drawn(model, viewer)
    assert masses.sum() == pytest.approx(1.0, abs=1e-3)
    assert p_value(llvm, angles, masses, COUNT) > SIGNIFICANCE


@pytest.mark.parametrize(("model", "viewer"), CASES, ids=str)
def test_chi_square_rejects_a_density_off_by_two_percent(llvm, drawn, model, viewer):
    angles, masses = drawn(model, viewer)
    assert p_value(llvm, angles, 1.02 * masses, COUNT) < SIGNIFICANCE


@pytest.mark.parametrize("viewer", [(30, -45), (-85, 20)], ids=str)
def test_chi_square_accepts_what_it_draws_in_scalar(scalar, viewer):
    """Fewer draws, against the density of the C++ plugin: Python's own numbers are slow."""
    bsdf, plugin = (
        scalar.load_dict({"type": kind, "model": "brown", "nested": brown_hair()})
        for kind in ("hairlut_drjit", "hairlut")
    )
    si, context = interaction(scalar, *map(math.radians, viewer)), scalar.BSDFContext()
    masses = cell_masses(scalar, lambda wo: plugin.pdf(context, si, wo), ROWS, COLUMNS)
    angles = sample_angles(scalar, bsdf, si, FEWER, seed=19)
    assert p_value(scalar, angles, masses, FEWER) > SIGNIFICANCE
    assert p_value(scalar, angles, 1.08 * masses, FEWER) < SIGNIFICANCE


# ---- weights, bias, gradients


@pytest.mark.parametrize("mix", [0.0, 0.5])
def test_weight_is_value_over_density(llvm, mix):
    bsdf, nested, context = (
        make(llvm, model="brown", mix=mix),
        llvm.load_dict(brown_hair()),
        llvm.BSDFContext(),
    )
    theta_r, phi_r, _ = places(5)
    si = vectors.interactions(llvm, theta_r, phi_r)
    drawn, weight = bsdf.sample(context, si, *vectors.numbers(llvm, PLACES, 6))
    value, density = bsdf.eval_pdf(context, si, drawn.wo)
    assert np.array(density) == pytest.approx(np.array(drawn.pdf), rel=1e-4)
    assert np.array(value) == pytest.approx(np.array(nested.eval(context, si, drawn.wo)), rel=1e-5)
    assert np.array(weight) == pytest.approx(np.array(value) / np.array(drawn.pdf), rel=1e-3)


def test_mix_of_one_is_the_nested_sampler_unchanged(llvm):
    bsdf, nested, context = make(llvm, mix=1.0), llvm.load_dict(brown_hair()), llvm.BSDFContext()
    theta_r, phi_r, _ = places(7)
    si = vectors.interactions(llvm, theta_r, phi_r)
    u, v = vectors.numbers(llvm, PLACES, 8)
    (drawn, weight), (expected, right) = (each.sample(context, si, u, v) for each in (bsdf, nested))
    assert np.array_equal(drawn.wo, expected.wo)
    assert np.array_equal(drawn.pdf, expected.pdf)
    assert np.array_equal(weight, right)


@pytest.fixture(scope="module")
def exact(mi):
    """Of test_brown_hair.py, whose quadrature is scalar."""
    before = mi.variant()
    mi.set_variant("scalar_rgb")
    found = light(mi, mi.load_dict(brown_hair()), math.radians(30))
    mi.set_variant(before)
    return found


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("radiance", ["constant", "contrasted"])
def test_draws_estimate_the_light_of_the_quadrature(exact, llvm, model, radiance):
    gamma = np.arcsin(0.998 * (2 * np.random.default_rng(9).random(COUNT) - 1))
    si = vectors.interactions(llvm, np.full(COUNT, math.radians(30)), gamma)
    drawn, weight = make(llvm, model=model).sample(llvm.BSDFContext(), si, *vectors.numbers(llvm, COUNT, 10))
    single = np.array(weight).mean(axis=0).astype(float)
    if radiance == "contrasted":
        single *= contrasted(np.array(drawn.wo).T)
    means, errors = exact
    k = int(radiance == "contrasted")
    error = np.hypot(single.std() / np.sqrt(COUNT), errors[k])
    assert abs(single.mean() - means[k]) < 3.5 * error
    if model == "brown":  # the others are too noisy for so small a bias
        assert abs(1.03 * single.mean() - means[k]) > 3.5 * error


@pytest.mark.parametrize("mix", [0.0, 0.5])
def test_gradients_are_those_of_the_nested_value(llvm, mix):
    """Directions and densities stay as they are, also those of the nested BSDF's own draws."""
    import drjit as dr

    bsdf, context = make(llvm, model="brown", mix=mix), llvm.BSDFContext()
    parameters = llvm.traverse(bsdf)
    theta_r, phi_r, _ = places(11)
    si, u = vectors.interactions(llvm, 0.9 * theta_r, 0.45 * phi_r), vectors.numbers(llvm, PLACES, 12)

    def absorb(absorption):
        parameters["nested.sigma_a.value"] = llvm.Color3f(absorption)
        parameters.update()

    drawn, _ = bsdf.sample(context, si, *u)
    means = []
    for absorption in (0.61, 0.59):
        absorb(absorption)
        means.append(np.mean(np.array(bsdf.eval(context, si, drawn.wo).x) / np.array(drawn.pdf)))
    absorption = llvm.Float(0.6)
    dr.enable_grad(absorption)
    absorb(absorption)
    drawn, weight = bsdf.sample(context, si, *u)
    assert not dr.grad_enabled(drawn.wo)
    assert not dr.grad_enabled(drawn.pdf)
    dr.backward(dr.mean(weight.x))
    assert dr.grad(absorption)[0] == pytest.approx((means[0] - means[1]) / 0.02, rel=1e-2)


# ---- pictures


@pytest.fixture(scope="module")
def strands(tmp_path_factory):
    path = tmp_path_factory.mktemp("hair") / "strands.txt"
    write_strands(strand_points(Hair(strands=1500, locks=12, radius=0.014)), path)
    return path


def scene(mi, strands, bsdf, integrator=ONE_SCATTERING):
    return mi.load_dict({**scene_dict(mi, strands, bsdf, (24, 20)), "integrator": integrator})


@pytest.fixture(scope="module")
def reference(mi, strands):
    """Means of the C++ plugin, uniform over the sphere."""
    before = mi.variant()
    mi.set_variant("scalar_rgb")
    uniform = {"type": "hairlut", "uniform": True, "nested": brown_hair()}
    means = batch_means(mi, scene(mi, strands, uniform), 900, spp=192)
    mi.set_variant(before)
    return means


@pytest.mark.parametrize("parameters", [{"model": "fitted"}, {"model": "brown"}, {"mix": 0.5}], ids=str)
def test_mean_image_is_the_reference(reference, llvm, strands, parameters):
    bsdf = {"type": "hairlut", "nested": brown_hair(), **parameters}
    sigmas, error = deviation(batch_means(llvm, scene(llvm, strands, bsdf), 100, spp=192), reference)
    assert error < 0.02
    assert abs(sigmas) < SIGMAS


def test_mean_image_is_the_reference_in_scalar(reference, scalar, strands):
    bsdf = {"type": "hairlut_drjit", "model": "brown", "nested": brown_hair()}
    means = batch_means(scalar, scene(scalar, strands, bsdf), 700, batches=6, spp=8)
    sigmas, error = deviation(means, reference)
    assert error < 0.02
    assert abs(sigmas) < SIGMAS


def test_no_pixel_is_nan_after_many_scatterings(llvm, strands):
    bsdf = {"type": "hairlut", "model": "brown", "nested": brown_hair()}
    assert np.all(batch_means(llvm, scene(llvm, strands, bsdf, PATH), 500, batches=1, spp=16) > 0.0)


# ---- parameters


def test_a_directory_is_read_where_the_scene_says(llvm, tmp_path):
    lone = make(llvm, model=str(with_shares("fitted", (1, 0), tmp_path)))
    both, context = make(llvm, model="fitted"), llvm.BSDFContext()
    si = vectors.interactions(llvm, [0.3], [0.2])
    wo = vectors.directions(llvm, np.array([-0.3, 0.9]), np.array([3.3, 0.2]))
    one, two = (np.array(bsdf.pdf(context, si, wo)) for bsdf in (lone, both))
    assert one[0] > 1.5 * two[0]
    assert one[1] < 0.1 * two[1]


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"model": "no_such_model"}, "printed, fitted, brown, nor a directory"),
        ({"mix": 1.5}, "mix is 1.5: expected a probability"),
        ({"mix": math.nan}, "mix is nan: expected a probability"),
        ({"nested": {"type": "dielectric"}}, "Dirac"),
        ({"second": {"type": "hair"}}, "expected one nested BSDF.*found 2"),
        ({"direct_weight": 0.5}, "direct_weight.*the model 'fitted' has no parameters"),
    ],
    ids=str,
)
def test_wrong_parameters_are_named(llvm, parameters, message):
    with pytest.raises(RuntimeError, match=message):
        make(llvm, **parameters)
