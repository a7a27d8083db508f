"""Writes the seeds of tests/fuzz/corpus: make_corpus.py. What fuzzing found later is kept beside them."""

import struct
from pathlib import Path

import numpy as np
import OpenEXR

from hairlut.digest import digest
from hairlut.warp import Warp

HERE = Path(__file__).resolve().parent
COMPRESSIONS = {
    "none": OpenEXR.NO_COMPRESSION,
    "rle": OpenEXR.RLE_COMPRESSION,
    "zips": OpenEXR.ZIPS_COMPRESSION,
    "zip": OpenEXR.ZIP_COMPRESSION,
    "piz": OpenEXR.PIZ_COMPRESSION,
    "pxr24": OpenEXR.PXR24_COMPRESSION,
    "b44": OpenEXR.B44_COMPRESSION,
}


def small_table(name: str, warp: str, compression: int) -> tuple[dict, np.ndarray]:
    """Header and texels of a 6 x 3 table that the loader accepts."""
    azimuth = name == "direct_phi"
    low, high = (0.0, 2 * np.pi) if azimuth else (-np.pi / 2, np.pi / 2)
    knots = Warp.parse(warp).u(6)
    row = np.linspace(low, high, 6, dtype=np.float32)
    row[[0, -1]] = np.float32([low, high])
    return {
        "compression": compression,
        "type": OpenEXR.scanlineimage,
        "hairlut.format": 1,
        "hairlut.model": "seed",
        "hairlut.table": name,
        "hairlut.angle": "phi" if azimuth else "theta_i",
        "hairlut.unit": "rad",
        "hairlut.azimuth": "sum" if azimuth else "none",
        "hairlut.warp": warp,
        "hairlut.cell": "linear" if warp == "uniform" else "parabola limit=0.9",
        "hairlut.theta_r_range": "-1.5707963267948966 1.5707963267948966",
        "hairlut.domain": f"{low!r} {high!r}",
        "hairlut.knots": " ".join(repr(float(u)) for u in knots),
    }, np.tile(row, (3, 1))


def write_loader() -> None:
    folder = HERE / "corpus" / "loader"
    for label, compression in COMPRESSIONS.items():
        for name, warp in (("direct_theta", f"octaves e={2.0**-18!r}"), ("direct_phi", "uniform")):
            header, texels = small_table(name, warp, compression)
            OpenEXR.File(header, {"Y": texels}).write(str(folder / f"{name}_{label}.exr"))


def small_mixture(
    compression: int, rows: int, columns: int, lobes: int
) -> tuple[dict, dict[str, np.ndarray]]:
    """Header and channels of a mixture that the loader accepts."""
    names = ["direct", "multiple", "third"][:lobes]
    share, turn = np.full((rows, columns), 0.5, np.float32), np.full((rows, columns), -0.7, np.float32)
    channels = {
        f"{name}.{what}": values for name in names for what, values in (("share", share), ("turn", turn))
    }
    header = {
        "compression": compression,
        "type": OpenEXR.scanlineimage,
        "hairlut.format": 2,
        "hairlut.generator": "seed",
        "hairlut.model": "seed",
        "hairlut.table": "mixture",
        "hairlut.unit": "rad",
        "hairlut.lobes": " ".join(names),
        "hairlut.axes": "theta_r offset",
        "hairlut.axis.theta_r": " ".join(repr(float(x)) for x in np.linspace(-1, 1, rows))
        if rows > 1
        else "0.0",
        "hairlut.axis.offset": " ".join(repr(float(x)) for x in np.linspace(0, 1, columns))
        if columns > 1
        else "0.0",
        "hairlut.mirrored": "1",
        "hairlut.digest": digest(list(channels.values())),
    }
    for name in names:
        header[f"hairlut.lobe.{name}"] = f"{name}_theta 00000001 {name}_phi 00000002"
    return header, channels


def write_mixtures() -> None:
    folder = HERE / "corpus" / "loader"
    for label in ("none", "rle", "zips", "zip"):
        for rows, columns, lobes in ((1, 1, 2), (3, 4, 3)):
            header, channels = small_mixture(COMPRESSIONS[label], rows, columns, lobes)
            OpenEXR.File(header, channels).write(str(folder / f"mixture_{rows}x{columns}_{label}.exr"))


def write_shipped() -> None:
    """Small tables of format 2, as they are baked."""
    folder = HERE / "corpus" / "loader"
    for table in ("direct_theta", "direct_phi"):
        for source in sorted((HERE.parents[1] / "luts").glob(f"fitted/{table}.exr")):
            folder.joinpath(f"{table}_format_2.exr").write_bytes(source.read_bytes())


def write_memory() -> None:
    """fuzz_memory.c says what the bytes are."""
    folder = HERE / "corpus" / "memory"
    draw = struct.pack("<6f", 0.3, 1.0, -0.4, 0.6, 0.25, 0.75)
    random = np.random.default_rng(1)
    for number, (width, height) in enumerate(((4, 2), (5, 3), (16, 4), (33, 2), (64, 16))):
        head = bytes([number % 4 + 8 * (number % 2)]) + draw
        cells = random.integers(0, 256, (2 * width - 1) * height).astype(np.uint8).tobytes()
        mixed = bytes([128 * (number % 2), number % 3 + 1, number + 1])
        mixed += random.integers(0, 256, 12 + 3 * 4 * 36).astype(np.uint8).tobytes()
        folder.joinpath(f"grown_{width}x{height}").write_bytes(
            head + bytes([0, width, height]) + cells + mixed
        )
        row = np.stack([np.linspace(-1, 1, width), np.full(width, 2.0)], axis=-1).astype(np.float32)
        numbers = struct.pack("<4fBf", -1, 1, -1, 1, 0, 1e-5)
        table = bytes([1 | 2 | 4 | 8 | 16, width, height]) + numbers + np.tile(row, (height, 1)).tobytes()
        mixed = bytes([2 | 4 | 8 | 16, 2, 2]) + struct.pack("<4f", -1, 1, -0.5, 0.5)
        mixed += struct.pack("<2f", 0.5, -0.7) * 16
        folder.joinpath(f"plain_{width}x{height}").write_bytes(head + table + mixed)


if __name__ == "__main__":
    write_loader()
    write_mixtures()
    write_shipped()
    write_memory()
