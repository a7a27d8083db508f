# SPDX-License-Identifier: BSD-3-Clause
"""The rivals from Python: built by CMake, called over arrays through ctypes."""

import ctypes
import platform
import sys
from dataclasses import dataclass
from functools import cache

import numpy as np
from runtime.c_library import ROOT, cmake

INPUTS = ("theta_r", "phi_r", "offset", "u_lobe", "u_theta", "u_phi", "theta_light", "phi_light")
OUTPUTS = ("theta_i", "phi_i", "pdf_angle", "pdf_solid_angle", "pdf_light")
CALLS = (
    "sample_direct",
    "pdf_direct",
    "sample_multiple",
    "pdf_multiple",
    "sample_hair",
    "pdf_hair",
    "vertex",
    "hit",
)
FLOATS = ctypes.POINTER(ctypes.c_float)


class Arrays(ctypes.Structure):
    _fields_ = [("n", ctypes.c_size_t), *((name, FLOATS) for name in INPUTS + OUTPUTS)]


CALL = ctypes.CFUNCTYPE(None, ctypes.POINTER(Arrays))


class Entry(ctypes.Structure):
    _fields_ = [
        *((name, ctypes.c_char_p) for name in ("model", "name", "how")),
        *((call, CALL) for call in CALLS),
    ]


@dataclass(frozen=True)
class Rival:
    """One way to do without a table; `calls` are those it offers."""

    model: str
    name: str
    how: str
    calls: dict[str, CALL]

    def run(self, call: str, **inputs) -> dict[str, np.ndarray]:
        """The outputs of a call for inputs that broadcast; inputs that are not given are 0."""
        names, given = list(inputs), np.broadcast_arrays(*inputs.values())
        n, shape = given[0].size, given[0].shape
        arrays = {name: np.zeros(n, np.float32) for name in INPUTS + OUTPUTS}
        for name, values in zip(names, given, strict=True):
            arrays[name][:] = values.ravel()
        pointers = {name: each.ctypes.data_as(FLOATS) for name, each in arrays.items()}
        self.calls[call](ctypes.byref(Arrays(n=n, **pointers)))
        return {name: arrays[name].reshape(shape) for name in OUTPUTS}


@cache
def rivals() -> list[Rival]:
    """Those that could be built here and that this processor runs."""
    folder = cmake(ROOT / "tests" / "bench" / "rivals", ROOT / "build" / "rivals", f"-DMKL_ROOT={sys.prefix}")
    suffix = "dylib" if platform.system() == "Darwin" else "so"
    library = ctypes.CDLL(str(folder / f"librivals.{suffix}"))
    library.rival_at.restype = ctypes.POINTER(Entry)
    found = []
    while entry := library.rival_at(len(found)):
        one = entry.contents
        calls = {call: getattr(one, call) for call in CALLS if getattr(one, call)}
        found.append(Rival(one.model.decode(), one.name.decode(), one.how.decode(), calls))
    return found
