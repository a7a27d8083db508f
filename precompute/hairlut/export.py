# SPDX-License-Identifier: BSD-3-Clause
"""Models and tables for engines that do not read OpenEXR.

Target "c" is a C source against the public header (csource.py); "raw" and "npz" are plain arrays (arrays.py),
of which "raw" also writes a model as the stream that the shaders read.
There is no KTX2 or DDS: the one maintained writer of float KTX2 for Python, pyktx, needs the native libktx,
which neither pip nor Debian installs; for DDS of floats there is none. A raw file is what those containers
have behind their header.
"""

from collections.abc import Callable, Sequence
from pathlib import Path

from . import arrays, csource, exr
from .errors import HairlutError
from .files import write_whole
from .table import Table


def export(paths: Sequence[Path], target: str, out: Path) -> Path:
    """Writes the tables at paths to out in the form of target, one of TARGETS; returns out.

    paths: directories of a model, or single files, which "c" does not take. out: the file for "c", else the
    folder that <model>/ goes to.
    """
    if target not in TARGETS:
        raise HairlutError(f"--to {target}: expected one of {', '.join(TARGETS)}")
    return TARGETS[target]([Path(path) for path in paths], Path(out))


def export_c(directories: Sequence[Path], out: Path) -> Path:
    """One C source that defines a hairlut_model_desc for each directory."""
    text = csource.source([exr.read_model(directory) for directory in directories])
    return write_whole(out, text.encode("ascii"))


def export_raw(paths: Sequence[Path], out: Path) -> Path:
    """Raw floats with a JSON sidecar: each table, and the stream of each directory's model."""
    models = [exr.read_model(path) for path in paths if path.is_dir()]
    names = [model.name for model in models]
    if len(set(names)) < len(names):
        raise HairlutError(f"models {', '.join(names)}: expected a different name for each directory")
    _each(paths, out, arrays.write_raw)
    for model in models:
        arrays.write_stream(model, out)
    return out


def export_npz(paths: Sequence[Path], out: Path) -> Path:
    """One npz for each table."""
    return _each(paths, out, arrays.write_npz)


def _each(paths: Sequence[Path], out: Path, write: Callable[[Table, dict, Path], list[Path]]) -> Path:
    for table, errors in [found for path in paths for found in _tables(path)]:
        write(table, errors, out)
    return out


def _tables(path: Path) -> list[tuple[Table, dict[str, float]]]:
    """The table of a file, or those of a model's directory, with their measured errors."""
    if not path.is_dir():
        return [exr.read(path)]
    model = exr.read_model(path)
    return [(table, model.errors[table.name]) for table in model.tables]


TARGETS: dict[str, Callable[[Sequence[Path], Path], Path]] = {
    "c": export_c,
    "raw": export_raw,
    "npz": export_npz,
}
