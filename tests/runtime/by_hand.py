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
KERNELS = {
    "avx2": ["-mavx2", "-mbmi2", "-mpopcnt"],
    "avx512": [
        "-mavx512f",
        "-mavx512bw",
        "-mavx512dq",
        "-mavx512vl",
        "-mbmi2",
        "-mpopcnt",
    ],
    "neon": [],
}
HERE_RUN = ("neon",) if platform.machine() in ("aarch64", "arm64") else ("avx2", "avx512")
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


def compiled(
    name: str, program: Path, compiler: str, *flags: str, kernels=HERE_RUN, kernel_flags=KERNELS
) -> Path:
    """The program, a C source, with the library's sources, compiled anew with these flags; in
    build/tests/name."""
    folder = BUILD / "tests" / name
    folder.mkdir(parents=True, exist_ok=True)
    units = [(SOURCE / f"{unit}.c", []) for unit in CORE]
    units += [(SOURCE / f"batch_{kernel}.c", kernel_flags[kernel]) for kernel in kernels]
    units.append((program, []))
    objects = []
    for source, extra in units:
        objects.append(folder / f"{source.stem}.o")
        run(compiler, *COMMON, *flags, *extra, "-c", source, "-o", objects[-1])
    run(compiler, *flags, *objects, "-o", folder / program.stem, "-lm")
    return folder / program.stem
