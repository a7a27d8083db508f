# SPDX-License-Identifier: BSD-3-Clause
"""Files: what is written is read again; what is no table is refused with file, attribute and remedy."""

import os
import shutil
import zlib
from dataclasses import replace

import numpy as np
import OpenEXR
import pytest

from hairlut import exr
from hairlut.errors import HairlutError
from hairlut.lobes import FITTED, PRINTED
from hairlut.table import bake_table
from hairlut.warp import Warp


@pytest.fixture(scope="module")
def table():
    return bake_table(FITTED.direct_phi, 12, 5, Warp("octaves", 2.0**-12))


@pytest.fixture
def path(table, tmp_path):
    exr.write(tmp_path / "direct_phi.exr", table, {"relative_variance": 1.25e-3})
    return tmp_path / "direct_phi.exr"


def rewrite(path, change=None, pixels=None, drop=None):
    """Writes the file again with attributes changed or dropped, or with other pixels."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        header = dict(file.header())
        channels = {name: np.array(channel.pixels) for name, channel in file.channels().items()}
    header = {k: v for k, v in header.items() if k not in ("channels", "dataWindow", "displayWindow")}
    header.pop(drop, None)
    header |= change or {}
    if pixels is not None:
        channels |= pixels(channels["Y"])
        channels = {name: data for name, data in channels.items() if data is not None}
        digest = zlib.crc32(np.stack([*map(np.float32, channels.values())], axis=-1).tobytes())
        header["hairlut.digest"] = f"crc32 {digest:08x}"
    channels = {name: np.ascontiguousarray(data) for name, data in channels.items()}
    with OpenEXR.File(header, channels) as file:
        file.write(str(path))


@pytest.mark.parametrize("warp", [Warp("uniform"), Warp("octaves", 2.0**-14), Warp("octaves", 0.1)], ids=str)
@pytest.mark.parametrize("size", [(4, 2), (33, 7)])
def test_round_trip(tmp_path, warp, size):
    for lobe in FITTED.lobes:
        table = bake_table(lobe, *size, warp)
        path = tmp_path / "new" / "directory" / f"{lobe.name}.exr"
        exr.write(path, table, {"quantile": 1.5e-3, "largest_weight": 2.0})
        again, errors = exr.read(path)
        np.testing.assert_array_equal(again.texels, table.texels)
        np.testing.assert_array_equal(again.slopes, table.slopes)
        assert again.texels.dtype == again.slopes.dtype == np.float32
        np.testing.assert_allclose(again.log_mass, table.log_mass, rtol=0, atol=1e-12)
        plain = {"texels": None, "slopes": None, "log_mass": None}
        assert replace(again, **plain) == replace(table, **plain)
        assert errors == {"quantile": 1.5e-3, "largest_weight": 2.0}
        assert [p.name for p in path.parent.iterdir() if p.suffix != ".exr"] == []


def test_header_is_what_the_format_page_says(path, table):
    with OpenEXR.File(str(path)) as file:
        header = dict(file.header())
        assert list(file.channels()) == ["Y", "dxdu"]
    assert header["colorInteropID"] == "data"
    assert header["hairlut.format"] == 2
    assert header["hairlut.model"] == "fitted"
    assert header["hairlut.table"] == "direct_phi"
    assert header["hairlut.angle"] == "phi"
    assert header["hairlut.azimuth"] == "difference"
    assert header["hairlut.unit"] == "rad"
    assert header["hairlut.theta_r_range"] == "-1.5707963267948966 1.5707963267948966"
    assert header["hairlut.domain"] == "0.0 6.283185307179586"
    assert header["hairlut.warp"] == "octaves e=0.000244140625"
    assert header["hairlut.cell"] == "rational quadratic"
    interleaved = np.stack([table.texels, table.slopes], axis=-1).tobytes()
    assert header["hairlut.digest"] == f"crc32 {zlib.crc32(interleaved):08x}"
    assert header["hairlut.error.relative_variance"] == "1.250e-03"
    np.testing.assert_array_equal([float(x) for x in header["hairlut.knots"].split()], table.warp.u(12))
    assert header["compression"] == OpenEXR.ZIP_COMPRESSION
    assert header["type"] == OpenEXR.scanlineimage


def test_byte_identical_when_written_twice(path, table, tmp_path):
    other = tmp_path / "b" / "direct_phi.exr"
    exr.write(other, table, {"relative_variance": 1.25e-3})
    assert other.read_bytes() == path.read_bytes()


def test_a_strided_array_is_not_written_corrupted(tmp_path, table):
    wide = np.repeat(table.texels, 2, axis=1)[:, ::2]
    assert not wide.flags.c_contiguous
    exr.write(tmp_path / "direct_phi.exr", replace(table, texels=wide))
    np.testing.assert_array_equal(exr.read(tmp_path / "direct_phi.exr")[0].texels, table.texels)


REQUIRED = [
    "format",
    "model",
    "table",
    "angle",
    "azimuth",
    "unit",
    "theta_r_range",
    "domain",
    "warp",
    "cell",
    "knots",
    "digest",
]
OPTIONAL = ["generator", "parameters", "log_mass", "error.relative_variance"]


def refusal(path):
    with pytest.raises(HairlutError) as caught:
        exr.read(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    return message


@pytest.mark.parametrize("name", REQUIRED)
def test_missing_attribute(path, name):
    rewrite(path, drop=f"hairlut.{name}")
    message = refusal(path)
    assert f"attribute hairlut.{name} is missing" in message
    assert "hairlut bake" in message


@pytest.mark.parametrize("name", OPTIONAL)
def test_attributes_that_a_file_may_lack(path, table, name):
    rewrite(path, drop=f"hairlut.{name}")
    np.testing.assert_array_equal(exr.read(path)[0].texels, table.texels)


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("format", 3, "is 3, expected 2 or less: use a newer hairlut"),
        ("format", 0, "is 0, expected 1"),
        ("format", "1", "is '1', expected 1"),
        ("unit", "deg", "is 'deg', expected 'rad'"),
        ("angle", "phi_i", "is 'phi_i', expected 'phi'"),
        ("azimuth", "wrapped", "is 'wrapped', expected 'difference' or 'sum'"),
        ("table", "multiple_theta", "is 'multiple_theta', expected 'direct_phi': rename the file"),
        ("theta_r_range", "1.0 -1.0", "expected two increasing numbers"),
        ("theta_r_range", "1.0", "expected 2 numbers"),
        ("domain", "0.0 inf", "expected 2 numbers"),
        ("domain", "zero one", "expected 2 numbers"),
        ("warp", "cubic", "is 'cubic' (warp cubic is not known: expected 'octaves"),
        ("warp", "octaves e=0.5", None),
        ("cell", "parabola limit=0.9", "expected 'rational quadratic'"),
        ("digest", "crc32 00000000", "they were changed after they were written"),
        ("domain", "0.0 7.0", "expected two increasing angles in radians from 0 to 6.28319"),
        ("knots", "0.0 1.0", "expected 12 numbers"),
    ],
)
def test_wrong_attribute(path, name, value, reason):
    rewrite(path, {f"hairlut.{name}": value})
    message = refusal(path)
    assert f"attribute hairlut.{'knots' if reason is None else name} " in message
    assert (reason or "from the warp octaves e=0.5") in message


def test_knots_that_are_not_the_warps(path):
    with OpenEXR.File(str(path)) as file:
        knots = file.header()["hairlut.knots"].split()
    knots[3] = repr(float(knots[3]) * (1 + 3e-6))
    rewrite(path, {"hairlut.knots": " ".join(knots)})
    assert "attribute hairlut.knots has" in refusal(path)
    assert "at column 3" in refusal(path)


def broken(j, i, value):
    def change(texels):
        texels = texels.copy()
        texels[j, i] = value
        return {"Y": texels}

    return change


@pytest.mark.parametrize(
    ("pixels", "reason"),
    [
        (broken(2, 3, np.nan), "row 2, column 3 is nan, expected a finite angle"),
        (broken(2, 3, np.inf), "row 2, column 3 is inf, expected a finite angle"),
        (broken(4, 5, 0.0), "row 4, columns 4 and 5"),
        (broken(0, 0, -1.0), "row 0 runs from -1 to"),
        (broken(1, 11, 7.0), "row 1 runs from 0 to 7"),
        (lambda y: {"Y": np.repeat(y[:, :1], 12, axis=1)}, "expected angles that increase"),
        (lambda y: {"Y": y.astype(np.float16)}, "channel Y is float16, expected 32-bit float"),
        (lambda y: {"Y": None, "R": y}, "channels are R, dxdu, expected Y, dxdu"),
        (lambda y: {"Z": y}, "channels are Y, Z, dxdu, expected Y, dxdu"),
        (lambda y: {"Y": y[:, :3], "dxdu": y[:, :3]}, "expected a width of 4"),
        (lambda y: {"Y": y[:1], "dxdu": y[:1]}, "a height of 2"),
        (lambda y: {"dxdu": 0 * y}, "row 0, column 0: dxdu is 0, expected 1e-09 to 1e+12"),
        (lambda y: {"dxdu": y + np.nan}, "row 0, column 0: dxdu is nan, expected"),
        (lambda y: {"dxdu": y + 1e13}, "expected 1e-09 to 1e+12"),
        (lambda y: {"dxdu": None}, "channels are Y, expected Y, dxdu"),
    ],
)
def test_wrong_texels(path, pixels, reason):
    rewrite(path, pixels=pixels)
    message = refusal(path)
    assert reason in message
    assert "hairlut bake" in message


def test_truncated_file_at_every_length(path):
    whole = path.read_bytes()
    for length in [*range(0, 64), *range(64, len(whole), 97), len(whole) - 1]:
        path.write_bytes(whole[:length])
        message = refusal(path)
        assert "hairlut bake" in message


def test_other_files_and_no_file(path, tmp_path):
    path.write_text("theta_r_deg,mu_deg\n")
    assert "is no OpenEXR image" in refusal(path)
    assert "no such file" in refusal(tmp_path / "direct_theta.exr")
    assert "is a directory: name a file in it" in refusal(tmp_path)


def test_renamed_file(path, tmp_path):
    shutil.move(path, tmp_path / "direct_theta.exr")
    message = refusal(tmp_path / "direct_theta.exr")
    assert "attribute hairlut.table is 'direct_phi', expected 'direct_theta': rename the file" in message


def test_an_image_that_is_no_table(tmp_path):
    path = tmp_path / "direct_phi.exr"
    with OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION}, {"Y": np.zeros((4, 4), np.float32)}) as file:
        file.write(str(path))
    assert "attribute hairlut.format is missing: the file is no hairlut table" in refusal(path)


def test_a_failed_write_leaves_the_old_file(path, table, monkeypatch):
    before = path.read_bytes()

    def fail(source, target):
        raise OSError("disk full")

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(HairlutError, match=r"direct_phi\.exr: cannot be written: disk full"):
        exr.write(path, replace(table, parameters="other"))
    assert path.read_bytes() == before
    assert [p.name for p in path.parent.iterdir()] == ["direct_phi.exr"]


def test_a_wrong_name_is_not_written(tmp_path):
    table = bake_table(PRINTED.direct_theta, 8, 4, Warp("octaves", 2.0**-10))
    with pytest.raises(HairlutError, match=r"must be named direct_theta\.exr"):
        exr.write(tmp_path / "theta.exr", table)
