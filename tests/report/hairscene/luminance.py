# SPDX-License-Identifier: BSD-3-Clause
"""Luminance as the engine has it, of linear RGB with the primaries of Rec. 709."""

import numpy as np

WEIGHTS = np.array([0.212671, 0.715160, 0.072169])


def luminance(rgb) -> np.ndarray:
    """(...,) of rgb (..., 3)."""
    return np.asarray(rgb, np.float64) @ WEIGHTS
