"""The C source of the built-in models holds the shipped tables, float for float."""

import re
import shutil

import numpy as np
import pytest

from hairlut import export, exr, interpolant
from hairlut.errors import HairlutError
from hairlut.lobes import TABLES


@pytest.fixture(scope="module")
def source(luts, tmp_path_factory):
    out = tmp_path_factory.mktemp("c") / "new" / "tables.c"
    export.export([luts / "printed", luts / "fitted"], "c", out)
    return out.read_text(encoding="ascii")


def floats(text):
    return np.array([float(word.rstrip("f")) for word in text.split(",") if word]).astype(np.float32)


def array(source, table, part):
    """(H+1, n) the numbers of one of a table's arrays."""
    entry = source[source.index(f'{{"{table.model}",') :]
    axes = re.findall(r"HAIRLUT_AXIS\((\w+)_rows, (\w+)_cells, ", entry)[:3]
    rows, cells = axes[TABLES.index(table.name)]
    assert rows == cells
    text = re.search(rf"static const float [\w ]*{rows}_{part}\[.*?\] = \{{\n(.*?)\}};", source, re.DOTALL)[1]
    return np.array([floats(line) for line in text.split("\n")])


def with_last_twice(texels):
    return np.concatenate([texels, texels[-1:]])


def test_rows_are_groups_of_inner_texels_and_of_their_changes(source, shipped):
    table, _, _, _ = shipped
    size, last = 8, table.width - 1
    texels = with_last_twice(table.texels)
    groups = array(source, table, "rows").reshape(len(texels), -1, 2, size)
    changes = np.diff(texels, axis=0, append=texels[-1:])
    for values, of, beyond in ((texels, 0, np.finfo(np.float32).max), (changes, 1, 0)):
        stored = groups[:, :, of]
        inner = stored[:, 1:].reshape(len(texels), -1)
        assert (inner[:, : last - 1] == values[:, 1:last]).all()
        assert (inner[:, last - 1 :] == beyond).all()
        pivots = values[:, size:last:size]
        assert (stored[:, 0, : pivots.shape[1]] == pivots).all()
        assert (stored[:, 0, pivots.shape[1] :] == beyond).all()


def test_cells_are_those_of_the_interpolant_from_both_ends(source, shipped):
    table, _, _, _ = shipped
    half = table.width // 2 + 1
    stored = array(source, table, "cells").reshape(2, half, table.height + 1, 4)
    exact = interpolant.cells(table, with_last_twice(table.theta_r))
    step = np.spacing(np.float32(np.abs(table.domain).max()))
    u, h = table.warp.u(table.width), table.warp.widths(table.width)
    for k in range(half):
        for side, i, nearer, sign in ((0, k, exact.x0, 1), (1, table.width - 2 - k, exact.x0 + exact.d, -1)):
            at, a, c, u0 = stored[side, k].astype(float).T
            assert np.abs(at - nearer[:, i]).max() <= step / 2
            assert (u0 == np.float32(u[k])).all()
            assert (np.sign(a) == sign).all()
            share = 4e-7 * u[k + 1] / h[i]  # of the cell's width in u that two rounded knots may be off
            slope, bend = (sign * exact.d[:, i] + exact.c[:, i]) / h[i], exact.c[:, i] / h[i] ** 2
            widest = exact.d[:, i].max()
            np.testing.assert_allclose(a, slope, rtol=1e-6, atol=3 * share * widest / h[i])
            np.testing.assert_allclose(c, bend, rtol=1e-6, atol=3 * share * widest / h[i] ** 2)


def test_tables_of_the_same_content_stand_in_it_once(source):
    """Both models have the same azimuth and the same multiple lobe."""
    names = re.findall(r"(\w+)_rows\[", source)
    assert names == [
        f"hairlut_{n}" for n in ("printed_direct_theta", "printed_direct_phi", "printed_multiple_theta")
    ] + ["hairlut_fitted_direct_theta"]


def test_every_model_is_named_once_and_in_order(source):
    entries = source[source.index("hairlut_builtin_entries[] = {") :]
    assert re.findall(r'\{"(\w+)",', entries) == ["printed", "fitted"]
    assert re.findall(r"HAIRLUT_AZIMUTH_\w+", entries) == [
        "HAIRLUT_AZIMUTH_SUM",
        "HAIRLUT_AZIMUTH_DIFFERENCE",
    ]
    assert "const int hairlut_builtin_count = 2;" in entries


def test_literals_are_floats_in_c(source):
    for word in re.findall(r"[-+\w.]*\df\b", source):
        assert re.fullmatch(r"-?\d+(\.\d+)?(e[-+]\d+)?f", word)
        assert "." in word or "e" in word


def test_deterministic(luts, tmp_path, source):
    export.export([luts / "printed", luts / "fitted"], "c", tmp_path / "again.c")
    assert (tmp_path / "again.c").read_text() == source


def test_wrong_input_is_named(luts, tmp_path):
    with pytest.raises(HairlutError, match=r"fitted, fitted: expected a different name"):
        export.export([luts / "fitted", luts / "fitted"], "c", tmp_path / "a.c")
    with pytest.raises(HairlutError, match=r"nowhere: expected a directory that holds direct_theta\.exr"):
        export.export([tmp_path / "nowhere"], "c", tmp_path / "a.c")
    shutil.copytree(luts / "fitted", tmp_path / "mixed")
    shutil.copy(luts / "printed" / "multiple_theta.exr", tmp_path / "mixed")
    with pytest.raises(HairlutError, match=r"attribute hairlut\.model differs"):
        export.export([tmp_path / "mixed"], "c", tmp_path / "a.c")
    assert not (tmp_path / "a.c").exists()
    table, _ = exr.read(luts / "fitted" / "direct_phi.exr")
    assert table.azimuth == "difference"
