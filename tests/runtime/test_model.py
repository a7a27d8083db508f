# SPDX-License-Identifier: BSD-3-Clause
"""Models from descriptors in memory: what is accepted, what is refused and how, and who owns the memory."""

import ctypes
import dataclasses

import numpy as np
import pytest
from runtime.c_library import (
    ARGUMENT,
    LOBES,
    MEMORY,
    MODELS,
    OK,
    ROOT,
    TABLE,
    VERSION,
    LoadError,
    builtin,
    core,
    loops,
)
from runtime.tables import (
    HALF_PI,
    OCTAVES,
    SUM,
    TWO_PI,
    UNIFORM,
    Allocator,
    Description,
    Lobe,
    Mixture,
    straight,
    two_lobes,
    with_slopes,
)

from hairlut import exr
from runtime import tables

NAN, INF = np.nan, np.inf


def spoilt(j: int, i: int, angle: float | None = None, slope: float | None = None) -> tables.MemoryTable:
    table = straight()
    for channel, value in enumerate((angle, slope)):
        if value is not None:
            table.texels[j, i, channel] = value
    return table


def narrow() -> tables.MemoryTable:
    table = spoilt(1, 3, 0.0)
    table.texels[1, 4, 0] = 1e-13
    return table


def slopes(value: float) -> tables.MemoryTable:
    table = straight()
    table.texels[..., 1] = value
    return table


ACCEPTED = {
    "smallest": straight(width=4, height=2),
    "odd width": straight(width=5),
    "widest": straight(width=4096, height=2),
    "tallest": straight(width=4, height=4096),
    "uniform": straight(warp=UNIFORM, warp_e=NAN),
    "part of the circle": straight(theta_r_range=(0.0, 0.5)),
    "narrow domain": straight(domain=(np.float32(0.1), np.float32(0.2))),
    "largest e": straight(warp_e=1.0),
    "smallest e": straight(warp_e=1e-12),
    "least slopes": slopes(1e-9),
    "largest slopes": slopes(1e12),
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
    "slope 0": (spoilt(1, 2, slope=0.0), TABLE, "row 1, column 2: dx/du is 0: expected 1e-09 to 1e+12 rad"),
    "slope negative": (spoilt(2, 7, slope=-1.0), TABLE, "row 2, column 7: dx/du is -1"),
    "slope too large": (spoilt(0, 0, slope=1.1e12), TABLE, "row 0, column 0: dx/du is"),
    "slope too small": (spoilt(0, 0, slope=9e-10), TABLE, "row 0, column 0: dx/du is"),
    "slope NaN": (spoilt(0, 5, slope=NAN), TABLE, "row 0, column 5: dx/du is"),
    "slope infinite": (spoilt(0, 5, slope=INF), TABLE, "row 0, column 5: dx/du is inf"),
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
    if "slopes" not in case:  # those make cells that rise nearly everything in a few floats
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


# ---- lobes ----


def refused(lobes: list[Lobe], mixture: Mixture | None = None, change=None) -> tuple[int, str]:
    """Result and message of hairlut_model_create, which must refuse; nothing stays allocated."""
    description, allocator = Description(lobes, mixture), Allocator()
    if change:
        change(description)
    with pytest.raises(LoadError) as refusal:
        description.create(allocator)
    assert not allocator.alive
    return refusal.value.result, str(refusal.value).split(": ", 1)[1]


def test_angles_must_suit_their_table():
    result, message = refused(two_lobes(straight((0.0, TWO_PI))))
    assert result == ARGUMENT
    assert message.startswith("direct_theta: domain 0 to 6.28318548: expected to lie within -1.57")
    assert "direct_phi: domain" in refused(two_lobes(direct_phi=straight()))[1]
    assert "azimuth is 7: expected HAIRLUT_AZIMUTH_SUM" in refused(two_lobes(azimuth=7))[1]


NAMES = {
    None: "lobe 1: name is NULL",
    "": "lobe 1: name is ''",
    "Direct": "lobe 1: name is 'Direct'",
    "2nd": "lobe 1: name is '2nd'",
    "a b": "lobe 1: name is 'a b'",
    "a" * 32: "lobe 1: name is 'aaa",
    "first": "lobes 0 and 1 are both named 'first'",
}


@pytest.mark.parametrize("name", NAMES)
def test_names_of_lobes_are_words_that_differ(name):
    result, message = refused([Lobe("first", straight()), Lobe(name, straight())])
    assert result == ARGUMENT
    assert message.startswith(NAMES[name])
    assert "expected" in message


def test_longest_name_and_most_lobes_are_accepted():
    table, names = straight(), ["a" * 31, *(f"lobe_{k}" for k in range(15))]
    model = Description([Lobe(name, table) for name in names]).create()
    assert model.lobes == names
    assert [model.lobe_index(name) for name in names] == list(range(16))
    result, message = refused([Lobe(f"l{k}", table) for k in range(17)])
    assert result == ARGUMENT
    assert message == "lobe_count is 17: expected 1 to 16"
    assert refused([])[1] == "lobe_count is 0: expected 1 to 16"


def test_lobes_without_a_theta_table_are_refused():
    assert refused([Lobe("only", None)]) == (ARGUMENT, "only_theta: table is NULL")


def test_names_and_numbers_that_there_are_not():
    model, library = tables.create(), core()
    assert model.lobes == ["direct", "multiple"]
    for number in (-1, 2, 2**31 - 1, -(2**31)):
        assert library.hairlut_lobe_name(model.pointer, number) is None
        s = model.sample(number, 0.1, 0.2, 0.3, 0.4)
        assert s["pdf_angle"] == s["pdf_solid_angle"] == 0
        assert np.isfinite(s["theta_i"]).all()
        assert model.pdf(number, 0.1, 0.2, 0.3, 0.4) == 0
        assert not np.any(model.invert(number, 0.1, 0.2, 0.3, 0.4))
    for name in (b"Direct", b"direct_theta", b""):
        assert library.hairlut_lobe_index(model.pointer, name) == -1
    assert library.hairlut_lobe_index(model.pointer, None) == -1


def test_a_model_without_the_two_lobes_of_dual_scattering_has_no_density_there():
    model, library = Description([Lobe("only", straight())]).create(), core()
    for lobe in ("direct", "multiple"):
        function = getattr(library, f"hairlut_pdf_{lobe}")
        function.restype, function.argtypes = ctypes.c_float, [ctypes.c_void_p, *[ctypes.c_float] * 4]
        assert function(model.pointer, 0.1, 0.2, 0.3, 0.4) == 0
        assert function(builtin("fitted").pointer, 0.1, 0.2, 0.3, 0.4) > 0


# ---- mixtures ----


def mixture(**changes) -> Mixture:
    """Two lobes over three theta_r and two offsets."""
    grid = np.ones((2, 3, 2), np.float32)
    given = {"theta_r": [-1.0, 0.0, 1.0], "offset": [0.0, 0.5], "share": grid, "turn": 0.5 * grid}
    return Mixture(**(given | changes))


def at(value: float, lobe: int = 1, j: int = 2, o: int = 1) -> np.ndarray:
    grid = np.ones((2, 3, 2), np.float32)
    grid[lobe, j, o] = value
    return grid


def no_share() -> np.ndarray:
    grid = np.ones((2, 3, 2), np.float32)
    grid[:, 1, 0] = 0
    return grid


MIXTURES = {
    "share negative": (
        {"share": at(-1e-9)},
        TABLE,
        "lobe 1 at theta_r node 2, offset node 1 is -9.9",
    ),
    "share NaN": ({"share": at(NAN)}, TABLE, "share of lobe 1"),
    "share infinite": ({"share": at(INF, 0)}, TABLE, "share of lobe 0"),
    "no share": ({"share": no_share()}, TABLE, "shares at theta_r node 1, offset node 0 are all 0"),
    "turn NaN": ({"turn": at(NAN)}, TABLE, "turn of lobe 1 at theta_r node 2, offset node 1 is"),
    "turn large": ({"turn": at(26.0)}, TABLE, "turn of lobe 1 at theta_r node 2, offset node 1 is 26"),
    "turn infinite": ({"turn": at(-INF)}, TABLE, "turn of lobe 1"),
    "theta_r equal": ({"theta_r": [-1.0, 0.0, 0.0]}, TABLE, "theta_r node 2 is 0"),
    "theta_r NaN": ({"theta_r": [NAN, 0.0, 1.0]}, TABLE, "theta_r node 0 is"),
    "theta_r in degrees": ({"theta_r": [-90.0, 0.0, 90.0]}, TABLE, "theta_r node 0 is -90"),
    "theta_r missing": ({"theta_r": None, "counts": (3, 2)}, ARGUMENT, "theta_r is NULL: expected 3 numbers"),
    "no rows": ({"counts": (0, 2)}, ARGUMENT, "theta_r_count is 0: expected 1 to 4096"),
    "too many rows": ({"counts": (4097, 2)}, ARGUMENT, "theta_r_count is 4097"),
    "offset decreasing": ({"offset": [0.5, 0.0]}, TABLE, "offset node 1 is 0"),
    "offset beyond 1": ({"offset": [0.5, 1.01]}, TABLE, "offset node 1 is 1.0"),
    "offset missing": ({"offset": None, "counts": (3, 2)}, ARGUMENT, "offset is NULL"),
    "no columns": ({"counts": (3, -1)}, ARGUMENT, "offset_count is -1"),
    "negative and mirrored": ({"offset": [-0.5, 0.5], "mirrored": 1}, TABLE, "offset node 0 is -0.5"),
    "mirrored twice": ({"mirrored": 2}, ARGUMENT, "mirrored is 2: expected 0 or 1"),
}


@pytest.mark.parametrize("case", MIXTURES)
def test_unsound_mixtures_are_refused_with_place_and_expectation(case):
    changes, expected, text = MIXTURES[case]
    result, message = refused(two_lobes(), mixture(**changes))
    assert result == expected
    assert message.startswith("mixture: ")
    assert text in message
    assert "expected" in message


def test_more_nodes_than_a_kernel_counts_are_refused():
    nodes = {"theta_r": np.linspace(-1, 1, 600), "offset": np.linspace(-1, 1, 600)}
    assert refused(two_lobes(), Mixture(**nodes))[1] == (
        "mixture: 600 x 600 nodes: expected at most 262144 in all"
    )


def test_mixtures_of_every_extent_are_accepted():
    for rows, columns in ((1, 1), (2, 1), (1, 2), (4096, 1), (1, 4096), (512, 512)):
        grid = np.ones((2, rows, columns), np.float32)
        nodes = {"theta_r": np.linspace(-1, 1, rows), "offset": np.linspace(-1, 1, columns)}
        model = tables.create(mixture=Mixture(**nodes, share=grid, turn=8 * np.pi * grid))
        assert model.pdf_hair(0.1, 0.2, 0.3, 0.4, 0.5) > 0


# ---- descriptors of other versions ----


def grow(struct, by: int) -> None:
    struct.size += by


SIZES = {
    "model": (lambda d: d.c, "hairlut_model_desc"),
    "lobe": (lambda d: d.lobes[0], "hairlut_lobe_desc"),
    "second lobe": (lambda d: d.lobes[1], "hairlut_lobe_desc"),
    "mixture": (lambda d: d.mixture, "hairlut_mixture_desc"),
    "table": (lambda d: next(iter(d.tables.values())), "hairlut_table"),
}


@pytest.mark.parametrize("which", SIZES)
def test_descriptors_of_another_size_are_refused(which):
    part, name = SIZES[which]
    for by, expected in ((8, VERSION), (-4, ARGUMENT)):
        result, message = refused(two_lobes(), mixture(), lambda d, by=by: grow(part(d), by))
        assert result == expected
        assert f"size of a {name} is" in message
        assert "in hairlut 2." in message


def test_null_arguments_are_errors_not_crashes():
    out, message = ctypes.c_void_p(1), ctypes.create_string_buffer(512)
    description, library = Description(two_lobes()), core()
    assert library.hairlut_validate(None, message) == ARGUMENT
    assert message.value == b"table is NULL"
    assert library.hairlut_model_create(ctypes.byref(description.c), None, None, message) == ARGUMENT
    assert message.value == b"out is NULL"
    assert library.hairlut_model_create(None, None, ctypes.byref(out), message) == ARGUMENT
    assert message.value == b"desc is NULL"
    assert out.value is None
    description.c.lobes = None
    assert (
        library.hairlut_model_create(ctypes.byref(description.c), None, ctypes.byref(out), message)
        == ARGUMENT
    )
    assert message.value == b"lobes is NULL: expected 2 descriptors"
    assert library.hairlut_model_create(None, None, ctypes.byref(out), None) == ARGUMENT
    assert library.hairlut_builtin(None) is None
    assert library.hairlut_builtin(b"Fitted") is None
    library.hairlut_free(None)


# ---- memory ----


def test_freeing_a_compiled_in_model_does_nothing():
    model = builtin("fitted")
    before = model.sample("direct", 0.1, 0.2, 0.3, 0.4)
    core().hairlut_free(model.pointer)
    assert model.sample("direct", 0.1, 0.2, 0.3, 0.4) == before


def test_sizes_of_tables():
    lobes = two_lobes(
        straight(width=9, height=2), straight((0.0, TWO_PI), 10, 3), straight(width=11, height=4)
    )
    model = Description(lobes).create()
    width, height = ctypes.c_int(), ctypes.c_int()
    found = {}
    for lobe in (-1, 0, 1, 2):
        for angle in (0, 1):
            core().hairlut_table_size(model.pointer, lobe, angle, ctypes.byref(width), ctypes.byref(height))
            found[lobe, angle] = width.value, height.value
    assert found[0, 0] == (9, 2)
    assert found[0, 1] == (10, 3)
    assert found[1, 0] == (11, 4)
    assert {found[place] for place in ((1, 1), (-1, 0), (-1, 1), (2, 0), (2, 1))} == {(0, 0)}


def memory_of(lobes: list[Lobe]) -> int:
    """Bytes that a model of these lobes allocates."""
    allocator = Allocator()
    model = Description(lobes).create(allocator)
    (block,) = allocator.alive.values()
    size = len(block)
    core().hairlut_free(model.pointer)
    model.owned = False
    return size


def test_lobes_that_name_one_table_share_its_memory():
    table, phi = straight(width=64, height=64), straight((0.0, TWO_PI), 64, 64)
    shared = memory_of([Lobe(f"l{k}", table, phi) for k in range(8)])
    apart = memory_of([Lobe(f"l{k}", straight(width=64, height=64), phi) for k in range(8)])
    one = memory_of([Lobe("l0", table, phi)])
    assert shared < one + 8 * 1024
    assert apart - shared == pytest.approx(7 * (one - 2048) / 2, rel=0.02)


@pytest.mark.parametrize("name", MODELS)
def test_tables_from_memory_give_the_compiled_in_models_bits(name):
    parts = []
    for axis in ("direct_theta", "direct_phi", "multiple_theta"):
        t = exr.read(ROOT / "luts" / name / f"{axis}.exr")[0]
        warp = {"uniform": UNIFORM, "octaves": OCTAVES}[t.warp.name]
        texels = np.stack([t.texels, t.slopes], axis=-1)
        parts.append(tables.MemoryTable(texels, t.domain, t.theta_r_range, warp, t.warp.e))
    model = tables.create(*parts, azimuth={"printed": SUM, "fitted": tables.DIFFERENCE}[name])
    for part in parts:
        part.texels[:] = np.nan  # they were copied
    assert loops().same_models(model.pointer, builtin(name).pointer)
    random = np.random.default_rng(3)
    inputs = random.uniform(-2, 2, (2, 10_000)), random.random((2, 10_000))
    tails = 2.0 ** -random.uniform(0, 30, (2, 5_000))
    inputs[1][:, ::2] = np.where(random.random(5_000) < 0.5, tails, 1 - tails)
    for lobe in LOBES:
        one, two = (m.sample(lobe, *inputs[0], *inputs[1]) for m in (model, builtin(name)))
        assert one.tobytes() == two.tobytes()
        place = one["theta_i"], one["phi_i"]
        one, two = (m.pdf(lobe, *inputs[0], *place) for m in (model, builtin(name)))
        assert np.array_equal(one, two)


def test_hooks_own_all_memory():
    allocator = Allocator()
    model = tables.create(allocator=allocator)
    assert allocator.calls == 1
    assert len(allocator.alive) == 1
    model.sample_hair(0.1, 0.2, 0.5, np.linspace(0, 1, 100), 0.4)
    assert allocator.calls == 1
    core().hairlut_free(model.pointer)
    model.owned = False
    assert not allocator.alive


def test_no_memory_is_an_error():
    with pytest.raises(LoadError, match=r"the allocator returned NULL for [0-9]+ bytes") as refusal:
        tables.create(allocator=Allocator(fail_at=0))
    assert refusal.value.result == MEMORY


def test_half_a_pair_of_hooks_is_refused_and_a_zeroed_pair_means_malloc():
    model = Description(two_lobes())
    description = ctypes.byref(model.c)
    half = Allocator().c()
    half.release = tables.Release()
    out, message = ctypes.c_void_p(1), ctypes.create_string_buffer(512)
    create = core().hairlut_model_create
    assert create(description, ctypes.byref(half), ctypes.byref(out), message) == ARGUMENT
    assert b"expected both allocate and release" in message.value
    assert create(description, ctypes.byref(tables.CAllocator()), ctypes.byref(out), None) == OK
    core().hairlut_free(out)


def rough(seed: int) -> tables.MemoryTable:
    """Cells from 1e-12 rad to a radian side by side, others in every row, and every second time slopes over
    all that is accepted: the worst that is accepted."""
    random = np.random.default_rng(seed)
    width, height = int(random.integers(4, 40)), int(random.integers(2, 9))
    rows = np.zeros((height, width), np.float32)
    for row in rows:
        while not (np.diff(row) >= 1e-12).all():
            inner = np.sign(random.uniform(-1, 1, width - 2)) * 10.0 ** random.uniform(-11, 0.1, width - 2)
            row[:] = np.sort(np.concatenate([[-HALF_PI], inner.astype(np.float32), [HALF_PI]]))
    e = 10.0 ** random.uniform(-12, 0)
    texels = with_slopes(rows, tables.knots(width, warp_e=e))
    any_slope = 10.0 ** random.uniform(-8.9, 11.9, rows.shape)
    texels[..., 1] = any_slope if seed % 2 else np.clip(texels[..., 1], 1e-9, 1e12)
    return tables.MemoryTable(texels, warp_e=e)


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
