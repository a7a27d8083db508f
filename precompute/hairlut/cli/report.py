"""hairlut report: the pages of luts/report/."""

import argparse
from pathlib import Path

PARTS = ("speed", "hard", "study", "pictures")

EXAMPLES = """examples:
  hairlut report --bench build/bench/hairlut_bench        all pages, some minutes
  hairlut report --only hard --out pages"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = subparsers.add_parser(
        "report",
        help="write speed against error, the hard cases and the study as pages with plots",
        description="Measures everything again and writes DIR/{speed_error,hard_cases,study}.md and figures.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--out", type=Path, default=Path("luts/report"), metavar="DIR", help="default: luts/report"
    )
    parser.add_argument("--luts", type=Path, default=Path("luts"), metavar="DIR", help="the shipped tables")
    parser.add_argument(
        "--bench",
        type=Path,
        default=Path("build/bench/hairlut_bench"),
        metavar="PROGRAM",
        help="the benchmark program, built from tests/bench (default: %(default)s)",
    )
    parser.add_argument("--only", choices=PARTS, action="append", help="this part alone; may be repeated")
    return parser


def run(args: argparse.Namespace) -> int:
    from ..extras import needed_for_plots

    needed_for_plots()
    from ..report import write

    for path in write(args.out, args.luts, args.bench, args.only or PARTS):
        print(path)
    return 0
