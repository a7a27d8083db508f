"""What is compared: ways to draw a direction for one and the same hair, and the settings they are used in."""

from __future__ import annotations

from dataclasses import dataclass

Parameters = dict[str, object]

SAMPLERS: dict[str, Parameters | None] = {
    "uniform": {"uniform": True},
    "printed": {"model": "printed"},
    "fitted": {"model": "fitted"},
    "own": None,  # without the plugin
    "mix": {"model": "fitted", "nested_weight": 0.5},
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


_ONE_SCATTERING: Parameters = {"type": "direct", "emitter_samples": 0, "bsdf_samples": 1}

SETTINGS = {
    "sky": Setting("one scattering, found by BSDF sampling alone, sky without lamps", _ONE_SCATTERING, False),
    "scatter": Setting("one scattering, found by BSDF sampling alone, sky and lamps", _ONE_SCATTERING, True),
    "path": Setting(
        "up to five scatterings, light sampling combined with BSDF sampling, sky and lamps",
        {"type": "path", "max_depth": 6, "rr_depth": 100},
        True,
    ),
}

REFERENCE = (
    "fitted"  # the best of those that are unbiased; the engine's hair does not draw what its density says
)


def bsdf_dict(sampler: str, nested: Parameters) -> Parameters:
    """The BSDF for `mi.load_dict` that draws as `sampler` says and has the values of `nested`."""
    parameters = SAMPLERS[sampler]
    return nested if parameters is None else {"type": "hairlut", "nested": nested, **parameters}
