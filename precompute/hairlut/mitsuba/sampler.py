# SPDX-License-Identifier: BSD-3-Clause
"""The whole hair in the engine's arrays: draws directions and gives their density, as hairlut_sample_hair and
hairlut_pdf_hair, and at the parameters of a strand hairlut_sample_strand and hairlut_pdf_strand, of
runtime/include/hairlut.h do."""

from __future__ import annotations

from collections.abc import Sequence

import drjit as dr
import mitsuba as mi

from ..model import BakedModel
from .arrays import Number, Records
from .axis import Axes, Place
from .mixing import Mix, wrap


class Sampler:
    """A model's textures in the arrays of the variant that is set; for no other variant.

    parameters  of the model: sample and pdf take a value for each, clamped to its range; NaN: density 0
    """

    def __init__(self, model: BakedModel) -> None:
        tables = model.tables
        numbers = {table.name: k for k, table in enumerate(tables)}
        self.parameters = model.parameters
        self._mix, self._axes = Mix(model.mixture, model.parameters), Axes(tables, model.parameters)
        self._theta = [numbers[lobe.theta.name] for lobe in model.lobes]
        self._phi = [numbers[lobe.phi.name] if lobe.phi else None for lobe in model.lobes]
        # phi_i = relative azimuth + sign * phi_r
        self._sign = [-1.0 if lobe.phi and lobe.phi.azimuth == "sum" else 1.0 for lobe in model.lobes]
        rows = zip(self._theta, self._phi, self._sign, strict=True)
        self._lobes = Records(
            [[theta, theta if phi is None else phi, sign, phi is None] for theta, phi, sign in rows]
        )

    def sample(
        self,
        theta_r: Number,
        phi_r: Number,
        offset: Number,
        u_lobe: Number,
        u_theta: Number,
        u_phi: Number,
        values: Sequence[Number] = (),
    ) -> tuple[Number, Number]:
        """(theta_i, phi_i in [-pi, pi)) from three numbers in [0, 1)."""
        values, _ = self._known(values)
        shares, turns, side = self._mix.at(theta_r, offset, values)
        lobe, turn = _drawn(shares, turns, u_lobe)
        theta, phi, sign, uniform = self._lobes[lobe]
        theta_i = self._draw(self._axes.place(mi.UInt32(theta)), values, theta_r, u_theta)
        azimuth = self._draw(self._axes.place(mi.UInt32(phi)), values, theta_r, u_phi)
        turned = side * (azimuth + turn) + sign * phi_r
        return theta_i, wrap(dr.select(uniform > 0, dr.two_pi * u_phi - dr.pi, turned))

    def pdf(
        self,
        theta_r: Number,
        phi_r: Number,
        offset: Number,
        theta_i: Number,
        phi_i: Number,
        values: Sequence[Number] = (),
    ) -> Number:
        """Density per rad^2 with which sample draws (theta_i, phi_i)."""
        values, known = self._known(values)
        shares, turns, side = self._mix.at(theta_r, offset, values)
        density = 0.0
        for share, turn, theta, phi, sign in zip(
            shares, turns, self._theta, self._phi, self._sign, strict=True
        ):
            along = self._density(self._axes.fixed(theta), values, theta_r, theta_i)
            around = 1 / dr.two_pi
            if phi is not None:
                relative = side * (phi_i - sign * phi_r) - turn
                relative -= dr.two_pi * dr.floor(relative / dr.two_pi)
                around = self._density(self._axes.fixed(phi), values, theta_r, relative)
            density += share * along * around
        return dr.select(known, density / sum(shares), 0)

    def _known(self, values: Sequence[Number]) -> tuple[list[Number], Number]:
        """(the values, with the least in place of NaN; whether none was NaN)"""
        known = mi.Bool(True)
        for value in values:
            known = known & (value == value)
        pairs = zip(values, self.parameters, strict=True)
        return [dr.select(dr.isnan(value), each.least, value) for value, each in pairs], known

    def _draw(self, table: Place, values: Sequence[Number], theta_r: Number, u: Number) -> Number:
        return self._axes.sample(table, self._axes.corners(table, values), theta_r, u)

    def _density(self, table: Place, values: Sequence[Number], theta_r: Number, x: Number) -> Number:
        return self._axes.pdf(table, self._axes.corners(table, values), theta_r, x)


def _drawn(shares: list[Number], turns: list[Number], u: Number) -> tuple[Number, Number]:
    """(lobe, its turn): the first k with u S < share_0 + ... + share_k, S the sum; never one of share 0."""
    left = u * sum(shares)
    lobe, turn, open_ = mi.UInt32(0), turns[0], mi.Bool(True)
    for k, (share, its) in enumerate(zip(shares, turns, strict=True)):
        here = open_ & (share > 0)
        lobe, turn = dr.select(here, k, lobe), dr.select(here, its, turn)
        open_ = open_ & (left >= share)
        left = left - share
    return lobe, turn
