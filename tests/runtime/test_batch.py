# SPDX-License-Identifier: BSD-3-Clause
"""The batch kernels give the bits of the one-direction functions, on every instruction set run here."""

import re
import signal
import subprocess
from pathlib import Path

import pytest
from runtime.by_hand import COMMON, HERE_RUN, NEON, X86
from runtime.c_library import BUILD, HERE, build, run, tool

from runtime import by_hand


def compiled(name: str, compiler: str, *flags: str, kernels=HERE_RUN) -> Path:
    """batch_check with the library's sources, compiled anew with these flags."""
    return by_hand.compiled(f"batch-{name}", HERE / "batch_check.c", compiler, *flags, kernels=kernels)


def checked(*command) -> dict[str, str]:
    """Checksum of all results, by set of kernels; fails with what differs."""
    done = subprocess.run(
        [str(word) for word in command],
        check=False,
        text=True,
        capture_output=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    return dict(re.findall(r"^set (\w+)\nchecksum (\w+)$", done.stdout, re.MULTILINE))


@pytest.fixture(scope="module")
def shipped() -> Path:
    """batch_check with the library as it is shipped."""
    program = BUILD / "tests" / "batch_check"
    program.parent.mkdir(parents=True, exist_ok=True)
    compiler = tool("cc")
    run(
        compiler,
        *COMMON,
        "-O1",
        HERE / "batch_check.c",
        build() / "libhairlut.a",
        "-o",
        program,
        "-lm",
    )
    return program


@pytest.fixture(scope="module")
def reference(shipped) -> dict[str, str]:
    """What the library as it is shipped computes."""
    return checked(shipped)


def test_every_set_of_kernels_equals_the_one_direction_functions(reference):
    assert {"public", "portable"} <= set(reference)
    assert len(set(reference.values())) == 1


def test_widest_set_of_this_processor_is_offered(reference):
    flags = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    if "avx2" not in flags:
        pytest.skip("this processor has no AVX2: its kernels are not run")
    assert "avx2" in reference
    assert ("avx512" in reference) == ({"avx512f", "avx512dq", "avx512bw", "avx512vl"} <= set(flags.split()))


@pytest.mark.parametrize("flags", [["-O3"], ["-O2", "-DHAIRLUT_PLAIN_QUAD"], ["-O0"]], ids=" ".join)
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_bits_do_not_depend_on_the_compiler(reference, compiler, flags):
    if not tool(compiler):
        pytest.skip(f"{compiler} is missing")
    program = compiled(f"{compiler}{''.join(flags)}", compiler, *flags)
    assert set(checked(program).values()) == set(reference.values())


def test_no_kernel_reads_or_writes_outside_its_arrays(reference):
    program = compiled(
        "asan",
        tool("cc"),
        "-O1",
        "-g",
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover=all",
    )
    assert set(checked(program).values()) == set(reference.values())


def emulated(machine: str) -> str | None:
    """The program that runs programs of such machines."""
    return tool(f"qemu-{machine}") or tool(f"qemu-{machine}-static")


def test_neon_equals_the_other_processors_bit_for_bit(reference):
    compiler, emulator = tool("aarch64-linux-gnu-gcc"), emulated("aarch64")
    if not compiler or not emulator:
        pytest.skip("NEON is not run: apt-get install gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user")
    program = compiled("aarch64", compiler, "-O2", "-static", kernels=NEON)
    results = checked(emulator, program)
    assert "neon" in results
    assert set(results.values()) == set(reference.values())


@pytest.fixture
def old_processor() -> list[str]:
    """Runs a program on a processor with SSE4 and no AVX: its other instructions end the program."""
    emulator = emulated("x86_64")
    if HERE_RUN is not X86 or not emulator:
        pytest.skip("a processor without AVX2 is not emulated: on x86, apt-get install qemu-user")
    return [emulator, "-cpu", "Nehalem"]


def test_processor_without_avx2_runs_the_portable_kernels(shipped, reference, old_processor):
    results = checked(*old_processor, shipped)
    assert set(results) == {"public", "portable"}
    assert set(results.values()) == set(reference.values())


def test_a_kernel_that_the_processor_lacks_ends_the_program(old_processor):
    """The emulation works: a build that does not query the processor runs into AVX2."""
    program = compiled("unasked", tool("cc"), "-O1", "-DHAIRLUT_CPU=HAIRLUT_CPU_AVX2")
    done = subprocess.run([*old_processor, program], check=False, capture_output=True, timeout=600)
    assert done.returncode == -signal.SIGILL


def test_fused_multiply_add_is_noticed(reference):
    """The check rejects a build whose one-direction functions round differently."""
    if "avx2" not in reference:
        pytest.skip("this processor has no AVX2")
    folder = compiled("fma", tool("cc"), "-O2", "-mfma", "-ffp-contract=fast").parent
    done = subprocess.run(
        [str(folder / "batch_check")],
        check=False,
        text=True,
        capture_output=True,
        timeout=600,
    )
    assert done.returncode == 1 or set(re.findall(r"checksum (\w+)", done.stdout)) != set(reference.values())
