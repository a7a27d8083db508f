# SPDX-License-Identifier: BSD-3-Clause
"""Models and tables as plain arrays: raw little-endian 32-bit floats with a JSON sidecar, and npz.

A model becomes <model>/hair.f32, the stream that the shaders read (stream.py), with hair.json beside it. A
table <model>/<table>.exr becomes <model>/<table>.f32, its texels (angle, dx/du) row by row, with
<table>.json; or <table>.npz with the same JSON text in the array "sidecar".
"""

import io
import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

import numpy as np

from . import exr
from .files import write_whole
from .model import BakedModel
from .stream import WIDTH, head_size, stream
from .table import Table

Errors = Mapping[str, float]


def sidecar(table: Table, errors: Errors) -> dict:
    """What the file's header says, and the size: rows of all nodes of the parameters."""
    return {
        "file": f"{table.name}.f32",
        "type": "float32, little-endian, (angle, dx/du) row by row",
        "width": table.width,
        "height": len(table.texels),
        "header": exr.attributes(table),
        "errors": dict(errors),
    }


def model_sidecar(model: BakedModel, texels: int) -> dict:
    """What a shader's host needs to know of a stream of so many texels."""
    lobes = [
        {"name": lobe.name, "theta": lobe.theta.name, "phi": lobe.phi and lobe.phi.name}
        for lobe in model.lobes
    ]
    return {
        "file": "hair.f32",
        "type": "float32, little-endian, texels of 4",
        "model": model.name,
        "texels": texels,
        "texture": [WIDTH, texels // WIDTH],
        "head": head_size(model),
        "lobes": lobes,
        "theta_r": np.asarray(model.mixture.theta_r, float).tolist(),
        "offset": np.asarray(model.mixture.offset, float).tolist(),
        "mirrored": bool(model.mixture.mirrored),
        **_parameters(model),
        "errors": {name: dict(errors) for name, errors in model.errors.items()},
    }


def _parameters(model: BakedModel) -> dict:
    """Name, range and standard value of each, in the order in which a shader takes them."""
    return {"parameters": [asdict(each) for each in model.parameters]} if model.parameters else {}


def write_raw(table: Table, errors: Errors, folder: Path) -> list[Path]:
    """Writes folder/<model>/<table>.f32 and .json; their paths."""
    texels = np.stack([table.texels, table.slopes], axis=-1)
    return _write(folder / table.model / table.name, texels, sidecar(table, errors))


def write_stream(model: BakedModel, folder: Path) -> list[Path]:
    """Writes folder/<model>/hair.f32 and .json; their paths."""
    texels = stream(model)
    return _write(folder / model.name / "hair", texels, model_sidecar(model, len(texels)))


def _write(base: Path, floats: np.ndarray, description: dict) -> list[Path]:
    text = json.dumps(description, indent=1) + "\n"
    return [
        write_whole(base.with_suffix(".f32"), np.ascontiguousarray(floats, "<f4").tobytes()),
        write_whole(base.with_suffix(".json"), text.encode("ascii")),
    ]


def write_npz(table: Table, errors: Errors, folder: Path) -> list[Path]:
    """Writes folder/<model>/<table>.npz: texels, slopes, theta_r of a node's rows, u of the columns,
    nodes_<name> of each parameter, and the sidecar."""
    data = io.BytesIO()
    np.savez(
        data,
        texels=np.ascontiguousarray(table.texels, np.float32),
        slopes=np.ascontiguousarray(table.slopes, np.float32),
        theta_r=table.theta_r,
        u=table.warp.u(table.width),
        **{f"nodes_{axis.name}": axis.nodes for axis in table.axes},
        sidecar=np.array(json.dumps(sidecar(table, errors))),
    )
    return [write_whole(folder / table.model / f"{table.name}.npz", data.getvalue())]
