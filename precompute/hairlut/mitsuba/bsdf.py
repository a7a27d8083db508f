# SPDX-License-Identifier: BSD-3-Clause
"""The BSDF: values from a nested hair BSDF, directions from a model's textures.

    model     string  a shipped model, such as "fitted" (default) or "brown", or a directory of textures
    mix       float   probability of the nested BSDF's own sampling, in [0, 1] (default 0)
    (nested)  bsdf    one BSDF without Dirac components that gives the values
    (name)    float or texture  a parameter of the model by its name, such as beta_m, in the model's unit
                                (default its standard value); beyond its range the nearer end counts

Conventions. On a curve the shading frame's t, local +y, is the fibre: sin(theta) = w.y. Azimuths run from
the surface normal, local +z, towards local +x. The engine's si.wi is the viewer direction (theta_r, phi_r),
its wo the incident one (theta_i, phi_i). The density is per steradian over the whole sphere.

The offset is h = sin(phi_r): the surface mirrors a ray that hits there to phi_i = -phi_r, the relative
azimuth -2 asin(h), which is the sign of hairlut.h.

A texture of a parameter may differ from strand to strand: a mesh_attribute, a bitmap, or for curves the
texture "hair_strands" (strands.py). What it gives should be what the nested BSDF uses; where it is not, there
is more noise, and no bias.

Directions and densities are detached: gradients pass through the nested BSDF's value over a constant density.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import drjit as dr
import mitsuba as mi

from ..axes import Parameter
from ..config import data
from ..errors import HairlutError
from ..exr import read_model
from ..model import BakedModel
from ..sampler import BUILTIN
from .arrays import Number
from .sampler import Sampler

MIN_COSINE = 1e-7


def read(model: str) -> BakedModel:
    """The model of that name, or of a directory; HairlutError names what is wrong."""
    if model in BUILTIN:
        return read_model(data("luts") / model)
    directory = Path(str(mi.file_resolver().resolve(model)))
    if not directory.is_dir():
        names = ", ".join(BUILTIN)
        raise HairlutError(f"hairlut: model {model!r} is none of {names}, nor a directory of textures")
    return read_model(directory)


def bsdf_class() -> type:
    """The class for the variant that is set, whose BSDF it extends."""

    class HairlutBSDF(mi.BSDF):
        def __init__(self, props: mi.Properties) -> None:
            super().__init__(props)
            self.model = str(props.get("model", "fitted"))
            self.mix = float(props.get("mix", 0.0))
            if not 0 <= self.mix <= 1:
                raise HairlutError(f"hairlut: mix is {self.mix:g}: expected a probability, 0 to 1")
            self.nested = _nested(props)
            self.sampler = Sampler(read(self.model))
            self.strand = _textures(props, self.model, self.sampler.parameters)
            self.m_components = [self.nested.flags(k) for k in range(self.nested.component_count())]
            self.m_flags = self.nested.flags()

        def sample(self, ctx, si, sample1, sample2, active=True):
            if self.mix == 1:
                return self.nested.sample(ctx, si, sample1, sample2, active)
            with dr.suspend_grad():
                u_lobe = (sample1 - self.mix) / (1 - self.mix)
                values = self._values(si, active)
                theta_i, phi_i = self.sampler.sample(*_viewer(si.wi), u_lobe, sample2.x, sample2.y, values)
                wo = _direction(theta_i, phi_i)
                if self.mix > 0:
                    own = sample1 < self.mix
                    drawn, _ = self.nested.sample(ctx, si, sample1 / self.mix, sample2, active & own)
                    wo = dr.select(own, drawn.wo, wo)
                    active = active & dr.select(own, drawn.pdf > 0, True)
            value, pdf = self.eval_pdf(ctx, si, wo, active)
            bs = dr.zeros(mi.BSDFSample3f)
            bs.wo, bs.pdf, bs.eta = wo, pdf, 1.0
            bs.sampled_type = mi.UInt32(+mi.BSDFFlags.Glossy)
            return bs, dr.select(pdf > 0, value / pdf, 0)

        def eval(self, ctx, si, wo, active=True):
            return self.nested.eval(ctx, si, wo, active)

        def pdf(self, ctx, si, wo, active=True):
            own = self.nested.pdf(ctx, si, wo, active) if self.mix > 0 else 0.0
            return self._mixed(own, si, wo, active)

        def eval_pdf(self, ctx, si, wo, active=True):
            if self.mix > 0:
                value, own = self.nested.eval_pdf(ctx, si, wo, active)
            else:
                value, own = self.nested.eval(ctx, si, wo, active), 0.0
            return value, self._mixed(own, si, wo, active)

        def _mixed(self, own: Number, si: Any, wo: Any, active: Number) -> Number:
            if self.mix == 1:
                return own
            with dr.suspend_grad():
                theta_i, phi_i = _angles(wo)
                values = self._values(si, active)
                density = self.sampler.pdf(*_viewer(si.wi), theta_i, phi_i, values)
                density /= dr.maximum(_across(wo), MIN_COSINE)
                return dr.select(active, self.mix * dr.detach(own) + (1 - self.mix) * density, 0)

        def _values(self, si: Any, active: Number) -> list[Number]:
            return [texture.eval_1(si, active) for texture in self.strand.values()]

        def eval_diffuse_reflectance(self, si, active=True):
            return self.nested.eval_diffuse_reflectance(si, active)

        def traverse(self, callback):
            callback.put("nested", self.nested, mi.ParamFlags.Differentiable)
            for name, texture in self.strand.items():
                callback.put(name, texture, mi.ParamFlags.NonDifferentiable)

        def to_string(self):
            strand = "".join(f"  {name} = {texture},\n" for name, texture in self.strand.items())
            return (
                f"HairlutBSDF[\n  model = {self.model},\n  mix = {self.mix:g},\n"
                f"{strand}  nested = {self.nested}\n]"
            )

    return HairlutBSDF


def _nested(props: mi.Properties) -> Any:
    nested = [each for _, each in props.objects() if isinstance(each, mi.BSDF)]
    if len(nested) != 1:
        raise HairlutError(
            f"hairlut: expected one nested BSDF, which gives the values, found {len(nested)}: "
            "add one, such as {'type': 'hair'}"
        )
    dirac = (mi.BSDFFlags.DeltaReflection, mi.BSDFFlags.DeltaTransmission)
    if any(mi.has_flag(nested[0].flags(), flag) for flag in dirac):
        raise HairlutError(
            "hairlut: the nested BSDF has a Dirac component, which no table samples: nest a rough one"
        )
    return nested[0]


def _textures(props: mi.Properties, model: str, parameters: Sequence[Parameter]) -> dict[str, Any]:
    """A texture for each parameter of the model, in order."""
    names = [parameter.name for parameter in parameters]
    for name, value in props.items():
        if name in ("model", "mix", *names) or isinstance(value, mi.BSDF):
            continue
        raise HairlutError(
            f"hairlut: parameter {name!r}: the model {model!r} has {', '.join(names) or 'no parameters'}"
        )
    return {each.name: props.get_unbounded_texture(each.name, each.standard) for each in parameters}


def _across(w: Any) -> Number:
    """cos(theta)"""
    return dr.sqrt(w.x * w.x + w.z * w.z)


def _angles(w: Any) -> tuple[Number, Number]:
    return dr.atan2(w.y, _across(w)), dr.atan2(w.x, w.z)


def _viewer(wi: Any) -> tuple[Number, Number, Number]:
    """(theta_r, phi_r, offset)"""
    theta_r, phi_r = _angles(wi)
    return theta_r, phi_r, dr.sin(phi_r)


def _direction(theta: Number, phi: Number) -> Any:
    across = dr.cos(theta)
    return mi.Vector3f(across * dr.sin(phi), dr.sin(theta), across * dr.cos(phi))
