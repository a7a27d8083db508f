"""What the shaders are held against: the C library on the same tables and records, and the tolerances."""

import ctypes
import functools
import itertools
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from shaders.backends import INPUTS, OUTPUTS, Scene

from hairlut.axis import axis_numbers
from hairlut.exr import read_model
from hairlut.table import Table
from hairlut.warp import Warp

ROOT = Path(__file__).parents[2]
LIBRARY = Path(os.environ.get("HAIRLUT_BUILD", ROOT / "build" / "runtime"))
MODELS = ("printed", "fitted")
ANGLE_TOLERANCE = 2e-6  # rad
DENSITY_TOLERANCE = 1e-4  # relative
NUMBER_TOLERANCE = 1e-5  # of an inverted u
BORDERING_TOLERANCE = 1e-3  # share of the records
THETA_R, PHI_R, U_THETA, U_PHI, U_LOBE, WEIGHT, THETA_I, PHI_I = range(INPUTS)
SAMPLES = {"direct": 0, "multiple": 4, "mixture": 8}
PER_AREA = [at + 2 for at in SAMPLES.values()]  # the samples' densities, per rad^2 and per steradian
SOLID = [at + 3 for at in SAMPLES.values()]
DENSITIES = {"direct": 12, "multiple": 13, "mixture": 14}
COSINE = 15
END = {THETA_I: np.float32(np.pi / 2), PHI_I: np.float32(2 * np.pi)}  # of the directions' domains
NUMBERS = {"direct": 16, "multiple": 18}


@functools.cache
def harness() -> ctypes.CDLL:
    """The C library and the loop over records, compiled with the C compiler that built the library."""
    if not (LIBRARY / "libhairlut.so").exists():
        pytest.skip(f"{LIBRARY}/libhairlut.so is missing: make build")
    compiler = shutil.which(os.environ.get("CC", "cc"))
    if compiler is None:
        pytest.skip("no C compiler: apt-get install gcc")
    out = Path(tempfile.mkdtemp(prefix="hairlut"), "harness.so")
    flags = ["-O2", "-shared", "-fPIC", f"-I{ROOT}/runtime/include", f"-L{LIBRARY}", f"-Wl,-rpath,{LIBRARY}"]
    source = Path(__file__).with_name("harness.c")
    subprocess.run([compiler, *flags, source, "-o", out, "-lhairlut"], check=True)
    library = ctypes.CDLL(str(out))
    library.create.restype = ctypes.c_void_p
    return library


class Reference:
    """The C library on three tables."""

    def __init__(self, tables: Sequence[Table]) -> None:
        self.texels = [np.ascontiguousarray(t.texels, np.float32) for t in tables]
        pointers = (ctypes.c_void_p * 3)(*(t.ctypes.data for t in self.texels))
        sizes = np.int32([[t.width, t.height, t.warp.name == "octaves"] for t in tables])
        numbers = np.float32([[*t.theta_r_range, *t.domain, t.warp.e, t.cell.limit] for t in tables])
        azimuth = int(tables[1].azimuth == "sum")
        self.model = ctypes.c_void_p(harness().create(pointers, _address(sizes), _address(numbers), azimuth))
        assert self.model, "the library refuses the tables"

    def __call__(self, records: np.ndarray) -> np.ndarray:
        """(n, 20) results of the (n, 8) records."""
        records = np.ascontiguousarray(records, np.float32)
        out = np.empty((len(records), OUTPUTS), np.float32)
        harness().evaluate(self.model, ctypes.c_size_t(len(records)), _address(records), _address(out))
        return out


def _address(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


@functools.cache
def model_tables(model: str) -> list[Table]:
    return read_model(ROOT / "luts" / model).tables


@functools.cache
def reference(model: str) -> Reference:
    return Reference(model_tables(model))


def scene(tables: Sequence[Table]) -> Scene:
    """Three tables, one below another, for a shader."""
    stacked = np.zeros((sum(t.height for t in tables), max(t.width for t in tables)), np.float32)
    axes, row = [], 0
    for table in tables:
        stacked[row : row + table.height, : table.width] = table.texels
        axes.append([row, *axis_numbers(table)])
        row += table.height
    return Scene(stacked, np.float32(axes).reshape(9, 4), int(tables[1].azimuth == "sum"))


# ---- records


def random_records(n: int, seed: int = 1) -> np.ndarray:
    """Viewer inclinations, numbers and directions uniform over their ranges."""
    random = np.random.default_rng(seed)
    records = random.random((n, INPUTS), np.float32)
    records[:, [THETA_R, THETA_I]] = (records[:, [THETA_R, THETA_I]] - 0.5) * np.float32(np.pi)
    records[:, [PHI_R, PHI_I]] = (records[:, [PHI_R, PHI_I]] - 0.5) * np.float32(2 * np.pi)
    return records


def around(values) -> np.ndarray:
    """Each value with the floats next to it."""
    x = np.float32(values)
    return np.unique(
        np.concatenate([np.nextafter(x, np.float32(-np.inf)), x, np.nextafter(x, np.float32(np.inf))])
    )


TINY, HUGE, NAN, INF = np.float32(1e-45), np.float32(3.4e38), np.float32(np.nan), np.float32(np.inf)
BEYOND = [-HUGE, HUGE, -INF, INF, NAN]
HARD_THETA_R = np.concatenate(
    [around([-np.pi / 2, 0, np.pi / 2, 0.7853982]), [-0.0, TINY, -1.57, 1.56, -1.2, 1.3, 0.3, -2, 2], BEYOND]
).astype(np.float32)
HARD_PHI = np.concatenate(
    [around([-np.pi, np.pi, 2 * np.pi, -2 * np.pi]), [0.0, -0.0, TINY, 1, -3, 7, 1e3, -1e8], BEYOND]
).astype(np.float32)
HARD_U = np.concatenate(
    [
        around([0.5, 1, 2.0**-24, 0.25]),
        [
            0,
            -0.0,
            TINY,
            2.0**-126,
            2.0**-64,
            2.0**-32,
            2.0**-25,
            1 - 2.0**-23,
            1 - 2.0**-12,
            2.0**-12,
            0.1,
            0.9,
            -1,
            2,
        ],
        BEYOND,
    ]
).astype(np.float32)


def hard_records(tables: Scene, seed: int = 2) -> np.ndarray:
    """Every pair of hard values of two inputs; directions on texels and beside them; numbers on knots."""
    random = np.random.default_rng(seed)
    hard = [HARD_THETA_R, HARD_PHI, HARD_U, HARD_U, HARD_U, HARD_U, HARD_THETA_R, HARD_PHI]
    blocks = []
    for a, b in itertools.combinations(range(INPUTS), 2):
        pairs = np.stack(np.meshgrid(hard[a], hard[b]), -1).reshape(-1, 2)
        block = random_records(len(pairs), int(random.integers(1 << 30)))
        block[:, [a, b]] = pairs
        blocks.append(block)
    for axis, column in ((0, THETA_I), (1, PHI_I)):
        blocks.append(_on_texels(tables, axis, column, random))
    blocks.append(_on_knots(tables, random))
    return np.concatenate(blocks).astype(np.float32)


def _on_texels(tables: Scene, axis: int, column: int, random: np.random.Generator) -> np.ndarray:
    """Directions at the texels of every fourth row of one table, seen from that row and from above it."""
    first, _, height = tables.axes[3 * axis, :3].astype(int)
    origin, scale = tables.axes[3 * axis + 1, :2]
    blocks = []
    for j in range(0, height, 4):
        x = around(tables.tables[first + j, : int(tables.axes[3 * axis, 1])])
        block = random_records(2 * len(x), int(random.integers(1 << 30)))
        block[:, THETA_R] = origin + np.repeat(np.float32([j, j + 0.37]), len(x)) / scale
        block[:, PHI_R] = 0
        block[:, column] = np.tile(x, 2)
        blocks.append(block)
    return np.concatenate(blocks)


def _on_knots(tables: Scene, random: np.random.Generator) -> np.ndarray:
    """Numbers at the knots of direct_theta and the floats beside them."""
    columns, octaves, e = int(tables.axes[0, 1]), bool(tables.axes[0, 3]), float(tables.axes[2, 0])
    m = (Warp("octaves", e) if octaves else Warp("uniform")).unfold(np.arange(columns // 2), columns)
    u = around(np.clip(np.concatenate([m, 1 - m]), 0, 1))
    block = random_records(4 * len(u), int(random.integers(1 << 30)))
    block[:, U_THETA] = np.tile(u, 4)
    block[:, U_PHI] = random.choice(u, len(block))
    return block


# ---- comparison


@dataclass(frozen=True)
class Agreement:
    """Largest differences from C over a set of records.

    bordering: records where single precision can fall on either side of a border between two cells, so that
    their densities were compared over the box of inputs around the record.
    """

    records: int
    angle: float  # rad
    density: float  # relative
    number: float  # of an inverted u
    bordering: int

    def holds(self) -> bool:
        return (
            self.angle <= ANGLE_TOLERANCE
            and self.density <= DENSITY_TOLERANCE
            and self.number <= NUMBER_TOLERANCE
            and self.bordering <= BORDERING_TOLERANCE * self.records
        )


def agreement(want_of: Reference, records: np.ndarray, got: np.ndarray) -> Agreement:
    """Compares a shader's results with C's; asserts what holds exactly: finite, in range, 0 where unknown."""
    assert_rules(records, got)
    want = closer(got, want_of(records), want_of(flushed(records)))
    want[:, SOLID] = got[:, PER_AREA] * per_steradian(want_of, records, got)
    angles = [at + k for at in SAMPLES.values() for k in (0, 1)]
    off = relative(got, want)
    off[is_unknown(records, "mixture", DENSITIES), DENSITIES["mixture"]] = 0.0
    columns = [at + k for at in SAMPLES.values() for k in (2, 3)] + list(DENSITIES.values())
    border = (off[:, columns] > DENSITY_TOLERANCE).any(axis=1)
    if border.any():
        off[border] = np.minimum(off[border], beyond_box(want_of, records[border], got[border]))
    cosine = np.abs(records[:, THETA_I]) <= np.float32(np.pi / 2)
    return Agreement(
        records=len(records),
        angle=float(np.max([circular(got[:, k], want[:, k]).max() for k in angles])),
        density=float(max(off[:, columns].max(), off[cosine, COSINE].max())),
        number=float(
            np.max([np.abs(got[:, at : at + 2] - want[:, at : at + 2]).max() for at in NUMBERS.values()])
        ),
        bordering=int(border.sum()),
    )


def per_steradian(want_of: Reference, records: np.ndarray, got: np.ndarray) -> np.ndarray:
    """(n, 3) C's 1/cos(theta_i) at the angles that the shader drew: beside the pole, the step of a float that
    these may be off is a large part of the cosine."""
    parts = []
    for at in SAMPLES.values():
        moved = records.copy()
        moved[:, THETA_I] = got[:, at]
        parts.append(want_of(moved)[:, COSINE])
    return np.stack(parts, axis=1)


def assert_rules(records: np.ndarray, got: np.ndarray) -> None:
    """The rules of hairlut.h that need no reference."""
    finite = np.isfinite(got[:, [k for k in range(OUTPUTS) if k != COSINE]]).all(axis=1)
    assert finite.all(), records[~finite][:3]
    for lobe, at in SAMPLES.items():
        theta, phi, pdf, solid = got[:, at : at + 4].T
        unknown = is_unknown(records, lobe, SAMPLES)
        assert (np.abs(theta) <= np.float32(np.pi / 2)).all()
        assert ((phi >= -np.float32(np.pi)) & (phi < np.float32(np.pi))).all()
        assert (pdf[unknown] == 0).all()
        assert (solid[unknown] == 0).all()
        assert (pdf[~unknown] > 0).all()
    for lobe, at in DENSITIES.items():
        assert (got[is_unknown(records, lobe, DENSITIES), at] == 0).all()
    for at in NUMBERS.values():
        assert ((got[:, at : at + 2] >= 0) & (got[:, at : at + 2] <= 1)).all()


def is_unknown(records: np.ndarray, lobe: str, kind: dict[str, int]) -> np.ndarray:
    """Records whose density must be 0: NaN among the function's inputs, or an infinite azimuth."""
    used = [THETA_R, PHI_R, U_THETA, U_PHI] if kind is SAMPLES else [THETA_R, PHI_R, THETA_I, PHI_I]
    if lobe == "mixture":
        used += [WEIGHT, U_LOBE] if kind is SAMPLES else [WEIGHT]
    azimuths = [PHI_R] if kind is SAMPLES else [PHI_R, PHI_I]
    return np.isnan(records[:, used]).any(axis=1) | ~np.isfinite(records[:, azimuths]).all(axis=1)


def flushed(records: np.ndarray) -> np.ndarray:
    """The records as a device sees them that has no denormal numbers, which shading languages allow."""
    return np.where(np.abs(records) < np.finfo(np.float32).tiny, np.float32(0), records)


def closer(got: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Row by row, the reference whose samples lie nearer."""
    angles = list(SAMPLES.values())
    off_a, off_b = (np.abs(got[:, angles] - x[:, angles]).max(axis=1, keepdims=True) for x in (a, b))
    return np.where(off_a <= off_b, a, b)


def beyond_box(want_of: Reference, records: np.ndarray, got: np.ndarray) -> np.ndarray:
    """(n, 20) how far, relatively, a result lies outside what C gives within rounding of its record, and the
    mixture's density outside what C gives within rounding of the direction that was drawn."""
    low, high = want_of(records), want_of(records)
    for moved in box(records):
        want = want_of(moved)
        low, high = np.minimum(low, want), np.maximum(high, want)
    drawn, mixture = records.copy(), SAMPLES["mixture"]
    drawn[:, [THETA_I, PHI_I]] = got[:, [mixture, mixture + 1]]
    for moved in box(drawn):
        want = want_of(moved)[:, DENSITIES["mixture"]]
        low[:, mixture + 2] = np.minimum(low[:, mixture + 2], want)
        high[:, mixture + 2] = np.maximum(high[:, mixture + 2], want)
    return relative(got, np.clip(got, low, high))


def box(records: np.ndarray) -> Iterator[np.ndarray]:
    """Records with directions moved by two floats at their domain's end, which is what an angle's arithmetic
    rounds by, and numbers by what the rounding of a column amounts to."""
    for signs in itertools.product((-1, 0, 1), repeat=2):
        moved = records.copy()
        for sign, direction, number in zip(signs, (THETA_I, PHI_I), (U_THETA, U_PHI), strict=True):
            if sign:
                moved[:, direction] += np.float32(sign * 2 * np.spacing(END[direction]))
                u = np.nan_to_num(records[:, number].astype(float), nan=-1, posinf=2, neginf=-1)
                step = sign * 2.0**-20 * (np.minimum(u, 1 - u) + 1e-6)
                inside = (u > 0) & (u < 1)
                moved[inside, number] = np.clip(u + step, 0, 1)[inside]
        yield moved


def relative(got: np.ndarray, want: np.ndarray) -> np.ndarray:
    return np.abs(got.astype(float) - want) / np.maximum(np.abs(want), np.finfo(np.float32).tiny)


def circular(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    d = np.abs(a.astype(float) - b)
    return np.minimum(d, np.abs(2 * np.pi - d))
