# SPDX-License-Identifier: BSD-3-Clause
"""Files that appear whole or not at all."""

import os
from collections.abc import Callable
from pathlib import Path

from .errors import HairlutError


def replace_whole(path: Path, write: Callable[[Path], None]) -> Path:
    """Lets write make a file beside path, with the folders it lies in, and then puts it in path's place.

    HairlutError if that cannot be done; what stood at path before is then untouched.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            write(temporary)
            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)
    except (OSError, RuntimeError) as error:  # OpenEXR raises the latter
        raise HairlutError(
            f"{path}: cannot be written: {getattr(error, 'strerror', None) or error}"
        ) from error
    return path


def check_folder(path: Path) -> None:
    """HairlutError if files in the folder at path, which need not exist yet, could not be written."""
    there = next(folder for folder in (path, *path.absolute().parents) if folder.exists())
    if not there.is_dir() or not os.access(there, os.W_OK):
        why = "may not be written to" if there.is_dir() else "is not a directory"
        raise HairlutError(f"{path}: cannot be written: {there} {why}: name another folder")


def write_whole(path: Path, data: bytes) -> Path:
    """Writes data to path in one step."""
    return replace_whole(path, lambda temporary: temporary.write_bytes(data))
