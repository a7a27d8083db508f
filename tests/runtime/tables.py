# SPDX-License-Identifier: BSD-3-Clause
"""Tables for the tests of models from memory, and OpenEXR files made from good ones with one thing wrong."""

import ctypes
import shutil
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from runtime.c_library import MESSAGE_SIZE, OK, ROOT, LoadError, Model, core

from hairlut.warp import Warp

HALF_PI = np.float32(np.pi / 2)
TWO_PI = np.float32(2 * np.pi)
UNIFORM, OCTAVES = 0, 1
DIFFERENCE, SUM = 0, 1


class CParameter(ctypes.Structure):
    _fields_ = [
        ("size", ctypes.c_size_t),
        ("name", ctypes.c_char_p),
        *((name, ctypes.c_float) for name in ("least", "most", "standard")),
    ]


class CNodes(ctypes.Structure):
    _fields_ = [
        ("size", ctypes.c_size_t),
        *((name, ctypes.c_int) for name in ("parameter", "count")),
        ("values", ctypes.POINTER(ctypes.c_float)),
    ]


class CTable(ctypes.Structure):
    _fields_ = [
        ("size", ctypes.c_size_t),
        ("texels", ctypes.POINTER(ctypes.c_float)),
        *((name, ctypes.c_int) for name in ("width", "height")),
        *((name, ctypes.c_float) for name in ("theta_r_min", "theta_r_max", "domain_min", "domain_max")),
        ("warp", ctypes.c_int),
        ("warp_e", ctypes.c_float),
        ("axis_count", ctypes.c_int),
        ("axes", ctypes.POINTER(CNodes)),
    ]


class CLobe(ctypes.Structure):
    _fields_ = [
        ("size", ctypes.c_size_t),
        ("name", ctypes.c_char_p),
        ("theta", ctypes.POINTER(CTable)),
        ("phi", ctypes.POINTER(CTable)),
        ("azimuth", ctypes.c_int),
    ]


class CMixture(ctypes.Structure):
    _fields_ = [
        ("size", ctypes.c_size_t),
        *((name, ctypes.c_int) for name in ("theta_r_count", "offset_count")),
        *((name, ctypes.POINTER(ctypes.c_float)) for name in ("theta_r", "offset", "share", "turn")),
        ("mirrored", ctypes.c_int),
        ("axis_count", ctypes.c_int),
        ("axes", ctypes.POINTER(CNodes)),
    ]


class CDescription(ctypes.Structure):
    _fields_ = [
        ("size", ctypes.c_size_t),
        ("lobe_count", ctypes.c_int),
        ("lobes", ctypes.POINTER(CLobe)),
        ("mixture", ctypes.POINTER(CMixture)),
        ("parameter_count", ctypes.c_int),
        ("parameters", ctypes.POINTER(CParameter)),
    ]


Allocate = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)
Release = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)


class CAllocator(ctypes.Structure):
    _fields_ = [("allocate", Allocate), ("release", Release), ("user", ctypes.c_void_p)]


def _floats(array: np.ndarray | None):
    return None if array is None else array.ctypes.data_as(ctypes.POINTER(ctypes.c_float))


@dataclass
class Parameter:
    """hairlut_parameter, in Python."""

    name: str | None
    least: float
    most: float
    standard: float

    def c(self) -> CParameter:
        name = None if self.name is None else self.name.encode()
        return CParameter(ctypes.sizeof(CParameter), name, self.least, self.most, self.standard)


@dataclass
class Nodes:
    """hairlut_parameter_nodes, in Python."""

    parameter: int
    values: np.ndarray | None
    count: int | None = None  # other than that of the values

    def c(self) -> CNodes:
        """The structure; it borrows the values."""
        if self.values is not None:
            self.values = np.ascontiguousarray(self.values, np.float32)
        count = len(self.values) if self.count is None else self.count
        return CNodes(ctypes.sizeof(CNodes), self.parameter, count, _floats(self.values))


def _array(kind: type[ctypes.Structure], values: Sequence) -> ctypes.Array:
    return (kind * max(len(values), 1))(*(value.c() for value in values))


@dataclass
class MemoryTable:
    """hairlut_table, in Python. texels: (height, width, 2), angles and dx/du; with axes, (nodes, height,
    width, 2)."""

    texels: np.ndarray | None
    domain: tuple[float, float] = (-HALF_PI, HALF_PI)
    theta_r_range: tuple[float, float] = (-HALF_PI, HALF_PI)
    warp: int = OCTAVES
    warp_e: float = 2.0**-18
    size: tuple[int, int] | None = None  # width, height, other than the shape of the texels
    axes: Sequence[Nodes] = ()

    def c(self) -> CTable:
        """The structure; it borrows the texels."""
        if self.texels is None:
            width, height = self.size
        else:
            self.texels = np.ascontiguousarray(self.texels, np.float32)
            width, height = self.size or self.texels.shape[-2:-4:-1]
        size = ctypes.sizeof(CTable)
        numbers = *self.theta_r_range, *self.domain, self.warp, self.warp_e
        self.kept = _array(CNodes, self.axes)
        return CTable(size, _floats(self.texels), width, height, *numbers, len(self.axes), self.kept)


def knots(width: int, warp: int = OCTAVES, warp_e: float = 2.0**-18) -> np.ndarray:
    """u of the columns."""
    chosen = Warp("octaves", max(float(np.float32(warp_e)), 1e-12)) if warp == OCTAVES else Warp("uniform")
    return chosen.u(width)


def with_slopes(x: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Rows of angles at the knots u, with the slopes of format 1 (luts/FORMAT.md): at an inner knot the
    density is that of both cells beside it, blended linearly in x; at an end it is a parabola's, bounded."""
    x = np.asarray(x, np.float32).astype(float)
    widths, h = np.diff(x, axis=-1), np.diff(u)
    before, after, h0, h1 = widths[..., :-1], widths[..., 1:], h[:-1], h[1:]
    slopes = np.empty_like(x)
    slopes[..., 1:-1] = (before + after) / (after * h0 / before + before * h1 / after)
    for end, inner, cell in ((0, 1, 0), (-1, -2, -1)):
        mean = widths[..., cell] / h[cell]
        slopes[..., end] = np.clip(2 * mean - slopes[..., inner], mean / 8, 8 * mean)
    return np.stack([x, slopes], axis=-1).astype(np.float32)


def straight(domain=(-HALF_PI, HALF_PI), width=8, height=3, **options) -> MemoryTable:
    """A table whose angles are evenly spaced."""
    row = np.linspace(*domain, width, dtype=np.float32)
    row[[0, -1]] = domain
    table = MemoryTable(None, domain, **options)
    possible = table.warp == UNIFORM or (table.warp == OCTAVES and 1e-12 <= table.warp_e <= 1)
    u = knots(width, table.warp, table.warp_e) if possible else np.linspace(0, 1, width)
    table.texels = np.tile(with_slopes(row, u), (height, 1, 1))
    return table


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


@dataclass
class Lobe:
    """hairlut_lobe_desc, in Python."""

    name: str | None
    theta: MemoryTable | None
    phi: MemoryTable | None = None
    azimuth: int = DIFFERENCE


@dataclass
class Mixture:
    """hairlut_mixture_desc, in Python. share, turn: (lobes, theta_r, offset); with axes, (lobes, nodes,
    theta_r, offset)."""

    theta_r: np.ndarray | None = None
    offset: np.ndarray | None = None
    share: np.ndarray | None = None
    turn: np.ndarray | None = None
    mirrored: int = 0
    counts: tuple[int, int] | None = None  # other than the lengths of the nodes
    axes: Sequence[Nodes] = ()

    def c(self) -> CMixture:
        """The structure; it borrows the arrays."""
        names = ("theta_r", "offset", "share", "turn")
        for name in names:
            if getattr(self, name) is not None:
                setattr(self, name, np.ascontiguousarray(getattr(self, name), np.float32))
        lengths = [1 if nodes is None else len(nodes) for nodes in (self.theta_r, self.offset)]
        arrays = [_floats(getattr(self, name)) for name in names]
        self.kept = _array(CNodes, self.axes)
        counts = self.counts or lengths
        return CMixture(ctypes.sizeof(CMixture), *counts, *arrays, self.mirrored, len(self.axes), self.kept)


class Description:
    """A hairlut_model_desc and what it points to. Lobes that name one table share its descriptor."""

    def __init__(
        self, lobes: list[Lobe], mixture: Mixture | None = None, parameters: Sequence[Parameter] = ()
    ) -> None:
        tables = {id(t): t for lobe in lobes for t in (lobe.theta, lobe.phi) if t is not None}
        self.tables = {key: t.c() for key, t in tables.items()}
        self.lobes = (CLobe * max(len(lobes), 1))(*(self._lobe(lobe) for lobe in lobes))
        self.mixture = mixture and mixture.c()
        points = ctypes.pointer(self.mixture) if mixture else None
        self.parameters = _array(CParameter, parameters)
        self.c = CDescription(
            ctypes.sizeof(CDescription), len(lobes), self.lobes, points, len(parameters), self.parameters
        )
        self.borrowed = lobes, mixture

    def _lobe(self, lobe: Lobe) -> CLobe:
        theta, phi = (t and ctypes.pointer(self.tables[id(t)]) for t in (lobe.theta, lobe.phi))
        name = None if lobe.name is None else lobe.name.encode()
        return CLobe(ctypes.sizeof(CLobe), name, theta, phi, lobe.azimuth)

    def create(self, allocator: "Allocator | None" = None) -> Model:
        """hairlut_model_create; LoadError if it refuses."""
        hooks = ctypes.byref(allocator.c()) if allocator else None
        out, message = ctypes.c_void_p(1), ctypes.create_string_buffer(MESSAGE_SIZE)
        result = core().hairlut_model_create(ctypes.byref(self.c), hooks, ctypes.byref(out), message)
        if result != OK:
            assert out.value is None
            raise LoadError(result, message.value.decode())
        return Model(out.value, "memory", owned=True)


def two_lobes(
    direct_theta: MemoryTable | None = None,
    direct_phi: MemoryTable | None = None,
    multiple_theta: MemoryTable | None = None,
    azimuth: int = DIFFERENCE,
) -> list[Lobe]:
    """Lobes "direct" and "multiple". Tables left out are straight ones."""
    return [
        Lobe("direct", direct_theta or straight(), direct_phi or straight((0.0, TWO_PI)), azimuth),
        Lobe("multiple", multiple_theta or straight()),
    ]


def create(
    *parts: MemoryTable, allocator: Allocator | None = None, mixture: Mixture | None = None, **named
) -> Model:
    """The model of two_lobes."""
    return Description(two_lobes(*parts, **named), mixture).create(allocator)


def copy_model(folder: Path, model: str = "fitted") -> Path:
    """Copies of a model's files, for tests that change them."""
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
