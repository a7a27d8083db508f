# SPDX-License-Identifier: BSD-3-Clause
"""A baked model: lobes and their mixture, read in double precision. What a bake or a fit is measured with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from . import interpolant
from .axes import NO_PARAMETERS, Parameter, check_parameters, check_ranges, completed
from .errors import HairlutError
from .lobes import Array, Model
from .mixture import Mixture, constant, wrap
from .table import Table

TURN = 2 * np.pi


@dataclass(frozen=True)
class BakedLobe:
    """The product of a table of theta_i and one of the relative azimuth; phi None: the azimuth is uniform."""

    name: str
    theta: Table
    phi: Table | None

    @property
    def tables(self) -> tuple[Table, ...]:
        return (self.theta, self.phi) if self.phi else (self.theta,)


@dataclass(frozen=True)
class BakedModel:
    """Lobes in the order of their mixture.

    errors      measured errors by the name of a table, or "mixture"
    parameters  those of the hair on which tables and mixture depend; in the mixture's axes in this order
    """

    name: str
    lobes: tuple[BakedLobe, ...]
    mixture: Mixture
    errors: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    parameters: tuple[Parameter, ...] = ()

    def __post_init__(self) -> None:
        names = tuple(lobe.name for lobe in self.lobes)
        if names != self.mixture.lobes:
            raise HairlutError(
                f"{self.name}: lobes {', '.join(names)}, but a mixture of {', '.join(self.mixture.lobes)}"
            )
        for lobe in self.lobes:
            kinds = tuple(table.angle for table in lobe.tables)
            if kinds != ("theta_i", "phi")[: len(kinds)]:
                raise HairlutError(f"{self.name}: lobe {lobe.name} has tables of {', '.join(kinds)}")
        by_name: dict[str, Table] = {}
        for table in (table for lobe in self.lobes for table in lobe.tables):
            if by_name.setdefault(table.name, table) is not table:
                raise HairlutError(f"{self.name}: two different tables are named {table.name}")
        self._check_parameters()

    def _check_parameters(self) -> None:
        check_parameters(self.parameters)
        for name, axes in [(t.name, t.axes) for t in self.tables] + [("mixture", self.mixture.axes)]:
            try:
                check_ranges(axes, self.parameters)
            except HairlutError as error:
                raise HairlutError(f"{self.name}/{name}: {error}") from error
        used = [axis.name for axis in self.mixture.axes]
        order = [parameter.name for parameter in self.parameters if parameter.name in used]
        if used != order:
            raise HairlutError(
                f"{self.name}/mixture: axes are {', '.join(used)}, expected the parameters' order, "
                f"{', '.join(order)}"
            )

    @property
    def tables(self) -> list[Table]:
        """Every table once, in the order of the lobes."""
        by_name = {table.name: table for lobe in self.lobes for table in lobe.tables}
        return list(by_name.values())

    def at(self, parameters: Mapping[str, float]) -> BakedModel:
        """The model at fixed parameters, without any; standard values for those that are not given."""
        values = completed(parameters, self.parameters)
        fixed = {table.name: table.at(values) for table in self.tables}
        lobes = tuple(BakedLobe(x.name, fixed[x.theta.name], x.phi and fixed[x.phi.name]) for x in self.lobes)
        errors = {} if self.parameters else self.errors  # measured over all parameters, not at these
        return BakedModel(self.name, lobes, self.mixture.parameters_at(values), errors)

    def sample(
        self,
        theta_r: Array,
        phi_r: Array,
        u: Array,
        offset: Array = 0.0,
        parameters: Mapping[str, Array] = NO_PARAMETERS,
    ) -> tuple[Array, Array, Array]:
        """(theta_i, phi_i in [-pi, pi), density per rad^2), each (...), drawn with u (..., 3): the lobe's
        number, then those of theta_i and of the azimuth. theta_r, phi_r, offset (rad, rad, in [-1, 1]) and
        the parameters' values (clamped to their ranges, standard ones where there are none) broadcast to
        (...)."""
        u = np.asarray(u, float)
        given, shape = completed(parameters, self.parameters), u.shape[:-1]
        theta_r, phi_r, offset = (np.broadcast_to(x, shape).ravel() for x in (theta_r, phi_r, offset))
        given = {name: np.broadcast_to(value, shape).ravel() for name, value in given.items()}
        u_lobe, u_theta, u_phi = (u[..., k].ravel() for k in range(3))
        share, turn, side = self.mixture.at(theta_r, offset, given)
        lobe_of = _drawn(share, u_lobe)
        theta_i, phi_i = np.empty(len(u_lobe)), np.empty(len(u_lobe))
        for k, lobe in enumerate(self.lobes):
            at = np.flatnonzero(lobe_of == k)
            those = {name: value[at] for name, value in given.items()}
            theta_i[at], _ = interpolant.sample(lobe.theta, theta_r[at], u_theta[at], those)
            if lobe.phi is None:
                phi_i[at] = TURN * u_phi[at] - np.pi
                continue
            x, _ = interpolant.sample(lobe.phi, theta_r[at], u_phi[at], those)
            relative = side[at] * (x + turn[k, at])
            phi_i[at] = wrap(relative + _sign(lobe.phi) * phi_r[at])
        density = self.pdf(theta_r, phi_r, theta_i, phi_i, offset, given)
        return theta_i.reshape(shape), phi_i.reshape(shape), density.reshape(shape)

    def pdf(
        self,
        theta_r: Array,
        phi_r: Array,
        theta_i: Array,
        phi_i: Array,
        offset: Array = 0.0,
        parameters: Mapping[str, Array] = NO_PARAMETERS,
    ) -> Array:
        """Density per rad^2 in (theta_i, phi_i) with which sample draws them; the arguments broadcast. 0 with
        a parameter that is NaN."""
        values = completed(parameters, self.parameters)
        given = np.broadcast_arrays(theta_r, phi_r, theta_i, phi_i, offset, *values.values())
        theta_r, phi_r, theta_i, phi_i, offset, *rest = (np.ravel(x).astype(float) for x in given)
        values = dict(zip(values, rest, strict=True))
        share, turn, side = self.mixture.at(theta_r, offset, values)
        density = np.zeros(len(theta_r))
        for k, lobe in enumerate(self.lobes):
            azimuthal = 1 / TURN
            if lobe.phi is not None:
                relative = phi_i - _sign(lobe.phi) * phi_r
                x = np.mod(side * relative - turn[k], TURN)
                azimuthal = interpolant.pdf(lobe.phi, theta_r, x, values)
            density += share[k] * interpolant.pdf(lobe.theta, theta_r, theta_i, values) * azimuthal
        for value in rest:
            density[np.isnan(value)] = 0.0
        return density.reshape(given[0].shape)


def assemble(
    model: Model, tables: Mapping[str, Table], errors: Mapping[str, Mapping[str, float]] | None = None
) -> BakedModel:
    """The baked model of a model's tables by name, with their measured errors."""
    lobes = tuple(BakedLobe(name, tables[f"{name}_theta"], tables.get(f"{name}_phi")) for name in model.names)
    return BakedModel(model.name, lobes, constant(model.names, model.shares), errors or {})


def _sign(phi: Table) -> float:
    """phi_i = relative azimuth + sign * phi_r."""
    return 1.0 if phi.azimuth == "difference" else -1.0


def _drawn(share: Array, u: Array) -> Array:
    """(n,) the first lobe k with u S < share_0 + ... + share_k, of shares (K, n) whose sum is S; never one of
    share 0."""
    running = np.cumsum(share, axis=0)
    drawn = (u * running[-1] >= running).sum(axis=0)
    last = len(share) - 1 - np.argmax(share[::-1] > 0, axis=0)
    return np.minimum(drawn, last)
