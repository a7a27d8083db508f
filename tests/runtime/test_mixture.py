"""Both lobes at once: the mixture against the single lobes, and light gathered with all of them.

The lighting integral is that of a renderer: scattering times a radiance that varies over the sphere, in
solid angle. Scattering is the exact mixture of both lobes, so an estimator whose density were not the
one it draws from would be off by more than the noise of ten million samples.
"""

import ctypes

import numpy as np
import pytest
from runtime.c_library import LOBES, Model, core
from runtime.tables import DIFFERENCE, SUM, MemoryTable, create

from hairlut import analytic, lobes
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


def sample_mixture(model: Model, weight, theta_r, phi_r, u_lobe, u_theta, u_phi) -> list[np.ndarray]:
    """[theta_i, phi_i, pdf_angle, pdf_solid_angle] of arrays of one length."""
    inputs = [np.ascontiguousarray(a, np.float32) for a in (weight, theta_r, phi_r, u_lobe, u_theta, u_phi)]
    out = [np.empty_like(inputs[0]) for _ in range(4)]
    n = ctypes.c_size_t(inputs[0].size)
    core().hairlut_sample_mixture_n(model.pointer, n, *pointers(*inputs), Samples(*pointers(*out)))
    return out


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
            samples = sample_mixture(model, filled(CHUNK, WEIGHT), *viewer, *u)
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


WRONG = {
    "the lobe drawn from, not the mixture": lambda model, v, s: (
        pdf_n(model, "direct", *v, s[0], s[1]).astype(float) * s[3] / s[2]
    ),
    "another weight": lambda model, v, s: (
        pdf_n(model, "mixture", 0.61, *v, s[0], s[1]).astype(float) * s[3] / s[2]
    ),
    "azimuth of the other reading": lambda model, v, s: (
        pdf_n(model, "mixture", WEIGHT, v[0], -v[1], s[0], s[1]).astype(float) * s[3] / s[2]
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
        texels[:, 0], texels[:, -1] = domain
        tables.append(MemoryTable(texels, tuple(domain), warp_e=e))
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
    ("weight", "lobe"),
    [(1.0, "direct"), (7.0, "direct"), (0.0, "multiple"), (-1.0, "multiple")],
)
def test_extreme_weights_are_a_single_lobe(model, weight, lobe):
    theta_r, phi_r, u_lobe, u_theta, u_phi = random_inputs(1)
    mixed = sample_mixture(model, filled(u_lobe.size, weight), theta_r, phi_r, u_lobe, u_theta, u_phi)
    alone = sample_lobe(model, lobe, theta_r, phi_r, u_theta, u_phi)
    for a, b in zip(mixed, alone, strict=True):
        assert np.array_equal(a, b)


def test_direction_is_that_of_the_lobe_chosen(model):
    theta_r, phi_r, u_lobe, u_theta, u_phi = random_inputs(2)
    mixed = sample_mixture(model, filled(u_lobe.size, WEIGHT), theta_r, phi_r, u_lobe, u_theta, u_phi)
    direct = sample_lobe(model, "direct", theta_r, phi_r, u_theta, u_phi)
    multiple = sample_lobe(model, "multiple", theta_r, phi_r, u_theta, u_phi)
    chosen = u_lobe < np.float32(WEIGHT)
    for k in range(2):
        assert np.array_equal(mixed[k], np.where(chosen, direct[k], multiple[k]))


def test_density_is_the_weighted_sum_of_both(model):
    """Bit for bit where the density is asked for; to rounding where a direction was drawn."""
    theta_r, phi_r, u_lobe, u_theta, u_phi = random_inputs(3)
    theta_i, phi_i, pdf, _ = sample_mixture(
        model, filled(u_lobe.size, WEIGHT), theta_r, phi_r, u_lobe, u_theta, u_phi
    )
    w = np.float32(WEIGHT)
    parts = [pdf_n(model, lobe, theta_r, phi_r, theta_i, phi_i) for lobe in LOBES]
    asked = pdf_n(model, "mixture", w, theta_r, phi_r, theta_i, phi_i)
    assert np.array_equal(asked, w * parts[0] + (np.float32(1) - w) * parts[1])
    # a drawn angle is rounded once more before its density is asked for: in the narrow cells of a lobe beyond
    # the domain's end that moves the density (test_scalar.py); elsewhere it is the same number
    difference = np.abs(asked.astype(float) - pdf) / pdf
    assert np.quantile(difference, 0.99) < 1e-4
    assert np.median(difference) < 1e-6


def test_density_integrates_to_one(model):
    """Midpoint rule over the sphere's angles; the error of the rule is that of the lobes' curvature."""
    n_theta, n_phi = 4000, 400
    theta = (np.arange(n_theta) + 0.5) / n_theta * np.pi - np.pi / 2
    phi = (np.arange(n_phi) + 0.5) / n_phi * 2 * np.pi - np.pi
    for theta_r, phi_r in VIEWERS:
        pdf = pdf_n(
            model,
            "mixture",
            WEIGHT,
            theta_r,
            phi_r,
            np.repeat(theta, n_phi),
            np.tile(phi, n_theta),
        ).astype(float)
        assert pdf.sum() * np.pi / n_theta * 2 * np.pi / n_phi == pytest.approx(1, abs=2e-3)


@pytest.mark.parametrize("position", range(6))
def test_nan_gives_density_zero(model, position):
    inputs = [filled(8, value) for value in (WEIGHT, 0.3, 0.2, 0.1, 0.4, 0.9)]
    inputs[position][:] = np.nan
    theta_i, phi_i, pdf, solid = sample_mixture(model, *inputs)
    assert not pdf.any()
    assert not solid.any()
    assert np.isfinite(theta_i).all()
    assert np.isfinite(phi_i).all()
