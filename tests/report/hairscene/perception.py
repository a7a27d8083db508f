# SPDX-License-Identifier: BSD-3-Clause
"""What an observer sees: sRGB pictures, and colour differences by CIE 2000 and by ITP (ITU-R BT.2124)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

EXPOSURE = 2.5
WHITE = 100.0  # cd/m2 of a picture's white


def displayed(image: Array) -> Array:
    """Linear values in [0, 1] that a display shows."""
    return np.clip(np.asarray(image, dtype=np.float64) * EXPOSURE, 0.0, 1.0)


def encoded(image: Array) -> Array:
    """sRGB-encoded values in [0, 1]."""
    import colour

    return np.asarray(colour.cctf_encoding(displayed(image), function="sRGB"))


def delta_e_2000(image: Array, reference: Array) -> Array:
    """Colour difference per pixel; about 1 is just noticeable, side by side."""
    import colour

    def lab(linear: Array) -> Array:
        return colour.XYZ_to_Lab(colour.sRGB_to_XYZ(linear, apply_cctf_decoding=False))

    return np.asarray(colour.delta_E(lab(displayed(image)), lab(displayed(reference)), method="CIE 2000"))


def delta_e_itp(image: Array, reference: Array) -> Array:
    """Colour difference per pixel; 1 is just noticeable under the most critical viewing."""
    import colour

    def ictcp(linear: Array) -> Array:
        wide = colour.RGB_to_RGB(linear, "sRGB", "ITU-R BT.2020")
        return colour.RGB_to_ICtCp(np.clip(wide, 0.0, None) * WHITE, method="ITU-R BT.2100-2 PQ")

    return np.asarray(colour.delta_E(ictcp(displayed(image)), ictcp(displayed(reference)), method="ITP"))
