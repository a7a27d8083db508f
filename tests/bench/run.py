"""`make bench`: bakes tables of 64x64 and 256x256, builds hairlut_bench, runs it, prints ratios of speed."""

import argparse
import os
import shutil
import subprocess
import sys
from pathlib import Path

import summary

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "bench"
SIZES = ("64x64", "256x256")


def tool(name: str) -> str:
    """A program of this environment, else of the path."""
    beside = Path(sys.executable).parent / name
    found = str(beside) if beside.exists() else shutil.which(name)
    if not found:
        sys.exit(f"bench: {name} is missing")
    return found


def run(*command, **options) -> None:
    done = subprocess.run([str(word) for word in command], check=False, **options)
    if done.returncode:
        sys.exit(done.returncode)


def bake(directory: Path) -> None:
    """One model directory for each reading and size: printed-64x64 and so on."""
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    for size in SIZES:
        for model in ("printed", "fitted"):
            staging = directory.parent / f"bake-{size}"
            run(tool("hairlut"), "bake", "--model", model, "--size", size, "--out", staging)
            shutil.move(staging / model, directory / f"{model}-{size}")


def build() -> Path:
    run(tool("cmake"), "-S", ROOT / "tests" / "bench", "-B", BUILD, "-G", "Ninja", "--log-level=WARNING",
        f"-DCMAKE_MAKE_PROGRAM={tool('ninja')}", f"-DMKL_ROOT={sys.prefix}")  # fmt: skip
    run(tool("cmake"), "--build", BUILD, "--", "--quiet")
    return BUILD / "hairlut_bench"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--luts",
        type=Path,
        help="directory of model directories; default: baked for the benchmark, into build/bench/luts",
    )
    parser.add_argument("--filter", default=".", metavar="REGEX", help="which benchmarks to run")
    parser.add_argument("--build-only", action="store_true", help="build hairlut_bench, time nothing")
    parser.add_argument("--repetitions", type=int, default=24)
    parser.add_argument("--seconds", type=float, default=0.015, help="least time of each repeat")
    parser.add_argument("--json", type=Path, default=BUILD / "results.json", metavar="FILE")
    args = parser.parse_args()
    program = build()
    if args.build_only:
        return
    if not args.luts:
        args.luts = BUILD / "luts"
        bake(args.luts)
    environment = os.environ | {"MKL_THREADING_LAYER": "SEQUENTIAL"}
    run(program, "--luts", args.luts, f"--benchmark_filter={args.filter}", f"--benchmark_out={args.json}",
        "--benchmark_out_format=json", f"--benchmark_repetitions={args.repetitions}",
        f"--benchmark_min_time={args.seconds}", "--benchmark_enable_random_interleaving=true",
        env=environment, stdout=subprocess.DEVNULL)  # fmt: skip
    print(summary.report(summary.read(args.json)))


if __name__ == "__main__":
    main()
