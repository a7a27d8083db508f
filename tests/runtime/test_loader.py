"""hairlut_load: good files whoever wrote them; all others are refused, with file, attribute and remedy."""

import ctypes
import re
import shutil
import threading

import numpy as np
import OpenEXR
import pytest
from runtime.c_library import (
    ARGUMENT,
    ATTRIBUTE,
    AXES,
    BUILD,
    FILE,
    HERE,
    MEMORY,
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
from runtime.tables import Allocator, copy_model, rewrite

from runtime import tables

pytestmark = pytest.mark.usefixtures("loader")
COMPRESSIONS = {
    "NONE": OpenEXR.NO_COMPRESSION,
    "RLE": OpenEXR.RLE_COMPRESSION,
    "ZIPS": OpenEXR.ZIPS_COMPRESSION,
    "ZIP": OpenEXR.ZIP_COMPRESSION,
    "PIZ": OpenEXR.PIZ_COMPRESSION,
}


@pytest.fixture(scope="module")
def make_exr():
    """make_exr.cpp, built against the OpenEXR that the loader uses."""
    if not tool("pkg-config"):
        pytest.skip("pkg-config is not installed: apt-get install pkg-config")
    out = BUILD / "tests" / "make_exr"
    out.parent.mkdir(parents=True, exist_ok=True)
    flags = run("pkg-config", "--cflags", "--libs", "OpenEXR").stdout.split()
    run("c++", "-std=c++17", HERE / "make_exr.cpp", *flags, "-o", out)
    return out


def same_samples(model, name: str) -> bool:
    """Whether a model draws what the compiled-in one of that name draws."""
    inputs = (
        np.random.default_rng(5).uniform(-1.5, 1.5, (2, 1000)),
        np.random.default_rng(6).random((2, 1000)),
    )
    one, two = (m.sample("direct", *inputs[0], *inputs[1]) for m in (model, builtin(name)))
    return one.tobytes() == two.tobytes()


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_files_of_the_newest_openexr_load_in_every_lossless_compression(tmp_path, compression):
    folder = copy_model(tmp_path)
    for axis in AXES:
        rewrite(folder / f"{axis}.exr", {"compression": COMPRESSIONS[compression]})
    assert same_samples(load(folder), "fitted")


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_files_of_the_loaders_own_openexr_load_in_every_lossless_compression(tmp_path, make_exr, compression):
    folder = tmp_path / "printed"
    folder.mkdir()
    for axis in AXES:
        source = ROOT / "luts" / "printed" / f"{axis}.exr"
        run(make_exr, source, folder / f"{axis}.exr", str(list(COMPRESSIONS).index(compression)))
    assert same_samples(load(folder), "printed")


def test_rows_may_be_stored_from_the_last_to_the_first(tmp_path):
    folder = copy_model(tmp_path)
    rewrite(folder / "direct_phi.exr", {"lineOrder": OpenEXR.DECREASING_Y})
    assert same_samples(load(folder), "fitted")


def test_attributes_of_others_are_ignored(tmp_path):
    folder = copy_model(tmp_path)
    rewrite(
        folder / "direct_phi.exr", {"owner": "someone", "hairlut.comment": "x" * 5000, "capDate": "today"}
    )
    assert same_samples(load(folder), "fitted")


def refused(folder, result: int, *texts: str, file="direct_theta.exr") -> None:
    """Loading must fail with that result, and say the file and every text."""
    with pytest.raises(LoadError) as refusal:
        load(folder)
    assert refusal.value.result == result, refusal.value.message
    for text in (file, *texts):
        assert text in refusal.value.message, refusal.value.message


NEEDED = ["format", "model", "table", "angle", "unit", "azimuth", "warp", "cell"]
NEEDED += ["theta_r_range", "domain", "knots"]
ATTRIBUTES = [f"hairlut.{name}" for name in NEEDED]


@pytest.mark.parametrize("attribute", ATTRIBUTES)
def test_a_missing_attribute_is_named(tmp_path, attribute):
    folder = copy_model(tmp_path)
    rewrite(folder / "direct_theta.exr", drop=[attribute])
    refused(folder, ATTRIBUTE, attribute, "is missing", "bake the table again")


@pytest.mark.parametrize("attribute", ATTRIBUTES)
def test_an_attribute_of_another_type_is_named(tmp_path, attribute):
    folder = copy_model(tmp_path)
    value = "1" if attribute == "hairlut.format" else 3
    rewrite(folder / "direct_theta.exr", {attribute: value})
    refused(folder, ATTRIBUTE, attribute, "is not a")


VALUES = [
    ("format", 2, VERSION, "is 2: expected at most 1; use a newer hairlut library"),
    ("format", 2**31 - 1, VERSION, "is 2147483647"),
    ("format", 0, ATTRIBUTE, "is 0: expected 1"),
    ("format", -1, ATTRIBUTE, "is -1: expected 1"),
    ("unit", "deg", ATTRIBUTE, "is 'deg': expected 'rad'"),
    ("unit", "radians", ATTRIBUTE, "is 'radians': expected 'rad'"),
    ("angle", "phi", ATTRIBUTE, "is 'phi': expected 'theta_i'"),
    ("azimuth", "sum", ATTRIBUTE, "is 'sum': expected 'none'"),
    ("model", "", ATTRIBUTE, "expected a name"),
    ("model", "m" * 64, ATTRIBUTE, "expected a name"),
    ("warp", "cubic", ATTRIBUTE, "is 'cubic': expected 'uniform' or 'octaves e=NUMBER'"),
    ("warp", "octaves e=", ATTRIBUTE, "expected"),
    ("warp", "octaves e=1e-5 ", ATTRIBUTE, "expected"),
    ("warp", "octaves e=0x1p-18", ATTRIBUTE, "expected"),
    ("warp", "octaves e=nan", ATTRIBUTE, "expected"),
    ("warp", "octaves e=inf", ATTRIBUTE, "expected"),
    ("warp", "octaves e=1e999999999999", ATTRIBUTE, "expected"),
    ("warp", "octaves e=1e-13", ATTRIBUTE, "expected e from 1e-12 to 1"),
    ("warp", "octaves e=-1", ATTRIBUTE, "expected e from 1e-12 to 1"),
    ("warp", "octaves e=0.5", ATTRIBUTE, "hairlut.knots, column 1"),
    ("warp", "uniform", ATTRIBUTE, "hairlut.knots, column 1"),
    ("cell", "cubic", ATTRIBUTE, "expected 'linear' or 'parabola limit=NUMBER'"),
    ("cell", "parabola limit=0.96", ATTRIBUTE, "expected"),
    ("cell", "parabola limit=-0.1", ATTRIBUTE, "expected"),
    ("theta_r_range", "-1.57", ATTRIBUTE, "expected two increasing angles in radians"),
    ("theta_r_range", "1.57 -1.57", ATTRIBUTE, "expected two increasing angles"),
    ("theta_r_range", "-90 90", ATTRIBUTE, "expected two increasing angles in radians"),
    ("theta_r_range", "-1.57 1.57 2", ATTRIBUTE, "expected two increasing angles"),
    ("theta_r_range", "-1,57 1,57", ATTRIBUTE, "expected two increasing angles"),
    ("domain", "0 1", TABLE, "expected the whole domain"),
    ("domain", "-inf inf", ATTRIBUTE, "expected two increasing angles"),
    ("knots", "", ATTRIBUTE, "holds 0 numbers"),
    ("knots", "0.0 0.5 1.0", ATTRIBUTE, "hairlut.knots, column 1"),
    ("knots", "0" * 300, ATTRIBUTE, "holds 0 numbers"),
    ("table", "direct_phi", ATTRIBUTE, "is 'direct_phi': expected 'direct_theta'"),
]


@pytest.mark.parametrize(("attribute", "value", "result", "text"), VALUES)
def test_a_wrong_value_is_shown_with_what_was_expected(tmp_path, attribute, value, result, text):
    folder = copy_model(tmp_path)
    rewrite(folder / "direct_theta.exr", {f"hairlut.{attribute}": value})
    refused(folder, result, text, "" if "knots" in text or result == TABLE else f"hairlut.{attribute}")


def test_knots_are_held_to_a_millionth_of_the_tail(tmp_path):
    folder = copy_model(tmp_path)
    path = folder / "direct_theta.exr"
    with OpenEXR.File(str(path)) as file:
        knots = file.header()["hairlut.knots"].split()
    for i, factor in ((1, 1 + 3e-6), (len(knots) // 3, 1 - 3e-6)):
        wrong = list(knots)
        wrong[i] = repr(float(knots[i]) * factor)
        rewrite(path, {"hairlut.knots": " ".join(wrong)})
        refused(folder, ATTRIBUTE, f"hairlut.knots, column {i}", "by hairlut.warp")
    rewrite(path, {"hairlut.knots": " ".join([*knots, "1.0"])})
    refused(folder, ATTRIBUTE, f"more than {len(knots)} numbers")
    rewrite(path, {"hairlut.knots": " ".join(knots[:-1])})
    refused(folder, ATTRIBUTE, f"holds {len(knots) - 1} numbers: expected {len(knots)}")
    rewrite(path, {"hairlut.knots": " ".join(f"{float(u):.12g}" for u in knots)})
    load(folder)


def test_direct_phi_must_say_which_azimuth_it_holds(tmp_path):
    folder = copy_model(tmp_path)
    rewrite(folder / "direct_phi.exr", {"hairlut.azimuth": "none"})
    refused(
        folder, ATTRIBUTE, "hairlut.azimuth is 'none': expected 'sum' or 'difference'", file="direct_phi.exr"
    )


def test_a_renamed_file_is_refused(tmp_path):
    folder = copy_model(tmp_path)
    shutil.copy(folder / "multiple_theta.exr", folder / "direct_theta.exr")
    refused(
        folder, ATTRIBUTE, "hairlut.table is 'multiple_theta': expected 'direct_theta'", "its own name back"
    )


def test_a_table_of_another_model_is_refused(tmp_path):
    folder = copy_model(tmp_path)
    shutil.copy(ROOT / "luts" / "printed" / "multiple_theta.exr", folder / "multiple_theta.exr")
    refused(folder, ATTRIBUTE, "hairlut.model is 'printed': expected 'fitted'", file="multiple_theta.exr")


@pytest.mark.parametrize("axis", AXES)
def test_a_missing_file_is_named(tmp_path, axis):
    folder = copy_model(tmp_path)
    (folder / f"{axis}.exr").unlink()
    refused(folder, FILE, "cannot be opened", file=f"{axis}.exr")


def test_a_file_cut_anywhere_is_refused(tmp_path):
    folder = copy_model(tmp_path)
    path = folder / "multiple_theta.exr"
    whole = path.read_bytes()
    for length in [*range(0, 64, 7), *range(64, len(whole), 97), len(whole) - 1]:
        path.write_bytes(whole[:length])
        with pytest.raises(LoadError, match=r"multiple_theta\.exr: ") as refusal:
            load(folder)
        assert refusal.value.result in (FILE, ATTRIBUTE, MEMORY), length


def test_what_is_no_openexr_file_is_refused(tmp_path):
    folder = copy_model(tmp_path)
    for content in (b"", b"hello", b"P6 4 4 255\n", b"\x76\x2f\x31\x01", bytes(5000)):
        (folder / "direct_theta.exr").write_bytes(content)
        refused(folder, FILE, "expected an OpenEXR image")


def moved(name: str):
    """A header's change that moves a window by one texel."""
    return lambda header: {name: tuple(corner + np.array([1, 0], np.int32) for corner in header[name])}


TILED = {"type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()}
LAYOUTS = {
    "half": (lambda x: {"Y": x.astype(np.float16)}, {}, "one 32-bit FLOAT channel named Y"),
    "uint": (lambda x: {"Y": x.astype(np.uint32)}, {}, "one 32-bit FLOAT channel named Y"),
    "another name": (lambda x: {"R": x}, {}, "one 32-bit FLOAT channel named Y"),
    "two channels": (lambda x: {"Y": x, "A": x}, {}, "one 32-bit FLOAT channel named Y"),
    "cropped": (None, moved("dataWindow"), "start at (0, 0)"),
    "moved display": (None, moved("displayWindow"), "start at (0, 0)"),
    "tiled": (None, TILED, "expected a scanline image"),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_other_layouts_are_refused(tmp_path, layout):
    folder = copy_model(tmp_path)
    channels, change, text = LAYOUTS[layout]
    rewrite(folder / "direct_theta.exr", change, channels=channels)
    refused(folder, ATTRIBUTE, text)


def test_two_parts_are_refused(tmp_path):
    folder = copy_model(tmp_path)
    path = folder / "direct_theta.exr"
    with OpenEXR.File(str(path), separate_channels=True) as file:
        header, pixels = dict(file.header()), np.array(file.channels()["Y"].pixels)
    header = {name: value for name, value in header.items() if name != "channels"}
    parts = [OpenEXR.Part({**header, "name": name}, {"Y": pixels}) for name in ("one", "two")]
    OpenEXR.File(parts).write(str(path))
    refused(folder, ATTRIBUTE, "it has 2 parts: expected 1")


TEXELS = {
    "NaN": (lambda x: put(x, (3, 4), np.nan), "row 3, columns 3 and 4"),
    "infinite": (lambda x: put(x, (3, 4), np.inf), "row 3, columns 4 and 5"),
    "not increasing": (lambda x: put(x, (5, 7), x[5, 6]), "row 5, columns 6 and 7"),
    "reversed": (lambda x: x[:, ::-1], "row 0, columns 0 and 1"),
    "short of the domain": (lambda x: put(x, (2, -1), x[2, -1] - 1e-6), "row 2 runs from"),
    "three columns": (lambda x: x[:, :3], "expected 4 x 2 to 4096 x 4096"),
    "one row": (lambda x: x[:1], "expected 4 x 2 to 4096 x 4096"),
    "too wide": (lambda x: np.zeros((2, 4097), np.float32), "expected 4 x 2 to 4096 x 4096"),
}


def put(x: np.ndarray, place, value) -> np.ndarray:
    x[place] = value
    return x


@pytest.mark.parametrize("case", TEXELS)
def test_texels_that_are_no_table_are_refused(tmp_path, case):
    folder = copy_model(tmp_path)
    change, text = TEXELS[case]
    path = folder / "direct_theta.exr"
    drop = ("dataWindow", "displayWindow")
    rewrite(path, texels=change, drop=drop)
    refused(folder, TABLE, text)


@pytest.mark.parametrize("compression", ["DWAA", "DWAB"])
def test_a_compression_that_openexr_lacks_is_no_crash(tmp_path, compression):
    folder = copy_model(tmp_path)
    rewrite(folder / "direct_theta.exr", {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION")})
    with pytest.raises(LoadError, match=r"direct_theta\.exr: ") as refusal:
        load(folder)
    assert refusal.value.result in (UNSUPPORTED, FILE, TABLE)  # newer libraries read it, lossily


def test_lossy_float24_is_refused_or_read_as_what_it_is(tmp_path):
    folder = copy_model(tmp_path)
    rewrite(folder / "direct_theta.exr", {"compression": OpenEXR.PXR24_COMPRESSION})
    with pytest.raises(LoadError, match=r"direct_theta\.exr: "):
        load(folder)


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
    half.allocate = tables.Allocate()
    assert library.hairlut_load_with(b"luts", ctypes.byref(half), ctypes.byref(out), message) == ARGUMENT


def test_a_message_keeps_file_and_attribute_of_a_long_path(tmp_path):
    deep = tmp_path
    for _ in range(6):
        deep = deep / ("d" * 60)
    deep.mkdir(parents=True)
    folder = copy_model(deep)
    rewrite(folder / "direct_theta.exr", {"hairlut.unit": "deg"})
    refused(folder, ATTRIBUTE, "...", "fitted/direct_theta.exr: hairlut.unit is 'deg': expected 'rad'; bake")


def load_with(folder, allocator: Allocator) -> tuple[int, ctypes.c_void_p, bytes]:
    out, message = ctypes.c_void_p(1), ctypes.create_string_buffer(512)
    hooks = allocator.c()
    result = exr().hairlut_load_with(str(folder).encode(), ctypes.byref(hooks), ctypes.byref(out), message)
    return result, out, message.value


def test_hooks_serve_every_allocation_and_get_everything_back():
    allocator = Allocator()
    result, out, _ = load_with(ROOT / "luts" / "fitted", allocator)
    assert result == OK
    assert allocator.calls == 7  # a path and texels for each file, and the model
    assert len(allocator.alive) == 1
    core().hairlut_free(out)
    assert not allocator.alive


@pytest.mark.parametrize("fail_at", range(7))
def test_no_memory_anywhere_is_an_error_and_leaks_nothing(fail_at):
    allocator = Allocator(fail_at=fail_at)
    result, out, message = load_with(ROOT / "luts" / "fitted", allocator)
    assert result == MEMORY
    assert out.value is None
    assert re.search(rb"the allocator returned NULL for \d+ bytes", message)
    assert not allocator.alive


def test_refusals_leak_nothing(tmp_path):
    folder = copy_model(tmp_path)
    rewrite(folder / "multiple_theta.exr", {"hairlut.unit": "deg"})
    allocator = Allocator()
    assert load_with(folder, allocator)[0] == ATTRIBUTE
    assert allocator.calls == 5
    assert not allocator.alive


def test_the_loader_uses_no_function_that_depends_on_the_locale():
    """strtod and friends read a decimal comma; what the library imports shows that none is called."""
    for library in ("libhairlut.so", "libhairlut_exr.so"):
        listing = run("nm", "-D", "--undefined-only", BUILD / "runtime" / library).stdout
        assert not re.search(r"\b(strto[dfl]\w*|ato[fil]|\w*scanf|setlocale)\b", listing)


def test_threads_may_load_at_once():
    failures = []

    def work() -> None:
        for _ in range(20):
            if not same_samples(load(ROOT / "luts" / "printed"), "printed"):
                failures.append(1)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures
