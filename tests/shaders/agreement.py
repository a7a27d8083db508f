# SPDX-License-Identifier: BSD-3-Clause
"""What the shaders are compared with: the C library on the same model and records, and the tolerances."""

import ctypes
import functools
import itertools
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from shaders.backends import INPUTS, OUTPUTS, WIDTH, Scene

from hairlut.stream import stream
from hairlut.warp import Warp

ROOT = Path(__file__).parents[2]
LIBRARY = Path(os.environ.get("HAIRLUT_BUILD", ROOT / "build" / "runtime"))
ANGLE_TOLERANCE = 6e-6  # rad
DENSITY_TOLERANCE = 1e-4  # relative
NUMBER_TOLERANCE = 1e-5  # of an inverted u
BORDERING_TOLERANCE = 1e-3  # share of the records
THETA_R, PHI_R, OFFSET, LOBE, SHARE, U_LOBE, U_THETA, U_PHI, THETA_I, PHI_I, FIRST_PARAMETER = range(11)
SAMPLES = {"lobe": 0, "hair": 4, "given": 8}
DENSITIES = {"lobe": 12, "hair": 13, "given": 14}
COSINE = 15
NUMBERS = [16, 17]
END = {THETA_I: np.float32(np.pi / 2), PHI_I: np.float32(2 * np.pi)}  # of the directions' domains


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
    """The C library on a model (hairlut.model.BakedModel, or one of shaders.models)."""

    def __init__(self, model) -> None:
        tables = list({id(t): t for lobe in model.lobes for t in (lobe.theta, lobe.phi) if t}.values())
        place = {id(table): k for k, table in enumerate(tables)}
        texels = [np.float32(np.stack([t.texels, t.slopes], axis=-1)) for t in tables]
        sizes = np.int32([[t.width, t.height, t.warp.name == "octaves"] for t in tables])
        numbers = np.float32([[*t.theta_r_range, *t.domain, t.warp.e] for t in tables])
        lobes = np.int32(
            [
                (
                    place[id(a.theta)],
                    place[id(a.phi)] if a.phi else -1,
                    bool(a.phi) and a.phi.azimuth == "sum",
                )
                for a in model.lobes
            ]
        )
        mixture = model.mixture
        grid = np.int32([len(mixture.theta_r), len(mixture.offset), mixture.mirrored])
        nodes = [
            np.ascontiguousarray(part, np.float32)
            for part in (mixture.theta_r, mixture.offset, mixture.share, mixture.turn)
        ]
        parameters = _parameters(model, tables)
        message = ctypes.create_string_buffer(512)
        pointers = (ctypes.c_void_p * len(tables))(*(t.ctypes.data for t in texels))
        created = harness().create(
            len(tables), pointers, _address(sizes), _address(numbers), len(lobes), _address(lobes),
            _address(grid), *map(_address, nodes), len(model.parameters), *map(_address, parameters), message,
        )  # fmt: skip
        assert created, message.value.decode()
        self.model, self._created = model, ctypes.c_void_p(created)

    def __call__(self, records: np.ndarray) -> np.ndarray:
        """(n, OUTPUTS) results of the (n, INPUTS) records."""
        records = np.ascontiguousarray(records, np.float32)
        out = np.empty((len(records), OUTPUTS), np.float32)
        harness().evaluate(self._created, ctypes.c_size_t(len(records)), _address(records), _address(out))
        return out


def _parameters(model, tables) -> list[np.ndarray]:
    """ranges, axes and nodes of `create` in harness.c."""
    names = [each.name for each in model.parameters]
    axes, nodes = [], []
    for owner in (*tables, model.mixture):
        axes += [len(owner.axes)]
        for axis in owner.axes:
            axes += [names.index(axis.name), len(axis.nodes)]
            nodes += list(axis.nodes)
    ranges = [number for each in model.parameters for number in (each.least, each.most, each.standard)]
    return [np.float32(ranges), np.int32(axes), np.float32(nodes)]


def _address(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def scene(model) -> Scene:
    """The model as second in a stream: a position that is not relative to its first texel reads the other
    one."""
    other = np.full((WIDTH, 4), 7, np.float32)
    return Scene(np.concatenate([other, stream(model)]), WIDTH)


# ---- records


def random_records(n: int, model, seed: int = 1) -> np.ndarray:
    """Viewer inclinations, offsets, numbers, directions and parameters uniform over their ranges."""
    random = np.random.default_rng(seed)
    records = random.random((n, INPUTS), np.float32)
    records[:, [THETA_R, THETA_I]] = (records[:, [THETA_R, THETA_I]] - 0.5) * np.float32(np.pi)
    records[:, [PHI_R, PHI_I]] = (records[:, [PHI_R, PHI_I]] - 0.5) * np.float32(2 * np.pi)
    records[:, OFFSET] = 2 * records[:, OFFSET] - 1
    records[:, LOBE] = np.floor(records[:, LOBE] * len(model.lobes))
    for k, each in enumerate(model.parameters, FIRST_PARAMETER):
        records[:, k] = each.least + records[:, k] * (each.most - each.least)
    return records


def nodes_of(model, name: str) -> np.ndarray:
    """Every node that the model has along a parameter."""
    owners = [model.mixture, *(t for lobe in model.lobes for t in (lobe.theta, lobe.phi) if t)]
    axes = [axis.nodes for owner in owners for axis in owner.axes if axis.name == name]
    return np.unique(np.concatenate([np.zeros(1), *axes]))


def around(values) -> np.ndarray:
    """Each value with the floats next to it."""
    x = np.float32(values)
    return np.unique(
        np.concatenate([np.nextafter(x, np.float32(-np.inf)), x, np.nextafter(x, np.float32(np.inf))])
    )


TINY, HUGE, NAN, INF = np.float32(1e-45), np.float32(3.4e38), np.float32(np.nan), np.float32(np.inf)
BEYOND = [-HUGE, HUGE, -INF, INF, NAN]


def _hard(near: list, more: list) -> np.ndarray:
    return np.concatenate([around(near), more, BEYOND]).astype(np.float32)


HARD_THETA_R = _hard([-np.pi / 2, 0, np.pi / 2, 0.7853982], [-0.0, TINY, -1.57, 1.56, -1.2, 1.3, 0.3, -2, 2])
HARD_PHI = _hard([-np.pi, np.pi, 2 * np.pi, -2 * np.pi], [0.0, -0.0, TINY, 1, -3, 7, 1e3, -1e8])
HARD_OFFSET = _hard([-1, -0.5, 0, 0.5, 1], [-0.0, TINY, -TINY, -0.3, 0.3, 0.9, 2, -2])
HARD_SHARE = _hard([1], [0, -0.0, 0.5, -1, 2, 1e9, 1e-30])
HARD_U = _hard(
    [0.5, 1, 2.0**-24, 0.25],
    [0, -0.0, TINY, *(2.0**-k for k in (126, 64, 32, 25, 12)), 1 - 2.0**-23, 1 - 2.0**-12, 0.1, 0.9, -1, 2],
)


def hard_records(model, seed: int = 2) -> np.ndarray:
    """Every pair of hard values of two inputs; directions on texels and beside them; numbers on knots;
    theta_r, offsets and parameters on nodes; lobes that there are not."""
    random = np.random.default_rng(seed)
    lobes = len(model.lobes)
    hard = {
        THETA_R: HARD_THETA_R,
        PHI_R: HARD_PHI,
        OFFSET: HARD_OFFSET,
        LOBE: np.float32([-1, 0, lobes - 1, lobes, 99]),
        SHARE: HARD_SHARE,
        **dict.fromkeys((U_LOBE, U_THETA, U_PHI), HARD_U),
        THETA_I: HARD_THETA_R,
        PHI_I: HARD_PHI,
    }
    blocks = []

    def add(columns: list[int], values: np.ndarray) -> None:
        block = random_records(len(values), model, int(random.integers(1 << 30)))
        block[:, columns] = values
        blocks.append(block)

    for a, b in itertools.combinations(hard, 2):
        add([a, b], np.stack(np.meshgrid(hard[a], hard[b]), -1).reshape(-1, 2))
    for k, lobe in enumerate(model.lobes):
        for table, number, angle in ((lobe.theta, U_THETA, THETA_I), (lobe.phi, U_PHI, PHI_I)):
            if table:
                add([LOBE, PHI_R, THETA_R, angle], np.column_stack(_on_texels(k, table)))
                add([LOBE, number], np.column_stack(_on_knots(k, table)))
    nodes = (
        around(model.mixture.theta_r),
        around(np.concatenate([model.mixture.offset, -model.mixture.offset])),
    )
    add([THETA_R, OFFSET], np.stack(np.meshgrid(*nodes), -1).reshape(-1, 2))
    parameters = {
        k: _hard(nodes_of(model, each.name), [each.least - 1, each.most + 1])
        for k, each in enumerate(model.parameters, FIRST_PARAMETER)
    }
    for a, b in itertools.combinations([*parameters, THETA_R, OFFSET, U_THETA], 2):
        if a in parameters:
            pairs = np.meshgrid(parameters[a], parameters[b] if b in parameters else hard[b])
            add([a, b], np.stack(pairs, -1).reshape(-1, 2))
    return np.concatenate(blocks).astype(np.float32)


def _on_texels(lobe: int, table) -> list[np.ndarray]:
    """Directions at the texels of every eighth row of a table, seen from that row and from above it."""
    low, high = table.theta_r_range
    j = np.arange(0, table.height, 8)
    at = np.concatenate([j, j + 0.37]) * (high - low) / (table.height - 1) + low
    x = [around(table.texels[row]) for row in np.tile(j, 2)]
    theta_r = np.repeat(at, [len(row) for row in x])
    return [np.full(len(theta_r), lobe), np.zeros(len(theta_r)), theta_r, np.concatenate(x)]


def _on_knots(lobe: int, table) -> list[np.ndarray]:
    """Numbers at the knots of a table and the floats beside them."""
    m = Warp(table.warp.name, table.warp.e).unfold(np.arange(table.width // 2), table.width)
    u = around(np.clip(np.concatenate([m, 1 - m]), 0, 1))
    return [np.full(len(u), lobe), u]


# ---- comparison


@dataclass(frozen=True)
class Agreement:
    """Largest differences from C over a set of records.

    bordering: records where single precision can fall on either side of the end of a domain, or of a border
    between two lobes, so that their densities were compared over the box of inputs around the record.
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
    assert_rules(want_of.model, records, got)
    want = closest(want_of, records, got)
    angles = [at + k for at in SAMPLES.values() for k in (0, 1)]
    densities = [at + k for at in SAMPLES.values() for k in (2, 3)] + list(DENSITIES.values())
    off = relative(got, want)
    border = (off[:, densities] > DENSITY_TOLERANCE).any(axis=1)
    if 0 < border.sum() <= BORDERING_TOLERANCE * len(records):  # else it fails anyway
        off[border] = np.minimum(off[border], beyond_box(want_of, records[border], got[border]))
    cosine = np.abs(records[:, THETA_I]) <= np.float32(np.pi / 2)
    return Agreement(
        records=len(records),
        angle=float(np.max([circular(got[:, k], want[:, k]).max() for k in angles])),
        density=float(max(off[:, densities].max(), off[cosine, COSINE].max())),
        number=float(np.abs(got[:, NUMBERS] - want[:, NUMBERS]).max()),
        bordering=int(border.sum()),
    )


def closest(want_of: Reference, records: np.ndarray, got: np.ndarray) -> np.ndarray:
    """C's results, or the nearer ones of what a shader may take the record for: denormal numbers may be 0,
    and u_lobe may choose the lobe beside where it lies within rounding of a border. Densities per steradian
    are at the angle that the shader drew: beside the pole a float's step is a large part of the cosine."""
    want = want_of(records)
    tiny = np.abs(records) < np.finfo(np.float32).tiny
    flushed = want_of(np.where(tiny, np.float32(0), records))
    for columns in [[at, at + 1, at + 2] for at in SAMPLES.values()] + [[at] for at in DENSITIES.values()]:
        take_nearer(got, want, flushed, columns, tiny.any(axis=1))
    for step in (-3e-7, 3e-7):
        beside = records.copy()
        beside[:, U_LOBE] = np.clip(records[:, U_LOBE] + np.float32(step), 0, 1)
        beside = want_of(beside)
        for at in (SAMPLES["hair"], SAMPLES["given"]):
            take_nearer(got, want, beside, [at, at + 1, at + 2], ~np.isnan(records[:, U_LOBE]))
    drawn = records.copy()
    for at in SAMPLES.values():
        drawn[:, THETA_I] = got[:, at]
        want[:, at + 3] = got[:, at + 2] * want_of(drawn)[:, COSINE]
    return want


def take_nearer(
    got: np.ndarray, want: np.ndarray, other: np.ndarray, columns: list[int], where: np.ndarray
) -> None:
    """Puts the other result in place of the wanted one where it is nearer: angles (all columns but the last)
    and a density."""

    def distance(x: np.ndarray) -> np.ndarray:
        angles = circular(got[:, columns[:-1]], x[:, columns[:-1]])
        return np.column_stack([angles, relative(got[:, columns[-1]], x[:, columns[-1]])]).max(axis=1)

    rows = np.flatnonzero(where & (distance(other) < distance(want)))
    want[np.ix_(rows, columns)] = other[np.ix_(rows, columns)]


def assert_rules(model, records: np.ndarray, got: np.ndarray) -> None:
    """The rules of hairlut.h that need no reference."""
    finite = np.isfinite(got[:, [k for k in range(OUTPUTS) if k != COSINE]]).all(axis=1)
    assert finite.all(), records[~finite][:3]
    for kind, at in SAMPLES.items():
        angle, phi, pdf, solid = got[:, at : at + 4].T
        unknown = is_unknown(model, records, kind, SAMPLES)
        assert (np.abs(angle) <= np.float32(np.pi / 2)).all()
        assert ((phi >= -np.float32(np.pi)) & (phi < np.float32(np.pi))).all()
        assert (pdf[unknown] == 0).all()
        assert (solid[unknown] == 0).all()
        assert (pdf[~unknown] > 0).all(), records[~unknown][pdf[~unknown] <= 0][:3]
    for kind, at in DENSITIES.items():
        assert (got[is_unknown(model, records, kind, DENSITIES), at] == 0).all()
    assert ((got[:, NUMBERS] >= 0) & (got[:, NUMBERS] <= 1)).all()


def is_unknown(model, records: np.ndarray, kind: str, what: dict[str, int]) -> np.ndarray:
    """Records whose density must be 0: NaN among the function's inputs, an infinite azimuth or share, no
    lobe."""
    lobes = len(model.lobes)
    used = [THETA_R, PHI_R, U_THETA, U_PHI] if what is SAMPLES else [THETA_R, PHI_R, THETA_I, PHI_I]
    if kind != "lobe":
        used += [OFFSET, U_LOBE] if what is SAMPLES else [OFFSET]
        used += range(FIRST_PARAMETER, FIRST_PARAMETER + len(model.parameters))
    azimuths = [PHI_R] if what is SAMPLES else [PHI_R, PHI_I]
    unknown = np.isnan(records[:, used]).any(axis=1) | ~np.isfinite(records[:, azimuths]).all(axis=1)
    if kind == "lobe":
        unknown |= (records[:, LOBE] < 0) | (records[:, LOBE] >= lobes)
    if kind == "given":
        share = records[:, SHARE]
        unknown |= ~np.isfinite(share) | ((lobes == 1) & (share <= 0))
    return unknown


def beyond_box(want_of: Reference, records: np.ndarray, got: np.ndarray) -> np.ndarray:
    """(n, OUTPUTS) how far, relatively, a result lies outside what C gives within rounding of its record, and
    the density of a sample of the hair outside what C gives within rounding of the direction that was
    drawn."""
    low, high = want_of(records), want_of(records)
    for moved in box(records):
        want = want_of(moved)
        low, high = np.minimum(low, want), np.maximum(high, want)
    for kind in ("hair", "given"):
        at, drawn = SAMPLES[kind], records.copy()
        drawn[:, [THETA_I, PHI_I]] = got[:, [at, at + 1]]
        for moved in box(drawn):
            want = want_of(moved)[:, DENSITIES[kind]]
            low[:, at + 2] = np.minimum(low[:, at + 2], want)
            high[:, at + 2] = np.maximum(high[:, at + 2], want)
    solid = [at + 3 for at in SAMPLES.values()]
    off = relative(got, np.clip(got, low, high))
    off[:, solid] = np.inf  # these were compared at the angles drawn
    return off


def box(records: np.ndarray) -> Iterator[np.ndarray]:
    """Records with directions moved by three floats at their domain's end, which is what an angle's
    arithmetic rounds by, numbers by what the rounding of a column amounts to, and theta_r and the offset by
    what that of a place between two nodes does: a share that is 0 at a node has no relative precision beside
    it."""
    for *signs, row, column in itertools.product(*[(-1, 0, 1)] * 3, (-4, -1, 0, 1, 4)):
        moved = records.copy()
        moved[:, THETA_R] += np.float32(row * 2.0**-21)
        moved[:, OFFSET] += column * np.spacing(np.abs(moved[:, OFFSET]))
        for sign, direction, number in zip(signs, (THETA_I, PHI_I), (U_THETA, U_PHI), strict=True):
            if sign:
                moved[:, direction] += np.float32(sign * 3 * np.spacing(END[direction]))
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
