# SPDX-License-Identifier: BSD-3-Clause
"""A program compiled with the library's sources file by file, with flags and kernels of the test's
choice."""

import platform
from pathlib import Path

from runtime.c_library import BUILD, RUNTIME, run

SOURCE = RUNTIME / "src"


def listed(library: str) -> list[tuple[Path, str, list[str]]]:
    """(file, processor or "", flags) of a library's sources, from the list that CMake reads."""
    lines = (line.split() for line in (SOURCE / "sources.txt").read_text().splitlines())
    mine = [line[1:] for line in lines if line and line[0] == library]
    assert mine, library
    return [(SOURCE / file, "".join(rest[:1]), rest[1:]) for file, *rest in mine]


def kernels_of(processor: str) -> dict[str, list[str]]:
    """Kernels by name, with what they are compiled with besides."""
    files = [(file.stem, flags) for file, owner, flags in listed("hairlut") if owner == processor]
    return {stem.removeprefix("batch_"): flags for stem, flags in files}


CORE = [file for file, processor, _ in listed("hairlut") if not processor]
X86 = kernels_of("x86")
NEON = kernels_of("arm64")
HERE_RUN = NEON if platform.machine() in ("aarch64", "arm64") else X86
INCLUDE = [f"-I{RUNTIME / 'include'}", f"-I{SOURCE}"]
# the library's flags: no fused multiply-add, no errno
COMMON = [
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wshadow",
    "-Werror",
    "-fno-math-errno",
    "-ffp-contract=off",
    *INCLUDE,
]


def objects(folder: Path, compiler: str, *flags: str, kernels=HERE_RUN) -> list[Path]:
    """The library's sources compiled anew with these flags, and kernels with flags of their own besides."""
    folder.mkdir(parents=True, exist_ok=True)
    units = [(file, []) for file in CORE]
    units += [(SOURCE / f"batch_{kernel}.c", extra) for kernel, extra in kernels.items()]
    for source, extra in units:
        run(compiler, *COMMON, *flags, *extra, "-c", source, "-o", folder / f"{source.stem}.o")
    return [folder / f"{source.stem}.o" for source, _ in units]


def linked(program: Path, library: list[Path], compiler: str, *flags: str) -> Path:
    """The program, a C source, with the library's objects, beside them."""
    out = library[0].parent / program.stem
    run(compiler, *COMMON, *flags, program, *library, "-o", out, "-lm")
    return out


def compiled(name: str, program: Path, compiler: str, *flags: str, kernels=HERE_RUN) -> Path:
    """The program, a C source, with the library's sources, all with these flags; in build/tests/name."""
    library = objects(BUILD / "tests" / name, compiler, *flags, kernels=kernels)
    return linked(program, library, compiler, *flags)
