# SPDX-License-Identifier: BSD-3-Clause
"""Models to sample from, at the speed of the C library (runtime/include/hairlut.h, whose rules hold).

Arguments broadcast against each other. float32 arrays are read in place, others are converted. Results are
float32 arrays of the broadcast shape. No finite argument gives NaN; NaN in an argument gives density 0.
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .errors import HairlutError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from .axes import Axis, Parameter
    from .model import BakedModel
    from .table import Table

    Floats = NDArray[np.float32]

__all__ = ["Model", "Sample", "builtin", "load"]

BUILTIN = ("printed", "fitted", "brown")


class Sample(NamedTuple):
    """Directions that were drawn, each field an array of the broadcast shape.

    theta_i          inclination, [-pi/2, pi/2]
    phi_i            azimuth, [-pi, pi)
    pdf_angle        density per rad^2 in (theta_i, phi_i)
    pdf_solid_angle  pdf_angle / cos(theta_i), per steradian
    """

    theta_i: Floats
    phi_i: Floats
    pdf_angle: Floats
    pdf_solid_angle: Floats


class Model:
    """A hair: a mixture of lobes, each a product of a distribution of theta_i and one of the azimuth.

    Made by `hairlut.load` or `hairlut.builtin`. Any number of threads may use one model at once; the
    interpreter lock is released while the C library works.
    """

    def __init__(self, name: str, core: Any, parameters: Sequence[Parameter] = ()) -> None:
        self.name = name
        self._core = core
        self._parameters = tuple(parameters)

    def __repr__(self) -> str:
        return f"<hairlut.Model {self.name}: lobes {', '.join(self.lobes)}>"

    @property
    def lobes(self) -> tuple[str, ...]:
        """The lobes' names, in the order of `shares`.

        >>> import hairlut
        >>> hairlut.builtin("fitted").lobes
        ('direct', 'multiple')
        """
        return tuple(self._core.lobes)

    @property
    def parameters(self) -> dict[str, tuple[float, float, float]]:
        """The hair's parameters on which the model depends: (least, most, standard) value by name.

        >>> import hairlut
        >>> hairlut.builtin("fitted").parameters
        {}
        """
        return {p.name: (p.least, p.most, p.standard) for p in self._parameters}

    def sample(
        self,
        /,
        theta_r: ArrayLike,
        phi_r: ArrayLike,
        u: ArrayLike,
        offset: ArrayLike = 0.0,
        shares: ArrayLike | None = None,
        **parameters: ArrayLike,
    ) -> Sample:
        """Draws incident directions for viewer directions.

        theta_r, phi_r  viewer direction, rad
        u               (..., 3) numbers in [0, 1): for the lobe, theta_i and the azimuth
        offset          where the fibre is hit, in [-1, 1]; 0 where there is none
        shares          (..., K) one number a lobe, in any unit; None: the model's own
        parameters      those of the strand, by name, clamped to their ranges; a missing one has its standard
                        value

        >>> import hairlut
        >>> hair = hairlut.builtin("fitted")
        >>> s = hair.sample(0.3, 1.0, [[0.2, 0.5, 0.5], [0.9, 0.5, 0.5]])
        >>> s.theta_i.round(3)
        array([-0.319, -0.103], dtype=float32)
        >>> bool((abs(s.pdf_angle / hair.pdf(0.3, 1.0, s.theta_i, s.phi_i) - 1) < 1e-4).all())
        True
        """
        numbers, strand = _components(u), self._strand(parameters)
        given = [_float32(x) for x in (theta_r, phi_r, offset)]
        shape = np.broadcast_shapes(*(x.shape for x in (*given, numbers[0], *strand)), _shape_of(shares))
        columns = [_column(x, shape) for x in (*given, *numbers)]
        strand = [_column(x, shape) for x in strand]
        out = _empty(shape, 4)
        self._core.sample(strand, self._shares(shares, shape), *columns, [x.reshape(-1) for x in out])
        return Sample(*out)

    def pdf(
        self,
        /,
        theta_r: ArrayLike,
        phi_r: ArrayLike,
        theta_i: ArrayLike,
        phi_i: ArrayLike,
        offset: ArrayLike = 0.0,
        shares: ArrayLike | None = None,
        **parameters: ArrayLike,
    ) -> Floats:
        """Density per rad^2 with which `sample` draws (theta_i, phi_i); 0 for theta_i beyond the poles.

        >>> import hairlut
        >>> float(hairlut.builtin("fitted").pdf(0.0, 0.0, 2.0, 0.0))
        0.0
        >>> hairlut.builtin("fitted").pdf(0.0, 0.0, 1.0, 0.0, beta_m=0.3)
        Traceback (most recent call last):
        hairlut.errors.HairlutError: parameter 'beta_m': model fitted has no parameters
        """
        given = [_float32(x) for x in (theta_r, phi_r, offset, theta_i, phi_i)]
        strand = self._strand(parameters)
        shape = np.broadcast_shapes(*(x.shape for x in (*given, *strand)), _shape_of(shares))
        (out,) = _empty(shape, 1)
        columns = [_column(x, shape) for x in given]
        strand = [_column(x, shape) for x in strand]
        self._core.pdf(strand, self._shares(shares, shape), *columns, out.reshape(-1))
        return out

    def sample_lobe(self, lobe: str, theta_r: ArrayLike, phi_r: ArrayLike, u: ArrayLike) -> Sample:
        """Draws from one lobe by itself, not turned, at the standard values of parameters; u (..., 2): for
        theta_i and the azimuth.

        >>> import hairlut
        >>> s = hairlut.builtin("fitted").sample_lobe("multiple", 0.3, 1.0, (0.5, 0.25))  # uniform in azimuth
        >>> bool(abs(s.phi_i + np.pi / 2) < 1e-6)
        True
        """
        numbers = _components(u, 2)
        given = [_float32(x) for x in (theta_r, phi_r)]
        shape = np.broadcast_shapes(*(x.shape for x in (*given, numbers[0])))
        out = _empty(shape, 4)
        columns = [_column(x, shape) for x in (*given, *numbers)]
        self._core.sample_lobe(self._number(lobe), *columns, [x.reshape(-1) for x in out])
        return Sample(*out)

    def pdf_lobe(
        self, lobe: str, theta_r: ArrayLike, phi_r: ArrayLike, theta_i: ArrayLike, phi_i: ArrayLike
    ) -> Floats:
        """Density per rad^2 with which `sample_lobe` draws (theta_i, phi_i).

        >>> import hairlut
        >>> float(hairlut.builtin("fitted").pdf_lobe("direct", 0.3, 0.0, -0.32, 3.1416)) > 0.9
        True
        """
        given = [_float32(x) for x in (theta_r, phi_r, theta_i, phi_i)]
        shape = np.broadcast_shapes(*(x.shape for x in given))
        (out,) = _empty(shape, 1)
        columns = [_column(x, shape) for x in given]
        self._core.pdf_lobe(self._number(lobe), *columns, out.reshape(-1))
        return out

    def invert(
        self, lobe: str, theta_r: ArrayLike, phi_r: ArrayLike, theta_i: ArrayLike, phi_i: ArrayLike
    ) -> Floats:
        """(..., 2) the numbers u from which `sample_lobe` draws (theta_i, phi_i).

        A direction outside the lobe's domain gives the nearer end, NaN gives 0.

        >>> import hairlut
        >>> hair = hairlut.builtin("fitted")
        >>> s = hair.sample_lobe("direct", 0.3, 1.0, (0.25, 0.75))
        >>> hair.invert("direct", 0.3, 1.0, s.theta_i, s.phi_i).round(4)
        array([0.25, 0.75], dtype=float32)
        """
        given = [_float32(x) for x in (theta_r, phi_r, theta_i, phi_i)]
        shape = np.broadcast_shapes(*(x.shape for x in given))
        columns = [_column(x, shape) for x in given]
        out = _empty(shape, 2)
        self._core.invert_lobe(self._number(lobe), *columns, *(x.reshape(-1) for x in out))
        return np.stack(out, axis=-1)

    def _number(self, lobe: str) -> int:
        if lobe not in self.lobes:
            raise HairlutError(f"lobe {lobe!r}: model {self.name} has {', '.join(self.lobes)}")
        return self.lobes.index(lobe)

    def _strand(self, given: dict[str, ArrayLike]) -> list[Floats]:
        """A value for each parameter; nothing where none is given."""
        for name in given:
            if name not in self.parameters:
                known = ", ".join(self.parameters) or "no parameters"
                raise HairlutError(f"parameter {name!r}: model {self.name} has {known}")
            if np.asarray(given[name]).dtype.kind not in "fiub":
                raise HairlutError(f"parameter {name!r}: is {given[name]!r}, expected real numbers")
        return [_float32(given.get(p.name, p.standard)) for p in self._parameters] if given else []

    def _shares(self, shares: ArrayLike | None, shape: tuple[int, ...]) -> Floats | None:
        if shares is None:
            return None
        given = _float32(shares)
        count = len(self.lobes)
        if given.ndim == 0 or given.shape[-1] != count:
            raise HairlutError(
                f"shares: has shape {given.shape}, expected (..., {count}), one number for each of "
                f"{', '.join(self.lobes)}"
            )
        if given.ndim == 1:
            return np.broadcast_to(given, (int(np.prod(shape)), count))
        return np.ascontiguousarray(np.broadcast_to(given, (*shape, count))).reshape(-1, count)


def builtin(name: str) -> Model:
    """A model compiled into the library: "printed", "fitted" or "brown".

    >>> import hairlut
    >>> hairlut.builtin("fitted")
    <hairlut.Model fitted: lobes direct, multiple>
    """
    core = _library().builtin(name)
    if core is None:
        raise HairlutError(f"model {name!r} is not compiled in: expected one of {', '.join(BUILTIN)}")
    return Model(name, core)


def load(directory: str | PathLike[str]) -> Model:
    """The model of a directory that `hairlut bake` or `hairlut fit` wrote (luts/FORMAT.md).

    HairlutError names the file, what is wrong with it, what was expected, and what to do.

    >>> import hairlut
    >>> hairlut.load("no/such/place")
    Traceback (most recent call last):
    hairlut.errors.HairlutError: no/such/place: expected a directory with mixture.exr...
    """
    library = _library()
    from . import exr  # late: reading images takes as long as all other imports

    baked = exr.read_model(Path(directory))
    return Model(baked.name, _create(library, baked), baked.parameters)


def _create(library: Any, baked: BakedModel) -> Any:
    """The C library's model of a baked one."""
    tables = baked.tables
    numbers = {table.name: k for k, table in enumerate(tables)}
    lobes = [
        (
            lobe.name,
            numbers[lobe.theta.name],
            numbers[lobe.phi.name] if lobe.phi else -1,
            lobe.phi is not None and lobe.phi.azimuth == "sum",
        )
        for lobe in baked.lobes
    ]
    mixture, number = baked.mixture, {p.name: k for k, p in enumerate(baked.parameters)}
    shape = len(lobes), -1, len(mixture.offset)
    grids = (np.ascontiguousarray(x, np.float32).reshape(shape) for x in (mixture.share, mixture.turn))
    nodes = (np.ascontiguousarray(x, np.float32) for x in (mixture.theta_r, mixture.offset))
    ranges = [(p.name, p.least, p.most, p.standard) for p in baked.parameters]
    tables = [(*_table(x), _axes(x.axes, number)) for x in tables]
    axes = _axes(mixture.axes, number)
    try:
        return library.create(ranges, tables, lobes, axes, *nodes, *grids, mixture.mirrored)
    except ValueError as error:
        raise HairlutError(f"{baked.name}: {error}") from error


def _axes(axes: Sequence[Axis], number: dict[str, int]) -> list[tuple[int, Floats]]:
    return [(number[axis.name], np.ascontiguousarray(axis.nodes, np.float32)) for axis in axes]


def _table(table: Table) -> tuple[Floats, float, float, float, float, bool, float]:
    texels = np.stack([table.texels, table.slopes], axis=-1)
    octaves = table.warp.name == "octaves"
    return texels, *table.theta_r_range, *table.domain, octaves, table.warp.e


def _library() -> Any:
    try:
        from . import _core
    except ImportError as error:
        raise HairlutError(
            "this hairlut was installed without its C library, so it bakes, fits and verifies, but has no "
            "load or builtin: install a C++ compiler and run pip install --force-reinstall hairlut "
            f"({error})"
        ) from error
    return _core


def _float32(values: ArrayLike) -> Floats:
    """The values as float32; those beyond its range as infinity, which the library clamps."""
    with np.errstate(over="ignore"):
        return np.asarray(values, np.float32)


def _components(u: ArrayLike, count: int = 3) -> list[Floats]:
    """The last axis of u (..., count), as views."""
    u = _float32(u)
    if u.ndim == 0 or u.shape[-1] != count:
        raise HairlutError(f"u: has shape {u.shape}, expected (..., {count})")
    return [u[..., k] for k in range(count)]


def _shape_of(shares: ArrayLike | None) -> tuple[int, ...]:
    return () if shares is None else np.shape(shares)[:-1]


def _column(values: Floats, shape: tuple[int, ...]) -> Floats:
    """The values broadcast to shape, as one axis: a view where a stride can express it."""
    if values.ndim == 0 or values.size == 1:
        return np.broadcast_to(values.reshape(()), (int(np.prod(shape)),))
    if values.shape == shape and values.ndim == 1:
        return values
    return np.broadcast_to(values, shape).reshape(-1)


def _empty(shape: tuple[int, ...], count: int) -> list[Floats]:
    return [np.empty(shape, np.float32) for _ in range(count)]
