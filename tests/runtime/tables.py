"""Tables for the tests of models from memory, and OpenEXR files made from good ones with one thing wrong."""

import ctypes
import shutil
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from runtime.c_library import AXES, MESSAGE_SIZE, OK, ROOT, LoadError, Model, core

HALF_PI = np.float32(np.pi / 2)
TWO_PI = np.float32(2 * np.pi)
UNIFORM, OCTAVES = 0, 1
DIFFERENCE, SUM = 0, 1


class CTable(ctypes.Structure):
    _fields_ = [
        ("texels", ctypes.POINTER(ctypes.c_float)),
        *((name, ctypes.c_int) for name in ("width", "height")),
        *((name, ctypes.c_float) for name in ("theta_r_min", "theta_r_max", "domain_min", "domain_max")),
        ("warp", ctypes.c_int),
        *((name, ctypes.c_float) for name in ("warp_e", "cell_limit")),
    ]


class CDescription(ctypes.Structure):
    _fields_ = [*((name, CTable) for name in AXES), ("azimuth", ctypes.c_int)]


Allocate = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)
Release = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)


class CAllocator(ctypes.Structure):
    _fields_ = [("allocate", Allocate), ("release", Release), ("user", ctypes.c_void_p)]


@dataclass
class MemoryTable:
    """hairlut_table, in Python."""

    texels: np.ndarray | None
    domain: tuple[float, float] = (-HALF_PI, HALF_PI)
    theta_r_range: tuple[float, float] = (-HALF_PI, HALF_PI)
    warp: int = OCTAVES
    warp_e: float = 2.0**-18
    cell_limit: float = 0.9
    size: tuple[int, int] | None = None  # width, height, where the texels' shape is not to be told

    def c(self) -> CTable:
        """The structure; it borrows the texels."""
        if self.texels is None:
            pointer, (width, height) = None, self.size
        else:
            self.texels = np.ascontiguousarray(self.texels, np.float32)
            pointer = self.texels.ctypes.data_as(ctypes.POINTER(ctypes.c_float))
            width, height = self.size or self.texels.shape[::-1]
        return CTable(
            pointer, width, height, *self.theta_r_range, *self.domain, self.warp, self.warp_e, self.cell_limit
        )


def straight(domain=(-HALF_PI, HALF_PI), width=8, height=3, **options) -> MemoryTable:
    """A table whose texels are evenly spaced."""
    row = np.linspace(*domain, width, dtype=np.float32)
    row[[0, -1]] = domain
    return MemoryTable(np.tile(row, (height, 1)), domain, **options)


def validate(table: MemoryTable) -> tuple[int, str]:
    """(result, message) of hairlut_validate."""
    message = ctypes.create_string_buffer(MESSAGE_SIZE)
    c = table.c()
    result = core().hairlut_validate(ctypes.byref(c), message)
    return result, message.value.decode()


@dataclass
class Allocator:
    """Counts what is allocated and released, and fails at the call numbered `fail_at`."""

    fail_at: int | None = None
    calls: int = 0
    alive: dict[int, ctypes.Array] = field(default_factory=dict)

    def c(self) -> CAllocator:
        self.functions = Allocate(self._allocate), Release(self._release)
        return CAllocator(*self.functions, None)

    def _allocate(self, _user, size: int) -> int | None:
        self.calls += 1
        if self.calls - 1 == self.fail_at:
            return None
        block = ctypes.create_string_buffer(size + 64)
        address = -(-ctypes.addressof(block) // 64) * 64
        self.alive[address] = block
        return address

    def _release(self, _user, address: int) -> None:
        del self.alive[address]


def create(
    direct_theta: MemoryTable | None = None,
    direct_phi: MemoryTable | None = None,
    multiple_theta: MemoryTable | None = None,
    azimuth: int = DIFFERENCE,
    allocator: Allocator | None = None,
) -> Model:
    """hairlut_model_create; LoadError if it refuses. Tables left out are straight ones."""
    parts = direct_theta or straight(), direct_phi or straight((0.0, TWO_PI)), multiple_theta or straight()
    description = CDescription(*(part.c() for part in parts), azimuth)
    hooks = ctypes.byref(allocator.c()) if allocator else None
    out, message = ctypes.c_void_p(1), ctypes.create_string_buffer(MESSAGE_SIZE)
    result = core().hairlut_model_create(ctypes.byref(description), hooks, ctypes.byref(out), message)
    if result != OK:
        assert out.value is None
        raise LoadError(result, message.value.decode())
    return Model(out.value, "memory", owned=True)


def copy_model(folder: Path, model: str = "fitted") -> Path:
    """A model's files, to be spoilt."""
    target = folder / model
    shutil.copytree(ROOT / "luts" / model, target)
    return target


def rewrite(path: Path, change=None, texels=None, channels=None, drop=()) -> None:
    """Writes a file again through OpenEXR's Python binding: attributes changed or dropped, texels or channels
    mapped."""
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        header, pixels = dict(file.header()), np.array(file.channels()["Y"].pixels)
    header = {name: value for name, value in header.items() if name not in (*drop, "channels")}
    header |= change(header) if callable(change) else change or {}
    pixels = np.ascontiguousarray(texels(pixels) if texels else pixels)
    with OpenEXR.File(header, channels(pixels) if channels else {"Y": pixels}) as file:
        file.write(str(path))
