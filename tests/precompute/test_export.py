"""The C source of the built-in models holds the shipped tables, float for float."""

import re
import shutil

import numpy as np
import pytest

from hairlut import export, exr
from hairlut.errors import HairlutError
from hairlut.interpolant import padded


@pytest.fixture(scope="module")
def source(luts, tmp_path_factory):
    out = tmp_path_factory.mktemp("c") / "new" / "tables.c"
    export.export([luts / "printed", luts / "fitted"], "c", out)
    return out.read_text(encoding="ascii")


def floats(text):
    return np.array([float(word.rstrip("f")) for word in text.split(",") if word]).astype(np.float32)


def holds(row, part):
    """Whether part stands somewhere in row, without a gap."""
    return (np.lib.stride_tricks.sliding_window_view(row, len(part)) == part).all(axis=1).any()


def test_rows_are_the_texels_with_their_padding(source, shipped):
    table, _, _, _ = shipped
    name = f"hairlut_{table.model}_{table.name}"
    rows = re.search(rf"static const float [\w ]*{name}\[.*?\] = \{{\n(.*?)\}};", source, re.DOTALL)[1]
    stored = [floats(line) for line in rows.split("\n")]
    assert len(stored) == table.height
    for row, expected in zip(stored, padded(table.texels).astype(np.float32), strict=True):
        assert holds(row, expected)


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
