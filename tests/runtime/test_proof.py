# SPDX-License-Identifier: BSD-3-Clause
"""The C library under stress: a walk through the whole API (exercise.c) under sanitizers and valgrind, every
allocation and every read failed in turn (faults.c), the fuzz targets, and the branches that they reach."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from conformance import cases, files
from runtime.by_hand import HERE_RUN, INCLUDE
from runtime.c_library import BUILD, HERE, MODELS, ROOT, RUNTIME, cmake, has_exr, run, tool

FUZZ = ROOT / "tests" / "fuzz"
SANITIZERS = "address,undefined"
SANITIZED = f"-fsanitize={SANITIZERS}", "-fno-sanitize-recover=all"
TARGETS = ("memory", "loader", "round_trip")

OPENEXR = "OpenEXR's getters fail only on arguments that are not passed"
CHUNKS = "OpenEXR has compared the chunk's header with the image's: a second look, whatever version is linked"
PROCESSOR = "another processor than this one"
CONSTANT = "the size is a constant where this is inlined"
NOT_EMPTY = "no block is empty: the callers see to it, the compiler does not know"
ONE_WIDTH = "a function that this is inlined into meets tables of one width or kind"
FEW_NODES = "a function that this is inlined into meets axes of few nodes"
# branches that nothing reaches: file, text of the line, reason
UNREACHED = [
    ("batch.c", "hairlut_this_cpu()", PROCESSOR),
    ("batch.h", "cpu == HAIRLUT_CPU_AVX", PROCESSOR),
    ("batch.h", ": &hairlut_batch_portable;", PROCESSOR),
    ("cpu.h", "saves_zmm) ? HAIRLUT_CPU_AVX512", PROCESSOR),
    ("cpu.h", "hairlut_read_cpuid", PROCESSOR),
    ("cpu.h", "hairlut_saved_registers()", PROCESSOR),
    ("cpu.h", ": HAIRLUT_CPU_AVX2;", PROCESSOR),
    ("simd_avx2.h", "for (int v = 1; v < vectors; ++v)", ONE_WIDTH),
    ("simd_avx512.h", "for (int v = 1; v < vectors; ++v)", ONE_WIDTH),
    ("simd_eight.h", "if (n == HAIRLUT_SMALL_GROUP)", CONSTANT),
    ("simd_eight.h", "if (alike)", CONSTANT),
    ("axis.h", "if (count > ", ONE_WIDTH),
    ("batch_axis.h", "for (size_t s = 0; s < n; s += LANES) {", NOT_EMPTY),
    ("batch_axis.h", "count(axis, axis->rows, n, q, size, alike, q->cell);", CONSTANT),
    ("batch_axis.h", "count(axis, axis->rows + HAIRLUT_LINE, n, q, size, alike, counts);", CONSTANT),
    ("batch_axis.h", "if (size == HAIRLUT_SMALL_GROUP)", CONSTANT),
    ("batch_axis.h", "if (alike)", CONSTANT),
    ("batch_strand_axis.h", "for (int k = 0; k < 4; ++k)", CONSTANT),
    ("batch_strand_axis.h", "for (int c = 1; c < 1 << axes; ++c)", CONSTANT),
    ("batch_strand_axis.h", "if (!alike) {", CONSTANT),
    ("batch_strand_axis.h", "if (alike)", CONSTANT),
    ("batch_strand_axis.h", "size == HAIRLUT_SMALL_GROUP ? to", CONSTANT),
    ("batch_strand_axis.h", "count_strands(axis, table, axis->rows", CONSTANT),
    ("mixture.c", "fixed >= 2147483648.0", "no blend of turns here is within 1e-9 rad of pi"),
    ("mixture.h", "for (int l = 0; l < 4; ++l)", CONSTANT),
    ("mixture.h", "if (corners)", "with and without parameters are two functions that this is inlined into"),
    ("mixture.h", "corners ? hairlut_blend_fours", "as the line before"),
    (
        "mixture.h",
        "for (int c = 1; c < spacing->count; ++c) {",
        "no corner is blended where a model is built",
    ),
    ("mixture.h", "if (!model->mixture.turns_vary)", "as the loop that it is in"),
    ("nodes.h", "while (eights > COUNTED_EIGHTS) {", FEW_NODES),
    ("nodes.h", "inner += beyond", FEW_NODES),
    ("nodes.h", "eights = beyond", FEW_NODES),
    ("viewer_one.h", "HAIRLUT_VIEWER_GRIDS", "test_viewer.py has a model of more grids"),
    ("viewer_one.h", "few ? view->corners", "as the line before"),
    ("strand_axis.h", "if (n == 2)", CONSTANT),
    ("strand_axis.h", "if (s->table->alike)", ONE_WIDTH),
    ("strand_axis.h", "if (s->table->groups > 0)", "no model over parameters here has tables of both widths"),
    ("strand_one.h", "n > 0 ? n : search", CONSTANT),
    ("strand_one.h", "end_lobe(searches", CONSTANT),
    ("strand_one.h", "read_lobe(searches", CONSTANT),
    ("model.c", "SIZE_MAX / 4", "a size_t has 64 bits here: no model is larger"),
    ("strand_axis.h", "for (int c = 1; c < n; ++c)", CONSTANT),
    ("table.c", "blend_floats(memory, ", "no table is empty"),
    ("exr_compression.c", "offset > LONG_MAX", "a long has 64 bits here: no offset is beyond it"),
    ("exr_file.c", "if (code == EXR_ERR_SUCCESS && parts != 1)", OPENEXR),
    ("exr_file.c", "if (code == EXR_ERR_SUCCESS)", OPENEXR),
    ("exr_file.c", "if (code != EXR_ERR_SUCCESS)", OPENEXR),
    ("exr_file.c", 'fail_exr(file, code, "compression")', OPENEXR),
    ("exr_file.c", 'HAIRLUT_OK : fail_exr(file, code, "header")', OPENEXR),
    ("exr_file.c", "if (begin) {", "OpenEXR 3.1 gives an empty text, not none"),
    (
        "exr_file.c",
        'storage == EXR_STORAGE_TILED ? "tiled" : "deep"',
        "no deep file is at hand",
    ),
    ("exr_file.c", "(chunk.start_y != y ||", CHUNKS),
]


def need(*programs: str) -> None:
    for program in programs:
        if not tool(program):
            pytest.skip(f"{program} is not installed")


@pytest.fixture(scope="module")
def good(tmp_path_factory) -> list[Path]:
    """A directory of each format, and one of a model over parameters."""
    folder, source = tmp_path_factory.mktemp("good"), ROOT / "luts" / "fitted"
    return [
        files.write_format_1(folder / "1", source),
        files.write_format_2(folder / "2", source),
        files.write_over_parameters(folder / "parameters"),
    ]


@pytest.fixture(scope="module")
def directories(good, tmp_path_factory) -> list[Path]:
    """Every case of tests/conformance, the shipped models, and one in a deep folder."""
    folder = tmp_path_factory.mktemp("cases")
    found = [ROOT / "luts" / model for model in MODELS]
    edits_of = cases.of_format_1(), cases.of_format_2(), cases.of_parameters()
    for given, edits in zip(good, edits_of, strict=True):
        for number, (_, file, edit, _) in enumerate(edits):
            found.append(folder / f"{given.name}-{number}")
            shutil.copytree(given, found[-1])
            edit.apply(found[-1] / file)
    deep = folder / ("d" * 250)
    shutil.copytree(good[1], deep)
    (deep / cases.PHI).write_bytes(b"no image")
    return [*found, deep]


def library(name: str, *definitions: str, compiler: str = "gcc") -> list:
    """The static libraries, built with instruments in build/tests/name, and what else to link."""
    forms = ["hairlut_exr", "hairlut"] if has_exr() else ["hairlut"]
    build = cmake(
        RUNTIME, BUILD / "tests" / name, f"-DCMAKE_C_COMPILER={tool(compiler)}", "-DHAIRLUT_EXAMPLES=OFF",
        "-DCMAKE_BUILD_TYPE=Debug", *definitions, targets=tuple(f"{form}_static" for form in forms),
    )  # fmt: skip
    archives = [build / f"lib{form}.a" for form in forms]
    return [*archives, *(["-lOpenEXRCore"] if has_exr() else []), "-lm", "-lpthread", "-ldl"]


def program(linked: list, *sources: Path, flags: tuple[str, ...] = (), compiler: str = "gcc") -> Path:
    """A program of these sources, the first of which names it, linked with library()."""
    exr = ["-DEXERCISE_EXR", *run("pkg-config", "--cflags", "OpenEXR").stdout.split()] if has_exr() else []
    out = linked[0].parent / sources[0].stem
    common = ["-std=gnu99", "-g", "-Wall", "-Wextra", *exr, *INCLUDE, f"-I{FUZZ}"]
    run(compiler, *common, *flags, *sources, *linked, "-o", out)
    return out


def exercised(command: list, directories: list[Path]) -> str:
    """What exercise.c prints of these directories."""
    said = run(*command, input="".join(f"{directory}\n" for directory in directories)).stdout
    assert said.endswith("done\n")
    return said


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_address_and_undefined_behaviour_sanitizers_report_nothing(directories, compiler):
    need(compiler)
    linked = library(f"asan-{compiler}", f"-DHAIRLUT_SANITIZE={SANITIZERS}", compiler=compiler)
    exercise = program(linked, HERE / "exercise.c", flags=SANITIZED, compiler=compiler)
    exercised([exercise], directories if has_exr() else [])


def test_thread_sanitizer_reports_nothing_with_one_model_in_many_threads(good):
    linked = library("tsan", "-DHAIRLUT_SANITIZE=thread")
    exercise = program(linked, HERE / "exercise.c", flags=("-fsanitize=thread",))
    exercised([exercise, "8"], good if has_exr() else [])


def test_the_sanitizers_report_a_mistake(tmp_path):
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


def test_valgrind_reports_neither_errors_nor_leaks(good, directories):
    need("valgrind")
    exercise = program(library("valgrind"), HERE / "exercise.c")
    checks = [
        "--error-exitcode=9",
        "--leak-check=full",
        "--show-leak-kinds=all",
        "--errors-for-leak-kinds=all",
    ]
    some = [*good, *directories[2::40], directories[-1]] if has_exr() else []
    exercised(["valgrind", "--quiet", *checks, exercise], some)


@pytest.mark.usefixtures("loader")
def test_every_allocation_and_every_read_fails_in_turn(good):
    said = run(program(library("valgrind"), HERE / "faults.c"), *good).stdout
    for directory in good:
        allocations = re.search(rf"{directory}: (\d+) allocations failed in turn", said)
        assert int(allocations[1]) > 50
        reads = re.findall(rf"{directory}: (\d+) reads failed in turn \((\w+)\), (\d+) loads", said)
        assert [how for _, how, _ in reads] == ["error", "end", "half"]
        assert int(reads[0][0]) > 20
        assert int(reads[0][2]) == 0, "a load whose read failed must not succeed"
    assert said.endswith("done\n")


def replayed(linked: list, target: str, folder: Path, flags: tuple[str, ...] = ()) -> None:
    """The corpus through a fuzz target."""
    inputs = sorted((FUZZ / "corpus" / target).iterdir())
    assert len(inputs) >= 6
    replay = program(linked, FUZZ / f"fuzz_{target}.c", FUZZ / "replay.c", flags=flags)
    said = run("env", f"FUZZ_FOLDER={folder}", replay, *inputs).stdout
    assert said == f"{len(inputs)} inputs\n"


@pytest.mark.parametrize("target", TARGETS)
def test_fuzz_corpus_passes_under_the_sanitizers(tmp_path, target):
    if target != "memory" and not has_exr():
        pytest.skip("hairlut_exr is not built")
    replayed(library("asan-gcc", f"-DHAIRLUT_SANITIZE={SANITIZERS}"), target, tmp_path, SANITIZED)


def test_fuzzers_run_for_a_moment_and_print_their_coverage():
    need("clang", "llvm-cov")
    said = run(FUZZ / "fuzz.sh", "2", timeout=300, cwd=ROOT).stdout
    targets = TARGETS if has_exr() else ("memory",)
    for target in targets:
        assert int(re.search(rf"fuzz_{target} number_of_executed_units (\d+)", said)[1]) > 5
        reached, total = map(int, re.search(rf"fuzz_{target} branches (\d+) of (\d+)", said).groups())
        assert 0.4 < reached / total < 1


Branch = tuple[str, int, str, int]


def counted_branches(folder: Path) -> dict[Branch, bool]:
    """For every branch of runtime/src, headers too, whether it was taken: (file, line, function, number)."""
    taken: dict[Branch, bool] = {}
    for data in sorted(folder.rglob("*.gcda")):
        gcov = run("gcov", "--json-format", "--branch-probabilities", "--stdout", data, cwd=folder)
        for document in gcov.stdout.splitlines():
            for file in json.loads(document)["files"]:
                if Path(file["file"]).parent != RUNTIME / "src":
                    continue
                for line in file["lines"]:
                    for number, branch in enumerate(line["branches"]):
                        key = (
                            Path(file["file"]).name,
                            line["line_number"],
                            line.get("function_name", ""),
                            number,
                        )
                        taken[key] = taken.get(key, False) or branch["count"] > 0
    return taken


def reason(file: str, line: str) -> str | None:
    """Why a branch of the line is not reached, if the list knows."""
    return next((why for name, text, why in UNREACHED if name == file and text in line), None)


@pytest.mark.usefixtures("loader")
def test_every_branch_is_reached_or_listed_with_the_reason(good, directories, tmp_path):
    """Counted by gcov over exercise.c, batch_check.c, faults.c and the fuzz corpora; NEON's kernels are not
    compiled on x86."""
    need("gcov")
    linked, flags = library("coverage", "-DHAIRLUT_COVERAGE=ON"), ("--coverage",)
    folder = linked[0].parent
    exercise, check, faults = (
        program(linked, HERE / f"{name}.c", flags=flags) for name in ("exercise", "batch_check", "faults")
    )
    for old in folder.rglob("*.gcda"):
        old.unlink()
    said = exercised([exercise, "2"], directories)
    kernels = set(re.search(r"^kernels (.*)$", said, re.MULTILINE)[1].split())
    run(check)
    run(faults, *good)
    for target in TARGETS:
        replayed(linked, target, tmp_path, flags)
    taken = counted_branches(folder)
    if not kernels & HERE_RUN.keys():  # a processor without AVX2 runs no line of them
        taken = {key: was for key, was in taken.items() if not re.match(r"(batch|simd)_\w+\.h", key[0])}
    lacking = {f"simd_{name}.h" for name in HERE_RUN.keys() - kernels}
    taken = {key: was for key, was in taken.items() if key[0] not in lacking}
    sources = {file: (RUNTIME / "src" / file).read_text().splitlines() for file, *_ in taken}
    missed = sorted({(file, line) for (file, line, *_), was in taken.items() if not was})
    report = [f"{sum(taken.values())} of {len(taken)} branches of {len(sources)} files of runtime/src"]
    report += [f"{f}:{n}: {sources[f][n - 1].strip()}: {reason(f, sources[f][n - 1])}" for f, n in missed]
    (BUILD / "tests" / "coverage.txt").write_text("\n".join(report) + "\n")
    unexplained = [line for line in report[1:] if line.endswith(": None")]
    assert not unexplained, "\n".join(unexplained)
    assert {
        "exr.c",
        "exr_mixture.c",
        "model.c",
        "mixture.c",
        "table.c",
        "lobe.c",
        "batch.c",
    } <= sources.keys()


def test_the_list_of_unreached_branches_is_of_this_source():
    for file, text, _ in UNREACHED:
        assert text in (RUNTIME / "src" / file).read_text(), (file, text)
