# SPDX-License-Identifier: BSD-3-Clause
"""hairlut.load and hairlut.builtin: the C library's bits, broadcast, without copies where a view will do."""

import ctypes
import doctest
import threading
import time

import numpy as np
import pytest

import hairlut
from hairlut import sampler

core = pytest.importorskip("hairlut._core", reason="hairlut was installed without its C library")

from runtime.c_library import ROOT, SAMPLE, Model, builtin  # noqa: E402
from runtime.c_library import core as c_core  # noqa: E402

N = 4001  # more than a block, and no whole number of vectors
NAMES = ("printed", "fitted")
FIELDS = sampler.Sample._fields


def inputs(seed: int = 1, n: int = N) -> dict[str, np.ndarray]:
    random = np.random.default_rng(seed)
    return {
        "theta_r": random.uniform(-1.7, 1.7, n).astype(np.float32),
        "phi_r": random.uniform(-7, 7, n).astype(np.float32),
        "theta_i": random.uniform(-1.7, 1.7, n).astype(np.float32),
        "phi_i": random.uniform(-7, 7, n).astype(np.float32),
        "offset": random.uniform(-1.1, 1.1, n).astype(np.float32),
        "u": random.random((n, 3), np.float32),
    }


def same(found: np.ndarray, expected: np.ndarray) -> None:
    np.testing.assert_array_equal(found.view(np.int32), np.ascontiguousarray(expected).view(np.int32))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("given", [None, (0.25, 4.0), "each"], ids=["own", "constant", "each"])
def test_whole_hair_equals_c_bit_for_bit(name: str, given) -> None:
    hair, c, x = hairlut.builtin(name), builtin(name), inputs()
    shares = np.random.default_rng(2).random((N, 2), np.float32) if given == "each" else given
    s = hair.sample(x["theta_r"], x["phi_r"], x["u"], x["offset"], shares)
    expected = c.sample_hair(x["theta_r"], x["phi_r"], *x["u"].T, x["offset"], shares)
    for field in FIELDS:
        same(getattr(s, field), expected[field])
    directions = x["theta_r"], x["phi_r"], x["theta_i"], x["phi_i"]
    same(hair.pdf(*directions, x["offset"], shares), c.pdf_hair(*directions, x["offset"], shares))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("lobe", ["direct", "multiple"])
def test_lobes_equal_c_bit_for_bit(name: str, lobe: str) -> None:
    hair, c, x = hairlut.builtin(name), builtin(name), inputs()
    s = hair.sample_lobe(lobe, x["theta_r"], x["phi_r"], x["u"][:, :2])
    expected = c.sample(lobe, x["theta_r"], x["phi_r"], x["u"][:, 0], x["u"][:, 1])
    for field in FIELDS:
        same(getattr(s, field), expected[field])
    directions = x["theta_r"], x["phi_r"], x["theta_i"], x["phi_i"]
    same(hair.pdf_lobe(lobe, *directions), c.pdf(lobe, *directions))
    u = hair.invert(lobe, *directions)
    for k, part in enumerate(c.invert(lobe, *directions)):
        same(np.ascontiguousarray(u[..., k]), part)


@pytest.mark.parametrize("name", NAMES)
def test_loaded_model_equals_the_compiled_in_one(name: str) -> None:
    x = inputs()
    loaded, compiled = hairlut.load(ROOT / "luts" / name), hairlut.builtin(name)
    assert loaded.lobes == compiled.lobes
    for a, b in zip(*(m.sample(x["theta_r"], x["phi_r"], x["u"]) for m in (loaded, compiled)), strict=True):
        same(a, b)


def test_arguments_broadcast() -> None:
    hair = hairlut.builtin("fitted")
    u = np.random.default_rng(3).random((5, 1, 7, 3), np.float32)
    theta_r, offset = np.linspace(-1, 1, 4, dtype=np.float32)[:, None], np.linspace(-1, 1, 7)
    s = hair.sample(theta_r, 0.5, u, offset, shares=(1, 3))
    assert s.theta_i.shape == (5, 4, 7)
    for i, j, k in np.ndindex(s.theta_i.shape):
        one = hair.sample(theta_r[j, 0], 0.5, u[i, 0, k], offset[k], (1, 3))
        assert one.theta_i.shape == ()
        assert [float(v) for v in one] == [float(getattr(s, field)[i, j, k]) for field in FIELDS]
    assert hair.pdf(theta_r, 0.5, 0.1, np.zeros(7)).shape == (4, 7)
    assert hair.sample(np.empty(0), 0.0, np.empty((0, 3))).theta_i.shape == (0,)


def test_strided_and_double_arrays_give_the_same() -> None:
    hair, x = hairlut.builtin("fitted"), inputs()
    expected = hair.sample(x["theta_r"], x["phi_r"], x["u"])
    apart = {k: np.repeat(v, 2, axis=0)[::2] for k, v in x.items()}
    doubles = {k: v.astype(float) for k, v in x.items()}
    backwards = {k: v[::-1].copy()[::-1] for k, v in x.items()}
    for other in (apart, doubles, backwards):
        found = hair.sample(other["theta_r"], other["phi_r"], other["u"])
        for a, b in zip(found, expected, strict=True):
            same(a, b)


def test_nan_has_density_zero_and_inputs_stay_as_they_are() -> None:
    hair, x = hairlut.builtin("fitted"), inputs()
    before = {k: v.copy() for k, v in x.items()}
    x["theta_r"][7] = before["theta_r"][7] = np.nan
    s = hair.sample(x["theta_r"], x["phi_r"], x["u"])
    assert s.pdf_angle[7] == 0
    assert np.isfinite(np.stack(s)).all()
    assert (np.delete(s.pdf_angle, 7) > 0).all()
    for k, v in x.items():
        np.testing.assert_array_equal(v, before[k])


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: hairlut.builtin("straight"), "model 'straight' is not compiled in: expected one of printed"),
        (lambda: hairlut.builtin("fitted").sample(0, 0, (0.5, 0.5)), r"u: has shape (2,), expected (..., 3)"),
        (
            lambda: hairlut.builtin("fitted").pdf(0, 0, 0, 0, shares=(1, 2, 3)),
            "shares: has shape (3,), expected (..., 2), one number for each of direct, multiple",
        ),
        (
            lambda: hairlut.builtin("fitted").pdf_lobe("trt", 0, 0, 0, 0),
            "lobe 'trt': model fitted has direct, multiple",
        ),
    ],
)
def test_wrong_use_is_named(call, text: str) -> None:
    with pytest.raises(hairlut.HairlutError) as error:
        call()
    assert text in str(error.value)


def test_the_interpreter_runs_while_the_library_works() -> None:
    hair, n = hairlut.builtin("fitted"), 3_000_000
    x, ticks, done = inputs(n=n), [], threading.Event()

    def draw() -> None:
        hair.sample(x["theta_r"], x["phi_r"], x["u"])
        done.set()

    thread = threading.Thread(target=draw)
    thread.start()
    while not done.is_set():
        ticks.append(time.perf_counter())
        time.sleep(0.001)
    thread.join()
    assert len(ticks) > 5


class Samples(ctypes.Structure):
    _fields_ = [(name, ctypes.c_void_p) for name in FIELDS]


def sample_hair_n(model: Model, out: np.ndarray, *arrays: np.ndarray) -> None:
    """The C function, into out (4, n)."""
    pointers = [ctypes.c_void_p(a.ctypes.data) for a in arrays]
    samples = Samples(*(row.ctypes.data for row in out))
    c_core().hairlut_sample_hair_n(model.pointer, ctypes.c_size_t(out.shape[1]), None, *pointers, samples)


def test_a_million_samples_run_at_the_speed_of_c() -> None:
    """At least 80 % of the C arrays' speed, least of ten, both in turn."""
    n, hair, c = 1_000_000, hairlut.builtin("fitted"), builtin("fitted")
    x = inputs(n=n)
    numbers = [np.ascontiguousarray(column) for column in x["u"].T]
    out = np.empty((4, n), np.float32)
    times = {"python": [], "c": []}
    for _ in range(10):
        start = time.perf_counter()
        hair.sample(x["theta_r"], x["phi_r"], x["u"], x["offset"])
        times["python"].append(time.perf_counter() - start)
        start = time.perf_counter()
        sample_hair_n(c, out, x["theta_r"], x["phi_r"], x["offset"], *numbers)
        times["c"].append(time.perf_counter() - start)
    assert min(times["c"]) / min(times["python"]) >= 0.8


def test_docstrings_show_what_happens() -> None:
    found = doctest.testmod(sampler, optionflags=doctest.ELLIPSIS)
    assert found.attempted >= 15
    assert found.failed == 0
    for name, member in vars(sampler.Model).items():
        if not name.startswith("_"):
            assert ">>>" in (member.fget if isinstance(member, property) else member).__doc__, name


def test_reject_another_record() -> None:
    """The comparison above sees one bit."""
    a = np.zeros(3, SAMPLE)
    b = a.copy()
    b["theta_i"][1] = np.float32(1e-45)
    with pytest.raises(AssertionError):
        same(a["theta_i"].copy(), b["theta_i"].copy())
