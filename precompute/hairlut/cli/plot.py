"""hairlut plot: pictures of textures, lobes and errors."""

import argparse
from pathlib import Path

from ..errors import HairlutError
from . import OK

EXAMPLES = """examples:
  hairlut plot luts/fitted/direct_theta.exr
  hairlut plot luts --out pictures"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = subparsers.add_parser(
        "plot",
        help="draw a texture, the lobe that it samples, and its errors",
        description="Writes DIR/<model>_<table>.png for a file, or for every .exr file below a directory.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("path", type=Path, nargs="+", help="a file, or a directory with .exr files below it")
    parser.add_argument("--model", metavar="FILE", help="the model file from which the tables were baked")
    parser.add_argument("--out", type=Path, default=Path("."), metavar="DIR", help="default: here")
    return parser


def run(args: argparse.Namespace) -> int:
    from ..extras import needed_for_plots

    needed_for_plots()
    from .. import plot
    from ..modelfile import find
    from ..verify import lobe_of

    model = find(args.model) if args.model else None
    files = [
        file for path in args.path for file in (sorted(path.rglob("*.exr")) if path.is_dir() else [path])
    ]
    if not files:
        raise HairlutError(
            f"{', '.join(map(str, args.path))}: no .exr file below: expected <model>/<table>.exr"
        )
    for file in files:
        print(plot.plot_file(file, lobe_of(file, model), args.out))
    return OK
