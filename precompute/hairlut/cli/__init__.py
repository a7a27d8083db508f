"""The command hairlut: a module a subcommand, with add_parser(subparsers) and run(args) -> exit code."""

import argparse
import importlib
import sys
from collections.abc import Sequence

from .. import __version__
from ..errors import HairlutError

COMMANDS = ("bake", "fit", "inspect", "verify", "export", "view", "plot")
OK, CHECK_FAILED, WRONG_USE = 0, 1, 2

EPILOG = """examples:
  hairlut bake                             bake both models into luts/
  hairlut inspect luts/fitted/direct_phi.exr
  hairlut export luts/printed luts/fitted --to c --out tables.c
exit codes: 0 done, 1 a check failed, 2 wrong use"""


def build_parser(commands: Sequence[str] = COMMANDS) -> argparse.ArgumentParser:
    """The parser of these commands: to import all of them takes longer than to bake a model."""
    parser = argparse.ArgumentParser(
        prog="hairlut",
        description="Bakes the sampling distributions of a hair shader into small lookup textures.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"hairlut {__version__}")
    subparsers = parser.add_subparsers(metavar="COMMAND", required=True)
    for name in commands:
        command = importlib.import_module(f".{name}", __name__)
        command.add_parser(subparsers).set_defaults(run=command.run)
    return parser


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
