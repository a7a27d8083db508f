# SPDX-License-Identifier: BSD-3-Clause
"""A C source of baked models against the public header: texels, and descriptors filled with plain numbers.

It compiles as C99 and C++ with hairlut.h alone. A program declares a model's descriptor and passes it on:

    extern const hairlut_model_desc hairlut_fitted_desc;
    hairlut_model_create(&hairlut_fitted_desc, NULL, &model, message);
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from . import __version__
from .axes import Axis, Parameter
from .errors import HairlutError
from .lobes import DIFFERENCE, SUM, Array
from .model import BakedLobe, BakedModel
from .table import Table

AZIMUTHS = {SUM: "HAIRLUT_AZIMUTH_SUM", DIFFERENCE: "HAIRLUT_AZIMUTH_DIFFERENCE"}
WARPS = {"octaves": "HAIRLUT_WARP_OCTAVES", "uniform": "HAIRLUT_WARP_UNIFORM"}
A_LINE = 8  # numbers


def source(models: Sequence[BakedModel]) -> str:
    """The text of the source; tables of the same texels stand in it once."""
    names = [model.name for model in models]
    if len({_identifier(name) for name in names}) < len(names):
        raise HairlutError(f"models {', '.join(names)}: expected a different name for each directory")
    texels: dict[bytes, str] = {}
    parts = [
        f"/* By hairlut {__version__} (export --to c) from {', '.join(names)}; not to be edited. */",
        '#include "hairlut.h"',
        *(text for model in models for text in _definitions(model, texels)),
    ]
    return "\n\n".join(parts) + "\n"


def _definitions(model: BakedModel, texels: dict[bytes, str]) -> list[str]:
    """The model's definitions. texels: name of the array of each table's texels that is already defined."""
    prefix = f"hairlut_{_identifier(model.name)}"
    parts = []
    for table in model.tables:
        pairs = np.stack([table.texels, table.slopes], axis=-1)
        name = texels.setdefault(pairs.tobytes(), f"{prefix}_{table.name}_texels")
        if name.startswith(f"{prefix}_{table.name}_"):
            parts.append(_array(name, pairs))
        parts += _axes(f"{prefix}_{table.name}", table.axes, model.parameters)
        parts.append(_table(f"{prefix}_{table.name}", table, name))
    lobes = ",\n".join(_lobe(prefix, lobe) for lobe in model.lobes)
    parts.append(f"static const hairlut_lobe_desc {prefix}_lobes[{len(model.lobes)}] = {{\n{lobes}}};")
    mixture = model.mixture
    for name in ("theta_r", "offset", "share", "turn"):
        parts.append(_array(f"{prefix}_{name}", getattr(mixture, name)))
    parts += _axes(f"{prefix}_mixture", mixture.axes, model.parameters)
    parts.append(
        f"static const hairlut_mixture_desc {prefix}_mixture = {{sizeof(hairlut_mixture_desc), "
        f"{len(mixture.theta_r)}, {len(mixture.offset)}, {prefix}_theta_r, {prefix}_offset, {prefix}_share, "
        f"{prefix}_turn, {int(mixture.mirrored)}, {_counted(f'{prefix}_mixture_axes', mixture.axes)}}};"
    )
    if model.parameters:
        lines = ",\n".join(map(_parameter, model.parameters))
        name = f"{prefix}_parameters[{len(model.parameters)}]"
        parts.append(f"static const hairlut_parameter {name} = {{\n{lines}}};")
    parts.append(
        f"extern const hairlut_model_desc {prefix}_desc;\nconst hairlut_model_desc {prefix}_desc = {{"
        f"sizeof(hairlut_model_desc), {len(model.lobes)}, {prefix}_lobes, &{prefix}_mixture, "
        f"{_counted(f'{prefix}_parameters', model.parameters)}}};"
    )
    return parts


def _identifier(name: str) -> str:
    return re.sub(r"\W", "_", name, flags=re.ASCII)


def _array(name: str, values: Array) -> str:
    words = [_literal(x) for x in np.float32(values).ravel()]
    lines = [", ".join(words[n : n + A_LINE]) for n in range(0, len(words), A_LINE)]
    return f"static const float {name}[{len(words)}] = {{\n" + ",\n".join(lines) + "};"


def _literal(x: float) -> str:
    """A C literal that reads back as the same float."""
    text = f"{np.float32(x):.9g}"
    return f"{text}f" if "." in text or "e" in text else f"{text}.0f"


def _table(name: str, table: Table, texels: str) -> str:
    numbers = ", ".join(map(_literal, [*table.theta_r_range, *table.domain]))
    return (
        f"static const hairlut_table {name} = {{sizeof(hairlut_table), {texels}, {table.width}, "
        f"{table.height}, {numbers}, {WARPS[table.warp.name]}, {_literal(table.warp.e)}, "
        f"{_counted(f'{name}_axes', table.axes)}}};"
    )


def _counted(name: str, items: Sequence) -> str:
    """The number of an array's items, and the array."""
    return f"{len(items)}, {name if items else 'NULL'}"


def _axes(name: str, axes: Sequence[Axis], parameters: Sequence[Parameter]) -> list[str]:
    """Definitions of the nodes of each axis, and of the array <name>_axes."""
    if not axes:
        return []
    numbers = {parameter.name: k for k, parameter in enumerate(parameters)}
    fields = [f"{numbers[axis.name]}, {len(axis.nodes)}, {name}_{axis.name}" for axis in axes]
    lines = ",\n".join(f"    {{sizeof(hairlut_parameter_nodes), {each}}}" for each in fields)
    array = f"static const hairlut_parameter_nodes {name}_axes[{len(axes)}] = {{\n{lines}}};"
    return [*(_array(f"{name}_{axis.name}", axis.nodes) for axis in axes), array]


def _parameter(parameter: Parameter) -> str:
    numbers = ", ".join(map(_literal, [parameter.least, parameter.most, parameter.standard]))
    return f'    {{sizeof(hairlut_parameter), "{parameter.name}", {numbers}}}'


def _lobe(prefix: str, lobe: BakedLobe) -> str:
    phi = f"&{prefix}_{lobe.phi.name}" if lobe.phi else "NULL"
    azimuth = AZIMUTHS[lobe.phi.azimuth if lobe.phi else DIFFERENCE]
    return f'    {{sizeof(hairlut_lobe_desc), "{lobe.name}", &{prefix}_{lobe.theta.name}, {phi}, {azimuth}}}'
