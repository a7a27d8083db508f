"""Tables as C source: runtime/src/builtin_tables.c, committed so that a C build needs no Python, is what
luts/ exports to, and what is exported is what the loader makes of the textures."""

import ctypes
import os

import pytest
from runtime.by_hand import INCLUDE, SOURCE
from runtime.c_library import FLAGS, MODELS, ROOT, RUNTIME, Model, load, loops, run, tool


def test_exporting_the_tables_again_gives_the_same_bytes(tmp_path):
    directories = [f"luts/{model}" for model in MODELS]
    out = tmp_path / "builtin_tables.c"
    run(tool("hairlut"), "export", *directories, "--to", "c", "--out", out, cwd=ROOT)
    assert out.read_bytes() == (RUNTIME / "src" / "builtin_tables.c").read_bytes(), (
        f"out of date: hairlut export {' '.join(directories)} --to c --out runtime/src/builtin_tables.c"
    )


def exported(directory) -> Model:
    """The model of a directory, compiled in: builtin.c with what the directory exports to as its tables."""
    source, library = directory / "tables.c", directory / "tables.so"
    run(tool("hairlut"), "export", directory, "--to", "c", "--out", source)
    run(os.environ.get("CC", "cc"), *FLAGS, "-fPIC", "-shared", *INCLUDE, SOURCE / "builtin.c", source,
        "-o", library)  # fmt: skip
    builtin = ctypes.CDLL(str(library)).hairlut_builtin
    builtin.restype, builtin.argtypes = ctypes.c_void_p, [ctypes.c_char_p]
    return Model(builtin(directory.name.encode()), "exported", owned=False)


@pytest.mark.usefixtures("loader")
@pytest.mark.parametrize("width", [5, 73, 74, 300, 600])
def test_exported_tables_are_those_that_the_loader_builds(width, tmp_path):
    """Of widths that are searched in small groups, in large ones, and by halving before (73 is the last small
    one; the blocks of 300 and 600 are 32 and 64 cells)."""
    design = "--size", f"{width}x3", "--warp", "octaves e=0.0009765625"
    run(tool("hairlut"), "bake", "--model", "fitted", *design, "--out", tmp_path)
    compiled, loaded = exported(tmp_path / "fitted"), load(tmp_path / "fitted")
    assert loops().same_tables(compiled.pointer, loaded.pointer)
    assert not loops().same_tables(compiled.pointer, load(ROOT / "luts" / "fitted").pointer)
