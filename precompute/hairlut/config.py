# SPDX-License-Identifier: BSD-3-Clause
"""Where the parts of an installed hairlut lie: `python -m hairlut.config --cmake-dir`.

In a wheel they are in the package's folder sdk/; a checkout has them in runtime/ and luts/.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from .errors import HairlutError

PACKAGE = Path(__file__).parent
CHECKOUT = PACKAGE.parents[1]
ROOTS = {"luts": CHECKOUT / "luts", "shaders": CHECKOUT / "runtime" / "shaders"}


def data(part: str) -> Path:
    """The folder of "luts" or "shaders"; HairlutError if this installation has none."""
    if ROOTS[part].is_dir():
        return ROOTS[part]
    return _existing(_sdk() / "share" / "hairlut" / part)


def include_dir() -> Path:
    """The folder of hairlut.h."""
    here = CHECKOUT / "runtime" / "include"
    return here if here.is_dir() else _existing(_sdk() / "include")


def cmake_dir() -> Path:
    """The folder of hairlut-config.cmake, for find_package(hairlut) with -Dhairlut_DIR."""
    return _existing(_sdk() / "lib" / "cmake" / "hairlut")


def _sdk() -> Path:
    """The folder sdk beside the compiled library: in an editable installation that is not this folder."""
    try:
        from . import _core
    except ImportError:
        return PACKAGE / "sdk"
    return Path(_core.__file__).parent / "sdk"


def _existing(path: Path) -> Path:
    if not path.is_dir():
        raise HairlutError(
            f"{path}: no such folder: this hairlut was installed without its C library; install a C++ "
            "compiler and run pip install --force-reinstall hairlut"
        )
    return path


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m hairlut.config", description="Prints where parts of the installation lie."
    )
    parser.add_argument(
        "--cmake-dir", action="append_const", dest="requested", const=cmake_dir, help="hairlut-config.cmake"
    )
    parser.add_argument(
        "--include-dir", action="append_const", dest="requested", const=include_dir, help="hairlut.h"
    )
    parser.add_argument(
        "--luts-dir",
        action="append_const",
        dest="requested",
        const=lambda: data("luts"),
        help="the shipped models",
    )
    parser.add_argument(
        "--shaders-dir",
        action="append_const",
        dest="requested",
        const=lambda: data("shaders"),
        help="the shaders",
    )
    requested = parser.parse_args(argv).requested
    if not requested:
        parser.error("expected --cmake-dir, --include-dir, --luts-dir or --shaders-dir")
    try:
        for each in requested:
            print(each())
    except HairlutError as error:
        print(f"hairlut: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
