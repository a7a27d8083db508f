"""The numbers that a reader of a table needs beside its texels, as the runtime and the shaders take them."""

import numpy as np

from .table import Table
from .warp import Warp

AXIS = ("columns", "height", "warp", "row_origin", "row_scale", "low", "high", "e", "f0", "k")


def axis_numbers(table: Table) -> list[float]:
    """The numbers named in AXIS, each one that a 32-bit float holds.

    warp                    1 octaves, 0 uniform
    row_origin, row_scale   row position = (theta_r - row_origin) * row_scale
    low, high               the domain
    e, f0, k                F(m + e) = f0 + k c (uniform: m = k c) for m = min(u, 1-u) and the column c,
                            counted from the nearer end
    """
    low, high = np.float32(table.theta_r_range).astype(float)  # the floats that the runtime would be given
    e = float(np.float32(table.warp.e))
    shape = [table.width, table.height, int(table.warp.name == "octaves")]
    rows = [low, (table.height - 1) / (high - low), *table.domain]
    warp = [e, *Warp(table.warp.name, e).scale(table.width)]
    return np.float32([*shape, *rows, *warp]).astype(float).tolist()
