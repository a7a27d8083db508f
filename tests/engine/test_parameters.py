# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the hair in both BSDFs: from the scene, from a texture, and by strand."""

import math
from pathlib import Path

import numpy as np
import pytest
from engine import chisquare, vectors
from shaders.models import strands as model

import hairlut
from hairlut import exr

COUNT, FEWER = 700_000, 300_000
ROWS, COLUMNS = 10, 20
VIEWER = math.radians(30), math.radians(-45)
SETS = {
    "smooth": {"beta_m": 0.5, "beta_n": 0.7, "absorption": 1.5, "tilt": 0.25, "weight": -1.2},
    "between nodes": {"beta_m": 0.3, "beta_n": 0.33, "absorption": 20.0, "tilt": -0.1, "weight": -2.7},
}
SIGNIFICANCE = 0.01 / len(SETS)
STRANDS = 400


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    folder = tmp_path_factory.mktemp("groom")
    exr.write_model(folder, model())
    return folder


@pytest.fixture(scope="module")
def drawn_by_hand(directory):
    return hairlut.load(directory)


@pytest.fixture
def plugin(mi):
    """The engine in variant scalar_rgb, where "hairlut" is the C++ plugin."""
    yield from in_variant(mi, "scalar_rgb")


@pytest.fixture
def arrays(llvm):
    """The engine in variant llvm_ad_rgb, where "hairlut" is Dr.Jit's."""
    yield from in_variant(llvm, "llvm_ad_rgb")


def in_variant(mi, variant):
    before = mi.variant()
    mi.set_variant(variant)
    yield mi
    mi.set_variant(before)


def make(mi, directory, kind="hairlut", **parameters):
    return mi.load_dict({"type": kind, "model": str(directory), "nested": {"type": "hair"}, **parameters})


# ---- the density is that of the draws


@pytest.mark.parametrize("name", SETS)
def test_chi_square_accepts_the_plugin(plugin, directory, name):
    bsdf, si, context = (
        make(plugin, directory, **SETS[name]),
        chisquare.interaction(plugin, *VIEWER),
        plugin.BSDFContext(),
    )
    masses = chisquare.cell_masses(plugin, lambda wo: bsdf.pdf(context, si, wo), ROWS, COLUMNS)
    angles = chisquare.sample_angles(plugin, bsdf, si, FEWER, seed=21)
    assert masses.sum() == pytest.approx(1.0, abs=2e-3)
    assert chisquare.p_value(plugin, angles, masses, FEWER) > SIGNIFICANCE


@pytest.mark.parametrize("name", SETS)
def test_chi_square_rejects_another_parameter_of_the_plugin(plugin, directory, name):
    bsdf, other = (
        make(plugin, directory, **SETS[name] | {"beta_m": SETS[name]["beta_m"] * by}) for by in (1, 1.1)
    )
    si, context = chisquare.interaction(plugin, *VIEWER), plugin.BSDFContext()
    masses = chisquare.cell_masses(plugin, lambda wo: other.pdf(context, si, wo), ROWS, COLUMNS)
    angles = chisquare.sample_angles(plugin, bsdf, si, FEWER, seed=21)
    assert chisquare.p_value(plugin, angles, masses, FEWER) < SIGNIFICANCE


@pytest.mark.parametrize("name", SETS)
def test_chi_square_accepts_drjit_and_rejects_another_parameter(arrays, directory, name):
    bsdf, other = (
        make(arrays, directory, **SETS[name] | {"beta_n": SETS[name]["beta_n"] * by}) for by in (1, 1.1)
    )
    si, context = vectors.interactions(arrays, *([angle] for angle in VIEWER)), arrays.BSDFContext()
    angles = vectors.sample_angles(arrays, bsdf, si, COUNT, seed=22)
    p_values = [
        chisquare.p_value(
            arrays,
            angles,
            vectors.cell_masses(arrays, lambda wo, one=one: one.pdf(context, si, wo), ROWS, COLUMNS),
            COUNT,
        )
        for one in (bsdf, other)
    ]
    assert p_values[0] > SIGNIFICANCE
    assert p_values[1] < SIGNIFICANCE


# ---- agreement on random parameters, strand by strand


@pytest.fixture(scope="module")
def lock(tmp_path_factory):
    """(texture of each parameter, its values (STRANDS,)): strands of one segment each."""
    folder, random = tmp_path_factory.mktemp("lock"), np.random.default_rng(9)
    curves = folder / "curves.txt"
    curves.write_text(
        "\n\n".join("\n".join(f"{k} {y} 0 0.1" for y in range(4)) for k in range(STRANDS)) + "\n"
    )
    textures, values = {}, {}
    for each in model().parameters:
        file = folder / f"{each.name}.txt"
        margin = 0.1 * (each.most - each.least)
        values[each.name] = np.float32(random.uniform(each.least - margin, each.most + margin, STRANDS))
        file.write_text("".join(f"{value!r}\n" for value in values[each.name].tolist()))
        textures[each.name] = {"type": "hair_strands", "curves": str(curves), "values": str(file)}
    return textures, values


def test_drjit_draws_with_a_strands_parameters_what_c_draws(arrays, directory, drawn_by_hand, lock):
    textures, values = lock
    theta_r, phi_r = np.random.default_rng(3).uniform((-1.57, -np.pi), (1.57, np.pi), (STRANDS, 2)).T
    u, v = vectors.numbers(arrays, STRANDS, 4)
    si = vectors.interactions(arrays, theta_r, phi_r)
    si.prim_index = arrays.UInt32(np.arange(STRANDS))
    bsdf = make(arrays, directory, **textures)
    sample, _ = bsdf.sample(arrays.BSDFContext(), si, u, v)
    numbers = np.stack([u, *np.array(v)], -1)
    c = drawn_by_hand.sample(theta_r, phi_r, numbers, np.sin(phi_r), **values)
    wo = np.array(vectors.directions(arrays, c.theta_i.astype(float), c.phi_i.astype(float)))
    apart = np.linalg.norm(np.array(sample.wo) - wo, axis=0)
    assert np.quantile(apart, 0.99) < 2e-5  # rounding may choose another lobe
    density = bsdf.pdf(arrays.BSDFContext(), si, arrays.Vector3f(wo))
    same = np.abs(np.array(density) / c.pdf_solid_angle - 1)
    assert np.quantile(same, 0.98) < 1e-3
    other = drawn_by_hand.sample(theta_r, phi_r, numbers, np.sin(phi_r))
    assert np.median(np.abs(other.theta_i - c.theta_i)) > 1e-3


def test_the_plugin_draws_with_a_strands_parameters_what_c_draws(plugin, directory, drawn_by_hand, lock):
    import hairlut.mitsuba  # noqa: F401  the texture

    textures, values = lock
    bsdf, context, random = (
        make(plugin, directory, **textures),
        plugin.BSDFContext(),
        np.random.default_rng(5),
    )
    for k in range(0, STRANDS, 2):
        theta_r, phi_r, u, v, w = random.uniform((-1.5, -3, 0, 0, 0), (1.5, 3, 1, 1, 1)).tolist()
        si = chisquare.interaction(plugin, theta_r, phi_r)
        si.prim_index = k
        sample, _ = bsdf.sample(context, si, u, plugin.Point2f(v, w))
        at = {name: value[k] for name, value in values.items()}
        c = drawn_by_hand.sample(theta_r, phi_r, np.array([u, v, w]), math.sin(phi_r), **at)
        wo = chisquare.direction(plugin, float(c.theta_i), float(c.phi_i))
        assert np.linalg.norm(np.array(sample.wo) - np.array(wo)) < 2e-5
        assert sample.pdf == pytest.approx(float(c.pdf_solid_angle), rel=1e-3)


@pytest.mark.parametrize("variant", ["plugin", "arrays"])
def test_without_parameters_the_standard_values_count(request, directory, drawn_by_hand, variant):
    mi = request.getfixturevalue(variant)
    bsdf, context = make(mi, directory), mi.BSDFContext()
    given = make(mi, directory, **{each.name: each.standard for each in model().parameters})
    si = chisquare.interaction(mi, 0.3, 0.4)
    wo = chisquare.direction(mi, -0.2, 2.0)
    expected = drawn_by_hand.pdf(0.3, 0.4, -0.2, 2.0, math.sin(0.4)) / math.cos(-0.2)
    for one in (bsdf, given):
        assert np.ravel(one.pdf(context, si, wo))[0] == pytest.approx(float(expected), rel=1e-3)


@pytest.mark.parametrize("variant", ["plugin", "arrays"])
@pytest.mark.parametrize("unknown", [0.3, {"type": "checkerboard"}], ids=["number", "texture"])
def test_an_unknown_parameter_is_refused_by_name(request, directory, variant, unknown):
    mi = request.getfixturevalue(variant)
    with pytest.raises(RuntimeError, match=r"(?s)beta_q.*has beta_m, beta_n, absorption"):
        make(mi, directory, beta_q=unknown)
    with pytest.raises(RuntimeError, match=r"(?s)beta_m.*fitted.*has no parameters"):
        make(mi, "fitted", beta_m=unknown)


def test_nan_has_no_density(arrays, directory):
    from hairlut.mitsuba.sampler import Sampler

    sampler, place = Sampler(model()), [arrays.Float(0.3, 0.4)] * 5
    values = [arrays.Float(each.standard) for each in model().parameters]
    assert (np.array(sampler.pdf(*place, values)) > 0).all()
    values[4] = arrays.Float(np.nan, 7.0)
    density = np.array(sampler.pdf(*place, values))
    assert density[0] == 0 < density[1]
    assert np.isfinite(np.array(sampler.sample(*place, arrays.Float(0.5), values))).all()


# ---- the texture of strands

SHORT = "0 0 0 1\n0 1 0 1\n0 2 0 1\n0 3 0 1\n\n1 0 0 1\n1 1 0 1\n1 2 0 1\n1 3 0 1\n"


@pytest.mark.parametrize(
    ("curves", "values", "parameters", "message"),
    [
        (SHORT, "0.3\n", {}, "has 1 numbers, expected one for each of the 2 strands"),
        (SHORT, "0.3\nfine\n", {}, "line 2: 'fine' is no number"),
        ("0 0 0 1\n0 1 0 1\n", "0.3\n", {}, "strand 1 has 2 points"),
        (SHORT, "0.3\n0.4\n", {"shape": "cylinder"}, "'cylinder': expected bsplinecurve or linearcurve"),
        (SHORT, None, {}, "values is .*expected a file"),
    ],
)
def test_wrong_strands_are_named(arrays, tmp_path: Path, curves, values, parameters, message):
    files = {"curves": tmp_path / "curves.txt", "values": tmp_path / "values.txt"}
    for file, text in zip(files.values(), (curves, values), strict=True):
        if text is not None:
            file.write_text(text)
    with pytest.raises(RuntimeError, match=message):
        arrays.load_dict(
            {"type": "hair_strands", **{name: str(file) for name, file in files.items()}, **parameters}
        )
