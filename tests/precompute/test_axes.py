# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of a hair: at fixed ones a model is the blend of its textures, in files and in numpy."""

from dataclasses import replace

import numpy as np
import pytest

from hairlut import exr, interpolant
from hairlut.axes import MAX_PARAMETERS, Axis, Parameter, between, corners
from hairlut.errors import HairlutError
from hairlut.mixture import wrap
from precompute.parametric import NODES, PARAMETERS, axes, model, values

COUNT = 40


def places(count: int) -> tuple:
    random = np.random.default_rng(11)
    return random.uniform(-1.6, 1.6, count), random.uniform(-3, 3, count), random.uniform(-1, 1, count)


def test_corners_are_numbered_with_the_first_axis_slowest_and_blend_linearly():
    depends = axes("beta_m", "absorption")
    node, part = corners(depends, {"beta_m": 0.25 + 0.65 * 0.4, "absorption": 0.7 * 0.1})
    assert node.tolist() == [4, 8, 5, 9]  # rows of 4 nodes of absorption: the lower node of both first
    assert part == pytest.approx([0.6 * 0.9, 0.4 * 0.9, 0.6 * 0.1, 0.4 * 0.1])
    for value, place in ((-1.0, (0, 0.0)), (0.0, (0, 0.0)), (9.0, (2, 1.0)), (1.1, (1, 0.5))):
        assert between(NODES["absorption"], value) == pytest.approx(place)


def test_a_model_at_fixed_parameters_is_the_blend_of_its_textures():
    given, each = model(), values(COUNT)
    theta_r, phi_r, offset = places(COUNT)
    u = np.random.default_rng(12).random((COUNT, 3))
    theta_i, phi_i, density = given.sample(theta_r, phi_r, u, offset, each)
    elsewhere = given.pdf(theta_r, phi_r, 0.3, phi_r + 1.0, offset, each)
    for n in range(COUNT):
        fixed = given.at({name: float(value[n]) for name, value in each.items()})
        assert fixed.parameters == fixed.mixture.axes == fixed.lobes[0].theta.axes == ()
        again = fixed.sample(theta_r[n], phi_r[n], u[n], offset[n])
        assert again == pytest.approx((theta_i[n], phi_i[n], density[n]), rel=1e-9)
        assert fixed.pdf(theta_r[n], phi_r[n], 0.3, phi_r[n] + 1.0, offset[n]) == pytest.approx(elsewhere[n])


def test_nodes_are_met_exactly():
    given = model()
    narrow = given.lobes[1].theta  # over absorption, beta_m
    at = narrow.at({"absorption": 1.5, "beta_m": 0.9})
    rows = (2 * 3 + 2) * narrow.height + np.arange(narrow.height)
    np.testing.assert_array_equal(at.texels, narrow.texels[rows])
    np.testing.assert_array_equal(at.slopes, narrow.slopes[rows])
    mixture = given.mixture.parameters_at({"beta_m": 0.25, "absorption": 5.0})
    share = given.mixture.share[:, 1, 3]
    np.testing.assert_allclose(mixture.share, share / share.sum(axis=0), rtol=1e-15)
    np.testing.assert_allclose(wrap(mixture.turn - given.mixture.turn[:, 1, 3]), 0, atol=1e-12)


def test_turns_are_blended_along_the_shorter_arc_from_the_lower_nodes():
    given = model().mixture
    turn = np.zeros_like(given.turn)
    turn[:, 0], turn[:, 1] = 3.0, -3.0
    _, found, _ = replace(given, turn=turn).at(0.1, 0.2, {"beta_m": 0.175, "absorption": 1.0})
    assert wrap(found - np.pi) == pytest.approx([0, 0, 0], abs=1e-12)


def test_missing_values_are_standard_ones():
    given = model()
    standard = {parameter.name: parameter.standard for parameter in PARAMETERS}
    assert given.pdf(0.2, 0.0, 0.1, 1.0) == given.pdf(0.2, 0.0, 0.1, 1.0, parameters=standard)
    assert given.at({}).pdf(0.2, 0.0, 0.1, 1.0) == pytest.approx(given.pdf(0.2, 0.0, 0.1, 1.0))


def test_a_parameter_that_is_no_number_has_density_0():
    given = model()
    theta_i, phi_i, density = given.sample(0.2, 0.0, [[0.3, 0.3, 0.3]] * 2, 0.0, {"tilt": [np.nan, 0.0]})
    assert np.isfinite([theta_i, phi_i]).all()
    assert density[0] == 0 < density[1]


def test_files_carry_parameters(tmp_path):
    given, each = model(), values(COUNT)
    exr.write_model(tmp_path / "parametric", given)
    again = exr.read_model(tmp_path / "parametric")
    assert again.parameters == given.parameters
    for table, other in zip(given.tables, again.tables, strict=True):
        assert [axis.name for axis in table.axes] == [axis.name for axis in other.axes]
        assert table.height == other.height
    theta_r, phi_r, offset = places(COUNT)
    u = np.random.default_rng(12).random((COUNT, 3))
    for ours, theirs in zip(
        given.sample(theta_r, phi_r, u, offset, each),
        again.sample(theta_r, phi_r, u, offset, each),
        strict=True,
    ):
        np.testing.assert_array_equal(ours, theirs)


def test_a_parameter_on_which_nothing_depends_is_written_and_read(tmp_path):
    given = replace(model(), parameters=(Parameter("idle", 1.0, 2.0, 1.25), *PARAMETERS))
    exr.write_model(tmp_path / "parametric", given)
    assert exr.read_model(tmp_path / "parametric").parameters == given.parameters


def test_a_table_needs_values_for_its_axes():
    with pytest.raises(HairlutError, match="parameter tilt: is missing"):
        interpolant.sample(model().lobes[0].theta, 0.1, 0.5)


def test_an_unknown_parameter_is_refused_by_name():
    for call in (
        lambda given: given.at({"beta": 1.0}),
        lambda given: given.pdf(0.0, 0.0, 0.0, 0.0, parameters={"beta": 1.0}),
    ):
        with pytest.raises(HairlutError, match="parameter 'beta': the model has beta_m, absorption, tilt"):
            call(model())
    with pytest.raises(HairlutError, match="the model has no parameters"):
        model().at({}).at({"beta_m": 0.2})


@pytest.mark.parametrize(
    ("name", "numbers", "complaint"),
    [
        ("Beta", (0.0, 1.0, 0.5), "expected a name"),
        ("theta_r", (0.0, 1.0, 0.5), "expected another name than theta_r"),
        ("shares", (0.0, 1.0, 0.5), "expected another name"),
        ("a" * 32, (0.0, 1.0, 0.5), "expected a name of up to 31"),
        ("beta", (1.0, 1.0, 1.0), "is 1 1 1, expected least, most and standard"),
        ("beta", (1.0, 1.0 + 1e-9, 1.0), "expected least, most and standard"),  # one float
        ("beta", (0.0, 1.0, 1.1), "is 0 1 1.1"),
        ("beta", (0.0, np.inf, 1.0), "is 0 inf 1"),
        ("beta", (0.0, 1.0, np.nan), "is 0 1 nan"),
        ("beta", (0.0, 1e31, 1.0), "at most 1e"),
    ],
)
def test_parameters_that_cannot_be_are_refused(name, numbers, complaint):
    with pytest.raises(HairlutError, match=complaint):
        Parameter(name, *numbers)


@pytest.mark.parametrize(
    ("nodes", "complaint"),
    [
        ([0.5], "expected 2 to 64 numbers"),
        (np.linspace(0, 1, 65), "expected 2 to 64 numbers"),
        ([0.0, 0.5, 0.5, 1.0], "is 0 0.5 0.5 1, expected numbers"),
        ([1.0, 0.0], "that increase"),
        ([0.0, np.nan, 1.0], "is 0 nan 1"),
        ([0.0, 1.0, 1.0 + 1e-9], "also as 32-bit floats"),
    ],
)
def test_nodes_that_cannot_be_are_refused(nodes, complaint):
    with pytest.raises(HairlutError, match=complaint):
        Axis("beta", np.asarray(nodes))


def with_table_axes(*depends: Axis):
    given = model()
    wide = replace(given.lobes[2].theta, axes=depends)
    return replace(
        given, lobes=(*given.lobes[:2], replace(given.lobes[2], theta=replace(wide, name="other_theta")))
    )


@pytest.mark.parametrize(
    ("make", "complaint"),
    [
        (lambda: with_table_axes(Axis("other", np.array([0.0, 1.0]))), "axis other: the model has beta_m"),
        (lambda: with_table_axes(Axis("tilt", np.array([0.0, 4.0]))), "axis tilt: runs from 0 to 4"),
        (lambda: with_table_axes(*axes("beta_m", "absorption")), "has 10 rows, expected a multiple of"),
        (lambda: with_table_axes(*axes("tilt", "tilt")), "every name once"),
        (lambda: replace(model(), parameters=PARAMETERS[::-1]), "mixture: axes are beta_m, absorption"),
        (lambda: replace(model(), parameters=PARAMETERS * 2), "every name once"),
        (
            lambda: replace(
                model(), parameters=tuple(Parameter(f"p{k}", 0, 1, 0) for k in range(MAX_PARAMETERS + 1))
            ),
            "9 parameters: expected at most 8",
        ),
        (lambda: replace(model().mixture, axes=axes("absorption", "beta_m")), "share has shape"),
    ],
)  # fmt: skip
def test_models_that_do_not_fit_together_are_refused(make, complaint):
    with pytest.raises(HairlutError, match=complaint):
        make()
