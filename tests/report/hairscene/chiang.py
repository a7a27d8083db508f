# SPDX-License-Identifier: BSD-3-Clause
"""The BSDF "chiang" for Mitsuba's array variants: precompute/examples/chiang_parameters.py with a texture for
each parameter, and the sampler of the paper. The engine's own `hair` has one roughness for all strands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

STANDARD = {"beta_m": 0.3, "beta_n": 0.3, "absorption": 0.6}
ETA, TILT = 1.55, dr.deg2rad(2.0)
TILTS = (2 * TILT, -TILT, -4 * TILT, 0.0)
SERIES = 32  # terms of the Bessel function I0, for arguments up to 12
Number = Any


def register() -> None:
    """Makes it known in the variant that is set."""
    mi.register_bsdf("chiang", _bsdf_class())


@dataclass(frozen=True)
class Hit:
    """The hair where a ray hits it: four lobes, each with its strength A_p, longitudinal variance, and
    direction around the fibre, relative to the viewer's; s: scale of the azimuthal logistic."""

    theta_r: Number
    phi_r: Number
    strength: list[Number]
    variance: list[Number]
    centre: list[Number]
    s: Number

    def values(self, theta_i: Number, phi_i: Number) -> list[Number]:
        """A_p M_p D_p: the BSDF times cos(theta_i), lobe by lobe."""
        found = []
        for p in range(4):
            along = longitudinal(theta_i, self.theta_r - TILTS[p], self.variance[p])
            around = azimuthal(phi_i - self.phi_r - self.centre[p], self.s) if p < 3 else dr.inv_two_pi
            found.append(self.strength[p] * along * around)
        return found


def hit(wi: Any, beta_m: Number, beta_n: Number, absorption: Number) -> Hit:
    across = dr.sqrt(wi.x * wi.x + wi.z * wi.z)
    theta_r, phi_r = dr.atan2(wi.y, across), dr.atan2(wi.x, wi.z)
    offset, sine, cosine = dr.sin(phi_r), wi.y, dr.maximum(across, 1e-6)
    inside = dr.asin(offset * cosine / dr.sqrt(ETA**2 - sine * sine))
    path = 2 * dr.cos(inside) / dr.sqrt(1 - (sine / ETA) ** 2)
    passed = dr.exp(-absorption * path)
    mirror = _fresnel(cosine * dr.sqrt(dr.maximum(1 - offset * offset, 0)))
    tt = (1 - mirror) ** 2 * passed
    trt = tt * passed * mirror
    strength = [mirror, tt, trt, trt * passed * mirror / (1 - passed * mirror)]
    v = (0.726 * beta_m + 0.812 * beta_m**2 + 3.7 * beta_m**20) ** 2
    s = dr.sqrt(dr.pi / 8) * (0.265 * beta_n + 1.194 * beta_n**2 + 5.372 * beta_n**22)
    centre = [2 * p * inside - 2 * dr.asin(offset) + p * dr.pi for p in range(3)]
    return Hit(theta_r, phi_r, strength, [v, v / 4, 4 * v, 4 * v], centre, s)


def longitudinal(theta_i: Number, theta_r: Number, v: Number) -> Number:
    """M_p, per steradian and 2 pi of azimuth."""
    x = dr.maximum(dr.cos(theta_i) * dr.cos(theta_r), 0) / v
    exponent = _log_bessel(x) - dr.sin(theta_i) * dr.sin(theta_r) / v - 1 / v
    return dr.exp(exponent) / (v * (1 - dr.exp(-2 / v)))


def azimuthal(phi: Number, s: Number) -> Number:
    """D_p, a logistic distribution cut to the circle."""
    e = dr.exp(-dr.abs(_wrapped(phi)) / s)
    return e / (s * (1 + e) ** 2 * dr.tanh(dr.pi / (2 * s)))


def draw(here: Hit, u_lobe: Number, u: Any) -> tuple[Number, Number]:
    """(theta_i, phi_i): a lobe by its strength, then both of its angles exactly (d'Eon et al. 2013)."""
    left, v, tilt, centre = u_lobe * sum(here.strength), here.variance[0], TILTS[0], here.centre[0]
    rest, even, open_ = left / here.strength[0], mi.Bool(False), left >= here.strength[0]
    for p in range(1, 4):
        left = left - here.strength[p - 1]
        v, tilt = dr.select(open_, here.variance[p], v), dr.select(open_, TILTS[p], tilt)
        centre = dr.select(open_, here.centre[p] if p < 3 else 0.0, centre)
        rest, even = dr.select(open_, left / here.strength[p], rest), open_ if p == 3 else even
        open_ = open_ & (left >= here.strength[p])
    rest = dr.clip(rest, 1e-7, 1 - 1e-7)
    seen = here.theta_r - tilt
    cosine = 1 + v * dr.log(dr.maximum(u.x, 1e-12) + (1 - u.x) * dr.exp(-2 / v))
    sine = dr.sqrt(dr.maximum(1 - cosine * cosine, 0))
    theta_i = -cosine * dr.sin(seen) + sine * dr.cos(dr.two_pi * u.y) * dr.cos(seen)
    edge = 1 / (1 + dr.exp(dr.pi / here.s))
    logistic = -here.s * dr.log(1 / (edge + rest * (1 - 2 * edge)) - 1)
    phi = dr.select(even, dr.two_pi * rest, logistic + centre)
    return dr.asin(dr.clip(theta_i, -1, 1)), _wrapped(here.phi_r + phi)


def _bsdf_class() -> type:
    class Chiang(mi.BSDF):
        def __init__(self, props: mi.Properties) -> None:
            super().__init__(props)
            self.strand = [props.get_unbounded_texture(name, value) for name, value in STANDARD.items()]
            flags = mi.BSDFFlags.Glossy | mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
            self.m_components, self.m_flags = [flags], flags

        def _hit(self, si, active) -> Hit:
            return hit(si.wi, *(texture.eval_1(si, active) for texture in self.strand))

        def sample(self, ctx, si, sample1, sample2, active=True):
            theta_i, phi_i = draw(self._hit(si, active), sample1, sample2)
            across = dr.cos(theta_i)
            bs = dr.zeros(mi.BSDFSample3f)
            bs.wo = mi.Vector3f(across * dr.sin(phi_i), dr.sin(theta_i), across * dr.cos(phi_i))
            bs.eta, bs.sampled_type = 1.0, mi.UInt32(+mi.BSDFFlags.Glossy)
            value, bs.pdf = self.eval_pdf(ctx, si, bs.wo, active)
            return bs, dr.select(bs.pdf > 0, value / bs.pdf, 0)

        def eval(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[1]

        def eval_pdf(self, ctx, si, wo, active=True):
            here = self._hit(si, active)
            theta_i = dr.atan2(wo.y, dr.sqrt(wo.x * wo.x + wo.z * wo.z))
            total = sum(here.values(theta_i, dr.atan2(wo.x, wo.z)))
            return mi.Color3f(dr.select(active, total, 0)), dr.select(active, total / sum(here.strength), 0)

        def to_string(self) -> str:
            return "Chiang"

    return Chiang


def _wrapped(phi: Number) -> Number:
    return phi - dr.two_pi * dr.floor((phi + dr.pi) / dr.two_pi)


def _fresnel(cosine: Number) -> Number:
    refracted = dr.sqrt(1 - (1 - cosine * cosine) / ETA**2)
    parallel = (ETA * cosine - refracted) / (ETA * cosine + refracted)
    across = (cosine - ETA * refracted) / (cosine + ETA * refracted)
    return (parallel * parallel + across * across) / 2


def _log_bessel(x: Number) -> Number:
    """log I0(x): the series up to 12, and three terms at infinity beyond, as the paper has two."""
    quarter, term, total = dr.minimum(x, 12) ** 2 / 4, mi.Float(1), mi.Float(1)
    for k in range(1, SERIES):
        term = term * quarter / k**2
        total += term
    large = dr.maximum(x, 12)
    beyond = large - dr.log(dr.two_pi * large) / 2 + dr.log(1 + 1 / (8 * large) + 9 / (128 * large * large))
    return dr.select(x < 12, dr.log(total), beyond)
