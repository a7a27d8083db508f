# SPDX-License-Identifier: BSD-3-Clause
"""Writes the pages of the report: speed, scale, hard cases, the study, quasi-random numbers, with plots.

PYTHONPATH=tests .venv/bin/python -m report --bench build/bench/hairlut_bench     some minutes
PYTHONPATH=tests .venv/bin/python -m report --only hard --out pages
"""

import argparse
import sys
from pathlib import Path

from hairlut.errors import HairlutError
from hairlut.extras import needed_for_plots
from report import write
from report.places import PAGES, ROOT

PARTS = ("speed", "scale", "sizes", "hard", "study", "quasi", "pictures")


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="report", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=PAGES, metavar="DIR", help="default: %(default)s")
    parser.add_argument("--luts", type=Path, default=ROOT / "luts", metavar="DIR", help="the shipped tables")
    parser.add_argument(
        "--bench",
        type=Path,
        default=ROOT / "build" / "bench" / "hairlut_bench",
        metavar="PROGRAM",
        help="the benchmark program, built from tests/bench (default: %(default)s)",
    )
    parser.add_argument("--only", choices=PARTS, action="append", help="this part alone; may be repeated")
    return parser.parse_args()


def main() -> int:
    args = parse()
    try:
        needed_for_plots()
        for path in write(args.out, args.luts, args.bench, args.only or PARTS):
            print(path)
    except HairlutError as error:
        print(f"report: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
