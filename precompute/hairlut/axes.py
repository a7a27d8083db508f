# SPDX-License-Identifier: BSD-3-Clause
"""Named parameters of a hair, and the axes of nodes over which tables and mixtures depend on them.

A strand's values lie in a cell between nodes: on each of d axes between two neighbours, linearly in the
parameter, which is clamped to the first and the last node. What a table or a mixture has at the 2^d corners
of the cell is blended, each corner with the product of its axes' parts. In the order of nodes the first axis
is the slowest.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .errors import HairlutError
from .lobes import LOBE_NAME, Array

MAX_PARAMETERS = 8  # of a model
MAX_AXES = 4  # of parameters, of a table or a mixture
NODES = 2, 64  # of an axis
LARGEST, NARROWEST = 1e30, 1e-30  # of numbers, and of the gap between two nodes: float32 has 1 / gap
NO_PARAMETERS: Mapping[str, Array] = {}
RESERVED = "theta_r", "theta_i", "phi", "phi_r", "phi_i", "offset", "u", "shares", "lobe"


@dataclass(frozen=True)
class Parameter:
    """A parameter of a hair: its range, and its value where none is given."""

    name: str
    least: float
    most: float
    standard: float

    def __post_init__(self) -> None:
        check_name(self.name)
        given = np.array([self.least, self.standard, self.most], float)
        if (
            not (abs(given) <= LARGEST).all()
            or not _rising(given[[0, 2]])
            or (np.diff(np.float32(given)) < 0).any()
        ):
            raise HairlutError(
                f"parameter {self.name}: is {numbers_of(given[[0, 2, 1]])}, expected least, most and "
                f"standard: an increasing range, and a number in it, of at most {LARGEST:g} in size"
            )


@dataclass(frozen=True)
class Axis:
    """Nodes (n,) of a parameter, increasing: the first is its least value, the last its greatest."""

    name: str
    nodes: Array

    def __post_init__(self) -> None:
        check_name(self.name)
        least, most = NODES
        if np.ndim(self.nodes) != 1 or not least <= len(self.nodes) <= most:
            raise HairlutError(
                f"axis {self.name}: has shape {np.shape(self.nodes)}, expected {least} to {most} numbers"
            )
        if not (abs(self.nodes) <= LARGEST).all() or not _rising(self.nodes):
            raise HairlutError(
                f"axis {self.name}: is {numbers_of(self.nodes)}, expected numbers of at most {LARGEST:g} "
                "in size that increase, also as 32-bit floats"
            )


def check_name(name: str) -> None:
    """HairlutError unless a parameter may have the name."""
    if not re.fullmatch(LOBE_NAME, name):
        raise HairlutError(
            f"parameter {name[:60]!r}: expected a name of up to 31 of a-z, 0-9 and _, a letter first"
        )
    if name in RESERVED:
        raise HairlutError(f"parameter {name}: expected another name than {', '.join(RESERVED)}")


def check_parameters(parameters: Sequence[Parameter]) -> None:
    """HairlutError unless a model may have them all."""
    if len(parameters) > MAX_PARAMETERS:
        raise HairlutError(f"{len(parameters)} parameters: expected at most {MAX_PARAMETERS}")
    names = [parameter.name for parameter in parameters]
    if len(set(names)) < len(names):
        raise HairlutError(f"parameters {', '.join(names)}: expected every name once")


def check_axes(axes: Sequence[Axis]) -> None:
    """HairlutError unless a table or a mixture may have them all."""
    names = [axis.name for axis in axes]
    if len(axes) > MAX_AXES:
        raise HairlutError(f"axes {', '.join(names)}: expected at most {MAX_AXES} parameters")
    if len(set(names)) < len(names):
        raise HairlutError(f"axes {', '.join(names)}: expected every name once")


def check_ranges(axes: Sequence[Axis], parameters: Sequence[Parameter]) -> None:
    """HairlutError unless each axis spans the range, as 32-bit floats, of a parameter of its name."""
    by_name = {parameter.name: parameter for parameter in parameters}
    for axis in axes:
        if axis.name not in by_name:
            raise HairlutError(f"axis {axis.name}: the model has {_listed(by_name)}")
        least, most = by_name[axis.name].least, by_name[axis.name].most
        if (np.float32(axis.nodes[[0, -1]]) != np.float32([least, most])).any():
            raise HairlutError(
                f"axis {axis.name}: runs from {axis.nodes[0]:.9g} to {axis.nodes[-1]:.9g}, expected the "
                f"parameter's range, {least:.9g} to {most:.9g}"
            )


def completed(values: Mapping[str, Array], parameters: Sequence[Parameter]) -> dict[str, Array]:
    """A value for each parameter: the given one, or the standard one; HairlutError for another name."""
    names = [parameter.name for parameter in parameters]
    for name in values:
        if name not in names:
            raise HairlutError(f"parameter {name!r}: the model has {_listed(names)}")
    return {p.name: np.asarray(values.get(p.name, p.standard), float) for p in parameters}


def node_count(axes: Sequence[Axis]) -> int:
    """How many nodes the axes have together."""
    return int(np.prod([len(axis.nodes) for axis in axes], dtype=int))


def corners(
    axes: Sequence[Axis], values: Mapping[str, Array], shape: tuple[int, ...] = ()
) -> tuple[Array, Array]:
    """(node, part), each (2^d, *shape): the nodes around the axes' values, which broadcast to shape, and the
    part of each in the blend. The node below the values on every axis comes first. NaN counts as the least
    value."""
    node, part = np.zeros((1, *shape), int), np.ones((1, *shape))
    for axis in axes:
        if axis.name not in values:
            raise HairlutError(f"parameter {axis.name}: is missing")
        value = np.broadcast_to(np.asarray(values[axis.name], float), shape)
        i, t = between(axis.nodes, np.where(np.isnan(value), axis.nodes[0], value))
        before = node * len(axis.nodes) + i
        node, part = np.concatenate([before, before + 1]), np.concatenate([part * (1 - t), part * t])
    return node, part


def between(nodes: Array, x: Array) -> tuple[Array, Array]:
    """(node before x, part of the way to the next), x clamped to the nodes' range."""
    at = np.interp(x, nodes, np.arange(len(nodes)))
    i = np.clip(at.astype(int), 0, max(len(nodes) - 2, 0))
    return i, at - i


def numbers_of(values: Array) -> str:
    """The first few numbers, for an error."""
    text = " ".join(f"{x:.6g}" for x in values[:6])
    return f"{text} ..." if len(values) > 6 else text


def _rising(values: Array) -> bool:
    return bool((np.diff(np.float32(values)) >= np.float32(NARROWEST)).all())


def _listed(names) -> str:
    return ", ".join(names) or "no parameters"
