"""Raw floats and npz give back the same texels, and the numbers to read them by."""

import json

import numpy as np
import pytest

from hairlut import exr, interpolant
from hairlut.axis import AXIS
from hairlut.cli import main
from hairlut.export import table_files
from hairlut.lobes import TABLES


def run(*args) -> int:
    return main(["export", *map(str, args)])


def read_raw(path):
    """(texels (height, width), sidecar) from the path of a sidecar."""
    sidecar = json.loads(path.read_text(encoding="ascii"))
    texels = np.fromfile(path.with_name(sidecar["file"]), "<f4")
    return texels.reshape(sidecar["height"], sidecar["width"]), sidecar


def test_raw_floats_and_sidecar(shipped, tmp_path):
    table, path, _, errors = shipped
    assert run(path, "--to", "raw", "--out", tmp_path) == 0
    file = tmp_path / table.model / f"{table.name}.f32"
    texels, sidecar = read_raw(file.with_suffix(".json"))
    assert np.array_equal(texels, table.texels)
    assert file.read_bytes() == table.texels.astype("<f4").tobytes()
    assert sidecar["header"] == exr.attributes(table)
    assert sidecar["errors"] == errors


def test_sidecar_alone_reads_the_texels(shipped, tmp_path):
    """A quartile by the sidecar's own numbers, in single precision, against the interpolant."""
    table, path, _, _ = shipped
    run(path, "--to", "raw", "--out", tmp_path)
    texels, sidecar = read_raw(tmp_path / table.model / f"{table.name}.json")
    axis = {name: np.float32(value) for name, value in sidecar["axis"].items()}
    assert sidecar["shader"] == [0.0, *(sidecar["axis"][name] for name in AXIS)]
    theta_r, u = np.float32(0.4), np.float32(0.25)
    row = (theta_r - axis["row_origin"]) * axis["row_scale"]
    shifted = (np.float32(u + axis["e"]).view(np.uint32) >> 2) + np.uint32(96 << 23)
    column = (shifted.view(np.float32) - axis["f0"]) / axis["k"]
    j, i = int(row), int(column)
    knots = np.array(sidecar["header"]["hairlut.knots"].split(), float)[i - 1 : i + 3]
    h, f = np.diff(knots), (u - knots[1]) / (knots[2] - knots[1])
    x = 0.0
    for weight, texel in ((1 - (row - j), texels[j]), (row - j, texels[j + 1])):
        d = np.diff(texel[i - 1 : i + 3].astype(float))
        at_knots = (d[:-1] + d[1:]) / (d[1:] * h[:-1] / d[:-1] + d[:-1] * h[1:] / d[1:])
        c = np.clip(h[1] * (at_knots[0] - at_knots[1]) / 2, -axis["limit"] * d[1], axis["limit"] * d[1])
        x += weight * (texel[i] + f * (d[1] + c * (1 - f)))
    angle, _ = interpolant.sample(table, [theta_r], [u])
    assert x == pytest.approx(angle[0], abs=1e-6)


def test_npz(shipped, tmp_path):
    table, path, _, _ = shipped
    assert run(path, "--to", "npz", "--out", tmp_path) == 0
    with np.load(tmp_path / table.model / f"{table.name}.npz") as file:
        assert np.array_equal(file["texels"], table.texels)
        assert file["texels"].dtype == np.float32
        assert np.array_equal(file["theta_r"], table.theta_r)
        assert np.array_equal(file["u"], table.warp.u(table.width))
        assert json.loads(str(file["sidecar"]))["header"] == exr.attributes(table)


def test_a_directory_stands_for_its_three_tables(shipped):
    _, path, _, _ = shipped
    assert table_files(path.parent) == [path.parent / f"{name}.exr" for name in TABLES]
    assert table_files(path) == [path]


def test_refusals(shipped, tmp_path, capsys):
    _, path, _, _ = shipped
    assert run(tmp_path / "absent.exr", "--to", "raw", "--out", tmp_path) == 2
    assert "absent.exr: no such file" in capsys.readouterr().err
    assert run(path, "--to", "raw", "--out", path) == 2
    assert "cannot be written" in capsys.readouterr().err
