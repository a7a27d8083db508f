# SPDX-License-Identifier: BSD-3-Clause
"""hairlut view: the lobe explorer."""

import argparse
from pathlib import Path

from . import OK, add_command

EXAMPLES = """examples:
  hairlut view --open                      write explorer.html and show it in a browser
  hairlut view build/mine --out mine.html  a model of your own"""


def add_parser(subparsers) -> argparse.ArgumentParser:
    parser = add_command(
        subparsers,
        "view",
        help="write an interactive HTML page of a model's lobes",
        description="Writes one self-contained HTML page that draws the lobes of baked models with WebGL2 "
        "and the shipped shader: samples, densities, shares, textures and errors, at any theta_r and offset.",
        epilog=EXAMPLES,
    )
    parser.add_argument(
        "directory",
        type=Path,
        nargs="*",
        help="directories of models (default: luts/brown luts/fitted luts/printed)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("explorer.html"),
        metavar="FILE",
        help="page to write (default: %(default)s)",
    )
    parser.add_argument("--open", action="store_true", help="show the page in the default browser")
    return parser


def run(args: argparse.Namespace) -> int:
    from ..view import write_explorer

    models = [Path("luts", name) for name in ("brown", "fitted", "printed")]
    out = write_explorer(args.directory or models, args.out)
    print(f"{out}  {out.stat().st_size / 1024:.0f} KB")
    if args.open:
        import webbrowser

        webbrowser.open(out.resolve().as_uri())
    return OK
