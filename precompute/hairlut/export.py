"""Tables for engines that do not read OpenEXR.

Target "c" is one C source, the runtime's built-in models; "raw" and "npz" are plain arrays (arrays.py).
There is no KTX2 or DDS: the one maintained writer of float KTX2 for Python, pyktx, needs the native libktx,
which neither pip nor Debian installs, and none was found for float DDS. A raw file is what those containers
hold after their header.
"""

import re
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from . import __version__, arrays, exr
from .axis import AXIS, axis_numbers
from .errors import HairlutError
from .files import write_whole
from .interpolant import curvatures
from .lobes import AZIMUTHS, DIFFERENCE, SUM, TABLES
from .table import Table
from .warp import Warp

IN_C = {SUM: "HAIRLUT_AZIMUTH_SUM", DIFFERENCE: "HAIRLUT_AZIMUTH_DIFFERENCE"}
GROUP = 16  # texels, runtime/src/internal.h
WARPS = {"octaves": "HAIRLUT_WARP_OCTAVES", "uniform": "HAIRLUT_WARP_UNIFORM"}


def export(paths: Sequence[Path], target: str, out: Path) -> Path:
    """Writes the tables at paths to out in the form of target, one of TARGETS; returns out.

    paths: directories of a model, or single files, which "c" does not take. out: the file for "c", else the
    folder that <model>/ goes to.
    """
    if target not in TARGETS:
        raise HairlutError(f"--to {target}: expected one of {', '.join(TARGETS)}")
    return TARGETS[target](paths, Path(out))


def export_c(directories: Sequence[Path], out: Path) -> Path:
    """One C source that defines hairlut_builtin_entries (runtime/src/internal.h), one for each directory."""
    models = [read_model(directory) for directory in directories]
    names = [tables[0].model for tables in models]
    if len({_identifier(name) for name in names}) < len(names):
        raise HairlutError(f"models {', '.join(names)}: expected a different name for each directory")
    arrays = _arrays(models)
    parts = [
        f"/* By hairlut {__version__} (export --to c) from {', '.join(names)}; not to be edited. */",
        '#include "internal.h"',
        *(_definitions(name, table) for name, table in arrays.values()),
        "const hairlut_builtin_entry hairlut_builtin_entries[] = {",
        *(_entry(tables, arrays) for tables in models),
        "};",
        f"const int hairlut_builtin_count = {len(models)};",
    ]
    return write_whole(out, ("\n".join(parts) + "\n").encode("ascii"))


def export_raw(paths: Sequence[Path], out: Path) -> Path:
    """Raw floats with a JSON sidecar for each table."""
    return _each(paths, out, arrays.write_raw)


def export_npz(paths: Sequence[Path], out: Path) -> Path:
    """One npz for each table."""
    return _each(paths, out, arrays.write_npz)


def _each(paths: Sequence[Path], out: Path, write: Callable[[Table, dict, Path], list[Path]]) -> Path:
    for table, errors in [exr.read(file) for path in paths for file in table_files(path)]:
        write(table, errors, out)
    return out


def table_files(path: Path) -> list[Path]:
    """The file itself, or the three files of a model's directory."""
    return [path / f"{name}.exr" for name in TABLES] if Path(path).is_dir() else [Path(path)]


TARGETS: dict[str, Callable[[Sequence[Path], Path], Path]] = {
    "c": export_c,
    "raw": export_raw,
    "npz": export_npz,
}


def read_model(directory: Path) -> list[Table]:
    """The three tables of a directory, in the order of TABLES, refused if they are not of one model."""
    directory = Path(directory)
    if not directory.is_dir():
        raise HairlutError(
            f"{directory}: expected a directory that holds {', '.join(f'{t}.exr' for t in TABLES)}"
        )
    tables = [exr.read(directory / f"{name}.exr")[0] for name in TABLES]
    names = [table.model for table in tables]
    if len(set(names)) > 1:
        raise HairlutError(
            f"{directory}: attribute hairlut.model differs ({', '.join(names)}): bake them again together"
        )
    if tables[1].azimuth not in AZIMUTHS:
        raise HairlutError(
            f"{directory}/direct_phi.exr: attribute hairlut.azimuth is none, expected sum or difference"
        )
    return tables


def _identifier(name: str) -> str:
    return re.sub(r"\W", "_", name, flags=re.ASCII)


Content = tuple[bytes, int, str, str]
Arrays = dict[Content, tuple[str, Table]]


def _content(table: Table) -> Content:
    """What a table's arrays follow from."""
    return table.texels.tobytes(), table.width, str(table.warp), str(table.cell)


def _arrays(models: Sequence[Sequence[Table]]) -> Arrays:
    """(name, table) of every array that is needed: tables of the same content share one."""
    arrays: Arrays = {}
    for table in (table for tables in models for table in tables):
        arrays.setdefault(_content(table), (f"hairlut_{_identifier(table.model)}_{table.name}", table))
    return arrays


def _literal(x: float) -> str:
    """A C literal that reads back as the same float."""
    text = f"{np.float32(x):.9g}"
    return f"{text}f" if "." in text or "e" in text else f"{text}.0f"


def _step(width: int) -> int:
    """Cells of a block of the search: 9 blocks of 8 where those do, else 17 of a power of two."""
    few = GROUP // 2
    if width - 1 <= (few + 1) * few:
        return few
    return next(step for step in (16, 32, 64, 128, 256) if width - 1 <= (GROUP + 1) * step)


def _rows(table: Table) -> np.ndarray:
    """The rows of the search, as the runtime stores them (runtime/src/internal.h): groups of the texels that
    end blocks, then cells; in a small table, with their changes to the row above."""
    step, cells = _step(table.width), table.width - 1
    size = min(step, GROUP)
    columns = np.concatenate([np.arange(1, size + 1) * step, np.arange(1, cells + -cells % step + 1)])
    inner, of = columns < cells, np.minimum(columns, cells)
    texels = np.concatenate([table.texels, table.texels[-1:]])[:, of]
    stored = [np.where(inner, texels, np.finfo(np.float32).max)]
    if size < GROUP:
        stored.append(np.where(inner, np.diff(texels, axis=0, append=texels[-1:]), 0))
    return np.stack([part.reshape(len(texels), -1, size) for part in stored], axis=2).reshape(len(texels), -1)


def _cells(table: Table) -> np.ndarray:
    """The cells, as the runtime stores them, with its arithmetic: from both ends to the middle, the rows of
    each. A cell is x0, a, c, u0 with x = x0 + d (a - c d), d = min(u, 1-u) - u0, about its nearer knot."""
    x = np.concatenate([table.texels, table.texels[-1:]]).astype(float)
    half, limit = table.width // 2 + 1, float(np.float32(table.cell.limit))
    return np.concatenate([_half(end, table, half, limit) for end in (x, x[:, ::-1])])


def _half(x: np.ndarray, table: Table, half: int, limit: float) -> np.ndarray:
    """The first cells of rows that are counted from one of their ends."""
    u = Warp(table.warp.name, float(np.float32(table.warp.e))).u(table.width).astype(np.float32).astype(float)
    h = np.diff(u)
    c = curvatures(x, h, limit)
    parts = x[:, :-1], (np.diff(x, axis=1) + c) / h, c / (h * h), u[:-1]
    cells = np.stack(np.broadcast_arrays(*parts), axis=-1)
    return cells[:, :half].swapaxes(0, 1).astype(np.float32).reshape(half, -1)


def _definitions(name: str, table: Table) -> str:
    """The arrays of a table's rows and cells."""
    size = f"({table.width}, {table.height})"
    return "\n".join(
        f"static const float HAIRLUT_LINE_ALIGNED {name}_{part}[{macro}{size}] = {{\n"
        + ",\n".join(",".join(map(_literal, row)) for row in numbers)
        + "};"
        for part, macro, numbers in (
            ("rows", "HAIRLUT_STORED", _rows(table)),
            ("cells", "HAIRLUT_CELLS", _cells(table)),
        )
    )


def _axis(table: Table, name: str) -> str:
    numbers = axis_numbers(table)
    before = numbers[AXIS.index("row_origin") : AXIS.index("e")]
    after = numbers[AXIS.index("e") : AXIS.index("limit")]
    return (
        f"HAIRLUT_AXIS({name}_rows, {name}_cells, {table.width}, {table.height}, "
        f"{', '.join(map(_literal, before))}, {WARPS[table.warp.name]}, {', '.join(map(_literal, after))})"
    )


def _entry(tables: Sequence[Table], arrays: Arrays) -> str:
    axes = ",\n      ".join(_axis(table, arrays[_content(table)][0]) for table in tables)
    return f'    {{"{tables[0].model}",\n     {{{axes},\n      {IN_C[tables[1].azimuth]}, {{0, 0, 0}}}}}},'
