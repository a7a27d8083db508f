"""A mixture of any lobes of any models: its density, its choice of a lobe, and weights that are none."""

import ctypes

import numpy as np
import pytest
from runtime.c_library import SAMPLE, Model, builtin, loops
from runtime.test_chi2 import SAMPLES, joint_counts, joint_expected, p_value

DIRECT, MULTIPLE = 0, 1
LOBES = {DIRECT: "direct", MULTIPLE: "multiple"}
VIEWERS = [(0.4, 1.1), (-1.2, -2.0), (0.0, 3.0)]
ALPHA = 0.01
LEAST_P = 1 - (1 - ALPHA) ** (1 / len(VIEWERS))


class Component(ctypes.Structure):
    _fields_ = [
        ("model", ctypes.c_void_p),
        ("lobe", ctypes.c_int),
        ("weight", ctypes.c_float),
        ("turn", ctypes.c_float),
    ]


class Components:
    """An array of hairlut_component; calls take scalars or arrays that broadcast."""

    def __init__(self, *parts: tuple[Model | None, int, float, float], count: int | None = None) -> None:
        self.parts = parts
        given = [(model and model.pointer.value, *numbers) for model, *numbers in parts]
        self.array = (Component * max(len(parts), 1))(*given)
        self.count = len(parts) if count is None else count

    def sample(self, *inputs) -> np.ndarray:
        """Records of SAMPLE for theta_r, phi_r, u_lobe, u_theta, u_phi."""
        return self._loop("loop_sample_components", SAMPLE, inputs)

    def pdf(self, lobe, *inputs) -> np.ndarray:
        """Densities per rad^2; takes and ignores the lobe that Model.pdf is asked for."""
        return self._loop("loop_pdf_components", np.float32, inputs)

    def _loop(self, function: str, kind, inputs) -> np.ndarray:
        arrays = np.broadcast_arrays(*(np.asarray(a, np.float32) for a in inputs))
        arrays = [np.array(np.atleast_1d(a), np.float32, order="C") for a in arrays]
        out = np.empty(arrays[0].shape, kind)
        pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (*arrays, out)]
        getattr(loops(), function)(self.array, self.count, ctypes.c_size_t(out.size), *pointers)
        return out


@pytest.fixture(scope="module")
def four() -> Components:
    """Four lobes of two models, one of weight 0, with weights that sum to 5; three are turned."""
    a, b = builtin("fitted"), builtin("printed")
    return Components(
        (a, DIRECT, 2.0, 0.0), (b, MULTIPLE, 0.5, 1.0), (a, MULTIPLE, 0.0, np.nan), (b, DIRECT, 2.5, -2.4)
    )


def shifted(phi, turn):
    """phi + turn in [-pi, pi), as floats."""
    turned = np.float32(phi) + np.float32(turn)
    return np.float32((turned.astype(float) + np.pi) % (2 * np.pi) - np.pi)


def random_inputs(seed: int, n: int = 100_000) -> list[np.ndarray]:
    """theta_r, phi_r, u_lobe, u_theta, u_phi"""
    random = np.random.default_rng(seed)
    viewer = random.uniform(-np.pi / 2, np.pi / 2, n), random.uniform(-np.pi, np.pi, n)
    return [a.astype(np.float32) for a in (*viewer, *random.random((3, n), np.float32))]


def test_density_is_the_weighted_mean_of_the_lobes(four):
    theta_r, phi_r, *u = random_inputs(1)
    theta_i, phi_i = np.pi * (u[0] - 0.5), 2 * np.pi * u[1] - np.pi
    parts = [
        w / 5 * m.pdf(LOBES[k], theta_r, phi_r, theta_i, np.float32(phi_i) - np.float32(turn)).astype(float)
        for m, k, w, turn in four.parts
        if w > 0
    ]
    np.testing.assert_allclose(four.pdf(None, theta_r, phi_r, theta_i, phi_i), sum(parts), rtol=1e-6)


def test_a_direction_is_that_of_the_lobe_that_u_lobe_chooses(four):
    theta_r, phi_r, u_lobe, *u = random_inputs(2)
    s = four.sample(theta_r, phi_r, u_lobe, *u)
    below = np.searchsorted(np.array([2.0, 2.5, 2.5, 5.0]), 5.0 * u_lobe.astype(float), side="right")
    for k, (model, lobe, _, turn) in enumerate(four.parts):
        alone, chosen = model.sample(LOBES[lobe], theta_r, phi_r, *u), below == k
        assert np.array_equal(s["theta_i"][chosen], alone["theta_i"][chosen])
        if chosen.any():
            off = shifted(s["phi_i"] - shifted(alone["phi_i"], turn), 0)[chosen]
            assert abs(off).max() < 1e-6
    assert set(below) == {0, 1, 3}


def test_a_turned_lobe_has_the_density_of_one_that_is_not_elsewhere():
    inputs, model = random_inputs(8), builtin("fitted")
    still, turned = (Components((model, DIRECT, 1.0, turn)).sample(*inputs) for turn in (0.0, 2.0))
    assert np.array_equal(still["theta_i"], turned["theta_i"])
    assert np.array_equal(still["pdf_angle"], turned["pdf_angle"])
    assert abs(shifted(turned["phi_i"] - still["phi_i"], -2.0)).max() < 1e-6
    assert (abs(turned["phi_i"]) <= np.float32(np.pi)).all()


@pytest.mark.parametrize("turns", [-3, 1, 1000])
def test_whole_turns_change_nothing(turns):
    """But the rounding of a large angle."""
    inputs, model = random_inputs(9), builtin("fitted")
    still, turned = (
        Components((model, DIRECT, 1.0, turn)).sample(*inputs) for turn in (0.0, 2 * np.pi * turns)
    )
    assert abs(shifted(turned["phi_i"] - still["phi_i"], 0)).max() < 1e-6 * (1 + abs(turns))


def test_the_density_of_a_sample_is_the_density_asked_for(four):
    """To the rounding of a drawn angle, as in test_mixture.py."""
    inputs = random_inputs(3)
    s = four.sample(*inputs)
    asked = four.pdf(None, *inputs[:2], s["theta_i"], s["phi_i"]).astype(float)
    difference = abs(asked - s["pdf_angle"]) / s["pdf_angle"]
    assert np.quantile(difference, 0.99) < 1e-4
    assert np.median(difference) < 1e-6
    cosine = np.maximum(np.cos(s["theta_i"].astype(float)), 4.3e-8)
    np.testing.assert_allclose(s["pdf_solid_angle"], s["pdf_angle"] / cosine, rtol=0.02)


@pytest.mark.parametrize("viewer", VIEWERS, ids=str)
def test_samples_follow_the_density(four, viewer):
    random = np.random.default_rng([5, VIEWERS.index(viewer)])
    s = four.sample(*np.float32(viewer), *random.random((3, SAMPLES), np.float32))
    assert p_value(joint_counts(s), joint_expected(four, "", *np.float32(viewer))) > LEAST_P


def test_samples_of_another_weight_are_rejected(four):
    viewer = np.float32(VIEWERS[0])
    s = four.sample(*viewer, *np.random.default_rng(6).random((3, SAMPLES), np.float32))
    other = Components(*four.parts[:3], (four.parts[3][0], DIRECT, 2.6, -2.4))
    assert p_value(joint_counts(s), joint_expected(other, "", *viewer)) < LEAST_P
    other = Components(*four.parts[:3], (four.parts[3][0], DIRECT, 2.5, -2.38))
    assert p_value(joint_counts(s), joint_expected(other, "", *viewer)) < LEAST_P


@pytest.mark.parametrize("viewer", VIEWERS, ids=str)
def test_density_integrates_to_one(four, viewer):
    assert joint_expected(four, "", *np.float32(viewer)).sum() / SAMPLES == pytest.approx(1, abs=2e-3)


def test_two_lobes_of_a_model_are_its_mixture():
    from runtime.test_mixture import filled, sample_mixture

    model, inputs = builtin("fitted"), random_inputs(4)
    s = Components((model, DIRECT, 0.6, 0.0), (model, MULTIPLE, 0.4, 0.0)).sample(*inputs)
    theta_i, phi_i, pdf, _ = sample_mixture(model, filled(inputs[0].size, 0.6), *inputs)
    same = s["theta_i"] == theta_i  # but where u_lobe lies on 0.6, rounded in two ways
    assert same.mean() > 0.9999
    assert np.array_equal(s["phi_i"][same], phi_i[same])
    np.testing.assert_allclose(s["pdf_angle"][same], pdf[same], rtol=1e-6)


def test_the_scale_of_the_weights_does_not_matter(four):
    inputs = random_inputs(6)
    large, small = (
        Components(*((m, lobe, np.float32(w) * np.float32(f), t) for m, lobe, w, t in four.parts)).sample(
            *inputs
        )
        for f in (2.0**126, 2.0**-130)
    )
    for s in (large, small):
        assert np.array_equal(s["theta_i"], four.sample(*inputs)["theta_i"])
        np.testing.assert_allclose(s["pdf_angle"], four.sample(*inputs)["pdf_angle"], rtol=1e-6)


NO_DENSITY = {
    "no components": ((), None),
    "a negative number of them": (((1, DIRECT, 1.0),), -3),
    "no weight": (((1, DIRECT, 0.0), (1, MULTIPLE, -1.0)), None),
    "NaN": (((1, DIRECT, np.nan), (1, MULTIPLE, 1.0)), None),
    "infinity": (((1, DIRECT, 1.0), (1, MULTIPLE, np.inf)), None),
    "a turn of infinity": (((1, DIRECT, 1.0, np.inf), (1, MULTIPLE, 1.0)), None),
    "a turn of NaN": (((1, DIRECT, 1.0), (1, MULTIPLE, 1.0, np.nan)), None),
}


@pytest.mark.parametrize("case", NO_DENSITY, ids=lambda name: name.replace(" ", "-"))
def test_without_valid_weights_the_density_is_zero(case):
    parts, count = NO_DENSITY[case]
    mixed = Components(*((builtin("fitted"), *numbers) for _, *numbers in parts), count=count)
    s = mixed.sample(0.3, 0.5, 0.5, 0.25, 0.75)
    assert s["pdf_angle"] == s["pdf_solid_angle"] == 0
    assert np.isfinite([s["theta_i"], s["phi_i"]]).all()
    assert mixed.pdf(None, 0.3, 0.5, 0.1, 0.2) == 0


def test_a_negative_weight_counts_as_none_and_its_model_is_not_read():
    inputs, model = random_inputs(7, 1000), builtin("fitted")
    alone = Components((model, DIRECT, 1.0, 0.3)).sample(*inputs)
    mixed = Components((None, MULTIPLE, -2.0, 0.0), (model, DIRECT, 0.5, 0.3), (None, DIRECT, 0.0, np.inf))
    mixed = mixed.sample(*inputs)
    assert alone.tobytes() == mixed.tobytes()


@pytest.mark.parametrize("position", range(5))
def test_nan_and_infinite_azimuth_give_density_zero(four, position):
    for bad in (np.nan, *((np.inf, -np.inf) if position == 1 else ())):
        inputs = [0.3, 0.2, 0.1, 0.4, 0.9]
        inputs[position] = bad
        s = four.sample(*inputs)
        assert s["pdf_angle"] == s["pdf_solid_angle"] == 0
        assert np.isfinite([s["theta_i"], s["phi_i"]]).all()
        if position < 4:
            direction = [0.3, 0.2, 0.4, 0.9]
            direction[min(position, 3)] = bad
            assert four.pdf(None, *direction) == 0


@pytest.mark.parametrize("u", [-1.0, 0.0, 1.0, 2.0, np.inf, -np.inf])
def test_u_lobe_outside_its_range_is_clamped(four, u):
    end = float(u > 0.5)
    assert four.sample(0.3, 0.2, u, 0.4, 0.9).tobytes() == four.sample(0.3, 0.2, end, 0.4, 0.9).tobytes()
    assert four.sample(0.3, 0.2, u, 0.4, 0.9)["pdf_angle"] > 0
