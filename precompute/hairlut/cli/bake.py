"""hairlut bake: from the equations to the textures."""

import argparse
import re
import sys
from pathlib import Path

from .. import exr, size
from ..errors import HairlutError
from ..interpolant import Cell
from ..lobes import MODELS, Lobe, find_model
from ..measure import measure
from ..table import bake_table
from ..warp import Warp

EXAMPLES = """examples:
  hairlut bake                                      both models into luts/, as small as V <= 1e-4 allows
  hairlut bake --model fitted --tolerance 1e-3 --out small
  hairlut bake --size 64x64 --out square
  hairlut bake --size 64x64 --warp uniform --cell linear --out baseline"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = subparsers.add_parser(
        "bake",
        help="integrate, normalise and invert the lobes; write them as textures",
        description="Integrates every lobe numerically, inverts its CDF and writes DIR/<model>/<table>.exr, "
        "with the errors that each table was measured to have.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--model", action="append", help=f"one of {', '.join(MODELS)}; may be repeated (default: all)"
    )
    how_large = parser.add_mutually_exclusive_group()
    how_large.add_argument(
        "--tolerance",
        type=float,
        default=size.DEFAULT_TOLERANCE,
        metavar="V",
        help="relative variance that a table may add to an estimate: the smallest width and height that meet "
        "it are found for each table (default: %(default)g)",
    )
    how_large.add_argument(
        "--size", type=parse_size, metavar="WxH", help="columns (u) and rows (theta_r) of every texture"
    )
    parser.add_argument(
        "--max-size",
        type=int,
        default=size.DEFAULT_LIMIT,
        metavar="N",
        help="longest side that --tolerance may choose (default: %(default)s)",
    )
    parser.add_argument("--out", type=Path, default=Path("luts"), metavar="DIR", help="default: luts")
    parser.add_argument(
        "--warp",
        metavar="WARP",
        help="with --size, where the columns lie on the u axis: 'quartic e=NUMBER' or 'uniform' (default: "
        "quartic, e as measured to be best)",
    )
    parser.add_argument(
        "--cell",
        default=str(size.CELL),
        metavar="CELL",
        help="curve inside a cell: 'quadratic limit=NUMBER' or 'linear' (default: %(default)s)",
    )
    return parser


def parse_size(text: str) -> tuple[int, int]:
    """(width, height) from "64x32"."""
    match = re.fullmatch(r"(\d{1,6})x(\d{1,6})", text)
    if not match:
        raise argparse.ArgumentTypeError(f"{text!r}: expected WIDTHxHEIGHT, for example 64x64")
    return int(match[1]), int(match[2])


def run(args: argparse.Namespace) -> int:
    if args.warp and not args.size:
        raise HairlutError("--warp: a tolerance chooses the warp itself: give --size too")
    args.warp = args.warp and Warp.parse(args.warp)
    args.cell = Cell.parse(args.cell)
    models = [find_model(name) for name in dict.fromkeys(args.model or MODELS)]
    try:
        choices = bake_all([lobe for model in models for lobe in model.lobes], args)
    except size.ToleranceError as error:
        print(f"hairlut: {error}", file=sys.stderr)
        return 1
    for choice in choices:  # only when all of them have come out
        write(args.out, choice)
    return 0


def bake_all(lobes: list[Lobe], args: argparse.Namespace) -> list[size.Choice]:
    from rich.console import Console
    from rich.progress import track

    console = Console(stderr=True)
    shown = track(lobes, "baking", console=console, transient=True, disable=not console.is_terminal)
    return [bake_one(lobe, args) for lobe in shown]


def bake_one(lobe: Lobe, args: argparse.Namespace) -> size.Choice:
    """A table of the size and warp asked for, or chosen by measurement where none was."""
    if args.warp:
        table = bake_table(lobe, *args.size, args.warp, args.cell)
        return size.Choice(table, measure(table, lobe), "size and warp as asked")
    if args.size:
        return size.table_of_size(lobe, *args.size, args.cell)
    return size.smallest_table(lobe, args.tolerance, args.max_size, args.cell)


def write(out: Path, choice: size.Choice) -> None:
    """Writes a table to its place below out, and says what was chosen and why."""
    table, errors = choice.table, choice.errors
    path = out / table.model / f"{table.name}.exr"
    exr.write(path, table, errors.summary())
    print(
        f"{path}  {table.width}x{table.height}, {table.texels.nbytes} bytes, {table.warp}: "
        f"V {errors.relative_variance:.2e}, largest weight {errors.largest_weight:.2f} ({choice.reason})"
    )
