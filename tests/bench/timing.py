# SPDX-License-Identifier: BSD-3-Clause
"""Times of the C library and of its rivals, from one run of hairlut_bench."""

import json
import os
import statistics
import subprocess
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

from hairlut.errors import HairlutError

REPETITIONS = 20  # the least is of a moment when no other program runs
LEAST_TIME = 0.012  # s, of each repetition: long enough to bring a large table into the caches
ARRAYS = (
    "arrays",
    "arrays128",
    "arrays256",
    "arrays512",
)  # whichever vectors the compiler preferred


@dataclass(frozen=True)
class Times:
    """repeats: ns a sample of every repetition, by MODEL/CALL/WHO/HOW. place: the processor and what decides
    its times. memory: bytes of a loaded model, by its name."""

    repeats: dict[str, list[float]]
    place: str
    memory: dict[str, int] = field(default_factory=dict)

    def least(self, *name: str) -> float | None:
        """Other programs only add to a time: the least of the repetitions counts. None: not timed."""
        return min(self.repeats.get("/".join(name), ()), default=None)

    def fastest(self, model: str, call: str, who: str, how: str) -> float | None:
        """The least of a rival's forms that compare with hairlut's "one" or "arrays"."""
        forms = ARRAYS if how == "arrays" else (how,)
        return min(filter(None, (self.least(model, call, who, form) for form in forms)), default=None)

    def models(self) -> list[str]:
        """Those that hairlut was timed on, the ones with rivals first."""
        names = {name.split("/")[0] for name in self.repeats if name.split("/")[2] == "hairlut"}
        first = ["fitted", "brown"]
        return sorted(names, key=lambda name: (first.index(name) if name in first else len(first), name))

    def repetitions(self) -> int:
        """How often each benchmark ran."""
        return max(map(len, self.repeats.values()))

    def interference(self) -> float:
        """By how much the median of a benchmark's repetitions exceeds their least, in the median over all."""
        return statistics.median(statistics.median(all) / min(all) for all in self.repeats.values()) - 1


def measure(
    program: Path, luts: Path, names: str, results: Path, repetitions=REPETITIONS, seconds=LEAST_TIME
):
    """Runs the benchmarks whose names match, in one process and in random order, and keeps the output in
    `results`. luts: a directory of further model directories."""
    if not os.access(program, os.X_OK):
        raise HairlutError(
            f"{program}: no such program: build tests/bench (make bench), or name it with --bench"
        )
    command = [
        program, "--luts", luts, f"--benchmark_filter={names}", f"--benchmark_out={results}",
        "--benchmark_out_format=json", f"--benchmark_min_time={seconds}",
        f"--benchmark_repetitions={repetitions}", "--benchmark_enable_random_interleaving=true",
    ]  # fmt: skip
    one_thread = os.environ | {"MKL_THREADING_LAYER": "SEQUENTIAL"}
    done = subprocess.run(
        list(map(str, command)), capture_output=True, text=True, check=False, env=one_thread
    )
    if done.returncode:
        raise HairlutError(f"{program} failed: {done.stderr.strip().splitlines()[-1:]}")
    return read(results)


def read(results: Path) -> Times:
    """The Times that hairlut_bench wrote."""
    document = json.loads(results.read_text())
    repeats = defaultdict(list)
    for run in document["benchmarks"]:
        if run.get("run_type", "iteration") == "iteration" and not run.get("error_occurred"):
            name = run["run_name"].split("/")[:4]  # further parts are Google Benchmark's
            repeats["/".join(name)].append(run["ns"])
    context = document.get("context", {})
    memory = {
        key.removeprefix("bytes of "): int(value)
        for key, value in context.items()
        if key.startswith("bytes of ")
    }
    return Times(dict(repeats), describe(processor(), context), memory)


def processor() -> str:
    """The processor's name, as Linux says it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return "unknown processor"
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, "unknown processor")


def describe(name: str, context: dict) -> str:
    """The processor with what decides its times, as far as the benchmark's context has it: the kernels that
    the library chooses on it, its second-level cache, the C library's mathematics and the compiler."""
    caches = [cache["size"] for cache in context.get("caches", []) if cache["level"] == 2]
    parts = [f"{context['kernels']} kernels"] if "kernels" in context else []
    parts += [f"second-level cache of {caches[0] // 1024} KiB"] if caches else []
    parts += [f"libm and libmvec of {context['libm']}"] if "libm" in context else []
    parts += [context["compiler"]] if "compiler" in context else []
    return f"{name} ({', '.join(parts)})" if parts else name
