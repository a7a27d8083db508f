# SPDX-License-Identifier: BSD-3-Clause
"""hairlut_load: the model it returns, its results and messages, its memory, its threads. Which files it
accepts and which it refuses: tests/conformance."""

import ctypes
import re
import threading
from pathlib import Path

import numpy as np
import pytest
from conformance import files
from conformance.cases import KEPT, MIXTURE, MULTIPLE, THETA, bytes_of, compression, put
from conformance.files import Edit
from runtime.c_library import (
    ARGUMENT,
    ATTRIBUTE,
    BUILD,
    FILE,
    HERE,
    MEMORY,
    MODELS,
    OK,
    ROOT,
    TABLE,
    UNSUPPORTED,
    VERSION,
    LoadError,
    builtin,
    core,
    exr,
    load,
    run,
    tool,
)  # fmt: skip
from runtime.tables import Allocate, Allocator

pytestmark = pytest.mark.usefixtures("loader")
SOURCE = ROOT / "luts" / "fitted"


@pytest.fixture(scope="module")
def make_exr():
    """make_exr.cpp, built against the OpenEXR that the loader uses."""
    if not tool("pkg-config") or not tool("c++"):
        pytest.skip("pkg-config or a C++ compiler is not installed: apt-get install pkg-config g++")
    out = BUILD / "tests" / "make_exr"
    out.parent.mkdir(parents=True, exist_ok=True)
    flags = run("pkg-config", "--cflags", "--libs", "OpenEXR").stdout.split()
    run("c++", "-std=c++17", HERE / "make_exr.cpp", *flags, "-o", out)
    return out


def directory_of(tmp_path: Path, of_format: int) -> Path:
    """A copy of a good model's directory, for tests that change it."""
    write = files.write_format_1 if of_format == 1 else files.write_format_2
    return write(tmp_path / f"model{of_format}", SOURCE)


def draws(model) -> bytes:
    """A thousand of each lobe, and of the whole hair."""
    theta_r, phi_r = np.random.default_rng(5).uniform(-1.5, 1.5, (2, 1000)).astype(np.float32)
    u = np.random.default_rng(6).random((3, 1000)).astype(np.float32)
    lobes = [model.sample(lobe, theta_r, phi_r, *u[:2]).tobytes() for lobe in ("direct", "multiple")]
    return b"".join([*lobes, model.sample_hair(theta_r, phi_r, *u, offset=u[1]).tobytes()])


@pytest.mark.parametrize("name", MODELS)
def test_shipped_files_draw_what_the_compiled_in_model_draws(name):
    assert draws(load(ROOT / "luts" / name)) == draws(builtin(name))


@pytest.mark.parametrize("of_format", [1, 2])
@pytest.mark.parametrize("number", range(len(KEPT)), ids=KEPT)
def test_files_of_the_loaders_own_openexr(tmp_path, make_exr, of_format, number):
    directory = directory_of(tmp_path, of_format)
    expected = draws(load(directory))
    for path in directory.iterdir():
        copy = path.with_suffix(".copy")
        run(make_exr, path, copy, str(number))
        copy.replace(path)
    assert draws(load(directory)) == expected


RESULTS = [
    (2, THETA, Edit(header={"hairlut.format": 3}), VERSION, "use a newer hairlut library"),
    (2, MIXTURE, Edit(header={"hairlut.format": 3}), VERSION, "use a newer hairlut library"),
    (2, THETA, Edit(drop=("hairlut.warp",)), ATTRIBUTE, "hairlut.warp is missing"),
    (2, THETA, Edit(header={"hairlut.warp": "cubic"}), ATTRIBUTE, "hairlut.warp is 'cubic': expected 'uni"),
    (2, THETA, Edit(header={"hairlut.table": "x"}), ATTRIBUTE, "is 'x': expected 'direct_theta'"),
    (2, THETA, put("Y", (3, 4), np.nan), TABLE, "row 3, columns 3 and 4"),
    (2, THETA, put("dxdu", (3, 4), 0.0), TABLE, "row 3, column 4: dx/du is 0: expected 1e-09 to 1e+12"),
    (2, MIXTURE, put("direct.share", (1, 2), -1), TABLE, "share of lobe 0 at theta_r node 1, offset node 2"),
    (
        2,
        THETA,
        compression("PIZ"),
        UNSUPPORTED,
        "compression is PIZ (number 4): expected NONE, RLE, ZIPS or Z",
    ),
    (1, MULTIPLE, compression("ZSTD"), UNSUPPORTED, "compression is a newer one (number 13)"),
    (2, MIXTURE, compression("B44"), UNSUPPORTED, "write it with ZIP"),
    (2, THETA, bytes_of(b"P6 4 4 255\n"), FILE, "expected a whole OpenEXR image"),
    (2, MULTIPLE, Edit(whole=Path.unlink), FILE, "cannot be opened"),
    (2, MIXTURE, Edit(whole=Path.unlink), ATTRIBUTE, "expected 1, as there is no mixture.exr beside it"),
]


@pytest.mark.parametrize(("of_format", "file", "edit", "result", "text"), RESULTS)
def test_results_and_remedies(tmp_path, of_format, file, edit, result, text):
    directory = directory_of(tmp_path, of_format)
    edit.apply(directory / file)
    with pytest.raises(LoadError) as refusal:
        load(directory)
    assert refusal.value.result == result, refusal.value.message
    assert text in refusal.value.message
    assert re.search(r"; (bake|write|use|check|give|do) |bake", refusal.value.message)


@pytest.mark.parametrize("of_format", [1, 2])
def test_a_file_cut_anywhere_is_refused(tmp_path, of_format):
    directory = directory_of(tmp_path, of_format)
    for path in (directory / MULTIPLE, directory / MIXTURE)[:of_format]:
        whole = path.read_bytes()
        for length in [*range(0, 64, 7), *range(64, len(whole), 97), len(whole) - 1]:
            path.write_bytes(whole[:length])
            with pytest.raises(LoadError, match=re.escape(f"{path.name}: ")) as refusal:
                load(directory)
            assert refusal.value.result in (FILE, ATTRIBUTE, MEMORY, TABLE), length
        path.write_bytes(whole)


def test_null_arguments_are_errors_not_crashes():
    out, message = ctypes.c_void_p(1), ctypes.create_string_buffer(512)
    library = exr()
    assert library.hairlut_load_with(None, None, ctypes.byref(out), message) == ARGUMENT
    assert message.value == b"directory is NULL"
    assert out.value is None
    assert library.hairlut_load_with(b"luts", None, None, message) == ARGUMENT
    assert message.value == b"out is NULL"
    assert library.hairlut_load(b"no/such/directory", ctypes.byref(out)) == FILE
    half = Allocator().c()
    half.allocate = Allocate()
    assert library.hairlut_load_with(b"luts", ctypes.byref(half), ctypes.byref(out), message) == ARGUMENT


@pytest.mark.parametrize(
    ("edit", "text"),
    [
        (
            Edit(header={"hairlut.unit": "deg"}),
            "direct_theta.exr: hairlut.unit is 'deg': expected 'rad'",
        ),
        (put("dxdu", (3, 4), 0.5), "direct_theta.exr: hairlut.digest is"),
    ],
)
def test_a_message_keeps_file_and_attribute_of_a_long_path(tmp_path, edit, text):
    deep = tmp_path
    for _ in range(6):
        deep = deep / ("d" * 60)
    deep.mkdir(parents=True)
    directory = directory_of(deep, 2)
    edit.apply(directory / THETA)
    with pytest.raises(LoadError) as refusal:
        load(directory)
    assert refusal.value.message.startswith("...")
    assert text in refusal.value.message


def load_with(folder, allocator: Allocator) -> tuple[int, ctypes.c_void_p, bytes]:
    out, message = ctypes.c_void_p(1), ctypes.create_string_buffer(512)
    hooks = allocator.c()
    result = exr().hairlut_load_with(str(folder).encode(), ctypes.byref(hooks), ctypes.byref(out), message)
    return result, out, message.value


# a path, the texels of each table, the nodes of a mixture, and the model
ALLOCATIONS = {1: 5, 2: 6}


@pytest.mark.parametrize("of_format", [1, 2])
def test_hooks_serve_every_allocation_and_get_everything_back(tmp_path, of_format):
    allocator = Allocator()
    result, out, _ = load_with(directory_of(tmp_path, of_format), allocator)
    assert result == OK
    assert allocator.calls == ALLOCATIONS[of_format]
    assert len(allocator.alive) == 1
    core().hairlut_free(out)
    assert not allocator.alive


@pytest.mark.parametrize("of_format", [1, 2])
def test_no_memory_anywhere_is_an_error_and_leaks_nothing(tmp_path, of_format):
    directory = directory_of(tmp_path, of_format)
    for fail_at in range(ALLOCATIONS[of_format]):
        allocator = Allocator(fail_at=fail_at)
        result, out, message = load_with(directory, allocator)
        assert result == MEMORY
        assert out.value is None
        assert re.search(rb"the allocator returned NULL for \d+ bytes", message)
        assert not allocator.alive


def test_refusals_leak_nothing(tmp_path):
    directory = directory_of(tmp_path, 2)
    Edit(header={"hairlut.unit": "deg"}).apply(directory / MULTIPLE)
    allocator = Allocator()
    assert load_with(directory, allocator)[0] == ATTRIBUTE
    assert allocator.calls == 4
    assert not allocator.alive


def test_lobes_that_share_a_table_share_its_memory(tmp_path):
    directory = directory_of(tmp_path, 2)
    header, _ = files.read(directory / MIXTURE)
    shared = {"hairlut.lobe.multiple": header["hairlut.lobe.direct"].partition(" direct_phi")[0]}
    Edit(header=shared).apply(directory / MIXTURE)
    allocator = Allocator()
    result, out, _ = load_with(directory, allocator)
    assert result == OK
    assert allocator.calls == ALLOCATIONS[2] - 1
    core().hairlut_free(out)


def test_the_loader_uses_no_function_that_depends_on_the_locale():
    """strtod and friends read a decimal comma; what the library imports shows that none is called."""
    for library in ("libhairlut.so", "libhairlut_exr.so"):
        listing = run("nm", "-D", "--undefined-only", BUILD / "runtime" / library).stdout
        assert not re.search(r"\b(strto[dfl]\w*|ato[fil]|\w*scanf|setlocale)\b", listing)


def test_threads_may_load_at_once(tmp_path):
    directory = directory_of(tmp_path, 2)
    expected, failures = draws(load(directory)), []

    def work() -> None:
        for _ in range(20):
            if draws(load(directory)) != expected:
                failures.append(1)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures
