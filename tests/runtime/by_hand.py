"""A program compiled with the library's sources file by file, with flags and kernels of the test's
choice."""

import platform
from pathlib import Path

from runtime.c_library import BUILD, RUNTIME, run

SOURCE = RUNTIME / "src"
CORE = (
    "sample",
    "density",
    "mixture",
    "frame",
    "model",
    "builtin",
    "builtin_tables",
    "batch",
    "batch_mixture",
    "batch_portable",
)
# kernels, with what they are compiled with besides
X86 = {
    "avx2": ["-mavx2", "-mbmi2"],
    "avx512": [
        "-mavx512f",
        "-mavx512bw",
        "-mavx512dq",
        "-mavx512vl",
        "-mbmi2",
        "-mpopcnt",
    ],
}
NEON = {"neon": []}
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


def compiled(name: str, program: Path, compiler: str, *flags: str, kernels=HERE_RUN) -> Path:
    """The program, a C source, with the library's sources, compiled anew with these flags, and kernels with
    flags of their own besides; in build/tests/name."""
    folder = BUILD / "tests" / name
    folder.mkdir(parents=True, exist_ok=True)
    units = [(SOURCE / f"{unit}.c", []) for unit in CORE]
    units += [(SOURCE / f"batch_{kernel}.c", extra) for kernel, extra in kernels.items()]
    units.append((program, []))
    objects = []
    for source, extra in units:
        objects.append(folder / f"{source.stem}.o")
        run(compiler, *COMMON, *flags, *extra, "-c", source, "-o", objects[-1])
    run(compiler, *flags, *objects, "-o", folder / program.stem, "-lm")
    return folder / program.stem
