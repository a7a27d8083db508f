"""exercise.c, a walk through the whole API, under sanitizers, valgrind, a line count; and the fuzz corpus."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from conformance import cases, files
from runtime.by_hand import CORE, HERE_RUN, listed
from runtime.c_library import BUILD, BUILTIN, HERE, ROOT, RUNTIME, cmake, has_exr, run, tool

FUZZ = ROOT / "tests" / "fuzz"
LEAST_COVERAGE = 0.95
CORE_WITHOUT_KERNELS = [file for file in CORE if not file.name.startswith("batch")]
LOADER = [file for file, *_ in listed("hairlut_exr")]
INCLUDE = [f"-I{RUNTIME / 'include'}", f"-I{RUNTIME / 'src'}", f"-I{FUZZ}"]


def need(*programs: str) -> None:
    for program in programs:
        if not tool(program):
            pytest.skip(f"{program} is not installed")


@pytest.fixture(scope="module")
def directories(tmp_path_factory) -> list[Path]:
    """Good models, of both formats, and ones that the loader refuses, each for another reason."""
    if not has_exr():
        return []
    found, folder = [ROOT / "luts" / model for model in BUILTIN], tmp_path_factory.mktemp("models")
    given = {1: (files.write_format_1, cases.of_format_1()), 2: (files.write_format_2, cases.of_format_2())}
    for number, (write, edits) in given.items():
        good = write(folder / f"good{number}", ROOT / "luts" / "fitted")
        found.append(good)
        for k, (_, file, edit, _) in enumerate(edits):
            directory = folder / ("d" * 250 if k == 0 else "") / f"{number}-{k}"
            shutil.copytree(good, directory)
            edit.apply(directory / file)
            found.append(directory)
    return found


def exercise(name: str, *definitions: str, flags: tuple[str, ...] = (), compiler: str = "gcc") -> Path:
    """The library and exercise.c, built with instruments."""
    build = cmake(
        RUNTIME, BUILD / "tests" / name, f"-DCMAKE_C_COMPILER={tool(compiler)}", "-DHAIRLUT_EXAMPLES=OFF",
        "-DCMAKE_BUILD_TYPE=Debug", *definitions,
        targets=("hairlut_static", *(["hairlut_exr_static"] if has_exr() else []))
    )  # fmt: skip
    loader = ["-DEXERCISE_EXR", build / "libhairlut_exr.a", "-lOpenEXRCore"] if has_exr() else []
    out = build / "exercise"
    run(compiler, "-std=gnu99", "-g", "-Wall", "-Wextra", *flags, *INCLUDE, HERE / "exercise.c", *loader,
        build / "libhairlut.a", "-lm", "-lpthread", "-o", out)  # fmt: skip
    return out


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_address_and_undefined_behaviour_sanitizers_find_nothing(directories, compiler):
    need(compiler)
    kinds = "address,undefined"
    flags = f"-fsanitize={kinds}", "-fno-sanitize-recover=all"
    program = exercise(f"asan-{compiler}", f"-DHAIRLUT_SANITIZE={kinds}", flags=flags, compiler=compiler)
    assert run(program, *directories).stdout.endswith("done\n")


def test_thread_sanitizer_finds_nothing_with_one_model_in_many_threads():
    program = exercise("tsan", "-DHAIRLUT_SANITIZE=thread", flags=("-fsanitize=thread",))
    run(program, "-t", "8", *([ROOT / "luts" / "fitted"] if has_exr() else []))


def test_the_sanitizers_are_awake(tmp_path):
    """A program with one fault each must fail."""
    faults = {
        "address": "#include <stdlib.h>\nint main(int n, char **v) { return *((char *)malloc(8) + 7 + n); }",
        "undefined": "#include <limits.h>\nint main(int n, char **v) { return INT_MAX + n == !v; }",
    }
    for kind, text in faults.items():
        source = tmp_path / f"{kind}.c"
        source.write_text(text)
        run("gcc", f"-fsanitize={kind}", "-fno-sanitize-recover=all", source, "-o", tmp_path / kind)
        assert subprocess.run([tmp_path / kind], capture_output=True).returncode != 0


def test_valgrind_finds_neither_errors_nor_leaks(directories):
    need("valgrind")
    program = exercise("valgrind")
    some = directories[:3] + directories[3::40]
    run("valgrind", "--error-exitcode=9", "--leak-check=full", "--show-leak-kinds=all",
        "--errors-for-leak-kinds=all", "--quiet", program, *some)  # fmt: skip


def counted_lines(folder: Path) -> dict[str, dict[int, bool]]:
    """For every file of runtime/src, headers too, its lines with code and whether each ran."""
    lines: dict[str, dict[int, bool]] = {}
    for data in sorted(folder.rglob("*.gcda")):
        for document in run("gcov", "--json-format", "--stdout", data, cwd=folder).stdout.splitlines():
            for file in json.loads(document)["files"]:
                if Path(file["file"]).parent == RUNTIME / "src":
                    seen = lines.setdefault(Path(file["file"]).name, {})
                    for line in file["lines"]:
                        number = line["line_number"]
                        seen[number] = seen.get(number, False) or line["count"] > 0
    return lines


def leave_out_kernels(lines: dict[str, dict[int, bool]], names: set[str]) -> None:
    """Takes the sources of kernels that did not run from counted_lines."""
    sources = {f"batch_{name}.c" for name in names} | {f"simd_{name}.h" for name in names}
    for file in sources & lines.keys():
        seen = lines.pop(file)
        assert not any(seen.values()), file


def test_lines_of_the_runtime_are_covered(directories):
    """Of every source that this machine runs: a processor without AVX2 executes no line of its kernels,
    which are then left out and named. NEON's are not compiled on x86."""
    need("gcov")
    program = exercise("coverage", "-DHAIRLUT_COVERAGE=ON", flags=("--coverage",))
    for old in program.parent.rglob("*.gcda"):
        old.unlink()
    said = run(program, "-t", "2", *directories).stdout
    kernels = set(re.search(r"^kernels (.*)$", said, re.MULTILINE)[1].split())
    absent = HERE_RUN.keys() - kernels
    lines = counted_lines(program.parent)
    leave_out_kernels(lines, absent)
    report = [
        f"{file}: {sum(seen.values())} of {len(seen)}; not {sorted(n for n, ran in seen.items() if not ran)}"
        for file, seen in sorted(lines.items())
    ]
    total, executed = (
        sum(count(seen) for seen in lines.values()) for count in (len, lambda s: sum(s.values()))
    )
    left_out = ", ".join(sorted(absent)) or "none"
    report.append(f"{executed} of {total} lines; not run by this processor: {left_out}")
    (BUILD / "tests" / "coverage.txt").write_text("\n".join(report) + "\n")
    assert {
        "axis.h",
        "model.c",
        "hair.c",
        "lobe.c",
        "mixture.c",
        "table.c",
        "frame.c",
        "batch.c",
    } <= lines.keys()
    assert executed / total >= LEAST_COVERAGE, report


def replayed(tmp_path, target: str, *sources: Path, libraries: tuple[str, ...] = ()) -> str:
    """The corpus through a fuzz target, under the sanitizers."""
    out = tmp_path / target
    run("gcc", "-std=gnu99", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", *INCLUDE,
        FUZZ / f"{target}.c", FUZZ / "replay.c", *CORE_WITHOUT_KERNELS, *sources, *libraries, "-lm",
        "-o", out)  # fmt: skip
    inputs = sorted((FUZZ / "corpus" / target.removeprefix("fuzz_")).iterdir())
    assert len(inputs) >= 10
    return run(out, *inputs).stdout


def test_fuzz_corpus_of_tables_in_memory_holds(tmp_path):
    assert "inputs" in replayed(tmp_path, "fuzz_memory")


@pytest.mark.usefixtures("loader")
def test_fuzz_corpus_of_files_holds(tmp_path):
    flags = run("pkg-config", "--cflags", "OpenEXR").stdout.split()
    libraries = (*flags, "-lOpenEXRCore")
    assert "inputs" in replayed(tmp_path, "fuzz_loader", *LOADER, libraries=libraries)


def test_fuzzers_build_and_run_for_a_moment():
    need("clang")
    done = run(FUZZ / "fuzz.sh", "4", timeout=120)
    runs = [int(count) for count in re.findall(r"number_of_executed_units (\d+)", done.stdout)]
    assert len(runs) == (2 if has_exr() else 1)
    assert min(runs) > 50
