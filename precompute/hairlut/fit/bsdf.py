# SPDX-License-Identifier: BSD-3-Clause
"""A hair's BSDF as a Python file, and the light that it scatters.

The file defines

    def bsdf(theta_r, theta_i, phi):            # or bsdf(theta_r, theta_i, phi, offset)
        ...
        return f

with f per steradian and without the cosine, as in L = integral of f L_i cos(theta_i) domega. The arguments
are NumPy arrays that broadcast against each other, angles in radians: theta_r and theta_i are the
inclinations of the viewer and of the light from the plane normal to the fibre, in (-pi/2, pi/2); phi is
phi_i - phi_r, in [0, 2 pi); offset is where across its width the fibre is hit, in radii, in (-1, 1): from
its surface it reflects to phi = -2 asin(offset) (Chiang et al. 2016). Any unit of f does: only its shape
matters.

A hair with parameters names them, each with its range, and its standard value where that is not the middle:

    PARAMETERS = {"beta_m": (0.05, 0.6), "absorption": (0.05, 5.0, 0.4)}
    def bsdf(theta_r, theta_i, phi, offset, beta_m, absorption): ...

bsdf gets them by name, as numbers.

A sampler draws f cos(theta_i) per steradian, which is f cos(theta_i)^2 per rad^2 in (theta_i, phi).
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..axes import Parameter, check_parameters
from ..errors import HairlutError
from ..lobes import Array
from ..userfile import guarded, run_file

EXPECTED = "expected a function bsdf(theta_r, theta_i, phi) or bsdf(theta_r, theta_i, phi, offset)"
EXPECTED_PARAMETERS = (
    'expected PARAMETERS = {"name": (least, most), ...} with increasing numbers, and the standard value as '
    "the third where that is not the middle"
)


class Bsdf(NamedTuple):
    """density: per rad^2, of (theta_r, theta_i, phi, offset) and the parameters by name; offset: the name of
    its argument that is the offset, empty where it takes none."""

    density: Callable[..., Array]
    offset: str
    parameters: tuple[Parameter, ...]


def load(path: Path) -> Bsdf:
    """The BSDF of a file; HairlutError naming the file and line."""
    path = Path(path)
    module = run_file(path).module
    function = getattr(module, "bsdf", None)
    if not callable(function):
        other = f"; it defines LOBES: hairlut bake --model {path}" if hasattr(module, "LOBES") else ""
        raise HairlutError(f"{path}: has no bsdf: {EXPECTED}{other}")
    for name in vars(module):
        if name != "PARAMETERS" and name.upper() == "PARAMETERS":
            raise HairlutError(f"{path}: defines {name}: name it PARAMETERS, {EXPECTED_PARAMETERS}")
    _check_doubled(path)
    parameters = _parameters(path, getattr(module, "PARAMETERS", {}))
    arguments = _arguments(path, function, [parameter.name for parameter in parameters])
    density = _Bsdf(path, guarded(function, path), len(arguments))
    return Bsdf(density, "".join(arguments[3:]), parameters)


class _Bsdf:
    """The density of a file's function. It gets arrays that broadcast, and that it may not write to; where it
    cannot take them, because it selects elements of one by another or changes one in place, full copies."""

    def __init__(self, path: Path, function: Callable, count: int):
        self._path, self._function, self._count, self._full = path, function, count, False

    def __call__(self, *at: Array, **parameters: float) -> Array:
        given = at[: self._count]
        if not self._full:
            try:
                return _density(self._path, self._function, tuple(map(_locked, given)), at, parameters)
            except HairlutError as error:
                first = error
        full = tuple(np.array(x) for x in np.broadcast_arrays(*given))
        try:
            values = _density(self._path, self._function, full, at, parameters)
        except HairlutError as error:
            raise error if self._full else first from None
        self._full = True
        return values


def _locked(x: Array) -> Array:
    """The array as one that cannot be written to."""
    view = np.asarray(x).view()
    view.flags.writeable = False
    return view


def _check_doubled(path: Path) -> None:
    """Refuses a PARAMETERS that writes one name twice, of which Python keeps the last."""
    for node in ast.walk(ast.parse(path.read_bytes())):
        if not isinstance(node, ast.Assign | ast.AnnAssign):
            continue
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        if not any(isinstance(t, ast.Name) and t.id == "PARAMETERS" for t in targets):
            continue
        keys = [k.value for k in getattr(node.value, "keys", []) if isinstance(k, ast.Constant)]
        for number, key in enumerate(keys):
            if key in keys[:number]:
                raise HairlutError(
                    f"{path}:{node.lineno}: PARAMETERS has {key!r} twice: expected each parameter once: "
                    "leave one of them out"
                )


def _parameters(path: Path, given: object) -> tuple[Parameter, ...]:
    """The parameters that a file names; HairlutError saying which of them is wrong."""
    if not isinstance(given, dict):
        raise HairlutError(f"{path}: PARAMETERS is of type {type(given).__name__}: {EXPECTED_PARAMETERS}")
    found = []
    for name, values in given.items():
        try:
            numbers = [] if isinstance(values, str) else [_number(x) for x in values]
        except (TypeError, ValueError, OverflowError):
            numbers = []
        if not isinstance(name, str) or len(numbers) not in (2, 3):
            raise HairlutError(f"{path}: PARAMETERS has {name!r}: {values!r}: {EXPECTED_PARAMETERS}")
        least, most, *standard = numbers
        try:
            found.append(Parameter(name, least, most, *(standard or [(least + most) / 2])))
        except HairlutError as error:
            raise HairlutError(f"{path}: PARAMETERS: {error}") from None
    try:
        check_parameters(found)
    except HairlutError as error:
        raise HairlutError(f"{path}: PARAMETERS: {error}") from None
    return tuple(found)


def _number(value: object) -> float:
    """A number as it is written in a file: no text that float() would read, no truth value."""
    if isinstance(value, str | bytes | bool | np.bool_):
        raise TypeError
    return float(value)


def _arguments(path: Path, function: Callable, names: list[str]) -> list[str]:
    """The arguments that a function takes before its parameters: 3, or 4 with an offset."""
    signature = inspect.signature(function)
    arguments = signature.parameters.values()
    unnamed = [a.name for a in arguments if a.kind is a.POSITIONAL_ONLY and a.name in names]
    if unnamed:
        raise HairlutError(
            f"{path}: bsdf{signature} takes {unnamed[0]} by position only, and parameters are passed by "
            "name: put it behind the '/', or leave the '/' out"
        )
    by_name = [a.name for a in arguments if a.kind in (a.POSITIONAL_OR_KEYWORD, a.KEYWORD_ONLY)]
    if not any(a.kind is a.VAR_KEYWORD for a in arguments):
        for name in names:
            if name not in by_name:
                raise HairlutError(
                    f"{path}: bsdf{signature} takes no {name}, which PARAMETERS names: "
                    f"add {name} to bsdf's arguments, or take it out of PARAMETERS"
                )
    needed = [
        a
        for a in arguments
        if a.default is a.empty and a.kind not in (a.VAR_POSITIONAL, a.VAR_KEYWORD) and a.name not in names
    ]
    before = [a.name for a in list(arguments)[:4]]
    misplaced = [a.name for a in needed[3:4] if a.kind is not a.KEYWORD_ONLY and a.name not in before]
    extra = misplaced or [a.name for a in needed[4:]] or [a.name for a in needed if a.kind is a.KEYWORD_ONLY]
    if names and extra:
        raise HairlutError(
            f"{path}: bsdf{signature} takes {extra[0]}, which PARAMETERS does not name: add its range, "
            f'PARAMETERS = {{"{extra[0]}": (least, most), ...}}, or give the argument a default'
        )
    if len(needed) not in (3, 4) or extra:
        raise HairlutError(f"{path}: bsdf{signature}: {EXPECTED}{', then its parameters' * bool(names)}")
    return [a.name for a in needed]


def _density(
    path: Path,
    function: Callable,
    given: tuple[Array, ...],
    at: tuple[Array, ...],
    parameters: dict[str, float],
) -> Array:
    """f cos(theta_i)^2, checked."""
    strand = "".join(f", {name} = {value:.9g}" for name, value in parameters.items())
    try:
        values = np.asarray(function(*given, **parameters))
    except HairlutError as error:
        raise HairlutError(f"{error}{strand.replace(',', ': at', 1)}") from None
    shape = np.broadcast_shapes(*(np.shape(x) for x in given))
    if values.dtype.kind not in "fiub":
        what = "None" if values.shape == () and values.item() is None else values.dtype
        raise HairlutError(f"{path}: bsdf returned {what}: expected real numbers")
    try:
        values = np.broadcast_to(values, shape)
    except ValueError:
        raise HairlutError(
            f"{path}: bsdf returned the shape {values.shape}: expected {shape}, as its arguments{strand}"
        ) from None
    good = np.isfinite(values) & (values >= 0)
    if not good.all():
        index = np.unravel_index(int(np.argmin(good)), shape)
        names = ("theta_r", "theta_i", "phi", "offset")
        point = ", ".join(
            f"{name} = {np.broadcast_to(x, shape)[index]:.9g}" for name, x in zip(names, given, strict=False)
        )
        raise HairlutError(
            f"{path}: bsdf is {values[index]:.6g} at {point}{strand}: expected a finite number, 0 or more"
        )
    return values * np.cos(at[1]) ** 2
