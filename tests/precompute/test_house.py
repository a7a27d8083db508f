# SPDX-License-Identifier: BSD-3-Clause
"""The tree stays in order: imports go one way, and the folders that an engine copies contain nothing else."""

import ast
import subprocess
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from precompute.conftest import LUTS, ROOT

PACKAGE = ROOT / "precompute" / "hairlut"


def imports(source: str, module: str, is_package: bool, top_only: bool = True) -> set[str]:
    """The modules of hairlut that a module's source imports: when it is loaded, or at all."""
    tree = ast.parse(source)
    nodes = list(_when_loaded(tree)) if top_only else list(ast.walk(tree))
    found = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = module.split(".")[: len(module.split(".")) + is_package - node.level] if node.level else []
            name = ".".join([*base, *([node.module] if node.module else [])])
            found |= {name, *(f"{name}.{alias.name}" for alias in node.names)}
    return {name for name in found if name.split(".")[0] == "hairlut"}


def _when_loaded(node: ast.AST):
    """Every statement outside functions; those under `if TYPE_CHECKING` count."""
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, (ast.FunctionDef, ast.Lambda)):
            yield child
            yield from _when_loaded(child)


def graph(folder: Path) -> dict[str, set[str]]:
    files = {
        ".".join(("hairlut", *path.relative_to(folder).with_suffix("").parts)).removesuffix(".__init__"): path
        for path in folder.rglob("*.py")
    }
    edges = {
        name: imports(path.read_text(), name, path.name == "__init__.py") for name, path in files.items()
    }
    # a package is loaded before its modules; that alone is no cycle
    return {
        name: {to for to in found if to in files and not name.startswith(f"{to}.")}
        for name, found in edges.items()
    }


def test_no_module_imports_itself_through_others():
    TopologicalSorter(graph(PACKAGE)).prepare()


def test_a_cycle_is_noticed(tmp_path):
    (tmp_path / "a.py").write_text(
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from .b import B\n"
    )
    (tmp_path / "b.py").write_text("from . import a\n")
    with pytest.raises(CycleError):
        TopologicalSorter(graph(tmp_path)).prepare()


def test_the_runtime_imports_nothing_of_the_python_package():
    for path in sorted((ROOT / "runtime").rglob("*.py")):
        if "python" not in path.relative_to(ROOT / "runtime").parts:  # the bindings
            assert not imports(path.read_text(), path.stem, False, top_only=False), path


def test_the_textures_folder_contains_nothing_else():
    files = {path.name if path.suffix != ".exr" else ".exr" for path in LUTS.rglob("*") if path.is_file()}
    assert files <= {".exr", "manifest.json", "FORMAT.md"}


LICENCE = "SPDX-License-Identifier: BSD-3-Clause"
SOURCES = {
    *(".py", ".pyi", ".sh", ".cmake"),
    *(".c", ".cpp", ".h", ".inl", ".cuh", ".glsl", ".hlsl", ".wgsl", ".js"),
}


def licensed(text: str) -> bool:
    """Whether the licence stands in the first line, or in the second behind #! or #version."""
    first, *rest = text.splitlines() or [""]
    return LICENCE in (rest[0] if first.startswith(("#!", "#version")) and rest else first)


def test_every_source_names_its_licence(sources):
    assert [path for path in sources if not licensed((ROOT / path).read_text())] == []


def test_a_missing_licence_is_noticed():
    assert licensed(f"# {LICENCE}\n")
    assert licensed(f"#!/bin/sh\n# {LICENCE}\n")
    assert not licensed("")
    assert not licensed(f"import os\n# {LICENCE}\n")


@pytest.fixture(scope="module")
def files() -> list[str]:
    """The files that git knows, or that it would add."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, text=True,
                            capture_output=True, check=False)  # fmt: skip
    if listed.returncode != 0:
        pytest.skip("not a git checkout")
    return [name for name in listed.stdout.splitlines() if (ROOT / name).is_file()]


@pytest.fixture(scope="module")
def sources(files) -> list[str]:
    return [name for name in files if Path(name).suffix in SOURCES or Path(name).name == "CMakeLists.txt"]


PROGRAMS = (
    *(b"\x7fELF", b"MZ", b"!<arch>\n", b"\x64\x86", b"\x64\xaa"),  # Linux; Windows; archives; objects of MSVC
    *(b"\xcf\xfa\xed\xfe", b"\xce\xfa\xed\xfe", b"\xca\xfe\xba\xbe"),  # macOS
)


def is_program(path: Path) -> bool:
    """Whether a file begins as programs, libraries and object files do."""
    return path.read_bytes().startswith(PROGRAMS)


def test_no_program_or_object_file_is_kept(files):
    assert [name for name in files if is_program(ROOT / name)] == []


def test_an_object_file_is_noticed(tmp_path):
    (tmp_path / "table").write_bytes(b"\x7fELF\2\1\1" + bytes(9))
    (tmp_path / "table.c").write_text("int table;\n")
    assert is_program(tmp_path / "table")
    assert not is_program(tmp_path / "table.c")
