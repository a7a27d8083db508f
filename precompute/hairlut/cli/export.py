# SPDX-License-Identifier: BSD-3-Clause
"""hairlut export: tables for engines with their own loaders."""

import argparse
from pathlib import Path

from ..export import TARGETS, export
from ..fixed import parse_values
from . import OK, add_command

EXAMPLES = """examples:
  hairlut export luts/printed luts/fitted --to c --out build/builtin_tables.c
  hairlut export luts/brown --to raw --out build                     build/brown/hair.f32, for shaders
  hairlut export luts/fitted/direct_phi.exr --to raw --out build     build/fitted/direct_phi.f32 and .json
  hairlut export luts/printed luts/fitted --to npz --out build
  hairlut export luts/groom --at beta_m=0.3 --at absorption=1 --to exr --out build     one hair of a groom"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = add_command(
        subparsers,
        "export",
        help="write tables for engines that do not read OpenEXR, or a model at fixed parameters",
        description="Writes baked tables in a form that does not need OpenEXR. c: one C source with the "
        "models. raw: little-endian 32-bit floats, with a JSON file beside each: the tables, and each "
        "directory's model as the shaders read it (runtime/shaders/README.md). npz: NumPy arrays. exr: the "
        "model's own files, at the parameters of the hair that --at fixes.",
        epilog=EXAMPLES,
    )
    parser.add_argument(
        "path", type=Path, nargs="+", help="directory of a model, or, for raw and npz, one table"
    )
    parser.add_argument(
        "--at",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="fix a parameter of the hair; those that are not named get their standard values",
    )
    parser.add_argument("--to", required=True, choices=sorted(TARGETS), help="output format")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="OUT", help="file (c) or folder (exr, raw, npz) to write"
    )
    return parser


def run(args: argparse.Namespace) -> int:
    print(export(args.path, args.to, args.out, parse_values(args.at)))
    return OK
