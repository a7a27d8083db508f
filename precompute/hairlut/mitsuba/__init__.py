# SPDX-License-Identifier: BSD-3-Clause
"""The BSDF "hairlut" for Mitsuba 3 in every variant: values from a nested BSDF, directions from textures.
With it comes the texture "hair_strands", for parameters that differ from strand to strand.

    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")  # or cuda_ad_rgb, scalar_rgb, ...
    import hairlut.mitsuba
    bsdf = mi.load_dict({"type": "hairlut", "model": "brown", "nested": {"type": "hair"}})

The import registers both in the variant that is set, and in every variant that is set later. Where the
C++ plugin of the BSDF is on the engine's file resolver (runtime/mitsuba), variant scalar_rgb keeps that one,
which is faster there. bsdf.py and strands.py have the parameters and the conventions of angles.
"""

from pathlib import Path

import mitsuba as mi

from .bsdf import bsdf_class
from .strands import texture_class

__all__ = ["register"]

NAME = "hairlut"
PLUGINS = [f"plugins/{NAME}{suffix}" for suffix in (".so", ".dylib", ".dll")]


def register(name: str = NAME) -> None:
    """Makes the BSDF known under a name in the variant that is set, in place of an older one of that name."""
    mi.register_bsdf(name, bsdf_class())


def _on_variant(*_variants: str | None) -> None:
    if mi.variant():
        mi.register_texture("hair_strands", texture_class())
    if mi.variant() and not (mi.variant() == "scalar_rgb" and _has_plugin()):
        register()


def _has_plugin() -> bool:
    resolver = mi.file_resolver()
    return any(Path(str(resolver.resolve(plugin))).is_file() for plugin in PLUGINS)


_on_variant()
mi.detail.add_variant_callback(_on_variant)
