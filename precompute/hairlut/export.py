# SPDX-License-Identifier: BSD-3-Clause
"""Models and tables for engines that do not read OpenEXR.

Target "c" is a C source against the public header (csource.py); "raw" and "npz" are plain arrays (arrays.py),
of which "raw" also writes a model as the stream that the shaders read. "exr" writes a model's files again: of
use where it depends on parameters of the hair and is wanted at fixed ones.
There is no KTX2 or DDS: the one maintained writer of float KTX2 for Python, pyktx, needs the native libktx,
which neither pip nor Debian installs; for DDS of floats there is none. A raw file is what those containers
have behind their header.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from . import arrays, csource, exr
from .errors import HairlutError
from .files import write_whole
from .fixed import fixed
from .model import BakedModel
from .table import Table

Errors = Mapping[str, float]
NO_VALUES: Mapping[str, float] = {}


@dataclass(frozen=True)
class Source:
    """What a path names: tables, with their measured errors, and the model, where it is a directory."""

    path: Path
    tables: Sequence[tuple[Table, Errors]]
    model: BakedModel | None


def export(paths: Sequence[Path], target: str, out: Path, at: Mapping[str, float] = NO_VALUES) -> Path:
    """Writes the tables at paths to out in the form of target, one of TARGETS; returns out.

    paths: directories of a model, or single files, which "c" and "exr" do not take. out: the file for "c",
    else the folder that <model>/ goes to. at: parameters of the hair to fix, at these values and at standard
    ones for those that it does not name; empty to fix none.
    """
    if target not in TARGETS:
        raise HairlutError(f"--to {target}: expected one of {', '.join(TARGETS)}")
    sources = [_source(Path(path), at, target in SINGLE_TABLES) for path in paths]
    return TARGETS[target](sources, Path(out))


def _source(path: Path, at: Mapping[str, float], may_be_a_table: bool) -> Source:
    if may_be_a_table and not path.is_dir():
        if at:
            raise HairlutError(
                f"{path}: --at: expected a directory, as one table does not know the parameters"
            )
        return Source(path, [exr.read(path)], None)
    model = fixed(path, exr.read_model(path), at) if at else exr.read_model(path)
    return Source(path, [(table, model.errors.get(table.name, {})) for table in model.tables], model)


def export_c(sources: Sequence[Source], out: Path) -> Path:
    """One C source that defines a hairlut_model_desc for each directory."""
    return write_whole(out, csource.source(_models(sources)).encode("ascii"))


def export_exr(sources: Sequence[Source], out: Path) -> Path:
    """The files of each directory's model, which go to another directory than its own."""
    models = _named_apart(_models(sources))
    for model in models:
        for source in sources:
            if (out / model.name).resolve() == source.path.resolve():
                raise HairlutError(
                    f"--out {out}: would replace {source.path}, which is exported: expected another folder"
                )
    for model in models:
        exr.write_model(out / model.name, model)
    return out


def export_raw(sources: Sequence[Source], out: Path) -> Path:
    """Raw floats with a JSON sidecar: each table, and the stream of each directory's model."""
    models = _named_apart(_models(sources))
    _each(sources, out, arrays.write_raw)
    for model in models:
        arrays.write_stream(model, out)
    return out


def export_npz(sources: Sequence[Source], out: Path) -> Path:
    """One npz for each table."""
    return _each(sources, out, arrays.write_npz)


def _each(sources: Sequence[Source], out: Path, write: Callable[[Table, Errors, Path], list[Path]]) -> Path:
    for source in sources:
        for table, errors in source.tables:
            write(table, errors, out)
    return out


def _models(sources: Sequence[Source]) -> list[BakedModel]:
    return [source.model for source in sources if source.model]


def _named_apart(models: list[BakedModel]) -> list[BakedModel]:
    names = [model.name for model in models]
    if len(set(names)) < len(names):
        raise HairlutError(f"models {', '.join(names)}: expected a different name for each directory")
    return models


SINGLE_TABLES = ("raw", "npz")
TARGETS: dict[str, Callable[[Sequence[Source], Path], Path]] = {
    "c": export_c,
    "exr": export_exr,
    "raw": export_raw,
    "npz": export_npz,
}
