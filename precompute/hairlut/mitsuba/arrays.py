# SPDX-License-Identifier: BSD-3-Clause
"""What differs between variants: numbers are Dr.Jit's arrays, in scalar variants Python's own."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

Number = Any  # mi.Float, mi.UInt32 or mi.Bool of the variant that is set


class Records:
    """Rows of K floats: records[i] is a list of K numbers. rows: (n, K), K a power of two reads fastest."""

    def __init__(self, rows: np.ndarray) -> None:
        rows = np.ascontiguousarray(rows, np.float32)
        self._width = rows.shape[1]
        self._rows = rows.tolist() if mi.variant().startswith("scalar") else mi.Float(rows.ravel())

    def __getitem__(self, i: Number) -> list[Number]:
        if isinstance(self._rows, list):
            return self._rows[i]
        shape = (self._width, dr.width(i))
        return list(dr.gather(mi.ArrayXf, self._rows, i, shape=shape))


def last(count: Number, most: int, is_below: Callable[[Number], Number]) -> Number:
    """The last i in [0, count) with is_below(i), by halving; is_below is true up to some i, then false.

    is_below(0) is taken for true. most: the largest count, on which the number of steps depends.
    """
    i = mi.UInt32(0)
    step = 1 << max(most - 1, 0).bit_length() >> 1
    while step:
        candidate = dr.minimum(i + step, count - 1)
        i = dr.select(is_below(candidate), candidate, i)
        step >>= 1
    return i
