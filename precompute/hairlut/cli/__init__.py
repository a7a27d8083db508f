# SPDX-License-Identifier: BSD-3-Clause
"""The command hairlut: a module a subcommand, with add_parser(subparsers) and run(args) -> exit code."""

import argparse
import importlib
import sys
import textwrap
from collections.abc import Sequence

from .. import __version__
from ..errors import HairlutError

COMMANDS = ("bake", "fit", "inspect", "verify", "export", "view", "plot")
OK, CHECK_FAILED, WRONG_USE = 0, 1, 2
WIDTH = 100  # of a description, characters

EPILOG = """examples:
  hairlut fit my_hair.py --out luts        from a BSDF to luts/my_hair/, which the C library loads
  hairlut bake                             bake the built-in models into luts/
  hairlut verify luts                      measure every table again
  hairlut export luts/printed luts/fitted --to c --out tables.c
exit codes: 0 done, 1 a check failed (a tolerance not met, a file that verify rejects), 2 wrong use
hairlut COMMAND --help shows a command's options and examples"""


def build_parser(commands: Sequence[str] = COMMANDS) -> argparse.ArgumentParser:
    """The parser of these commands: to import all of them takes longer than to bake a model."""
    parser = argparse.ArgumentParser(
        prog="hairlut",
        description="Makes small lookup textures from which a renderer importance-samples hair.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"hairlut {__version__}")
    subparsers = parser.add_subparsers(metavar="COMMAND", required=True)
    for name in commands:
        command = importlib.import_module(f".{name}", __name__)
        command.add_parser(subparsers).set_defaults(run=command.run)
    return parser


def add_command(subparsers, name: str, help: str, description: str, epilog: str) -> argparse.ArgumentParser:
    """The parser of a command. epilog: examples and what follows them, printed as it stands."""
    return subparsers.add_parser(
        name,
        help=help,
        description=textwrap.fill(description, WIDTH),
        epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )


def main(argv: Sequence[str] | None = None) -> int:
    """Runs a command line; the exit code."""
    argv = sys.argv[1:] if argv is None else argv
    args = build_parser(argv[:1] if argv[:1] and argv[0] in COMMANDS else COMMANDS).parse_args(argv)
    try:
        return args.run(args)
    except HairlutError as error:
        print(f"hairlut: {error}", file=sys.stderr)
        return WRONG_USE
    except BrokenPipeError:  # the reader of our output, such as head, has seen enough
        sys.stderr.close()
        return OK
    except OSError as error:  # a full disk, a file that may not be read
        place = f"{error.filename}: " if error.filename else ""
        print(f"hairlut: {place}{error.strerror or error}", file=sys.stderr)
        return WRONG_USE
    except MemoryError:
        print("hairlut: out of memory: give it less data, or smaller sizes", file=sys.stderr)
        return WRONG_USE
    except KeyboardInterrupt:
        print("hairlut: interrupted; no file was left half-written", file=sys.stderr)
        return 130
