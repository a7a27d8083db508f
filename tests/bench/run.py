# SPDX-License-Identifier: BSD-3-Clause
"""`make bench`: builds hairlut_bench, bakes a large model, times hairlut beside its rivals, prints ratios."""

import argparse
import shutil
import subprocess
import sys
from pathlib import Path

from bench import summary, timing

from hairlut.errors import HairlutError

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "bench"
LARGE = "256x256"
# whole calls, one at a time and over arrays; threads and the study's warps are the report's
CALLS = "^(fitted|brown|printed|fitted-.*)/[^/]+/[^/]+/(one|native|avx2|arrays[0-9]*)$"


def tool(name: str) -> str:
    """A program of this environment, else of the path."""
    beside = Path(sys.executable).parent / name
    found = str(beside) if beside.exists() else shutil.which(name)
    if not found:
        raise HairlutError(f"{name} is missing")
    return found


def run(*command: object) -> None:
    done = subprocess.run([str(word) for word in command], check=False)
    if done.returncode:
        raise HairlutError(f"{' '.join(map(str, command))} failed")


def build() -> Path:
    run(tool("cmake"), "-S", ROOT / "tests" / "bench", "-B", BUILD, "-G", "Ninja", "--log-level=WARNING",
        f"-DCMAKE_MAKE_PROGRAM={tool('ninja')}", f"-DMKL_ROOT={sys.prefix}")  # fmt: skip
    run(tool("cmake"), "--build", BUILD, "--", "--quiet")
    return BUILD / "hairlut_bench"


def bake(directory: Path) -> None:
    """A large model, as directory/fitted-256x256."""
    staging = directory.parent / "staging"
    run(tool("hairlut"), "bake", "--model", "fitted", "--size", LARGE, "--out", staging)
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    shutil.move(staging / "fitted", directory / f"fitted-{LARGE}")


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="bench", description=__doc__)
    parser.add_argument(
        "--luts",
        type=Path,
        metavar="DIR",
        help="further model directories (default: a large model, baked into build/bench/luts)",
    )
    parser.add_argument("--filter", default=CALLS, metavar="REGEX", help="which benchmarks to run")
    parser.add_argument("--build-only", action="store_true", help="build hairlut_bench, time nothing")
    parser.add_argument("--repetitions", type=int, default=timing.REPETITIONS)
    parser.add_argument("--seconds", type=float, default=timing.LEAST_TIME, help="least time of each repeat")
    parser.add_argument("--json", type=Path, default=BUILD / "results.json", metavar="FILE")
    return parser.parse_args()


def main() -> int:
    args = parse()
    try:
        program = build()
        if args.build_only:
            return 0
        if not args.luts:
            args.luts = BUILD / "luts"
            bake(args.luts)
        times = timing.measure(program, args.luts, args.filter, args.json, args.repetitions, args.seconds)
    except HairlutError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 2
    print(summary.report(times))
    return 0


if __name__ == "__main__":
    sys.exit(main())
