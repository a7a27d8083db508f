# SPDX-License-Identifier: BSD-3-Clause
"""hairlut plot: pictures of textures, lobes and errors."""

import argparse
from pathlib import Path

from .. import exr, mixturefile
from ..errors import HairlutError
from ..lobes import NO_FORMULA
from . import OK, add_command

EXAMPLES = """examples:
  hairlut plot luts/fitted/direct_theta.exr
  hairlut plot luts --out pictures"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = add_command(
        subparsers,
        "plot",
        help="plot a table, the lobe that it samples, and its errors",
        description="Writes DIR/<model>_<table>.png for a table, or for every table below a directory.",
        epilog=EXAMPLES,
    )
    parser.add_argument("path", type=Path, nargs="+", help="a table, or a directory of models")
    parser.add_argument("--model", metavar="FILE", help="the model file that the tables were baked from")
    parser.add_argument(
        "--out", type=Path, default=Path("."), metavar="DIR", help="default: the working directory"
    )
    return parser


def run(args: argparse.Namespace) -> int:
    from ..extras import needed_for_plots

    needed_for_plots()
    from .. import plot
    from ..modelfile import find
    from ..verify import lobe_of

    model = find(args.model) if args.model else None
    files = [file for path in args.path for file in (tables_below(path) if path.is_dir() else [path])]
    for file in files:
        print(plot.plot_file(file, lobe_of(file, model), args.out))
    return OK


def tables_below(folder: Path) -> list[Path]:
    """The tables below a directory, apart from those that were fitted to a BSDF: no formula is known to draw
    them against."""
    found = [file for file in sorted(folder.rglob("*.exr")) if file.name != mixturefile.FILE]
    if not found:
        raise HairlutError(f"{folder}: no .exr file in this directory: expected <model>/<table>.exr")
    drawn = [file for file in found if exr.read(file)[0].parameters != NO_FORMULA]
    if not drawn:
        raise HairlutError(
            f"{folder}: its tables were fitted to a BSDF: no formula is known to draw them against"
        )
    return drawn
