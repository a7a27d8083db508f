# SPDX-License-Identifier: BSD-3-Clause
"""The whole hair: its mixture against the single lobes and against the model read in double precision, light
gathered with all of it, and what shares, turns, offsets and mirroring do.

The lighting integral is that of a renderer: scattering times a radiance that varies over the sphere, in
solid angle. Scattering is the exact mixture of both lobes, so an estimator whose density were not the
one it draws from would be off by more than the noise of ten million samples.
"""

import ctypes
import dataclasses

import numpy as np
import pytest
from runtime.c_library import LOBES, ROOT, Model, builtin, core
from runtime.models import from_baked
from runtime.tables import DIFFERENCE, SUM, MemoryTable, create

from hairlut import analytic, exr, lobes
from hairlut.mixture import Mixture
from hairlut.warp import Warp

N = 10_000_000
CHUNK = 500_000
WEIGHT = 0.6
VIEWERS = [(0.4, 1.1), (-1.2, -2.0)]
SIGMAS = 3.0  # of the estimate's own standard error: 0.3 % of unbiased estimators fail, but the seed is fixed
POINTER = ctypes.POINTER(ctypes.c_float)


def pointers(*arrays):
    return [None if a is None else a.ctypes.data_as(POINTER) for a in arrays]


class Samples(ctypes.Structure):
    _fields_ = [(name, POINTER) for name in ("theta_i", "phi_i", "pdf_angle", "pdf_solid_angle")]


def filled(n: int, value: float) -> np.ndarray:
    return np.full(n, value, np.float32)


def sample_hair_n(model: Model, shares, offset, *inputs) -> list[np.ndarray]:
    """[theta_i, phi_i, pdf_angle, pdf_solid_angle] of theta_r, phi_r, u_lobe, u_theta, u_phi, arrays of one
    length. shares: None, or (lobes, n); offset: None, or an array."""
    theta_r, phi_r, *u = (np.ascontiguousarray(a, np.float32) for a in inputs)
    shares, offset = (None if a is None else np.ascontiguousarray(a, np.float32) for a in (shares, offset))
    out = [np.empty_like(theta_r) for _ in range(4)]
    given = pointers(shares, theta_r, phi_r, offset, *u)
    core().hairlut_sample_hair_n(
        model.pointer, ctypes.c_size_t(theta_r.size), *given, Samples(*pointers(*out))
    )
    return out


def pdf_hair_n(model: Model, shares, offset, *inputs) -> np.ndarray:
    """pdf_angle of theta_r, phi_r, theta_i, phi_i, which broadcast; shares and offset as in sample_hair_n."""
    arrays = [np.ascontiguousarray(a, np.float32) for a in np.broadcast_arrays(*inputs)]
    shares, offset = (None if a is None else np.ascontiguousarray(a, np.float32) for a in (shares, offset))
    out = np.empty_like(arrays[0])
    given = pointers(shares, *arrays[:2], offset, *arrays[2:], out)
    core().hairlut_pdf_hair_n(model.pointer, ctypes.c_size_t(out.size), *given)
    return out


def shares_of(weight: float, n: int) -> np.ndarray:
    """Of the direct lobe and of the other, for n samples, in a unit of their own."""
    return np.repeat(np.float32([[3 * weight], [3 * (1 - weight)]]), n, axis=1)


def sample_lobe(model: Model, lobe: str, theta_r, phi_r, u_theta, u_phi) -> list[np.ndarray]:
    inputs = [np.ascontiguousarray(a, np.float32) for a in (theta_r, phi_r, u_theta, u_phi)]
    out = [np.empty_like(inputs[0]) for _ in range(4)]
    function = getattr(core(), f"hairlut_sample_{lobe}_n")
    function(
        model.pointer,
        ctypes.c_size_t(inputs[0].size),
        *pointers(*inputs),
        Samples(*pointers(*out)),
    )
    return out


def pdf_n(model: Model, name: str, *arrays) -> np.ndarray:
    """hairlut_pdf_NAME_n."""
    inputs = [np.ascontiguousarray(a, np.float32) for a in np.broadcast_arrays(*arrays)]
    out = np.empty_like(inputs[0])
    function = getattr(core(), f"hairlut_pdf_{name}_n")
    function(model.pointer, ctypes.c_size_t(out.size), *pointers(*inputs, out))
    return out


# ---- the scene ----


def radiance(theta, phi) -> np.ndarray:
    """Light from (theta, phi): brightest from one side and one end of the fibre, with a second harmonic."""
    across = np.cos(theta)
    return 1 + 0.7 * across * np.cos(phi - 0.9) + 0.5 * np.sin(theta) + 0.3 * across**2 * np.sin(2 * phi)


def exact_density(name: str, lobe: str, theta_r: float, phi_r: float, theta, phi) -> np.ndarray:
    """The lobe that the tables stand for, per rad^2."""
    model = lobes.MODELS[name]
    if lobe == "multiple":
        return analytic.density(model.multiple_theta, theta_r, theta) / (2 * np.pi)
    relative = (phi + phi_r if model.direct_phi.azimuth == "sum" else phi - phi_r) % (2 * np.pi)
    return analytic.density(model.direct_theta, theta_r, theta) * analytic.density(
        model.direct_phi, theta_r, relative
    )


def scattering(name: str, lobe: str, theta_r: float, phi_r: float, theta, phi) -> np.ndarray:
    """What is gathered, per steradian: BSDF times cosine, in the shape of the lobe or of their mixture."""
    if lobe == "mixture":
        density = WEIGHT * exact_density(name, "direct", theta_r, phi_r, theta, phi) + (
            1 - WEIGHT
        ) * exact_density(name, "multiple", theta_r, phi_r, theta, phi)
    else:
        density = exact_density(name, lobe, theta_r, phi_r, theta, phi)
    return density / np.cos(theta)


def reference(name: str, lobe: str, theta_r: float, phi_r: float) -> float:
    """The integral over the sphere by quadrature in double: Gauss-Legendre in theta and in phi, split where
    the azimuth's period ends."""
    nodes, weights = np.polynomial.legendre.leggauss(24)

    def panels(ends):
        half = 0.5 * np.diff(ends)
        mid = 0.5 * (ends[1:] + ends[:-1])
        return (mid[:, None] + half[:, None] * nodes).ravel(), (half[:, None] * weights).ravel()

    theta, w_theta = panels(np.linspace(-np.pi / 2, np.pi / 2, 41))
    start = -phi_r if lobes.MODELS[name].direct_phi.azimuth == "sum" else phi_r
    phi, w_phi = panels(np.linspace(start, start + 2 * np.pi, 41))
    values = scattering(name, lobe, theta_r, phi_r, theta[:, None], phi) * radiance(theta[:, None], phi)
    return float((w_theta * np.cos(theta)) @ values @ w_phi)


def directions(samples) -> tuple[np.ndarray, np.ndarray]:
    """(theta_i, phi_i) in double; the float next to pi/2 lies above it, outside the exact lobe's domain."""
    return np.clip(samples[0].astype(float), -np.pi / 2, np.pi / 2), samples[1].astype(float)


def estimate(model: Model, lobe: str, theta_r: float, phi_r: float, density, n=N) -> tuple[float, float]:
    """(mean, standard error) of scattering * radiance / density over n samples; density is per steradian."""
    random = np.random.Generator(np.random.SFC64(20250101))
    total = squares = 0.0
    for _ in range(n // CHUNK):
        u = random.random((3, CHUNK), np.float32)
        viewer = filled(CHUNK, theta_r), filled(CHUNK, phi_r)
        if lobe == "mixture":
            samples = sample_hair_n(model, shares_of(WEIGHT, CHUNK), None, *viewer, *u)
        else:
            samples = sample_lobe(model, lobe, *viewer, u[0], u[1])
        theta, phi = directions(samples)
        # the same factor 1/cos(theta) stands in both: taken from the library, so that float's pole cancels
        per_angle = scattering(model.name, lobe, theta_r, phi_r, theta, phi) * np.cos(theta)
        jacobian = samples[3].astype(float) / samples[2]
        value = per_angle * jacobian * radiance(theta, phi) / density(samples)
        total += value.sum()
        squares += (value**2).sum()
    mean = total / n
    return mean, np.sqrt((squares / n - mean**2) / n)


@pytest.mark.parametrize("viewer", VIEWERS, ids=str)
@pytest.mark.parametrize("lobe", [*LOBES, "mixture"])
def test_light_is_gathered_without_bias(model, lobe, viewer):
    mean, error = estimate(model, lobe, *viewer, density=lambda s: s[3].astype(float))
    expected = reference(model.name, lobe, *viewer)
    assert error < 3e-4 * expected
    assert abs(mean - expected) < SIGMAS * error, f"{mean} {expected}: {(mean - expected) / error:.2f} errors"


def mixed_pdf(model: Model, weight: float, *inputs) -> np.ndarray:
    arrays = np.broadcast_arrays(*inputs)
    return pdf_hair_n(model, shares_of(weight, arrays[0].size), None, *arrays)


WRONG = {
    "the lobe drawn from, not the mixture": lambda model, v, s: (
        pdf_n(model, "direct", *v, s[0], s[1]).astype(float) * s[3] / s[2]
    ),
    "another weight": lambda model, v, s: mixed_pdf(model, 0.61, *v, s[0], s[1]).astype(float) * s[3] / s[2],
    "azimuth of the other reading": lambda model, v, s: (
        mixed_pdf(model, WEIGHT, v[0], -v[1], s[0], s[1]).astype(float) * s[3] / s[2]
    ),
    # divided out once more, not left in: that would have no finite variance at the poles to judge it by
    "a cosine divided out twice": lambda model, v, s: s[3].astype(float) ** 2 / s[2],
    "three parts in a thousand": lambda model, v, s: 1.003 * s[3].astype(float),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_a_wrong_density_is_rejected(model, wrong):
    viewer = VIEWERS[0]
    mean, error = estimate(
        model,
        "mixture",
        *viewer,
        density=lambda s: WRONG[wrong](model, np.float32(viewer), s),
    )
    assert abs(mean - reference(model.name, "mixture", *viewer)) > SIGMAS * error


def coarse(name: str) -> Model:
    """Tables of 8x5 texels, far from the lobes between their knots."""
    exact, width, e = lobes.MODELS[name], 8, 2.0**-10
    rows, columns = np.linspace(-np.pi / 2, np.pi / 2, 5), np.arange(width)
    m = Warp("octaves", e).unfold(np.minimum(columns, width - 1 - columns), width)
    tables = []
    for lobe in exact.lobes:
        domain = np.float32(lobe.domain)
        texels = np.float32(analytic.quantile(lobe, rows[:, None], m[None], (columns >= width / 2)[None]))
        slopes = 1 / analytic.density(lobe, rows[:, None], texels.astype(float))
        texels[:, 0], texels[:, -1] = domain
        pairs = np.stack([texels, np.clip(slopes, 1e-9, 1e3)], axis=-1)
        tables.append(MemoryTable(pairs, tuple(domain), warp_e=e))
    made = create(*tables, azimuth=SUM if exact.direct_phi.azimuth == "sum" else DIFFERENCE)
    made.name = name
    return made


def test_coarse_tables_gather_light_without_bias_too(model):
    viewer = VIEWERS[0]
    mean, error = estimate(coarse(model.name), "mixture", *viewer, density=lambda s: s[3].astype(float))
    assert abs(mean - reference(model.name, "mixture", *viewer)) < SIGMAS * error


def test_density_of_the_lobe_instead_of_the_table_is_rejected(model):
    """Drawn from a table, weighted by the formula that was tabulated: the bias that a coarse table shows."""
    viewer = VIEWERS[0]

    def formula(s):
        theta, phi = directions(s)
        return scattering(model.name, "mixture", *viewer, theta, phi) * np.cos(theta) * s[3] / s[2]

    mean, error = estimate(coarse(model.name), "mixture", *viewer, density=formula)
    assert abs(mean - reference(model.name, "mixture", *viewer)) > SIGMAS * error


# ---- against the single lobes ----


def random_inputs(seed: int, n: int = 100_000) -> tuple[np.ndarray, ...]:
    """theta_r, phi_r, u_lobe, u_theta, u_phi"""
    random = np.random.default_rng(seed)
    theta_r = random.uniform(-np.pi / 2, np.pi / 2, n).astype(np.float32)
    phi_r = random.uniform(-np.pi, np.pi, n).astype(np.float32)
    return theta_r, phi_r, *random.random((3, n), np.float32)


@pytest.mark.parametrize(
    ("shares", "lobe"),
    [((1, 0), "direct"), ((7, -1), "direct"), ((0, 1e-44), "multiple"), ((-1, 3e38), "multiple")],
)
def test_a_lobe_that_has_all_shares_is_drawn_alone(model, shares, lobe):
    theta_r, phi_r, u_lobe, u_theta, u_phi = random_inputs(1)
    given = np.repeat(np.float32(shares)[:, None], u_lobe.size, axis=1)
    mixed = sample_hair_n(model, given, None, theta_r, phi_r, u_lobe, u_theta, u_phi)
    alone = sample_lobe(model, lobe, theta_r, phi_r, u_theta, u_phi)
    for a, b in zip(mixed, alone, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-6)  # azimuths are wrapped in another way


def test_direction_is_that_of_the_lobe_chosen(model):
    theta_r, phi_r, u_lobe, u_theta, u_phi = random_inputs(2)
    given = shares_of(WEIGHT, u_lobe.size)
    mixed = sample_hair_n(model, given, None, theta_r, phi_r, u_lobe, u_theta, u_phi)
    direct = sample_lobe(model, "direct", theta_r, phi_r, u_theta, u_phi)
    multiple = sample_lobe(model, "multiple", theta_r, phi_r, u_theta, u_phi)
    chosen = u_lobe * given.sum(axis=0) < given[0]
    assert np.array_equal(mixed[0], np.where(chosen, direct[0], multiple[0]))
    apart = np.abs(mixed[1].astype(float) - np.where(chosen, direct[1], multiple[1]))
    assert np.minimum(apart, 2 * np.pi - apart).max() < 2e-6


def test_density_is_the_weighted_sum_of_both(model):
    """Bit for bit for pdf; to rounding for sample."""
    theta_r, phi_r, u_lobe, u_theta, u_phi = random_inputs(3)
    given = shares_of(WEIGHT, u_lobe.size)
    theta_i, phi_i, pdf, _ = sample_hair_n(model, given, None, theta_r, phi_r, u_lobe, u_theta, u_phi)
    parts = [pdf_n(model, lobe, theta_r, phi_r, theta_i, phi_i) for lobe in LOBES]
    weights = given * (np.float32(1) / (given[0] + given[1]))
    density = pdf_hair_n(model, given, None, theta_r, phi_r, theta_i, phi_i)
    assert np.array_equal(density, weights[0] * parts[0] + weights[1] * parts[1])
    # a drawn angle is rounded once more before its density is evaluated: in the narrow cells of a lobe beyond
    # the domain's end that moves the density (test_scalar.py); elsewhere it is the same number
    difference = np.abs(density.astype(float) - pdf) / pdf
    assert np.quantile(difference, 0.99) < 1e-4
    assert np.median(difference) < 1e-6


def test_a_models_own_shares_are_those_of_its_mixture(model):
    inputs = random_inputs(4)
    own = sample_hair_n(model, None, None, *inputs)
    equal = sample_hair_n(model, shares_of(0.5, inputs[0].size), None, *inputs)
    for a, b in zip(own, equal, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-6)


def sphere_integral(model: Model, theta_r: float, phi_r: float, offset: float, shares=None) -> float:
    """Midpoint rule over the sphere's angles; the error of the rule is that of the lobes' curvature."""
    n_theta, n_phi = 3000, 600
    theta = (np.arange(n_theta) + 0.5) / n_theta * np.pi - np.pi / 2
    phi = (np.arange(n_phi) + 0.5) / n_phi * 2 * np.pi - np.pi
    n = n_theta * n_phi
    given = None if shares is None else np.repeat(np.float32(shares)[:, None], n, axis=1)
    directions = np.repeat(theta, n_phi), np.tile(phi, n_theta)
    pdf = pdf_hair_n(model, given, filled(n, offset), theta_r, phi_r, *directions)
    return float(pdf.sum(dtype=float) * np.pi / n_theta * 2 * np.pi / n_phi)


@pytest.mark.parametrize("viewer", VIEWERS, ids=str)
def test_density_integrates_to_one(model, viewer):
    for shares in (None, (0.6, 0.4), (0.0, 2.0)):
        assert sphere_integral(model, *viewer, 0.0, shares) == pytest.approx(1, abs=2e-3)


@pytest.mark.parametrize("offset", [-2.0, -0.95, -0.2, 0.0, 0.6, 1.0])
def test_density_integrates_to_one_at_every_offset(offset):
    for viewer in VIEWERS:
        for shares in (None, (1, 0, 0, 3)):
            assert sphere_integral(builtin("brown"), *viewer, offset, shares) == pytest.approx(1, abs=3e-3)


# ---- against the model read in double precision ----


def uneven(random: np.random.Generator, count: int, low: float) -> np.ndarray:
    """Nodes from low to 1."""
    steps = np.append(0, np.cumsum(random.uniform(0.5, 1.5, count - 1)))
    return low + (1 - low) * steps / steps[-1] if count > 1 else np.zeros(1)


def random_mixture(names: tuple[str, ...], rows: int, columns: int, mirrored: bool, seed: int) -> Mixture:
    """A fifth of the shares are 0; turns are anywhere."""
    random = np.random.default_rng(seed)
    shape = len(names), rows, columns
    share = np.where(random.random(shape) < 0.2, 0, random.random(shape))
    share[0] += 0.01
    theta_r, offset = uneven(random, rows, -1.5), uneven(random, columns, 0 if mirrored else -1)
    turn = random.uniform(-7, 7, shape)
    return Mixture(names, *(np.float32(a).astype(float) for a in (theta_r, offset, share, turn)), mirrored)


SHAPES = [
    (1, 1, False),
    (1, 1, True),
    (5, 1, False),
    (1, 6, True),
    (7, 9, True),
    (7, 9, False),
    (80, 70, True),
]


@pytest.mark.parametrize(("rows", "columns", "mirrored"), SHAPES)
def test_mixtures_are_read_as_in_double_precision(rows, columns, mirrored):
    baked = exr.read_model(ROOT / "luts" / "brown")
    mixture = random_mixture(baked.mixture.lobes, rows, columns, mirrored, rows + columns)
    baked = dataclasses.replace(baked, mixture=mixture)
    model = from_baked(baked)
    random = np.random.default_rng(5)
    n = 20_000
    theta_r, phi_r = np.float32(random.uniform(-1.55, 1.55, n)), np.float32(random.uniform(-3, 3, n))
    offset, u = np.float32(random.uniform(-1.2, 1.2, n)), random.random((n, 3), np.float32)
    s = model.sample_hair(theta_r, phi_r, *u.T, offset=offset)
    theta_i, phi_i, _ = baked.sample(theta_r, phi_r, u, offset)
    apart = np.abs(s["phi_i"] - phi_i)
    same = (np.abs(s["theta_i"] - theta_i) < 1e-5) & (np.minimum(apart, 2 * np.pi - apart) < 1e-4)
    assert same.mean() > 0.9995  # the rest drew another lobe: u_lobe lies within rounding of a limit
    exact = baked.pdf(theta_r, phi_r, s["theta_i"], s["phi_i"], offset)
    for density in (s["pdf_angle"], model.pdf_hair(theta_r, phi_r, s["theta_i"], s["phi_i"], offset)):
        assert np.quantile(np.abs(density / exact - 1), 0.999) < 1e-3
        assert np.median(np.abs(density / exact - 1)) < 1e-5
    wrong = baked.pdf(theta_r, phi_r, s["theta_i"], s["phi_i"], offset + 0.1)
    assert columns == 1 or np.median(np.abs(s["pdf_angle"] / wrong - 1)) > 1e-3


# ---- signs ----


def relative(s: np.ndarray, phi_r: float) -> np.ndarray:
    """phi_i - phi_r in [-pi, pi)."""
    return (s["phi_i"].astype(float) - phi_r + np.pi) % (2 * np.pi) - np.pi


def test_a_mirrored_hair_hit_at_the_other_side_scatters_to_the_other_side():
    model, phi_r = builtin("brown"), 0.7
    u = np.random.default_rng(6).random((3, 1000), np.float32)
    for offset in (0.1, 0.5, 1.0):
        left, right = (model.sample_hair(0.3, phi_r, *u, offset=h) for h in (-offset, offset))
        assert np.array_equal(left["theta_i"], right["theta_i"])
        np.testing.assert_allclose(left["pdf_angle"], right["pdf_angle"], rtol=2e-4)
        apart = np.abs(relative(left, phi_r) + relative(right, phi_r))
        assert np.minimum(apart, 2 * np.pi - apart).max() < 2e-6
        assert np.abs(relative(left, phi_r) - relative(right, phi_r)).max() > 0.1


def test_turns_follow_the_surfaces_reflection():
    """A narrow lobe about azimuth 0 turned by -2 asin(h), as Chiang's and pbrt's offset has it."""
    nodes = np.linspace(0, 1, 33)
    narrow = np.float32([0, 1e-3, 2 * np.pi - 1e-3, 2 * np.pi])
    row = np.stack([narrow, np.float32([1e-3, 1e-2, 1e-2, 1e-3])], axis=-1)
    phi = MemoryTable(np.tile(row, (2, 1, 1)), (0.0, np.float32(2 * np.pi)), warp=0)
    from runtime.tables import Description, Lobe, straight
    from runtime.tables import Mixture as CMixture

    turn = -2 * np.arcsin(nodes)[None, None, :]
    mixture = CMixture(offset=nodes, turn=turn, mirrored=1)
    model = Description([Lobe("surface", straight(), phi)], mixture).create()
    for offset in (-1.0, -0.9, -0.3, 0.0, 0.4, 0.99):
        s = model.sample_hair(0.1, 2.0, 0.5, 0.5, [0.05, 0.95], offset=offset)
        expected = (-2 * np.arcsin(offset) + np.pi) % (2 * np.pi) - np.pi
        apart = np.abs(relative(s, 2.0) - expected)
        assert np.minimum(apart, 2 * np.pi - apart).max() < 2e-2


# ---- hard inputs ----


@pytest.mark.parametrize("position", range(6))
def test_nan_gives_density_zero(position):
    for name in ("fitted", "brown"):
        inputs = [filled(8, value) for value in (0.3, 0.2, 0.1, 0.4, 0.9)]
        offset = filled(8, 0.5)
        [*inputs, offset][position][:] = np.nan
        theta_i, phi_i, pdf, solid = sample_hair_n(builtin(name), None, offset, *inputs)
        assert not pdf.any()
        assert not solid.any()
        assert np.isfinite(theta_i).all()
        assert np.isfinite(phi_i).all()
        assert not pdf_hair_n(
            builtin(name), None, offset, inputs[0], inputs[1], inputs[2], inputs[3]
        ).any() or (position == 4)


def test_offsets_beyond_the_fibre_are_clamped():
    model = builtin("brown")
    u = np.random.default_rng(7).random((3, 100), np.float32)
    for beyond, end in ((1.5, 1.0), (3e38, 1.0), (np.inf, 1.0), (-1.5, -1.0), (-np.inf, -1.0)):
        far, at = (model.sample_hair(0.3, 0.5, *u, offset=h) for h in (beyond, end))
        assert far.tobytes() == at.tobytes()
        assert np.array_equal(
            model.pdf_hair(0.3, 0.5, u[0], u[1], offset=beyond),
            model.pdf_hair(0.3, 0.5, u[0], u[1], offset=end),
        )


BAD_SHARES = {
    "none": (0, 0),
    "negative": (-1, -2),
    "nan": (np.nan, 1),
    "inf": (1, np.inf),
    "-inf": (-np.inf, 1),
}


@pytest.mark.parametrize("case", BAD_SHARES)
def test_shares_that_are_none_give_density_zero_and_finite_angles(case):
    model = builtin("fitted")
    s = model.sample_hair(0.3, 0.5, [0.0, 0.3, 0.9, 1.0], 0.4, 0.7, shares=BAD_SHARES[case])
    assert not s["pdf_angle"].any()
    assert not s["pdf_solid_angle"].any()
    assert np.isfinite(s["theta_i"]).all()
    assert np.isfinite(s["phi_i"]).all()
    assert model.pdf_hair(0.3, 0.5, 0.1, 2.0, shares=BAD_SHARES[case]) == 0


@pytest.mark.parametrize("unit", [1e-44, 1e-38, 1e-20, 1.0, 1e20, 1e38])
def test_shares_may_have_any_unit(unit):
    model = builtin("fitted")
    u = np.random.default_rng(8).random((3, 1000), np.float32)
    plain, scaled = (model.sample_hair(0.3, 0.5, *u, shares=np.float64([1, 3]) * k) for k in (1, unit))
    same = plain["theta_i"] == scaled["theta_i"]
    assert same.mean() > (0.9 if unit < 1e-40 else 0.999)  # a denormal share has few digits
    np.testing.assert_allclose(
        plain["pdf_angle"][same], scaled["pdf_angle"][same], rtol=0.2 if unit < 1e-40 else 1e-6
    )
    assert (scaled["pdf_angle"] > 0).all()


def test_a_lobe_without_share_is_never_drawn():
    model = builtin("fitted")
    for u_lobe in (0.0, 1.0, -1.0, 2.0, np.float32(1) - np.float32(2**-24)):
        s = model.sample_hair(0.3, 0.5, u_lobe, 0.25, 0.75, shares=(0, 1))
        assert s["theta_i"] == model.sample("multiple", 0.3, 0.5, 0.25, 0.75)["theta_i"]
        s = model.sample_hair(0.3, 0.5, u_lobe, 0.25, 0.75, shares=(1, 0))
        assert s["theta_i"] == model.sample("direct", 0.3, 0.5, 0.25, 0.75)["theta_i"]
