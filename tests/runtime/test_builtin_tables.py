# SPDX-License-Identifier: BSD-3-Clause
"""Compiled-in tables: runtime/src/builtin_tables.c, committed so that a C build needs neither Python nor
OpenEXR, is what runtime/tools/embed.c makes of luts/, and that is what the loader builds of the textures."""

import ctypes
import os
from pathlib import Path

import pytest
from runtime.by_hand import INCLUDE, SOURCE
from runtime.c_library import BUILTIN, FLAGS, ROOT, Model, build, builtin, load, loops, run, tool

pytestmark = pytest.mark.usefixtures("loader")
LARGEST_LIBRARY = 1_100_000  # bytes, of which a set of kernels takes 0.2 MB


@pytest.fixture(scope="module")
def embed() -> Path:
    """The tool, built."""
    run(tool("cmake"), "--build", build(), "--target", "embed")
    return build() / "embed"


def test_embedding_the_tables_again_gives_the_same_bytes(embed):
    text = run(embed, *(f"luts/{model}" for model in BUILTIN), cwd=ROOT).stdout
    assert text == (SOURCE / "builtin_tables.c").read_text(), "out of date: make builtin"


@pytest.mark.parametrize("name", BUILTIN)
def test_compiled_in_models_are_those_that_the_loader_builds(name):
    assert loops().same_models(builtin(name).pointer, load(ROOT / "luts" / name).pointer)


def embedded(embed: Path, directory: Path) -> Model:
    """The model of a directory, compiled in: builtin.c with what embed makes of the directory."""
    source, library = directory / "tables.c", directory / "tables.so"
    source.write_text(run(embed, directory).stdout)
    run(os.environ.get("CC", "cc"), *FLAGS, "-fPIC", "-shared", *INCLUDE, SOURCE / "builtin.c", source,
        "-o", library)  # fmt: skip
    find = ctypes.CDLL(str(library)).hairlut_builtin
    find.restype, find.argtypes = ctypes.c_void_p, [ctypes.c_char_p]
    return Model(find(directory.name.encode()), "embedded", owned=False)


@pytest.mark.parametrize("width", [5, 73, 74, 300, 600])
def test_embedded_tables_of_every_layout_are_those_that_the_loader_builds(embed, width, tmp_path):
    """Of widths that are searched in small groups, in large ones, and by halving before (73 is the last small
    one; the blocks of 300 and 600 are 32 and 64 cells)."""
    design = "--size", f"{width}x3", "--warp", "octaves e=0.0009765625"
    run(tool("hairlut"), "bake", "--model", "fitted", *design, "--out", tmp_path)
    compiled, loaded = embedded(embed, tmp_path / "fitted"), load(tmp_path / "fitted")
    assert loops().same_models(compiled.pointer, loaded.pointer)
    assert not loops().same_models(compiled.pointer, load(ROOT / "luts" / "fitted").pointer)


def test_wrong_use_of_the_tool_is_an_error(embed, tmp_path):
    with pytest.raises(AssertionError, match="use: embed DIRECTORY"):
        run(embed)
    with pytest.raises(AssertionError, match=r"embed: .*mixture|embed: .*\.exr"):
        run(embed, tmp_path)


def test_the_library_stays_small():
    assert (build() / "libhairlut.so").stat().st_size < LARGEST_LIBRARY
