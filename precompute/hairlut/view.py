"""The lobe explorer: one HTML page that draws with the shipped shader from the tables inside it."""

import base64
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from . import __version__, config
from .axis import axis_numbers
from .exr import read_model
from .files import write_whole
from .lobes import MODELS, SUM
from .measure import Errors, measure
from .size import table_of_size
from .table import Table

VIEWER = Path(__file__).with_name("viewer")
PROGRAMS = ("model", "draw", "evaluate", "screen", "sphere", "point", "dot", "nothing")
SIZES = (16, 32, 64)


def write_explorer(directories: Sequence[Path], out: Path, sizes: Sequence[int] = SIZES) -> Path:
    """Writes the page of the models in directories, with their tables baked again at sizes; returns out."""
    return write_whole(Path(out), page(directories, sizes).encode())


def page(directories: Sequence[Path], sizes: Sequence[int] = SIZES) -> str:
    """The page as text."""
    models = {}
    for directory in directories:
        shipped = read_model(directory).tables
        models[shipped[0].model] = model_data(shipped, sizes)
    programs = {f"{name}.glsl": (VIEWER / f"{name}.glsl").read_text() for name in PROGRAMS}
    programs["hairlut.glsl"] = (config.data("shaders") / "hairlut.glsl").read_text()
    parts = {
        "/*@style*/": (VIEWER / "style.css").read_text(),
        "/*@data*/": json.dumps({"version": __version__, "models": models}, separators=(",", ":")),
        "/*@shaders*/": "\n".join(_script(name, text) for name, text in programs.items()),
        "/*@script*/": (VIEWER / "explorer.js").read_text(),
    }
    text = (VIEWER / "page.html").read_text()
    for mark, part in parts.items():
        text = text.replace(mark, part)
    return text


def model_data(shipped: Sequence[Table], sizes: Sequence[int]) -> dict:
    """A model's tables at every size: as shipped, and baked again where its lobes are known."""
    model = MODELS.get(shipped[0].model)
    if model is None:
        return _model(shipped, {"shipped": [(table, None) for table in shipped]})
    chosen = {
        "shipped": [(table, measure(table, lobe)) for table, lobe in zip(shipped, model.lobes, strict=True)]
    }
    for size in sizes:
        choices = [table_of_size(lobe, size, size) for lobe in model.lobes]
        chosen[str(size)] = [(choice.table, choice.errors) for choice in choices]
    return _model(shipped, chosen)


def _model(shipped: Sequence[Table], chosen: dict[str, list[tuple[Table, Errors | None]]]) -> dict:
    sizes = {size: [_table(table, errors) for table, errors in tables] for size, tables in chosen.items()}
    return {"azimuth": int(shipped[1].azimuth == SUM), "sizes": sizes}


def _table(table: Table, errors: Errors | None) -> dict:
    texels = np.ascontiguousarray(table.texels, "<f4").tobytes()
    return {
        "name": table.name,
        "width": table.width,
        "height": table.height,
        "axis": axis_numbers(table),
        "texels": base64.b64encode(texels).decode("ascii"),
        "variance": errors and [float(f"{x:.3g}") for x in errors.variance],
        "weight": errors and [float(f"{x:.5g}") for x in errors.weight],
    }


def _script(name: str, text: str) -> str:
    return f'<script type="text/plain" id="{name}">\n{text}</script>'
