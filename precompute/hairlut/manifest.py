# SPDX-License-Identifier: BSD-3-Clause
"""Whether the textures of a model file are up to date: what they were made from, kept beside them.

A model's directory holds `manifest.json`, written after the textures: the SHA-256 of the model file, of the
files it names in INPUTS and of each texture, with the options and the version that made them. Textures are
up to date when all of these are still so; an interrupted bake leaves some that are not.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable
from pathlib import Path

from . import __version__
from .files import write_whole

NAME = "manifest.json"


def is_current(folder: Path, source: Path, options: dict) -> bool:
    """Whether folder holds the textures of this model file, made with these options by this version."""
    try:
        manifest = json.loads((folder / NAME).read_text())
        made_from = {folder / name: digest for name, digest in manifest["inputs"].items()}
        made = {folder / name: digest for name, digest in manifest["textures"].items()}
        return (
            manifest["generator"] == __version__
            and manifest["options"] == options
            and _relative(source, folder) in manifest["inputs"]
            and all(_digest(path) == digest for path, digest in {**made_from, **made}.items())
        )
    except (OSError, ValueError, KeyError, AttributeError, TypeError):
        return False


def record(folder: Path, inputs: Iterable[Path], textures: Iterable[Path], options: dict) -> None:
    """Writes the manifest of textures that have just been written into folder."""
    manifest = {
        "generator": __version__,
        "options": options,
        "inputs": {_relative(path, folder): _digest(path) for path in inputs},
        "textures": {path.name: _digest(path) for path in textures},
    }
    write_whole(folder / NAME, f"{json.dumps(manifest, indent=1)}\n".encode())


def source(folder: Path) -> Path | None:
    """The model file that the manifest in folder names, if it is there and holds only data.

    To load a Python file because a manifest says so would run whatever stands in it.
    """
    try:
        first = next(iter(json.loads((folder / NAME).read_text())["inputs"]))
        path = folder / first
        return path if path.suffix in (".toml", ".npz") and path.is_file() else None
    except (OSError, ValueError, KeyError, AttributeError, TypeError, StopIteration):
        return None


def _relative(path: Path, folder: Path) -> str:
    return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
