# SPDX-License-Identifier: BSD-3-Clause
"""The library and a consumer for other systems, compiled by Zig's clang, which brings their C libraries.

Built for macOS (both processors), Windows and ARM Linux; the Windows programs run under wine and the ARM ones
under qemu, with the bits of this machine.
"""

import sys
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import pytest
from runtime.by_hand import NEON, X86
from runtime.c_library import BUILD, HERE, run, tool
from runtime.test_batch import checked

from runtime import by_hand

FOLDER = BUILD / "tests" / "zig"


@dataclass(frozen=True)
class Target:
    """A system as Zig names it; its kernels; how its programs begin; what runs them here."""

    name: str
    kernels: dict[str, list[str]]
    magic: bytes
    emulator: tuple[str, ...] = ()
    package: str = ""


ARM_LIBRARIES = Path("/usr/aarch64-linux-gnu")
MACH_O = b"\xcf\xfa\xed\xfe"
TARGETS = [
    Target("aarch64-macos", NEON, MACH_O),
    Target("x86_64-macos", X86, MACH_O),
    Target("x86_64-windows-gnu", X86, b"MZ", ("wine",), "wine wine64"),
    Target(
        "aarch64-linux-gnu",
        NEON,
        b"\x7fELF",
        ("qemu-aarch64", "-L", str(ARM_LIBRARIES)),
        "qemu-user libc6-dev-arm64-cross",
    ),
]


@pytest.fixture(scope="module", params=TARGETS, ids=lambda target: target.name)
def target(request) -> Target:
    return request.param


def compiler(target: Target) -> Path:
    """A command that compiles for the target as `cc` does here."""
    if not find_spec("ziglang"):
        pytest.skip("nothing is compiled for other systems: .venv/bin/pip install ziglang")
    command = FOLDER / f"cc-{target.name}"
    FOLDER.mkdir(parents=True, exist_ok=True)
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m ziglang cc -target {target.name} "$@"\n')
    command.chmod(0o755)
    return command


@pytest.fixture(scope="module")
def programs(target) -> dict[str, Path]:
    """batch_check and the consumer in C99, for the target."""
    cc, flags = str(compiler(target)), ["-O2", "-DHAIRLUT_STATIC"]
    library = by_hand.objects(FOLDER / target.name, cc, *flags, kernels=target.kernels)
    sources = {"batch_check": HERE / "batch_check.c", "c99": HERE / "consumers" / "c99.c"}
    return {name: by_hand.linked(source, library, cc, *flags) for name, source in sources.items()}


def test_library_and_consumer_are_built(target, programs):
    for program in programs.values():
        assert program.read_bytes().startswith(target.magic)


def emulated(target: Target, program: Path) -> list[str]:
    """The command that runs a program of the target; skips where there is none."""
    if not target.emulator:
        pytest.skip(f"no emulator of {target.name} runs here: its programs are only built")
    if not tool(target.emulator[0]) or ("-L" in target.emulator and not ARM_LIBRARIES.exists()):
        pytest.skip(f"{target.name} is not run: apt-get install {target.package}")
    quiet = ["env", "WINEDEBUG=-all", f"WINEPREFIX={FOLDER / 'wine'}"]
    return [*quiet, *target.emulator, str(program)]


def test_consumer_runs(target, programs):
    run(*emulated(target, programs["c99"]))


@pytest.fixture(scope="module")
def reference() -> set[str]:
    """The checksum of this machine's results."""
    program = by_hand.compiled("batch-native", HERE / "batch_check.c", tool("cc"), "-O2")
    return set(checked(program).values())


def test_results_are_this_machines_bit_for_bit(target, programs, reference):
    there = checked(*emulated(target, programs["batch_check"]))
    assert {"public", "portable"} <= there.keys()
    assert target.kernels is X86 or "neon" in there
    assert set(there.values()) == reference
