"""Models from tables in memory: what is accepted, what is refused and how, and who owns the memory."""

import ctypes
import dataclasses

import numpy as np
import pytest
from runtime.c_library import ARGUMENT, AXES, LOBES, MEMORY, MODELS, OK, ROOT, TABLE, LoadError, builtin, core
from runtime.tables import HALF_PI, OCTAVES, TWO_PI, UNIFORM, Allocator, straight

from hairlut import exr
from runtime import tables

NAN, INF = np.nan, np.inf


def spoilt(j: int, i: int, value: float) -> tables.MemoryTable:
    table = straight()
    table.texels[j, i] = value
    return table


def narrow() -> tables.MemoryTable:
    table = spoilt(1, 3, 0.0)
    table.texels[1, 4] = 1e-13
    return table


ACCEPTED = {
    "smallest": straight(width=4, height=2),
    "odd width": straight(width=5),
    "widest": straight(width=4096, height=2),
    "tallest": straight(width=4, height=4096),
    "uniform": straight(warp=UNIFORM, warp_e=NAN),
    "linear cells": straight(cell_limit=0.0),
    "part of the circle": straight(theta_r_range=(0.0, 0.5)),
    "narrow domain": straight(domain=(np.float32(0.1), np.float32(0.2))),
    "most curved": straight(cell_limit=0.95),
    "largest e": straight(warp_e=1.0),
    "smallest e": straight(warp_e=1e-12),
}

REFUSED = {
    "no texels": (tables.MemoryTable(None, size=(8, 3)), ARGUMENT, "texels is NULL"),
    "too narrow": (straight(size=(3, 8)), TABLE, "size is 3x8: expected a width of 4 to 4096"),
    "one row": (straight(size=(8, 1)), TABLE, "size is 8x1"),
    "too wide": (straight(size=(4097, 2)), TABLE, "size is 4097x2"),
    "too tall": (straight(size=(8, 100000)), TABLE, "size is 8x100000"),
    "negative": (straight(size=(-8, -3)), TABLE, "size is -8x-3"),
    "range reversed": (straight(theta_r_range=(1.0, -1.0)), ARGUMENT, "theta_r_min 1, theta_r_max -1"),
    "range empty": (straight(theta_r_range=(1.0, 1.0)), ARGUMENT, "theta_r_min"),
    "range NaN": (straight(theta_r_range=(NAN, 1.0)), ARGUMENT, "theta_r_min"),
    "range infinite": (straight(theta_r_range=(-1.0, INF)), ARGUMENT, "theta_r_min"),
    "range of a denormal": (straight(theta_r_range=(0.0, 1e-44)), ARGUMENT, "theta_r_min"),
    "domain reversed": (dataclasses.replace(straight(), domain=(1, -1)), ARGUMENT, "domain_min 1"),
    "domain NaN": (dataclasses.replace(straight(), domain=(-1, NAN)), ARGUMENT, "domain_max"),
    "domain in degrees": (straight(domain=(-90, 90)), ARGUMENT, "domain_min -90"),
    "unknown warp": (straight(warp=2), ARGUMENT, "warp is 2: expected"),
    "e zero": (straight(warp_e=0.0), ARGUMENT, "warp_e is 0: expected 1e-12 to 1"),
    "e NaN": (straight(warp_e=NAN), ARGUMENT, "warp_e"),
    "e large": (straight(warp_e=1.5), ARGUMENT, "warp_e"),
    "limit large": (straight(cell_limit=1.0), ARGUMENT, "cell_limit is 1: expected 0 to 0.95"),
    "limit negative": (straight(cell_limit=-0.1), ARGUMENT, "cell_limit"),
    "limit NaN": (straight(cell_limit=NAN), ARGUMENT, "cell_limit"),
    "texel NaN": (spoilt(1, 3, NAN), TABLE, "row 1, columns 2 and 3"),
    "texel infinite": (spoilt(1, 3, INF), TABLE, "row 1, columns 3 and 4"),
    "not increasing": (spoilt(2, 4, -0.5), TABLE, "row 2, columns 3 and 4"),
    "flat": (spoilt(0, 1, -HALF_PI), TABLE, "row 0, columns 0 and 1"),
    "narrower than any": (
        narrow(),
        TABLE,
        "row 1, columns 3 and 4: 0, 9.99999982e-14: expected angles that incr",
    ),
    "first texel": (
        spoilt(1, 0, -1.5),
        TABLE,
        "row 1 runs from -1.5 to 1.57079637: expected the whole domain",
    ),
    "last texel": (spoilt(2, 7, 1.5), TABLE, "row 2 runs from -1.57079637 to 1.5"),
}


@pytest.mark.parametrize("case", ACCEPTED)
def test_sound_tables_are_accepted_and_sampled(case):
    table = ACCEPTED[case]
    assert tables.validate(table)[0] == OK
    model = tables.create(table, multiple_theta=table)
    s = model.sample("direct", 0.2, 0.3, np.linspace(0, 1, 101), 0.5)
    assert (np.diff(s["theta_i"]) > 0).all()
    assert np.isfinite(s["pdf_solid_angle"]).all()
    u = model.invert("direct", 0.2, 0.3, s["theta_i"], s["phi_i"])[0]
    np.testing.assert_allclose(u, np.linspace(0, 1, 101), atol=1e-5)


@pytest.mark.parametrize("case", REFUSED)
def test_unsound_tables_are_refused_with_place_and_expectation(case):
    table, expected, text = REFUSED[case]
    result, message = tables.validate(table)
    assert result == expected
    assert text in message
    assert "expected" in message
    with pytest.raises(LoadError, match=r"multiple_theta: ") as refusal:
        tables.create(multiple_theta=table)
    assert refusal.value.result == expected


def test_angles_must_suit_their_table():
    with pytest.raises(LoadError, match=r"direct_theta: domain .* expected to lie within -1.57") as refusal:
        tables.create(direct_theta=straight((0.0, TWO_PI)))
    assert refusal.value.result == ARGUMENT
    with pytest.raises(LoadError, match=r"direct_phi: domain .* expected to lie within 0 to"):
        tables.create(direct_phi=straight())
    with pytest.raises(LoadError, match=r"azimuth is 7: expected HAIRLUT_AZIMUTH_SUM"):
        tables.create(azimuth=7)


def test_null_arguments_are_errors_not_crashes():
    out, message = ctypes.c_void_p(1), ctypes.create_string_buffer(512)
    description = tables.CDescription()
    library = core()
    assert library.hairlut_validate(None, message) == ARGUMENT
    assert message.value == b"table is NULL"
    assert library.hairlut_model_create(ctypes.byref(description), None, None, message) == ARGUMENT
    assert message.value == b"out is NULL"
    assert library.hairlut_model_create(None, None, ctypes.byref(out), message) == ARGUMENT
    assert message.value == b"desc is NULL"
    assert out.value is None
    assert library.hairlut_model_create(None, None, ctypes.byref(out), None) == ARGUMENT
    assert library.hairlut_builtin(None) is None
    assert library.hairlut_builtin(b"Fitted") is None
    library.hairlut_free(None)


def test_freeing_a_compiled_in_model_does_nothing():
    model = builtin("fitted")
    before = model.sample("direct", 0.1, 0.2, 0.3, 0.4)
    core().hairlut_free(model.pointer)
    assert model.sample("direct", 0.1, 0.2, 0.3, 0.4) == before


def test_size_of_each_table_is_told():
    width, height = ctypes.c_int(), ctypes.c_int()
    model = tables.create(
        straight(width=9, height=2), straight((0.0, TWO_PI), 10, 3), straight(width=11, height=4)
    )
    for part in range(3):
        core().hairlut_table_size(model.pointer, part, ctypes.byref(width), ctypes.byref(height))
        assert (width.value, height.value) == (9 + part, 2 + part)


@pytest.mark.parametrize("name", MODELS)
def test_tables_from_memory_give_the_compiled_in_models_bits(name):
    parts = []
    for axis in AXES:
        t = exr.read(ROOT / "luts" / name / f"{axis}.exr")[0]
        warp = {"uniform": UNIFORM, "octaves": OCTAVES}[t.warp.name]
        parts.append(tables.MemoryTable(t.texels, t.domain, t.theta_r_range, warp, t.warp.e, t.cell.limit))
    azimuth = {"printed": tables.SUM, "fitted": tables.DIFFERENCE}[name]
    model = tables.create(*parts, azimuth=azimuth)
    for part in parts:
        part.texels[:] = np.nan  # they were copied
    random = np.random.default_rng(3)
    inputs = random.uniform(-2, 2, (2, 10_000)), random.random((2, 10_000))
    tails = 2.0 ** -random.uniform(0, 30, (2, 5_000))  # the end cells, which the padding texels bend
    inputs[1][:, ::2] = np.where(random.random(5_000) < 0.5, tails, 1 - tails)
    for lobe in LOBES:
        one, two = (m.sample(lobe, *inputs[0], *inputs[1]) for m in (model, builtin(name)))
        assert one.tobytes() == two.tobytes()
        at = one["theta_i"], one["phi_i"]
        one, two = (m.pdf(lobe, *inputs[0], *at) for m in (model, builtin(name)))
        assert np.array_equal(one, two)


def test_hooks_own_all_memory():
    allocator = Allocator()
    model = tables.create(allocator=allocator)
    assert allocator.calls == 1
    assert len(allocator.alive) == 1
    model.sample("direct", 0.1, 0.2, np.linspace(0, 1, 100), 0.4)
    assert allocator.calls == 1
    core().hairlut_free(model.pointer)
    model.owned = False
    assert not allocator.alive


def test_refusals_leave_nothing_allocated():
    allocator = Allocator()
    with pytest.raises(LoadError):
        tables.create(spoilt(1, 3, NAN), allocator=allocator)
    assert not allocator.alive


def test_no_memory_is_an_error():
    with pytest.raises(LoadError, match=r"the allocator returned NULL for [0-9]+ bytes") as refusal:
        tables.create(allocator=Allocator(fail_at=0))
    assert refusal.value.result == MEMORY


def test_half_a_pair_of_hooks_is_refused_and_a_zeroed_pair_means_malloc():
    parts = [straight(), straight((0.0, TWO_PI)), straight()]
    description = ctypes.byref(tables.CDescription(*(part.c() for part in parts), tables.SUM))
    half = Allocator().c()
    half.release = tables.Release()
    out, message = ctypes.c_void_p(1), ctypes.create_string_buffer(512)
    create = core().hairlut_model_create
    assert create(description, ctypes.byref(half), ctypes.byref(out), message) == ARGUMENT
    assert b"expected both allocate and release" in message.value
    assert create(description, ctypes.byref(tables.CAllocator()), ctypes.byref(out), None) == OK
    core().hairlut_free(out)


def rough(seed: int) -> tables.MemoryTable:
    """Cells from 1e-12 rad to a radian side by side, others in every row: the worst that is let by."""
    random = np.random.default_rng(seed)
    width, height = int(random.integers(4, 40)), int(random.integers(2, 9))
    rows = np.zeros((height, width), np.float32)
    for row in rows:
        while not (np.diff(row) >= 1e-12).all():
            inner = np.sign(random.uniform(-1, 1, width - 2)) * 10.0 ** random.uniform(-11, 0.1, width - 2)
            row[:] = np.sort(np.concatenate([[-HALF_PI], inner.astype(np.float32), [HALF_PI]]))
    e, limit = 10.0 ** random.uniform(-12, 0), random.uniform(0, 0.95)
    return tables.MemoryTable(rows, warp_e=e, cell_limit=limit)


@pytest.mark.parametrize("seed", range(40))
def test_the_roughest_tables_give_finite_densities(seed):
    table = rough(seed)
    assert tables.validate(table) == (OK, "")
    model = tables.create(table, multiple_theta=table)
    random = np.random.default_rng(seed)
    theta_r = np.append(random.uniform(-1.6, 1.6, 500), [-HALF_PI, HALF_PI] * 10)
    u = np.append(random.random(500), 2.0 ** -np.arange(1, 21))
    s = model.sample("direct", theta_r, 0.3, u, u[::-1])
    for name in ("pdf_angle", "pdf_solid_angle"):
        assert np.isfinite(s[name]).all()
        assert (s[name] > 0).all()
    pdf = model.pdf("direct", theta_r, 0.3, s["theta_i"], s["phi_i"])
    assert np.isfinite(pdf).all()
    assert (pdf > 0).all()
