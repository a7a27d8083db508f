# SPDX-License-Identifier: BSD-3-Clause
"""hairlut plot: pictures of textures, lobes and errors."""

import argparse
from pathlib import Path

from .. import mixturefile
from ..errors import HairlutError
from ..fixed import parse_values
from . import OK, add_command

EXAMPLES = """examples:
  hairlut plot luts/fitted/direct_theta.exr
  hairlut plot luts --out pictures
  hairlut plot luts/groom --at beta_m=0.3     a groom's tables, where one parameter has this value"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = add_command(
        subparsers,
        "plot",
        help="plot a table and the density that it samples",
        description="Writes DIR/<model>_<table>.png for a table, or for every table below a directory: the "
        "texture, its density, some rows, and its errors, if it was baked from a formula. A table over "
        "parameters of the hair is shown at fixed values, and along each of its parameters.",
        epilog=EXAMPLES,
    )
    parser.add_argument("path", type=Path, nargs="+", help="a table, or a directory of models")
    parser.add_argument("--model", metavar="FILE", help="the model file that the tables were baked from")
    parser.add_argument(
        "--at",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="fix a parameter of the hair; those that are not named get their standard values",
    )
    parser.add_argument(
        "--out", type=Path, default=Path("."), metavar="DIR", help="default: the working directory"
    )
    return parser


def run(args: argparse.Namespace) -> int:
    from ..extras import needed_for_plots

    needed_for_plots()
    from .. import plot
    from ..modelfile import find

    model = find(args.model) if args.model else None
    at = parse_values(args.at)
    files = [file for path in args.path for file in (tables_below(path) if path.is_dir() else [path])]
    for file in files:
        print(plot.plot_file(file, args.out, model, at))
    return OK


def tables_below(folder: Path) -> list[Path]:
    """The tables below a directory."""
    found = [file for file in sorted(folder.rglob("*.exr")) if file.name != mixturefile.FILE]
    if not found:
        raise HairlutError(f"{folder}: no .exr file in this directory: expected <model>/<table>.exr")
    return found
