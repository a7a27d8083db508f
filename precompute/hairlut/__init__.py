# SPDX-License-Identifier: BSD-3-Clause
"""Importance sampling of hair scattering from small lookup textures, and the tool that bakes them.

    import hairlut
    hair = hairlut.load("luts/fitted")              # or hairlut.builtin("fitted")
    s = hair.sample(theta_r, phi_r, u)              # u (..., 3); s.theta_i, s.phi_i, s.pdf_solid_angle
    q = hair.pdf(theta_r, phi_r, theta_i, phi_i)    # of any direction, per rad^2

Public: load, builtin, Model, Sample (sampler.py), HairlutError; hairlut.modelfile for model files; the
command hairlut. All else may change.

Data flows one way: lobes (the equations) -> integrate -> invert -> table -> exr. warp places the columns of a
table on the axis of the cumulative probability, interpolant is the rule by which a table is read, and
analytic the closed form against which all of it is tested.
"""

__version__ = "2.3.0"

__all__ = ["HairlutError", "Model", "Sample", "builtin", "load"]

from .errors import HairlutError


def __getattr__(name: str) -> object:
    """Models are imported when they are first named: the command starts without numpy."""
    if name in __all__:
        from . import sampler

        return getattr(sampler, name)
    raise AttributeError(f"module 'hairlut' has no attribute {name!r}")
