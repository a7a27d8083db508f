"""Ratios of speed from one run of hairlut_bench: summary.py RESULTS.json.

A ratio is taken of the least times of all repeats, since another program's interference only adds to them;
then of the medians, with the spread of the ratios of single repeats, which the benchmark interleaves.
"""

import argparse
import json
import statistics
import sys
from collections import defaultdict
from pathlib import Path

TABLES = ("direct_theta", "direct_phi", "multiple_theta")
LOBES = ("direct", "multiple")


def read(path: Path) -> dict[str, list[float]]:
    """ns a sample of every repeat, by name."""
    times = defaultdict(list)
    for run in json.loads(path.read_text())["benchmarks"]:
        if run.get("run_type") == "iteration" and not run.get("error_occurred"):
            times[run.get("run_name", run["name"]).split("/repeats")[0]].append(run["ns"])
    return dict(times)


class Ratio:
    """slow / fast: how many times faster the second is."""

    def __init__(self, slow: list[float], fast: list[float]) -> None:
        self.least = min(slow) / min(fast)
        self.median = statistics.median(slow) / statistics.median(fast)
        single = [a / b for a, b in zip(slow, fast, strict=False)]
        self.low, self.high = min(single), max(single)

    def __str__(self) -> str:
        return f"{self.least:.2f}; {self.median:.2f} ({self.low:.2f} to {self.high:.2f})"


def models(times: dict[str, list[float]]) -> list[str]:
    return sorted({name.split("/")[2] for name in times if name.startswith("sample/scalar/")})


def reading(model: str) -> str:
    """The reading whose rivals a model is compared with, from its directory's name."""
    return "printed" if model.startswith("printed") else "fitted"


def fastest(times: dict[str, list[float]], prefix: str, suffix: str) -> list[float] | None:
    """The rival's fastest form."""
    found = [times[n] for n in times if n.startswith(prefix) and n.endswith(suffix)]
    return min(found, key=min, default=None)


def goals(
    times: dict[str, list[float]], model: str, table: str
) -> list[tuple[str, list[float] | None, list[float] | None]]:
    """(what, slow, fast) of one table."""
    here, rival = f"{model}/{table}", f"{reading(model)}/{table}"
    scalar, batch = (
        times.get(f"sample/scalar/{here}"),
        times.get(f"sample/batch/{here}"),
    )
    return [
        (
            "analytic, scalar / scalar sample (goal 8)",
            times.get(f"rival/analytic/scalar/{rival}"),
            scalar,
        ),
        (
            "hybrid, scalar / scalar sample (goal 2.5)",
            times.get(f"rival/hybrid/scalar/{rival}"),
            scalar,
        ),
        (
            "Boost, scalar / scalar sample",
            times.get(f"rival/boost/scalar/{rival}"),
            scalar,
        ),
        (
            "analytic, vectorised / batch sample (goal 5)",
            fastest(times, "rival/analytic/vector", rival),
            batch,
        ),
        (
            "hybrid, vectorised / batch sample (goal 4)",
            fastest(times, "rival/hybrid/vector", rival),
            batch,
        ),
        ("MKL / batch sample", times.get(f"rival/mkl/vector/{rival}"), batch),
        (
            "batch sample / floor from angles (limit 2.5)",
            batch,
            times.get(f"floor/angles/{here}"),
        ),
        (
            "batch sample / floor from indices (limit 2.5)",
            batch,
            times.get(f"floor/index/{here}"),
        ),
        (
            "pdf / sample of one table, scalar",
            times.get(f"pdf/scalar/{here}"),
            scalar,
        ),
        ("pdf / sample of one table, batch", times.get(f"pdf/batch/{here}"), batch),
        (
            "scalar sample / uniform in u (limit 1.5)",
            scalar,
            times.get(f"uniform/scalar/{here}"),
        ),
        (
            "batch sample / uniform in u (limit 1.5)",
            batch,
            times.get(f"uniform/batch/{here}"),
        ),
    ]


def lobe_goals(times, model: str, lobe: str):
    """The public functions: two tables, azimuth and both densities a sample."""

    def get(what):
        return times.get(f"lobe/{what}/{model}/{lobe}")

    return [
        (
            "pdf / sample of a direction, scalar (limit 2.5)",
            get("pdf/scalar"),
            get("sample/scalar"),
        ),
        (
            "pdf / sample of a direction, batch (limit 2.5)",
            get("pdf/batch"),
            get("sample/batch"),
        ),
        ("sample of a direction, scalar / batch", get("sample/scalar"), get("sample/batch")),
    ]


def table(title: str, columns: list[str], rows: dict[str, list[str]]) -> list[str]:
    head = [
        f"\n{title}\n",
        f"| | {' | '.join(columns)} |",
        "|---" * (len(columns) + 1) + "|",
    ]
    return head + [f"| {name} | {' | '.join(cells)} |" for name, cells in rows.items()]


def report(times: dict[str, list[float]]) -> str:
    lines = ["Ratios of the least times; of the medians (and of single repeats, from lowest to highest)."]
    for model in models(times):
        for kind, names, of in (("table", TABLES, goals), ("lobe", LOBES, lobe_goals)):
            rows: dict[str, list[str]] = {}
            for name in names:
                for what, slow, fast in of(times, model, name):
                    rows.setdefault(what, []).append(str(Ratio(slow, fast)) if slow and fast else "not timed")
            lines += table(f"{model}, by {kind}", list(names), rows)
        rows = {}
        for how in (
            "sample/scalar",
            "sample/avx2",
            "sample/avx512",
            "sample/neon",
            "pdf/scalar",
            "pdf/batch",
            "floor/angles",
        ):
            cells = [times.get(f"{how}/{model}/{name}") for name in TABLES]
            if all(cells):
                rows[how] = [f"{min(c):.2f}" for c in cells]
        lines += table(f"{model}, least ns a sample", list(TABLES), rows)
    return "\n".join(lines)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path)
    print(report(read(parser.parse_args(arguments).results)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
