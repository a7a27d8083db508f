# SPDX-License-Identifier: BSD-3-Clause
"""The texture "hair_strands": a number for each strand of a file of curves.

Mitsuba's curves carry none themselves, as meshes do (mesh_attribute).

curves  string  the file that the shape reads
values  string  a file with as many numbers as there are strands, in the same order, a line each
shape   string  "bsplinecurve" (default) or "linearcurve"

beta_m = {"type": "hair_strands", "curves": "lock.txt", "values": "beta_m.txt"}
bsdf = {"type": "hairlut", "model": "groom", "beta_m": beta_m, "nested": {...}}
"""

from __future__ import annotations

from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

from ..errors import HairlutError
from .arrays import Records

JOINED = {"bsplinecurve": 3, "linearcurve": 1}  # control points of a strand, less its segments


def texture_class() -> type:
    """The class for the variant that is set, whose Texture it extends."""

    class HairStrands(mi.Texture):
        def __init__(self, props: mi.Properties) -> None:
            super().__init__(props)
            shape = str(props.get("shape", "bsplinecurve"))
            if shape not in JOINED:
                raise HairlutError(f"hair_strands: shape is {shape!r}: expected {' or '.join(JOINED)}")
            curves, self.file = (_file(props, name) for name in ("curves", "values"))
            values, segments = _numbers(self.file), _segments(curves, JOINED[shape])
            if len(values) != len(segments):
                raise HairlutError(
                    f"{self.file}: has {len(values)} numbers, expected one for each of the {len(segments)} "
                    f"strands of {curves}"
                )
            self.average = float(values.mean())
            self.last = int(segments.sum()) - 1
            self.values = Records(np.repeat(values, segments)[:, None])

        def eval_1(self, si, active=True):
            segment = dr.minimum(si.prim_index, self.last)  # where nothing was hit it is any number
            return self.values[segment][0]

        def eval(self, si, active=True):
            return mi.UnpolarizedSpectrum(self.eval_1(si, active))

        def eval_3(self, si, active=True):
            return mi.Color3f(self.eval_1(si, active))

        def mean(self):
            return mi.Float(self.average)

        def is_spatially_varying(self):
            return True

        def to_string(self):
            return f"HairStrands[values = {self.file}]"

    return HairStrands


def _file(props: mi.Properties, name: str) -> Path:
    path = Path(str(mi.file_resolver().resolve(str(props.get(name, "")))))
    if not path.is_file():
        raise HairlutError(f"hair_strands: {name} is {str(path)!r}: expected a file")
    return path


def _numbers(path: Path) -> np.ndarray:
    """The numbers of a file, a line each."""
    values = []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        try:
            values.append(float(line))
        except ValueError:
            raise HairlutError(f"{path}, line {number}: {line[:60]!r} is no number") from None
    return np.array(values)


def _segments(path: Path, joined: int) -> np.ndarray:
    """How many segments each strand of a file has: its lines less `joined`; empty lines part strands."""
    strands = [block.count("\n") + 1 for block in _blocks(path.read_text())]
    short = [k for k, points in enumerate(strands, 1) if points <= joined]
    if short:
        raise HairlutError(
            f"{path}: strand {short[0]} has {strands[short[0] - 1]} points, too few for a curve"
        )
    return np.array(strands) - joined


def _blocks(text: str) -> list[str]:
    """Lines that follow each other without an empty one."""
    lines = "\n".join(line.strip() for line in text.splitlines())
    return [block.strip("\n") for block in lines.split("\n\n") if block.strip("\n")]
