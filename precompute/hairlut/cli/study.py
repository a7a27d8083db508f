"""hairlut study: the comparison of warps, cells, rows and ends behind the table's design."""

import argparse
from pathlib import Path

EXAMPLES = """examples:
  hairlut study
  hairlut study --out pages"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = subparsers.add_parser(
        "study",
        help="compare warps, cells, rows, ends and 16-bit texels",
        description="Measures every candidate (some minutes) and writes DIR/study.md and its figures.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--out", type=Path, default=Path("luts/report"), metavar="DIR", help="default: luts/report"
    )
    return parser


def run(args: argparse.Namespace) -> int:
    from ..extras import needed_for_plots

    needed_for_plots()
    from ..report import progress, study_page

    with progress("study") as step:
        study_page.write(args.out, step)
    print(args.out / "study.md")
    return 0
