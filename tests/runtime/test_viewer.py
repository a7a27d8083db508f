# SPDX-License-Identifier: BSD-3-Clause
"""hairlut_viewer: bit for bit what the functions give that take all arguments at once."""

import ctypes
import itertools

import numpy as np
import pytest
from runtime.c_library import SAMPLE, Model, builtin, loops

from runtime import strands

HARD = [np.nan, np.inf, -np.inf, 0.0, 0.3, -2.0, 1e30, -3e38]
SHAPES = {
    "as fitted": {},
    "nothing depends": {"theta": (), "phi": (), "mixture": ()},
    "two axes a table": {"theta": ("beta_m", "absorption"), "phi": ("beta_n", "beta_m")},
    "four axes": {"mixture": ("beta_m", "beta_n", "absorption", "unused"), "theta": ("unused",)},
    "more grids than a viewer has room for": {"lobes": 6, "apart": True},
    "sixteen lobes": {"lobes": 16},
}


def pointer(array):
    """Of float32 numbers, or NULL."""
    return None if array is None else array.ctypes.data_as(ctypes.c_void_p)


def by_viewers(model: Model, parameters, shares, *inputs) -> tuple[np.ndarray, np.ndarray]:
    """Samples, and densities of the directions in the last two inputs."""
    arrays = [np.ascontiguousarray(a, np.float32) for a in np.broadcast_arrays(*inputs)]
    n = arrays[0].size
    given = [
        None if a is None else np.array(np.broadcast_to(np.float32(a), (n, len(a[0]))), order="C")
        for a in (parameters, shares)
    ]
    samples, pdf = np.empty(n, SAMPLE), np.empty(n, np.float32)
    same = loops().loop_viewer(
        model.pointer, *map(pointer, given), ctypes.c_size_t(n), *map(pointer, (*arrays, samples, pdf))
    )
    assert same == 1
    return samples, pdf


def assert_same(model: Model, parameters, shares, *inputs) -> np.ndarray:
    """Viewers' bits are those of hairlut_sample_strand and hairlut_pdf_strand. Returns the samples."""
    theta_r, phi_r, offset, u_lobe, u_theta, u_phi, theta_i, phi_i = inputs
    samples, pdf = by_viewers(model, parameters, shares, *inputs)
    one = model.sample_strand(
        parameters, theta_r, phi_r, u_lobe, u_theta, u_phi, offset=offset, shares=shares
    )
    assert samples.tobytes() == one.tobytes()
    one = model.pdf_strand(parameters, theta_r, phi_r, theta_i, phi_i, offset, shares)
    assert pdf.tobytes() == one.tobytes()
    return samples


def hits(n: int, seed: int = 3) -> list[np.ndarray]:
    """A viewer, three numbers and another direction each."""
    random = np.random.default_rng(seed)
    ranges = [(-1.6, 1.6), (-9, 9), (-1.1, 1.1), (0, 1), (0, 1), (0, 1), (-1.6, 1.6), (-9, 9)]
    return [np.float32(random.uniform(*ends, n)) for ends in ranges]


@pytest.mark.parametrize("shape", SHAPES)
def test_strands(shape):
    model = strands.model(**SHAPES[shape])
    samples = assert_same(model, strands.strands(3_000), None, *hits(3_000))
    assert (samples["pdf_angle"] > 0).all()


@pytest.mark.parametrize("name", ["fitted", "brown"])
def test_models_without_parameters(name):
    model = builtin(name)
    samples = assert_same(model, None, None, *hits(3_000))
    assert (samples["pdf_angle"] > 0).all()
    assert samples.tobytes() == assert_same(model, np.zeros((1, 0)), None, *hits(3_000)).tobytes()


@pytest.mark.parametrize("shape", ["as fitted", "nothing depends"])
def test_no_parameters_are_the_standard_ones(shape):
    assert_same(strands.model(**SHAPES[shape]), None, None, *hits(1_000))


def test_a_callers_shares():
    model = strands.model()
    for shares in (
        (0.0, 2.0, -1.0),
        (3e38, 3e38, 1e-30),
        (0.0, 0.0, 0.0),
        (1.0, np.nan, 1.0),
        (np.inf, 1.0, 0.0),
    ):
        samples = assert_same(model, strands.strands(500), np.array([shares]), *hits(500))
        known = np.isfinite(shares).all() and max(shares) > 0
        assert ((samples["pdf_angle"] > 0) == known).all()
        assert_same(builtin("brown"), None, np.array([shares]), *hits(500))
    assert_same(builtin("fitted"), None, np.array([[0.25, 0.75]]), *hits(500))


@pytest.mark.parametrize("first", range(8))
def test_hard_inputs(first):
    """Every pair of hard values in two arguments; a hard parameter besides."""
    grid = np.float32(list(itertools.product(HARD, HARD))).T
    inputs = [np.full(grid.shape[1], 0.4, np.float32) for _ in range(8)]
    inputs[first] = grid[0]
    inputs[(first + 3) % 8] = grid[1]
    assert_same(builtin("brown"), None, None, *inputs)
    for value in (0.3, np.nan, np.inf, -1e30):
        given = strands.strands(1)
        given[:, first % 4] = value
        samples = assert_same(strands.model(), given, None, *inputs)
        assert all(np.isfinite(samples[name]).all() for name in SAMPLE.names)
