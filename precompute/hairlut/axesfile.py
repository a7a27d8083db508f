# SPDX-License-Identifier: BSD-3-Clause
"""The parameters of a hair in the headers of tables and mixtures (luts/FORMAT.md)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .axes import MAX_AXES, Axis, Parameter, check_axes, check_name, check_ranges, node_count, numbers_of
from .errors import HairlutError
from .exrfile import PREFIX, REBAKE, Attributes, Header, numbers_text

ROWS = "theta_r"  # the axis of a table's rows of one node
LAST = "theta_r", "offset"  # the axes of a mixture's rows and columns of one node


def of_table(axes: Sequence[Axis]) -> Attributes:
    """What a table's header says of its axes; nothing where there are none."""
    if not axes:
        return {}
    names = " ".join([*(axis.name for axis in axes), ROWS])
    return {"hairlut.axes": names} | {_axis(axis.name): numbers_text(axis.nodes) for axis in axes}


def of_mixture(parameters: Sequence[Parameter], axes: Sequence[Axis]) -> Attributes:
    """What a mixture's header says of the parameters; where it does not depend on one, the standard value."""
    nodes = {axis.name: axis.nodes for axis in axes}
    texts = {}
    for p in parameters:
        texts[_axis(p.name)] = numbers_text(nodes.get(p.name, [p.standard]))
        texts[f"{PREFIX}parameter.{p.name}"] = numbers_text([p.least, p.most, p.standard])
    return texts


def _axis(name: str) -> str:
    return f"{PREFIX}axis.{name}"


def read_names(header: Header, last: str, most: int, default: str | None = None) -> list[str]:
    """The parameters' names in hairlut.axes, which ends with `last`."""
    text = header.text("axes", default)
    names = text.removesuffix(last).split(" ")[:-1]
    if not f" {text}".endswith(f" {last}") or len(names) > most or len(set(names)) < len(names):
        expected = f"up to {most} names of parameters, each once, then {last!r}, one space between"
        raise header.failure("axes", f"is {text[:120]!r}, expected {expected}")
    for name in names:
        try:
            check_name(name)
        except HairlutError as error:
            raise header.failure("axes", f"is {text[:120]!r} ({error})") from error
    return names


def read_table_axes(header: Header) -> tuple[Axis, ...]:
    """The axes of a table."""
    names = read_names(header, ROWS, MAX_AXES, ROWS)
    _refuse_others(header, "axis", names)
    return tuple(_read_axis(header, name) for name in names)


def read_parameters(header: Header, names: Sequence[str]) -> tuple[tuple[Parameter, ...], tuple[Axis, ...]]:
    """(a mixture's parameters, the axes of those on which it depends)"""
    _refuse_others(header, "axis", names)
    _refuse_others(header, "parameter", names)
    parameters = tuple(_read_parameter(header, name) for name in names)
    axes = tuple(_read_axis(header, p.name) for p in parameters if not _is_fixed(header, p))
    try:
        check_axes(axes)
    except HairlutError as error:
        raise header.failure("axes", f"is {header.text('axes')!r} ({error})") from error
    for axis in axes:
        try:
            check_ranges([axis], parameters)
        except HairlutError as error:
            raise header.failure(f"axis.{axis.name}", f"does not fit ({error})") from error
    return parameters, axes


def _refuse_others(header: Header, kind: str, names: Sequence[str]) -> None:
    """HairlutError if the header says something of a parameter that hairlut.axes lacks."""
    prefix = f"{PREFIX}{kind}."
    for attribute in header.attributes:
        name = attribute.removeprefix(prefix)
        if attribute.startswith(prefix) and name not in (*names, *LAST):
            raise header.failure("axes", f"does not name {name[:60]!r}, of which there is a {prefix}<name>")


def _is_fixed(header: Header, parameter: Parameter) -> bool:
    """Whether the mixture does not depend on the parameter: its axis is then the standard value."""
    nodes, standard = header.numbers(f"axis.{parameter.name}"), parameter.standard
    if len(nodes) == 1 and np.float32(nodes[0]) != np.float32(standard):
        expected = f"the standard value {standard:.9g}, or nodes from the parameter's least to its greatest"
        raise header.failure(f"axis.{parameter.name}", f"is {nodes[0]:.9g}, expected {expected}")
    return len(nodes) == 1


def _read_axis(header: Header, name: str) -> Axis:
    nodes = header.numbers(f"axis.{name}")
    try:
        return Axis(name, nodes)
    except HairlutError as error:
        raise header.failure(f"axis.{name}", f"is {numbers_of(nodes)} ({error})") from error


def _read_parameter(header: Header, name: str) -> Parameter:
    given = header.numbers(f"parameter.{name}", 3)
    try:
        return Parameter(name, *given.tolist())
    except HairlutError as error:
        raise header.failure(f"parameter.{name}", f"is {numbers_of(given)} ({error})") from error


def split_rows(header: Header, rows: int, axes: Sequence[Axis]) -> int:
    """Rows of theta_r of one node, of an image's rows."""
    nodes = node_count(axes)
    if rows % nodes:
        names = ", ".join(axis.name for axis in axes)
        raise HairlutError(
            f"{header.path}: has {rows} rows, expected a multiple of the {nodes} nodes of {names}: {REBAKE}"
        )
    return rows // nodes
