"""Writes the seeds of tests/fuzz/corpus: make_corpus.py. What fuzzing found later is kept beside them."""

import struct
from pathlib import Path

import numpy as np
import OpenEXR

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


def write_memory() -> None:
    folder = HERE / "corpus" / "memory"
    directions = struct.pack("<4f", 0.3, 1.0, 0.25, 0.75)
    random = np.random.default_rng(1)
    for width, height in ((4, 2), (5, 3), (16, 4), (33, 2), (64, 16)):
        cells = random.integers(0, 40, (width - 1) * height).astype(np.uint8).tobytes()
        folder.joinpath(f"grown_{width}x{height}").write_bytes(bytes([0, width, height]) + directions + cells)
        row = np.linspace(-1, 1, width, dtype=np.float32)
        numbers = struct.pack("<4fB2f", -1, 1, -1, 1, 0, 1e-5, 0.5)
        head = bytes([1 | 2 | 4 | 8 | 16 | 32, width, height]) + numbers + directions
        folder.joinpath(f"plain_{width}x{height}").write_bytes(head + np.tile(row, height).tobytes())


if __name__ == "__main__":
    write_loader()
    write_memory()
