# SPDX-License-Identifier: BSD-3-Clause
"""A model at fixed parameters of the hair, as an ordinary one of 32-bit floats."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isnan
from pathlib import Path

import numpy as np

from .axes import Parameter
from .errors import HairlutError
from .model import BakedLobe, BakedModel
from .parameter import number
from .table import Table

RISE = np.float32(2e-12)  # rad from texel to texel; readers refuse less than half of it


def parse_values(texts: Sequence[str]) -> dict[str, float]:
    """Values of parameters by name, from texts NAME=VALUE."""
    values: dict[str, float] = {}
    for text in texts:
        name, _, value = text.partition("=")
        if isnan(number(value)):
            raise HairlutError(f"--at {text}: expected NAME=VALUE with a number, as in --at beta_m=0.3")
        if name in values:
            raise HairlutError(f"--at {name}: is given twice: expected one value for each parameter")
        values[name] = number(value)
    return values


def fixed(path: Path, model: BakedModel, values: Mapping[str, float]) -> BakedModel:
    """The model at path at these values, and standard ones for other parameters; HairlutError, naming path,
    for a parameter that it does not have, or a value beyond its range."""
    check_values(path, model.parameters, values)
    if not model.parameters:
        return model
    given = model.at(values)
    tables = {table.name: as_floats(table) for table in given.tables}
    lobes = tuple(BakedLobe(x.name, tables[x.theta.name], x.phi and tables[x.phi.name]) for x in given.lobes)
    return replace(given, lobes=lobes)


def check_values(path: Path, parameters: Sequence[Parameter], values: Mapping[str, float]) -> None:
    """HairlutError, naming path, for a name that is not a parameter's, or a value beyond its range."""
    by_name = {parameter.name: parameter for parameter in parameters}
    for name, value in values.items():
        if name not in by_name:
            raise HairlutError(f"{path}: --at {name}: the model has {', '.join(by_name) or 'no parameters'}")
        least, most = by_name[name].least, by_name[name].most
        if not least <= value <= most:
            raise HairlutError(f"{path}: --at {name}={value:g}: expected {least:g} to {most:g}")


def as_floats(table: Table) -> Table:
    """The table with texels of 32 bits. Angles that would round to one float are set apart."""
    texels = np.asarray(table.texels, np.float32)
    last = texels.shape[1] - 1
    for i in range(1, last):
        texels[:, i] = np.maximum(texels[:, i], _above(texels[:, i - 1]))
    for i in range(last - 1, 0, -1):
        texels[:, i] = np.minimum(texels[:, i], -_above(-texels[:, i + 1]))
    return replace(table, texels=texels, slopes=np.asarray(table.slopes, np.float32))


def _above(x: np.ndarray) -> np.ndarray:
    """The least float that a reader takes for more than x."""
    return np.maximum(np.nextafter(x, np.float32(np.inf)), x + RISE)
