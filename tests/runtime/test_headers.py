# SPDX-License-Identifier: BSD-3-Clause
"""The headers compile alone, in C99 and in C++17, without a warning; the symbols are the header's."""

import re
import subprocess

import pytest
from runtime.c_library import HERE, OK, RUNTIME, UNSUPPORTED, build, core, has_exr, run, tool

CONSUMERS = HERE / "consumers"
STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]
HEADERS = sorted((RUNTIME / "include").glob("*.h"))


def compiler(name: str) -> str:
    """Its path; skips where it is not installed."""
    path = tool(name)
    if not path:
        pytest.skip(f"{name} is not installed")
    return path


@pytest.mark.parametrize("name", ["gcc", "clang"])
@pytest.mark.parametrize("header", HEADERS, ids=lambda header: header.name)
def test_every_header_compiles_alone_as_c99(tmp_path, name, header):
    source = tmp_path / "alone.c"
    source.write_text(f'#include "{header.name}"\nint alone(void);\nint alone(void) {{ return 0; }}\n')
    run(compiler(name), "-std=c99", *STRICT, f"-I{header.parent}", "-c", source, "-o", tmp_path / "alone.o")


@pytest.mark.parametrize(
    ("name", "standard", "file"),
    [
        ("gcc", "c99", "c99.c"),
        ("clang", "c99", "c99.c"),
        ("gcc", "c11", "c99.c"),
        ("g++", "c++17", "cxx17.cpp"),
        ("clang++", "c++17", "cxx17.cpp"),
    ],
)
def test_programs_compile_without_a_warning_and_run(tmp_path, name, standard, file):
    out = tmp_path / "program"
    run(compiler(name), f"-std={standard}", *STRICT, f"-I{RUNTIME / 'include'}", CONSUMERS / file,
        build() / "libhairlut.a", "-lm", "-o", out)  # fmt: skip
    run(out)


@pytest.mark.parametrize("name", ["gcc", "clang"])
def test_sources_compile_without_a_warning(tmp_path, name):
    for source in sorted((RUNTIME / "src").glob("*.c")):
        if source.name.startswith("exr") or re.search(r"avx|neon", source.name):
            continue
        run(compiler(name), "-std=c99", *STRICT, "-O2", f"-I{RUNTIME / 'include'}", "-c", source,
            "-o", tmp_path / "out.o")  # fmt: skip


def declared(macro: str) -> set[str]:
    """Functions that hairlut.h and hairlut_version.h declare with an export macro."""
    text = "".join(header.read_text() for header in HEADERS)
    return set(re.findall(rf"\n{macro} [\w\s]*?[\w*]*\b(hairlut_\w+)\(", text))


def exported(library: str) -> set[str]:
    """Symbols that a shared library defines for others."""
    nm = compiler("nm")
    listing = subprocess.run(
        [nm, "-D", "--defined-only", build() / library], text=True, capture_output=True, check=True
    )
    return {line.split()[-1] for line in listing.stdout.splitlines()}


def listed(library: str) -> set[str]:
    """What runtime/src/exports.txt promises of a library."""
    lines = (RUNTIME / "src" / "exports.txt").read_text().splitlines()
    words = [line.split() for line in lines if not line.startswith("#")]
    assert words == sorted(words)
    return {symbol for owner, symbol in words if owner == library}


@pytest.mark.parametrize(
    ("library", "macro"), [("hairlut", "HAIRLUT_API"), ("hairlut_exr", "HAIRLUT_EXR_API")]
)
def test_libraries_export_the_listed_and_declared_functions_and_nothing_else(library, macro):
    if library == "hairlut_exr" and not has_exr():
        pytest.skip("hairlut_exr was not built: OpenEXR >= 3.1 was not found")
    assert exported(f"lib{library}.so") == declared(macro) == listed(library)


def test_every_result_has_a_text():
    texts = {core().hairlut_result_string(result) for result in range(OK, UNSUPPORTED + 1)}
    assert len(texts) == UNSUPPORTED + 1
    for wrong in (-1, UNSUPPORTED + 1, 1000):
        assert core().hairlut_result_string(wrong) == b"unknown result"


def test_version_of_the_library_is_the_headers():
    text = (RUNTIME / "include" / "hairlut_version.h").read_text()
    major, minor, patch = (
        int(re.search(rf"HAIRLUT_VERSION_{part} (\d+)", text)[1]) for part in ("MAJOR", "MINOR", "PATCH")
    )
    assert core().hairlut_version() == major * 10000 + minor * 100 + patch


def test_libraries_name_their_major_version():
    readelf = compiler("readelf")
    text = run(readelf, "-d", build() / "libhairlut.so").stdout
    assert f"Library soname: [libhairlut.so.{core().hairlut_version() // 10000}]" in text


def test_core_depends_on_the_c_library_alone():
    readelf = compiler("readelf")
    needed = re.findall(r"\(NEEDED\).*\[(.*)\]", run(readelf, "-d", build() / "libhairlut.so").stdout)
    assert set(needed) <= {"libc.so.6", "libm.so.6"}
