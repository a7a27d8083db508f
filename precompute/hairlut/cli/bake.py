"""hairlut bake: from the equations to the textures."""

import argparse
import re
from pathlib import Path

from .. import exr
from ..interpolant import Cell
from ..lobes import MODELS, find_model
from ..table import Table, bake_table, check_size
from ..warp import Warp

EXAMPLES = """examples:
  hairlut bake                                      both models into luts/, 64x64
  hairlut bake --model fitted --size 32x32 --out small
  hairlut bake --warp uniform --cell linear --out baseline"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = subparsers.add_parser(
        "bake",
        help="integrate, normalise and invert the lobes; write them as textures",
        description="Integrates every lobe numerically, inverts its CDF and writes DIR/<model>/<table>.exr.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--model", action="append", help=f"one of {', '.join(MODELS)}; may be repeated (default: all)"
    )
    parser.add_argument(
        "--size",
        type=parse_size,
        default=(64, 64),
        metavar="WxH",
        help="columns (u) and rows (theta_r) of each texture (default: 64x64)",
    )
    parser.add_argument("--out", type=Path, default=Path("luts"), metavar="DIR", help="default: luts")
    parser.add_argument(
        "--warp",
        default="quartic e=9.5367431640625e-07",
        metavar="WARP",
        help="where the columns lie on the u axis: 'quartic e=NUMBER' or 'uniform' (default: %(default)s)",
    )
    parser.add_argument(
        "--cell",
        default="quadratic limit=0.9",
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
    warp, cell = Warp.parse(args.warp), Cell.parse(args.cell)
    check_size(*args.size)
    models = [find_model(name) for name in dict.fromkeys(args.model or MODELS)]
    tables = bake_all(models, args.size, warp, cell)
    for table in tables:  # only when all of them have come out
        path = args.out / table.model / f"{table.name}.exr"
        exr.write(path, table)
        print(f"{path}  {table.width}x{table.height}  {table.warp}")
    return 0


def bake_all(models, size: tuple[int, int], warp: Warp, cell: Cell) -> list[Table]:
    from rich.console import Console
    from rich.progress import track

    lobes = [lobe for model in models for lobe in model.lobes]
    console = Console(stderr=True)
    shown = track(lobes, "baking", console=console, transient=True, disable=not console.is_terminal)
    return [bake_table(lobe, *size, warp, cell) for lobe in shown]
