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

A sampler draws f cos(theta_i) per steradian, which is f cos(theta_i)^2 per rad^2 in (theta_i, phi).
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..errors import HairlutError
from ..lobes import Array
from ..userfile import guarded, run_file
from .cells import Density

EXPECTED = "expected a function bsdf(theta_r, theta_i, phi) or bsdf(theta_r, theta_i, phi, offset)"


def load(path: Path) -> tuple[Density, bool]:
    """(density per rad^2, whether it takes an offset) of a file; HairlutError naming the file and line."""
    path = Path(path)
    function = getattr(run_file(path).module, "bsdf", None)
    if not callable(function):
        raise HairlutError(f"{path}: has no bsdf: {EXPECTED}")
    count = _arguments(path, function)
    return _Bsdf(path, guarded(function, path), count), count == 4


class _Bsdf:
    """The density of a file's function. It gets arrays that broadcast; where it cannot take them, because it
    selects elements of one by another, full arrays."""

    def __init__(self, path: Path, function: Callable, count: int):
        self._path, self._function, self._count, self._full = path, function, count, False

    def __call__(self, *at: Array) -> Array:
        given = at[: self._count]
        if not self._full:
            try:
                return _density(self._path, self._function, given, at)
            except HairlutError as error:
                first = error
        full = tuple(np.array(x) for x in np.broadcast_arrays(*given))
        try:
            values = _density(self._path, self._function, full, at)
        except HairlutError as error:
            raise error if self._full else first from None
        self._full = True
        return values


def _arguments(path: Path, function: Callable) -> int:
    parameters = inspect.signature(function).parameters.values()
    needed = [p for p in parameters if p.default is p.empty and p.kind is not p.VAR_POSITIONAL]
    if len(needed) not in (3, 4) or any(p.kind is p.KEYWORD_ONLY for p in needed):
        raise HairlutError(f"{path}: bsdf{inspect.signature(function)}: {EXPECTED}")
    return len(needed)


def _density(path: Path, function: Callable, given: tuple[Array, ...], at: tuple[Array, ...]) -> Array:
    """f cos(theta_i)^2, checked."""
    values = np.asarray(function(*given))
    shape = np.broadcast_shapes(*(np.shape(x) for x in given))
    if values.dtype.kind not in "fiub":
        raise HairlutError(f"{path}: bsdf returned {values.dtype}: expected real numbers")
    try:
        values = np.broadcast_to(values, shape)
    except ValueError:
        raise HairlutError(
            f"{path}: bsdf returned the shape {values.shape}: expected {shape}, as its arguments"
        ) from None
    good = np.isfinite(values) & (values >= 0)
    if not good.all():
        index = np.unravel_index(int(np.argmin(good)), shape)
        names = ("theta_r", "theta_i", "phi", "offset")
        point = ", ".join(
            f"{name} = {np.broadcast_to(x, shape)[index]:.9g}" for name, x in zip(names, given, strict=False)
        )
        raise HairlutError(
            f"{path}: bsdf is {values[index]:.6g} at {point}: expected a finite number, 0 or more"
        )
    return values * np.cos(at[1]) ** 2
