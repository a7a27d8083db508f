# SPDX-License-Identifier: BSD-3-Clause
"""What is compared: ways to draw a direction for one and the same hair, and the settings they are used in."""

from __future__ import annotations

from dataclasses import dataclass

Parameters = dict[str, object]

SAMPLERS: dict[str, Parameters] = {
    "uniform": {"uniform": True},
    "printed": {"model": "printed"},
    "fitted": {"model": "fitted"},
    "own": {"mix": 1.0},
    "mix": {"model": "fitted", "mix": 0.5},
}

LABELS = {
    "uniform": "uniform sphere",
    "printed": "printed tables",
    "fitted": "fitted tables",
    "own": "the BSDF's own",
    "mix": "half fitted, half own",
}


@dataclass(frozen=True)
class Setting:
    """An estimator and its light: how the samplers are compared."""

    title: str
    integrator: Parameters
    lamps: bool
    light_sampling: bool


_ONE_SCATTERING: Parameters = {"type": "direct", "emitter_samples": 0, "bsdf_samples": 1}
_FIVE_SCATTERINGS: Parameters = {"type": "path", "max_depth": 6, "rr_depth": 100}

SETTINGS = {
    "single": Setting("one scattering, BSDF sampling alone, sky", _ONE_SCATTERING, False, False),
    "walk": Setting("up to five scatterings, BSDF sampling alone, sky", _FIVE_SCATTERINGS, False, False),
    "path": Setting(
        "up to five scatterings, with light sampling, sky and lamps", _FIVE_SCATTERINGS, True, True
    ),
}

REFERENCE = (
    "fitted"  # the best of those that are unbiased; the engine's hair does not draw what its density says
)


def bsdf_dict(sampler: str, nested: Parameters, light_sampling: bool = True) -> Parameters:
    """The BSDF for `mi.load_dict` that draws as `sampler` says and has the values of `nested`."""
    return {"type": "hairlut", "nested": nested, "light_sampling": light_sampling, **SAMPLERS[sampler]}
