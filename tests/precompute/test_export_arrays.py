# SPDX-License-Identifier: BSD-3-Clause
"""Raw floats, streams and npz read back as the same numbers."""

import json

import numpy as np
import pytest

from hairlut import exr, interpolant
from hairlut.cli import main
from hairlut.stream import AXIS, HEAD, WIDTH, stream


def run(*args) -> int:
    return main(["export", *map(str, args)])


def read_raw(path, *shape):
    """(floats of a shape that ends in `shape`, sidecar) from the path of a sidecar."""
    sidecar = json.loads(path.read_text(encoding="ascii"))
    return np.fromfile(path.with_name(sidecar["file"]), "<f4").reshape(*shape), sidecar


def test_raw_floats_and_sidecar(shipped, tmp_path):
    table, path, _, errors = shipped
    assert run(path, "--to", "raw", "--out", tmp_path) == 0
    file = tmp_path / table.model / f"{table.name}.json"
    texels, sidecar = read_raw(file, table.height, table.width, 2)
    assert np.array_equal(texels[..., 0], table.texels)
    assert np.array_equal(texels[..., 1], table.slopes)
    assert (sidecar["height"], sidecar["width"]) == table.texels.shape
    assert sidecar["header"] == exr.attributes(table)
    assert sidecar["errors"] == errors
    assert not (tmp_path / table.model / "hair.f32").exists()


def test_stream_and_sidecar(luts, tmp_path):
    model = exr.read_model(luts / "brown")
    assert run(luts / "brown", "--to", "raw", "--out", tmp_path) == 0
    texels, sidecar = read_raw(tmp_path / "brown" / "hair.json", -1, 4)
    assert np.array_equal(texels, stream(model))
    assert sidecar["texels"] == len(texels)
    assert sidecar["texture"] == [WIDTH, len(texels) // WIDTH]
    assert sidecar["head"] == HEAD + 2 * AXIS * len(model.lobes)
    assert [lobe["name"] for lobe in sidecar["lobes"]] == list(model.mixture.lobes)
    assert sidecar["mirrored"] is model.mixture.mirrored
    tables = {lobe[part] for lobe in sidecar["lobes"] for part in ("theta", "phi")}
    assert all((tmp_path / "brown" / f"{name}.f32").is_file() for name in tables)


def test_stream_alone_draws_a_sample(luts, tmp_path):
    """A quartile of the second lobe's theta_i by the layout of runtime/shaders/README.md, against the
    interpolant."""
    run(luts / "fitted", "--to", "raw", "--out", tmp_path)
    texels, sidecar = read_raw(tmp_path / "fitted" / "hair.json", -1, 4)
    table = next(t for t in exr.read_model(luts / "fitted").tables if t.name == sidecar["lobes"][1]["theta"])
    theta_r, u = np.float32(0.4), np.float32(0.25)
    first, columns, height, _ = texels[HEAD + 2 * AXIS].astype(int)
    origin, scale, low, high = texels[HEAD + 2 * AXIS + 1]
    e, column_scale, column_origin, _ = texels[HEAD + 2 * AXIS + 2]
    assert (columns, height, low, high) == (table.width, table.height, *np.float32(table.domain))
    row = (theta_r - origin) * scale
    curve = (np.float32(u + e).view(np.uint32) >> 2) + np.uint32(96 << 23)
    i, j = int(curve.view(np.float32) * column_scale - column_origin), int(row)
    u0, inverse_h, h, _ = texels[first + i]
    assert inverse_h * h == pytest.approx(1)
    at = first + columns // 2 + i * height + j
    x0, w, d0, d1 = (1 - (row - j)) * texels[at] + (row - j) * texels[at + 1]
    f = (u - u0) * inverse_h
    g, p = 1 - f, f * (1 - f)
    x = x0 + w * (w * f * f + d0 * p) / (w * (f * f + g * g) + (d0 + d1) * p)
    angle, _ = interpolant.sample(table, [theta_r], [u])
    assert x == pytest.approx(angle[0], abs=1e-6)


def test_npz(shipped, tmp_path):
    table, path, _, _ = shipped
    assert run(path, "--to", "npz", "--out", tmp_path) == 0
    with np.load(tmp_path / table.model / f"{table.name}.npz") as file:
        assert np.array_equal(file["texels"], table.texels)
        assert np.array_equal(file["slopes"], table.slopes)
        assert file["texels"].dtype == file["slopes"].dtype == np.float32
        assert np.array_equal(file["theta_r"], table.theta_r)
        assert np.array_equal(file["u"], table.warp.u(table.width))
        assert json.loads(str(file["sidecar"]))["header"] == exr.attributes(table)


def test_refusals(shipped, luts, tmp_path, capsys):
    _, path, _, _ = shipped
    assert run(tmp_path / "absent.exr", "--to", "raw", "--out", tmp_path) == 2
    assert "absent.exr: no such file" in capsys.readouterr().err
    assert run(path, "--to", "raw", "--out", path) == 2
    assert "cannot be written" in capsys.readouterr().err
    assert run(luts / "brown", luts / "brown", "--to", "raw", "--out", tmp_path) == 2
    assert "expected a different name" in capsys.readouterr().err
