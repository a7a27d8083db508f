# SPDX-License-Identifier: BSD-3-Clause
"""How different two pictures look to an observer."""

from __future__ import annotations

import numpy as np


def colour_difference(image: np.ndarray, reference: np.ndarray, exposure: float) -> np.ndarray:
    """(height, width) CIE 2000 differences of linear sRGB pictures (height, width, 3) as a display
    shows them; about 1 is just noticeable side by side."""
    import colour

    def lab(linear: np.ndarray) -> np.ndarray:
        shown = np.clip(exposure * np.asarray(linear, float), 0.0, 1.0)
        return colour.XYZ_to_Lab(colour.sRGB_to_XYZ(shown, apply_cctf_decoding=False))

    return np.asarray(colour.delta_E(lab(image), lab(reference), method="CIE 2000"))
