"""Times of the C library and of its rivals, from one run of the benchmark program (tests/bench)."""

import json
import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

from hairlut.errors import HairlutError

REPETITIONS = 24  # the least finds a moment when no other program runs
LEAST_TIME = 0.015  # s, of each repetition: long enough to bring a large table into the caches


@dataclass(frozen=True)
class Times:
    """ns: nanoseconds a sample, by the benchmark's name, the least of the repetitions, as other programs only
    add to it; spread: (largest - least) / least."""

    ns: dict[str, float]
    spread: dict[str, float]
    processor: str

    def get(self, name: str) -> float | None:
        return self.ns.get(name)


def run(program: Path, luts: Path, pattern: str) -> Times:
    """Runs the benchmarks whose names match, in one process and in random order."""
    if not os.access(program, os.X_OK):
        raise HairlutError(
            f"{program}: no such program: build tests/bench with CMake, or name it with --bench"
        )
    command = [
        program, "--luts", luts, f"--benchmark_filter={pattern}", "--benchmark_format=json",
        f"--benchmark_min_time={LEAST_TIME}", f"--benchmark_repetitions={REPETITIONS}",
        "--benchmark_enable_random_interleaving=true",
    ]  # fmt: skip
    one_thread = os.environ | {"MKL_THREADING_LAYER": "SEQUENTIAL"}
    done = subprocess.run(
        list(map(str, command)), capture_output=True, text=True, check=False, env=one_thread
    )
    if done.returncode:
        raise HairlutError(f"{program} failed: {done.stderr.strip().splitlines()[-1:]}")
    document = json.loads(done.stdout)
    return _times(document["benchmarks"], describe(_processor(), document.get("context", {})))


def describe(processor: str, context: dict) -> str:
    """The processor with what decides its times: the kernels that the library chooses on it, its second-level
    cache; both from the "context" of the benchmark's output, as far as it says."""
    caches = [cache["size"] for cache in context.get("caches", []) if cache["level"] == 2]
    told = [f"{context['kernels']} kernels"] if "kernels" in context else []
    told += [f"second-level cache of {caches[0] // 1024} KiB"] if caches else []
    return f"{processor} ({', '.join(told)})" if told else processor


def _times(entries: list[dict], processor: str) -> Times:
    repeats: dict[str, list[float]] = {}
    for entry in entries:
        if entry.get("run_type", "iteration") == "iteration":
            repeats.setdefault(entry["run_name"], []).append(entry["ns"])
    ns = {name: min(values) for name, values in repeats.items()}
    return Times(ns, {name: (max(v) - min(v)) / ns[name] for name, v in repeats.items()}, processor)


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return "unknown processor"
    return next(
        (line.partition(":")[2].strip() for line in lines if line.startswith("model name")),
        "unknown processor",
    )
