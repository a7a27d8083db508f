"""The shipped shaders against the C library, on every back end that this machine has."""

import numpy as np
import pytest
from shaders import backends
from shaders.agreement import (
    DENSITIES,
    MODELS,
    NUMBERS,
    SAMPLES,
    Agreement,
    Reference,
    agreement,
    hard_records,
    model_tables,
    random_records,
    reference,
    scene,
)
from shaders.backends import BACKENDS, Scene

from hairlut.cell import Cell
from hairlut.lobes import FITTED
from hairlut.table import bake_table
from hairlut.warp import Warp

RANDOM = 100_000


@pytest.fixture(scope="module", params=MODELS)
def model(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture(scope="module")
def tables(model: str) -> Scene:
    return scene(model_tables(model))


@pytest.mark.parametrize("backend", BACKENDS)
def test_agrees_with_c_on_random_and_hard_inputs(backend: str, model: str, tables: Scene):
    records = np.concatenate([hard_records(tables), random_records(RANDOM)])
    result = agreement(reference(model), records, BACKENDS[backend](tables, records))
    print(backend, model, result)
    assert result.holds(), result


SHAPES = {  # the smallest table, a wide one, and the baseline without a warp or a curve
    "4x2": (4, 2, "octaves e=0.0001", "parabola limit=0.95"),
    "130x7": (130, 7, "octaves e=1.52587890625e-05", "parabola limit=0.5"),
    "9x33 uniform, linear": (9, 33, "uniform", "linear"),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("backend", BACKENDS)
def test_agrees_with_c_on_other_tables(backend: str, shape: str):
    width, height, warp, cell = SHAPES[shape]
    lobes = FITTED.lobes
    tables = [bake_table(lobe, width, height, Warp.parse(warp), Cell.parse(cell)) for lobe in lobes]
    records = np.concatenate([hard_records(scene(tables))[::7], random_records(5000)])
    result = agreement(Reference(tables), records, BACKENDS[backend](scene(tables), records))
    assert result.holds(), result


# One wrong step each; the comparison must notice all of them.
MUTANTS = {
    "linear cells": ("axis.limit * abs(d)", "0.0 * abs(d)"),
    "end cells without their rule": ("c = d - h.y * after / h.z", "c = 0.5 * (d - h.y * after / h.z)"),
    "curvature not clamped": ("clamp(c, -bound, bound)", "c"),
    "knots' slopes as if cells were of one width": (
        "(d0 + d1) / (d1 * h0 / d0 + d0 * h1 / d1)",
        "2.0 * (d0 + d1) / (h0 + h1) / (d1 / d0 + d0 / d1)",
    ),
    "density of the column, not of u": (
        "return hairlut_draw(clamp(x, axis.low, axis.high), cell.h / slope)",
        "return hairlut_draw(clamp(x, axis.low, axis.high), axis.k / slope)",
    ),
    "rows blended with 8 bits": ("(row, r - float(row))", "(row, floor((r - float(row)) * 256.0) / 256.0)"),
    "upper tail not folded": ("u <= 0.5 ? u : 1.0 - u", "u"),
    "difference taken for sum": ("? phi - r : phi + r", "? phi + r : phi - r"),
    "NaN not told": ("return (floatBitsToUint(x) & 0x7fffffffu) > 0x7f800000u", "return false"),
    "density of one lobe": ("known ? w * direct + (1.0 - w) * multiple", "known ? direct"),
    "cosine of the float pi/2": ("z * series - 4.37113883e-8", "z * series"),
}


@pytest.mark.parametrize("mutant", MUTANTS)
def test_comparison_rejects_a_shader_with_one_wrong_step(mutant: str, monkeypatch: pytest.MonkeyPatch):
    tables = scene(model_tables("fitted"))
    records = np.concatenate([hard_records(tables), random_records(2000)])
    right, wrong = MUTANTS[mutant]
    shipped = backends.source("harness.glsl", "hairlut.glsl")
    assert right in shipped
    monkeypatch.setattr(backends, "source", lambda *_: shipped.replace(right, wrong))
    got = backends.run_glsl(tables, records)
    try:
        result = agreement(reference("fitted"), records, got)
    except AssertionError:
        return
    assert not result.holds(), result


def test_comparison_rejects_one_wrong_density_and_one_wrong_number(model: str):
    """The tolerances themselves: C's own results, one value of one record moved."""
    records = random_records(1000)
    got = reference(model)(records)
    assert agreement(reference(model), records, got) == Agreement(
        1000, 0.0, pytest.approx(0, abs=2e-7), 0.0, 0
    )
    for column in (SAMPLES["direct"] + 2, SAMPLES["mixture"] + 3, DENSITIES["multiple"]):
        off = got.copy()
        off[7, column] *= 1 + 2e-4
        assert not agreement(reference(model), records, off).holds()
    off = got.copy()
    off[7, NUMBERS["direct"]] = 1 - off[7, NUMBERS["direct"]]
    assert not agreement(reference(model), records, off).holds()
