"""hairlut export: tables for engines with their own loaders."""

import argparse
from pathlib import Path

from ..export import TARGETS, export

EXAMPLES = """examples:
  hairlut export luts/printed luts/fitted --to c --out build/builtin_tables.c"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = subparsers.add_parser(
        "export",
        help="write tables in another form",
        description="Writes baked tables in a form that needs no OpenEXR. c: a C source of the models.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("path", type=Path, nargs="+", help="directory of a model")
    parser.add_argument("--to", required=True, choices=sorted(TARGETS), help="form of the output")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="file to write")
    return parser


def run(args: argparse.Namespace) -> int:
    print(export(args.path, args.to, args.out))
    return 0
