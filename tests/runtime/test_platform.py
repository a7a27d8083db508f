# SPDX-License-Identifier: BSD-3-Clause
"""What the sources require of compiler and processor, and what an including project may set."""

import re
import subprocess

import pytest
from runtime.by_hand import COMMON, INCLUDE, SOURCE, listed
from runtime.c_library import BUILD, HERE, RUNTIME, build, cmake, run, tool

ASK = """#include <stdio.h>
#include "cpu.h"
int main(void)
{
    const int avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") &&
                     __builtin_cpu_supports("popcnt");
    const int avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                       __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
    printf("%d %d\\n", (int)hairlut_this_cpu(), avx2 + (avx2 && avx512));
    return hairlut_this_cpu() != hairlut_ask_cpu();
}
"""


def test_every_source_is_in_the_list():
    named = [file for library in ("hairlut", "hairlut_exr") for file, *_ in listed(library)]
    assert sorted(named) == sorted(SOURCE.glob("*.c"))


@pytest.fixture(scope="module")
def asker(tmp_path_factory):
    """A program that prints what cpu.h and the compiler's own library say of the processor."""
    if "#define __x86_64__ 1" not in run(tool("cc"), "-dM", "-E", "-x", "c", "/dev/null").stdout:
        pytest.skip("cpuid is x86's")
    folder = tmp_path_factory.mktemp("cpu")
    (folder / "ask.c").write_text(ASK)
    run(tool("cc"), *COMMON, folder / "ask.c", "-static", "-o", folder / "ask")
    return folder / "ask"


def test_cpuid_says_what_the_compilers_library_says(asker):
    ours, theirs = run(asker).stdout.split()
    assert ours == theirs


@pytest.mark.parametrize("processor", ["Nehalem", "SandyBridge", "Haswell", "max"])
def test_cpuid_of_emulated_processors(asker, processor):
    emulator = tool("qemu-x86_64") or tool("qemu-x86_64-static")
    if not emulator:
        pytest.skip("other processors are not emulated: apt-get install qemu-user")
    ours, theirs = run(emulator, "-cpu", processor, asker).stdout.split()
    assert ours == theirs
    assert int(ours) == 0 or processor in ("Haswell", "max")


def refused(tmp_path, *flags: str) -> str:
    """What the compiler says of model.c with these flags."""
    done = subprocess.run(
        [tool("gcc"), "-std=c99", "-O2", *flags, *INCLUDE, "-c", SOURCE / "model.c", "-o", tmp_path / "x.o"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode != 0
    return done.stderr


@pytest.mark.parametrize("flag", ["-ffast-math", "-Ofast", "-ffinite-math-only"])
def test_fast_math_by_hand_is_refused_with_a_reason(tmp_path, flag):
    assert "hairlut: compile without -ffast-math" in refused(tmp_path, flag)


def test_the_x87_unit_is_refused_with_a_remedy(tmp_path):
    assert "-msse2 -mfpmath=sse" in refused(tmp_path, "-mfpmath=387")


PROJECT = """cmake_minimum_required(VERSION 3.21)
project(engine LANGUAGES C)
add_compile_options({options})
add_subdirectory("{runtime}" hairlut)
add_executable(batch_check "{check}")
target_include_directories(batch_check PRIVATE "{runtime}/src")
target_compile_options(batch_check PRIVATE -fno-fast-math -Wno-error)
target_link_libraries(batch_check PRIVATE hairlut::hairlut_static m)
add_executable(nan "{nan}")
target_link_libraries(nan PRIVATE hairlut::hairlut_static)
"""
NAN = """#include <string.h>
#include "hairlut.h"
int main(void)
{
    const unsigned bits = 0x7fc00000u;
    float nan;
    memcpy(&nan, &bits, sizeof nan);
    const float pdf = hairlut_pdf_direct(hairlut_builtin("fitted"), nan, 0.0f, 0.0f, 0.0f);
    unsigned found;
    memcpy(&found, &pdf, sizeof found);
    return found != 0u;
}
"""


def checksums(program) -> set[str]:
    """Of all results, one for each set of kernels."""
    return set(re.findall(r"checksum (\w+)", run(program).stdout))


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize(
    "options", ["-ffast-math -O2", "-Ofast -Werror -Wfloat-equal", "-Werror -Wfloat-equal -Wextra -O1"]
)
def test_an_engines_own_flags_change_no_bit(tmp_path, compiler, options):
    if not tool(compiler):
        pytest.skip(f"{compiler} is not installed")
    nan = tmp_path / "nan.c"
    nan.write_text(NAN)
    flags = options.replace(" ", ";")
    project = PROJECT.format(options=flags, runtime=RUNTIME, check=HERE / "batch_check.c", nan=nan)
    (tmp_path / "CMakeLists.txt").write_text(project)
    folder = cmake(
        tmp_path, tmp_path / "build", f"-DCMAKE_C_COMPILER={tool(compiler)}", "-DHAIRLUT_EXR=OFF",
        targets=("nan", "batch_check"),
    )  # fmt: skip
    run(folder / "nan")
    program = BUILD / "tests" / "batch_check_plain"
    program.parent.mkdir(parents=True, exist_ok=True)
    run(tool("cc"), *COMMON, "-O1", HERE / "batch_check.c", build() / "libhairlut.a", "-o", program, "-lm")
    theirs, ours = (checksums(check) for check in (folder / "batch_check", program))
    assert len(theirs) == 1
    assert theirs == ours


@pytest.mark.parametrize("machine", ["x86_64", "aarch64"])
def test_sources_compile_as_for_msvc(tmp_path, machine):
    """clang takes MSVC's part: its macros, its intrinsics, none of gcc's; msvc/ stands for its C library."""
    if not tool("clang"):
        pytest.skip("clang is not installed")
    mode = [f"--target={machine}-pc-windows-msvc", "-fms-compatibility-version=19.38", "-nostdlibinc"]
    mode += ["-ffreestanding", "-isystem", str(HERE / "msvc"), "-std=c99", "-Wall", "-Wextra", "-Werror"]
    for source, processor, flags in listed("hairlut"):
        own = flags if processor == "x86" and machine == "x86_64" else []
        run(
            tool("clang"), *mode, *own, *INCLUDE, "-DHAIRLUT_BUILDING", "-c", source, "-o", tmp_path / "x.obj"
        )
    text = (SOURCE / "cpu.h").read_text()
    assert "__cpuidex" in text
    assert "_xgetbv" in text
