# SPDX-License-Identifier: BSD-3-Clause
"""The lobe explorer: one HTML page that draws with the shipped shader from the models inside it."""

import base64
import json
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from . import __version__, config
from .exr import read_model
from .files import write_whole
from .lobes import MODELS
from .measure import Errors, measure
from .model import BakedModel, assemble
from .size import table_of_size
from .stream import stream
from .table import Table

VIEWER = Path(__file__).with_name("viewer")
PROGRAMS = ("model", "draw", "evaluate", "shares", "screen", "sphere", "point", "dot", "nothing")
SIZES = (16, 32)


def write_explorer(directories: Sequence[Path], out: Path, sizes: Sequence[int] = SIZES) -> Path:
    """Writes the page of the models in directories, with their tables baked again at sizes; returns out."""
    return write_whole(Path(out), page(directories, sizes).encode())


def page(directories: Sequence[Path], sizes: Sequence[int] = SIZES) -> str:
    """The page as text."""
    models = {}
    for directory in directories:
        shipped = read_model(directory)
        models[shipped.name] = model_data(shipped, sizes)
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


def model_data(shipped: BakedModel, sizes: Sequence[int]) -> dict:
    """A model at every size: as shipped, and baked again where its lobes have formulas."""
    names = [table.name for table in shipped.tables]
    lobes = [
        {"name": lobe.name, "tables": [names.index(table.name) for table in lobe.tables]}
        for lobe in shipped.lobes
    ]
    data = {"lobes": lobes, "parameters": [asdict(parameter) for parameter in shipped.parameters]}
    model = MODELS.get(shipped.name)
    if model is None:
        return data | {"sizes": {"shipped": _size(shipped, {})}}
    exact = {lobe.name: lobe for lobe in model.lobes}
    chosen = {"shipped": _size(shipped, {t.name: measure(t, exact[t.name]) for t in shipped.tables})}
    for size in sizes:
        choices = {name: table_of_size(exact[name], size, size) for name in names}
        baked = assemble(model, {name: choice.table for name, choice in choices.items()})
        chosen[str(size)] = _size(baked, {name: choice.errors for name, choice in choices.items()})
    return data | {"sizes": chosen}


def _size(model: BakedModel, errors: Mapping[str, Errors]) -> dict:
    names = [parameter.name for parameter in model.parameters]
    return {
        "stream": _packed(stream(model)),
        "tables": [_table(table, names, errors.get(table.name)) for table in model.tables],
    }


def _table(table: Table, parameters: list[str], errors: Errors | None) -> dict:
    return {
        "name": table.name,
        "width": table.width,
        "height": table.height,
        "theta_r": table.theta_r_range,
        "domain": table.domain,
        "axes": [
            {"parameter": parameters.index(axis.name), "nodes": axis.nodes.tolist()} for axis in table.axes
        ],
        "texels": _packed(table.texels),
        "variance": errors and [float(f"{x:.3g}") for x in errors.variance],
        "weight": errors and [float(f"{x:.5g}") for x in errors.weight],
    }


def _packed(floats: np.ndarray) -> str:
    """Little-endian 32-bit floats, deflated, as base64."""
    return base64.b64encode(zlib.compress(np.ascontiguousarray(floats, "<f4").tobytes(), 9)).decode("ascii")


def _script(name: str, text: str) -> str:
    return f'<script type="text/plain" id="{name}">\n{text}</script>'
