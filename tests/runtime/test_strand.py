# SPDX-License-Identifier: BSD-3-Clause
"""Models over parameters: read as in double precision, and all that holds of any model at every strand."""

import ctypes
import dataclasses

import numpy as np
import pytest
from runtime.c_library import ARGUMENT, OK, TABLE, LoadError, builtin, core
from runtime.models import from_baked
from runtime.strands import PARAMETERS
from runtime.tables import (
    Allocator,
    Description,
    Lobe,
    MemoryTable,
    Mixture,
    Nodes,
    Parameter,
    straight,
    two_lobes,
)
from runtime.test_chi2 import FINE, GRID, joint_counts, p_value

from runtime import strands, tables

SHAPES = {
    "as fitted": {},
    "nothing depends": {"theta": (), "phi": (), "mixture": ()},
    "one table's axis": {"theta": ("beta_m",), "phi": (), "mixture": ()},
    "two axes a table": {"theta": ("beta_m", "absorption"), "phi": ("beta_n", "beta_m")},
    "four axes": {"mixture": ("beta_m", "beta_n", "absorption", "unused"), "lobes": 2},
    "six lobes": {"lobes": 6},
    "no turns": {"turned": False},
}


def viewers(n: int, seed: int = 5) -> tuple[np.ndarray, ...]:
    """theta_r, phi_r, offset, (n, 3) u"""
    random = np.random.default_rng(seed)
    theta_r, phi_r = np.float32(random.uniform(-1.55, 1.55, n)), np.float32(random.uniform(-3, 3, n))
    return theta_r, phi_r, np.float32(random.uniform(-1.2, 1.2, n)), random.random((n, 3), np.float32)


@pytest.mark.parametrize("shape", SHAPES)
def test_strands_are_read_as_in_double_precision(shape):
    baked, model = strands.baked(**SHAPES[shape]), strands.model(**SHAPES[shape])
    n = 5_000
    theta_r, phi_r, offset, u = viewers(n)
    given = strands.strands(n)
    named = {p.name: given[:, k] for k, p in enumerate(PARAMETERS)}
    s = model.sample_strand(given, theta_r, phi_r, *u.T, offset=offset)
    theta_i, phi_i, _ = baked.sample(theta_r, phi_r, u, offset, parameters=named)
    apart = np.abs(s["phi_i"] - phi_i)
    same = (np.abs(s["theta_i"] - theta_i) < 1e-5) & (np.minimum(apart, 2 * np.pi - apart) < 1e-4)
    assert same.mean() > 0.999  # the rest drew another lobe: u_lobe lies within rounding of a limit
    exact = baked.pdf(theta_r, phi_r, s["theta_i"], s["phi_i"], offset, parameters=named)
    pdf = model.pdf_strand(given, theta_r, phi_r, s["theta_i"], s["phi_i"], offset)
    for density in (s["pdf_angle"], pdf):
        assert np.quantile(np.abs(density / exact - 1), 0.999) < 1e-3
        assert np.median(np.abs(density / exact - 1)) < 1e-5
    wrong = {**named, "beta_m": named["beta_m"] + 0.05}
    wrong = baked.pdf(theta_r, phi_r, s["theta_i"], s["phi_i"], offset, parameters=wrong)
    assert shape == "nothing depends" or np.median(np.abs(s["pdf_angle"] / wrong - 1)) > 1e-3


# ---- what a call without parameters reads ----


def test_functions_without_parameters_read_the_standard_values():
    baked, model = strands.baked(), strands.model()
    plain = from_baked(rounded(baked.at({})))
    theta_r, phi_r, offset, u = viewers(5_000)
    one, other = (m.sample_hair(theta_r, phi_r, *u.T, offset=offset) for m in (model, plain))
    same = np.abs(one["theta_i"] - other["theta_i"]) < 1e-5
    assert same.mean() > 0.999
    place = one["theta_i"], one["phi_i"]
    one, other = (m.pdf_hair(theta_r, phi_r, *place, offset=offset) for m in (model, plain))
    assert np.quantile(np.abs(one / other - 1), 0.999) < 1e-3
    for lobe in range(3):
        one, other = (m.pdf(lobe, theta_r, phi_r, *place) for m in (model, plain))
        assert np.quantile(np.abs(one / other - 1), 0.999) < 1e-3
    standard = np.float32([p.standard for p in PARAMETERS])
    named = model.pdf_strand(standard, theta_r, phi_r, *place, offset)
    assert np.quantile(np.abs(named / plain.pdf_hair(theta_r, phi_r, *place, offset) - 1), 0.999) < 1e-3


def rounded(baked):
    """With texels as a file has them."""
    tables = {
        table.name: dataclasses.replace(
            table, texels=np.float32(table.texels), slopes=np.float32(table.slopes)
        )
        for table in baked.tables
    }
    lobes = tuple(
        dataclasses.replace(x, theta=tables[x.theta.name], phi=x.phi and tables[x.phi.name])
        for x in baked.lobes
    )
    return dataclasses.replace(baked, lobes=lobes)


def test_a_standard_value_on_a_node_is_the_nodes_own_table():
    """The blend has a corner of weight 1, and the bits of its texels."""
    baked = strands.baked(theta=("beta_m",), phi=(), mixture=())
    node = float(baked.lobes[0].theta.axes[0].nodes[1])
    parameters = (dataclasses.replace(PARAMETERS[0], standard=node), *PARAMETERS[1:])
    model = from_baked(dataclasses.replace(baked, parameters=parameters))
    plain = from_baked(rounded(dataclasses.replace(baked, parameters=parameters).at({})))
    theta_r, phi_r, offset, u = viewers(2_000)
    one, other = (m.sample_hair(theta_r, phi_r, *u.T, offset=offset) for m in (model, plain))
    assert one.tobytes() == other.tobytes()


def test_no_parameters_are_the_standard_ones():
    model = strands.model()
    theta_r, phi_r, offset, u = viewers(1_000)
    s = model.sample_strand(None, theta_r, phi_r, *u.T, offset=offset)
    assert s.tobytes() == model.sample_hair(theta_r, phi_r, *u.T, offset=offset).tobytes()
    one = model.pdf_strand(None, theta_r, phi_r, s["theta_i"], s["phi_i"], offset)
    assert one.tobytes() == model.pdf_hair(theta_r, phi_r, s["theta_i"], s["phi_i"], offset).tobytes()


def test_a_model_without_parameters_is_what_it_was():
    model = builtin("brown")
    assert model.parameters == []
    theta_r, phi_r, offset, u = viewers(1_000)
    s = model.sample_strand(np.full((1_000, 0), 0.0), theta_r, phi_r, *u.T, offset=offset)
    assert s.tobytes() == model.sample_hair(theta_r, phi_r, *u.T, offset=offset).tobytes()
    arrays = strands.sample_strand_n(model, None, None, offset, theta_r, phi_r, *u.T)
    assert arrays[2].tobytes() == s["pdf_angle"].tobytes()


def test_parameters_have_names_and_ranges():
    model, library = strands.model(), core()
    assert model.parameters == [p.name for p in PARAMETERS]
    for k, p in enumerate(PARAMETERS):
        assert library.hairlut_parameter_index(model.pointer, p.name.encode()) == k
        ends = [ctypes.c_float() for _ in range(3)]
        assert library.hairlut_parameter_range(model.pointer, k, *map(ctypes.byref, ends)) == 1
        assert [end.value for end in ends] == [np.float32(x) for x in (p.least, p.most, p.standard)]
        assert library.hairlut_parameter_range(model.pointer, k, None, None, None) == 1
    for number in (-1, 4, 2**31 - 1):
        assert library.hairlut_parameter_name(model.pointer, number) is None
        assert library.hairlut_parameter_range(model.pointer, number, None, None, None) == 0
    for name in (b"beta", b"Beta_m", b"", None):
        assert library.hairlut_parameter_index(model.pointer, name) == -1
    assert library.hairlut_parameter_count(builtin("fitted").pointer) == 0


# ---- hard inputs ----


@pytest.mark.parametrize("parameter", range(len(PARAMETERS)))
def test_nan_gives_density_zero_and_finite_angles(parameter):
    model, given = strands.model(), strands.strands(200)
    given[:, parameter] = np.nan
    theta_r, phi_r, offset, u = viewers(200)
    s = model.sample_strand(given, theta_r, phi_r, *u.T, offset=offset)
    assert not s["pdf_angle"].any()
    assert not s["pdf_solid_angle"].any()
    assert (np.abs(s["theta_i"]) <= np.float32(np.pi / 2)).all()
    assert (np.abs(s["phi_i"]) <= np.float32(np.pi)).all()
    assert not model.pdf_strand(given, theta_r, phi_r, 0.1, 0.2, offset).any()


def test_values_outside_their_range_are_clamped():
    model, n = strands.model(), 500
    theta_r, phi_r, offset, u = viewers(n)
    for end, beyond in (("least", (-np.inf, -3e38, -2.5)), ("most", (np.inf, 3e38, 7.0))):
        clamped = np.float32([[getattr(p, end) for p in PARAMETERS]])
        expected = model.sample_strand(clamped, theta_r, phi_r, *u.T, offset=offset)
        assert (expected["pdf_angle"] > 0).all()
        for value in beyond:
            s = model.sample_strand(np.full((1, 4), value), theta_r, phi_r, *u.T, offset=offset)
            assert s.tobytes() == expected.tobytes()


@pytest.mark.parametrize("hard", [np.nan, np.inf, -np.inf, 1e30, -3e38, 1.5707964])
def test_other_hard_inputs_give_what_they_give_without_parameters(hard):
    """The angles finite, and the density 0, where hairlut_sample_hair's is."""
    model, given = strands.model(), strands.strands(1, seed=4)
    for k in range(6):
        inputs = np.full((6, 1), 0.3, np.float32)
        inputs[k] = hard
        theta_r, phi_r, offset, *u = inputs
        one = model.sample_strand(given, theta_r, phi_r, *u, offset=offset)
        other = model.sample_hair(theta_r, phi_r, *u, offset=offset)
        assert all(np.isfinite(one[name]).all() for name in one.dtype.names)
        assert (one["pdf_angle"] > 0) == (other["pdf_angle"] > 0)
        one = model.pdf_strand(given, theta_r, phi_r, u[0], u[1], offset)
        other = model.pdf_hair(theta_r, phi_r, u[0], u[1], offset)
        assert np.isfinite(one).all()
        assert (one > 0) == (other > 0)


def test_a_callers_shares_replace_the_models():
    model, n = strands.model(), 2_000
    theta_r, phi_r, offset, u = viewers(n)
    given = strands.strands(n)
    only = model.sample_strand(given, theta_r, phi_r, *u.T, offset=offset, shares=(0.0, 2.0, -1.0))
    pdf = model.pdf_strand(given, theta_r, phi_r, only["theta_i"], only["phi_i"], offset, shares=(0, 7, 0))
    np.testing.assert_allclose(pdf, only["pdf_angle"], rtol=2e-3)
    for shares in ((0, 0, 0), (np.nan, 1, 1), (np.inf, 1, 1)):
        s = model.sample_strand(given, theta_r, phi_r, *u.T, offset=offset, shares=shares)
        assert not s["pdf_angle"].any()
        assert np.isfinite(s["theta_i"]).all()


# ---- densities ----


@pytest.mark.parametrize("shape", SHAPES)
def test_densities_of_samples_are_those_of_their_directions(shape):
    model, n = strands.model(**SHAPES[shape]), 20_000
    theta_r, phi_r, offset, u = viewers(n, seed=8)
    given = strands.strands(n, seed=8)
    s = model.sample_strand(given, theta_r, phi_r, *u.T, offset=offset)
    pdf = model.pdf_strand(given, theta_r, phi_r, s["theta_i"], s["phi_i"], offset)
    assert np.isfinite(s["pdf_solid_angle"]).all()
    assert (s["pdf_angle"] > 0).all()
    error = np.abs(pdf / s["pdf_angle"] - 1)
    assert np.median(error) < 1e-6
    assert np.quantile(error, 0.999) < 2e-3


def sphere(model, strand, theta_r: float, phi_r: float, offset: float, fine=(1500, 400)) -> float:
    """The density's integral over all directions, by the midpoint rule."""
    theta, phi = ((np.arange(n) + 0.5) / n - 0.5 for n in fine)
    pdf = model.pdf_strand(
        strand, theta_r, phi_r, np.repeat(theta * np.pi, fine[1]), np.tile(phi * 2 * np.pi, fine[0]), offset
    )
    return float(pdf.sum(dtype=float) * np.pi / fine[0] * 2 * np.pi / fine[1])


@pytest.mark.parametrize("seed", range(6))
def test_densities_integrate_to_one_at_every_strand(seed):
    strand, random = strands.strands(6, seed=11)[seed], np.random.default_rng(seed)
    theta_r, phi_r, offset = random.uniform(-1.5, 1.5), random.uniform(-3, 3), random.uniform(-1, 1)
    assert sphere(strands.model(), strand, theta_r, phi_r, offset) == pytest.approx(1, abs=3e-3)


CHI2_SAMPLES, CHI2_STRANDS, ALPHA = 200_000, 8, 0.01


def joint_p_value(model, strand, believed, viewer, seed: int) -> float:
    """Chi-squared, on cells of the sphere: samples of a strand against the density of another."""
    u = np.random.default_rng(seed).random((3, CHI2_SAMPLES), np.float32)
    theta_r, phi_r, offset = viewer
    s = model.sample_strand(strand, theta_r, phi_r, *u, offset=offset)
    n = GRID * FINE
    theta, phi = (np.arange(n) + 0.5) / n * np.pi - np.pi / 2, (np.arange(n) + 0.5) / n * 2 * np.pi - np.pi
    pdf = model.pdf_strand(believed, theta_r, phi_r, np.repeat(theta, n), np.tile(phi, n), offset)
    cells = pdf.astype(float).reshape(GRID, FINE, GRID, FINE).sum(axis=(1, 3)).ravel()
    return p_value(joint_counts(s), cells * 2 * np.pi**2 / n**2 * CHI2_SAMPLES)


@pytest.mark.parametrize("number", range(CHI2_STRANDS))
def test_samples_follow_the_density_of_their_strand_and_of_no_other(number):
    """Rejects a correct library with probability ALPHA in all; another roughness is rejected each time."""
    least_p = 1 - (1 - ALPHA) ** (1 / CHI2_STRANDS)
    strand, random = strands.strands(CHI2_STRANDS, seed=21)[number], np.random.default_rng(number)
    viewer = random.uniform(-1.2, 1.2), random.uniform(-3, 3), random.uniform(-0.9, 0.9)
    assert joint_p_value(strands.model(), strand, strand, viewer, number) > least_p
    for parameter, range_of in ((0, 0.55), (1, 0.6)):
        wrong = strand.copy()
        wrong[parameter] += np.float32(0.3 * range_of * (1 if strand[parameter] < 0.35 else -1))
        assert joint_p_value(strands.model(), strand, wrong, viewer, number) < least_p


# ---- arrays ----


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("n", [0, 1, 7, 600])
def test_arrays_are_one_direction_after_the_other(shape, n):
    model = strands.model(**SHAPES[shape])
    theta_r, phi_r, offset, u = viewers(n, seed=3)
    given = strands.strands(n, seed=3)
    shares = np.random.default_rng(1).uniform(-0.1, 1, (n, len(model.lobes))).astype(np.float32)
    for s_of, o_of in ((None, None), (shares, offset)):
        side_by_side = None if s_of is None else s_of.T
        one = model.sample_strand(
            given, theta_r, phi_r, *u.T, offset=0.0 if o_of is None else o_of, shares=s_of
        )
        arrays = strands.sample_strand_n(model, given.T, side_by_side, o_of, theta_r, phi_r, *u.T)
        for array, name in zip(arrays, one.dtype.names, strict=True):
            assert array.tobytes() == one[name].tobytes()
        pdf = model.pdf_strand(
            given, theta_r, phi_r, u[:, 0], u[:, 1], 0.0 if o_of is None else o_of, shares=s_of
        )
        array = strands.pdf_strand_n(model, given.T, side_by_side, o_of, theta_r, phi_r, u[:, 0], u[:, 1])
        assert array.tobytes() == pdf.tobytes()


# ---- descriptors ----


def nodes(parameter: int, *values: float, count: int | None = None) -> Nodes:
    return Nodes(parameter, np.float32(values), count)


def varied(axes, count: int = 3, **changes) -> MemoryTable:
    """A straight table at that many nodes."""
    table = straight()
    texels = np.tile(table.texels, (count, 1, 1, 1))
    return dataclasses.replace(table, texels=texels, axes=axes, **changes)


GOOD = [Parameter("rough", 0.0, 1.0, 0.5), Parameter("dark", -1.0, 3.0, 3.0)]
AXIS = nodes(0, 0.0, 0.25, 1.0)


def refused(lobes, mixture=None, parameters=GOOD, change=None) -> tuple[int, str]:
    """Result and message of hairlut_model_create, which must refuse; nothing stays allocated."""
    description, allocator = Description(lobes, mixture, parameters), Allocator()
    if change:
        change(description)
    with pytest.raises(LoadError) as refusal:
        description.create(allocator)
    assert not allocator.alive
    return refusal.value.result, refusal.value.message


def one(axes, count=3, **changes) -> list[Lobe]:
    return [Lobe("only", varied(axes, count, **changes))]


PARAMETERS_REFUSED = {
    "no name": (Parameter(None, 0, 1, 0), "parameter 1: name is NULL"),
    "capital": (Parameter("Dark", 0, 1, 0), "parameter 1: name is 'Dark': expected [a-z]"),
    "long": (Parameter("a" * 32, 0, 1, 0), "parameter 1: name is 'aaa"),
    "an argument": (Parameter("offset", 0, 1, 0), "parameter 1: name is 'offset', an argument of sample"),
    "twice": (Parameter("rough", 0, 1, 0), "parameters 0 and 1 are both named 'rough'"),
    "no range": (Parameter("dark", 1, 1, 1), "parameter 'dark': least 1, most 1: expected increasing"),
    "reversed": (Parameter("dark", 2, 1, 1), "parameter 'dark': least 2, most 1"),
    "NaN": (Parameter("dark", np.nan, 1, 1), "parameter 'dark': least"),
    "infinite": (Parameter("dark", 0, np.inf, 1), "parameter 'dark': least 0, most inf"),
    "too large": (Parameter("dark", 0, 1.1e30, 1), "from -1e+30 to 1e+30"),
    "denormal": (Parameter("dark", 0, 1e-40, 0), "parameter 'dark': least 0"),
    "standard outside": (Parameter("dark", 0, 1, 1.5), "parameter 'dark': standard 1.5: expected 0 to 1"),
    "standard NaN": (Parameter("dark", 0, 1, np.nan), "parameter 'dark': standard"),
}


@pytest.mark.parametrize("case", PARAMETERS_REFUSED)
def test_unsound_parameters_are_refused_with_name_and_expectation(case):
    parameter, text = PARAMETERS_REFUSED[case]
    result, message = refused(one([AXIS]), None, [GOOD[0], parameter])
    assert result == ARGUMENT
    assert message.startswith(text) or text in message
    assert "expected" in message


AXES_REFUSED = {
    "too many": ([AXIS] * 5, ARGUMENT, "axis_count is 5: expected 0 to 4"),
    "twice": ([AXIS, AXIS], ARGUMENT, "axes 0 and 1 are both of parameter 0: expected one axis of each"),
    "no parameter": ([nodes(-1, 0, 1)], ARGUMENT, "axis 0: parameter is -1: expected 0 to 7"),
    "beyond any": ([nodes(8, 0, 1)], ARGUMENT, "axis 0: parameter is 8: expected 0 to 7"),
    "one node": ([nodes(0, 0)], ARGUMENT, "axis 0 (parameter 0): count is 1: expected 2 to 64 nodes"),
    "65 nodes": ([nodes(0, *np.linspace(0, 1, 65))], ARGUMENT, "count is 65: expected 2 to 64"),
    "no values": ([Nodes(0, None, 3)], ARGUMENT, "axis 0 (parameter 0): values is NULL: expected 3 numbers"),
    "equal": ([nodes(0, 0, 0.5, 0.5, 1)], TABLE, "axis 0 (parameter 0), node 2 is 0.5: expected increasing"),
    "NaN": ([nodes(0, 0, np.nan, 1)], TABLE, "axis 0 (parameter 0), node 1 is nan"),
    "infinite": ([nodes(0, 0, np.inf)], TABLE, "axis 0 (parameter 0), node 1 is inf"),
}
MATCHES_REFUSED = {
    "not the model's": ([nodes(2, 0, 1)], ARGUMENT, "axis 0: parameter is 2: expected one of the model's 2"),
    "least": ([nodes(0, 0.1, 1)], TABLE, "axis 'rough', node 0 is 0.100000001: expected 0, its least"),
    "most": ([nodes(1, -1, 2, 2.5)], TABLE, "axis 'dark', node 2 is 2.5: expected 3, its most"),
}


@pytest.mark.parametrize("case", AXES_REFUSED | MATCHES_REFUSED)
def test_unsound_axes_are_refused_by_tables_and_mixture(case):
    axes, expected, text = (AXES_REFUSED | MATCHES_REFUSED)[case]
    table = varied(axes, 70)
    assert tables.validate(table)[0] == (OK if case in MATCHES_REFUSED else expected)
    for lobes, mixture, owner in (
        ([Lobe("only", table)], None, "only_theta: "),
        ([Lobe("only", straight())], Mixture(axes=axes), "mixture: "),
    ):
        result, message = refused(lobes, mixture)
        assert result == expected
        assert message.startswith(owner)
        assert text in message


def test_a_wrong_texel_is_named_by_node_and_row():
    table = varied([AXIS])
    table.texels[2, 1, 3, 0] = np.nan
    message = refused([Lobe("only", table)])[1]
    assert message.startswith("only_theta: node 2 of the axes, row 1, columns 2 and 3: ")
    share, turn = np.ones((1, 3, 2, 2)), np.zeros((1, 3, 2, 2))
    share[0, 2, 1, 0] = -1
    grid = {"theta_r": [0.0, 1.0], "offset": [0.0, 1.0], "axes": [AXIS]}
    message = refused([Lobe("only", straight())], Mixture(share=share, turn=turn, **grid))[1]
    assert "lobe 0 at node 2 of the axes, theta_r node 1, offset node 0 is -1: expected" in message


def test_more_rows_or_nodes_than_any_model_has_are_refused():
    many = [nodes(p, *np.linspace(0, 1, 64)) for p in range(4)]
    parameters = [Parameter(name, 0.0, 1.0, 0.5) for name in "abcd"]
    message = refused(one(many), None, parameters)[1]
    assert message == (
        "only_theta: 16777216 nodes of the axes, of 3 rows each: expected at most 65536 rows in all"
    )
    message = refused([Lobe("only", straight())], Mixture(axes=many), parameters)[1]
    assert message.startswith("mixture: 16777216 nodes of the axes x 1 x 1: expected at most 262144 in all")


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda d: setattr(d.c, "parameter_count", 9), "parameter_count is 9: expected 0 to 8"),
        (lambda d: setattr(d.c, "parameter_count", -1), "parameter_count is -1: expected 0 to 8"),
        (lambda d: setattr(d.c, "parameters", None), "parameters is NULL: expected 2 descriptors"),
        (lambda d: setattr(d.parameters[0], "size", 8), "size of a hairlut_parameter is 8: expected sizeof"),
        (lambda d: setattr(d.parameters[1], "size", 8), "size of a hairlut_parameter is 8: expected sizeof"),
        (lambda d: setattr(first_table(d), "axes", None), "only_theta: axes is NULL: expected 1 descriptors"),
        (lambda d: setattr(first_table(d).axes[0], "size", 8), "size of a hairlut_parameter_nodes is 8"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_unsound_counts_pointers_and_sizes_are_refused(change, text):
    assert text in refused(one([AXIS]), None, GOOD, change)[1]


def first_table(description: Description):
    return next(iter(description.tables.values()))


def test_descriptors_of_2_0_are_accepted_and_have_no_parameters():
    """Their sizes on this machine; what stands behind them, or in their padding, is not read."""
    lobes = two_lobes()
    new = Description(lobes, Mixture()).create()
    old = Description(lobes, Mixture(), GOOD)
    sizes = (old.c, 32, "parameter_count"), (old.mixture, 56, "axis_count")
    for struct, size, name in (*sizes, *((table, 48, "axis_count") for table in old.tables.values())):
        struct.size = size
        setattr(struct, name, -12345)
    model = old.create()
    assert model.parameters == []
    theta_r, phi_r, offset, u = viewers(200)
    one, other = (m.sample_hair(theta_r, phi_r, *u.T, offset=offset) for m in (new, model))
    assert one.tobytes() == other.tobytes()


def test_a_model_over_parameters_is_one_block_of_memory():
    allocator = Allocator()
    model = Description(one([AXIS]), Mixture(axes=[nodes(1, -1, 3)]), GOOD).create(allocator)
    assert allocator.calls == 1
    assert model.pdf_strand([[0.3, 1.0]], 0.1, 0.2, 0.3, 0.4) > 0
    core().hairlut_free(model.pointer)
    model.owned = False
    assert not allocator.alive
