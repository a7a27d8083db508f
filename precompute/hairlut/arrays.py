"""Tables as plain arrays: raw floats with a JSON sidecar, and npz.

A table <model>/<table>.exr becomes <model>/<table>.f32, its texels row by row as little-endian 32-bit floats,
with <table>.json beside it; or <table>.npz with the same JSON text in the array "sidecar".
"""

import io
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from . import exr
from .axis import AXIS, axis_numbers
from .files import write_whole
from .table import Table

Errors = Mapping[str, float]


def sidecar(table: Table, errors: Errors) -> dict:
    """What the file's header says, and the numbers of the axis in the order that a shader wants them."""
    numbers = dict(zip(AXIS, axis_numbers(table), strict=True))
    return {
        "file": f"{table.name}.f32",
        "type": "float32, little-endian, row by row",
        "width": table.width,
        "height": table.height,
        "header": exr.attributes(table),
        "errors": dict(errors),
        "axis": numbers,
        # hairlut_axis_of in runtime/shaders; the leading 0 is the includer's handle of the table
        "shader": [0.0, *numbers.values()],
    }


def write_raw(table: Table, errors: Errors, folder: Path) -> list[Path]:
    """Writes folder/<model>/<table>.f32 and .json; their paths."""
    base = folder / table.model / table.name
    text = json.dumps(sidecar(table, errors), indent=1) + "\n"
    return [
        write_whole(base.with_suffix(".f32"), np.ascontiguousarray(table.texels, "<f4").tobytes()),
        write_whole(base.with_suffix(".json"), text.encode("ascii")),
    ]


def write_npz(table: Table, errors: Errors, folder: Path) -> list[Path]:
    """Writes folder/<model>/<table>.npz: texels, theta_r of the rows, u of the columns, and the sidecar."""
    data = io.BytesIO()
    np.savez(
        data,
        texels=np.ascontiguousarray(table.texels, np.float32),
        theta_r=table.theta_r,
        u=table.warp.u(table.width),
        sidecar=np.array(json.dumps(sidecar(table, errors))),
    )
    return [write_whole(folder / table.model / f"{table.name}.npz", data.getvalue())]
