"""hairlut export: tables for engines with their own loaders."""

import argparse
from pathlib import Path

from ..export import TARGETS, export
from . import OK

EXAMPLES = """examples:
  hairlut export luts/printed luts/fitted --to c --out build/builtin_tables.c
  hairlut export luts/fitted/direct_phi.exr --to raw --out build     build/fitted/direct_phi.f32 and .json
  hairlut export luts/printed luts/fitted --to npz --out build"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = subparsers.add_parser(
        "export",
        help="write tables in another form",
        description="Writes baked tables in a form that needs no OpenEXR. c: a C source of the models. "
        "raw: little-endian 32-bit floats with a JSON sidecar. npz: numpy arrays.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "path", type=Path, nargs="+", help="directory of a model; with raw and npz also a file"
    )
    parser.add_argument("--to", required=True, choices=sorted(TARGETS), help="form of the output")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="OUT", help="file (c) or folder (raw, npz) to write"
    )
    return parser


def run(args: argparse.Namespace) -> int:
    print(export(args.path, args.to, args.out))
    return OK
