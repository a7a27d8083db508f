# SPDX-License-Identifier: BSD-3-Clause
"""hairlut verify reports what is wrong with a file, and where, and passes good files."""

import json
import shutil
from dataclasses import replace

import numpy as np
import OpenEXR
import pytest

from hairlut import exr
from hairlut.cli import main
from hairlut.verify import verify
from precompute.conftest import LUTS


@pytest.fixture
def luts(tmp_path):
    """A copy of the shipped tables, for tests that change them."""
    for model in ("printed", "fitted"):
        shutil.copytree(LUTS / model, tmp_path / model)
    return tmp_path


def problems(path):
    return [problem for report in verify(path) for problem in report.problems]


def spoil(path, change):
    """Applies change(texels) to the texels of a file, leaving its header alone."""
    table, errors = exr.read(path)
    texels = table.texels.copy()
    change(texels)
    exr.write(path, replace(table, texels=texels), errors)


def rewrite(path, change):
    """Applies change(header) to a file, leaving its texels alone."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        header = dict(file.header())
        channels = {name: np.array(channel.pixels) for name, channel in file.channels().items()}
    change(header)
    with OpenEXR.File(header, channels) as file:
        file.write(str(path))


def test_the_shipped_tables_pass():
    reports = verify(LUTS)
    assert len(reports) >= 6
    assert [report.problems for report in reports] == [[]] * len(reports)


@pytest.mark.parametrize("name", ["printed/direct_theta", "fitted/direct_phi", "fitted/multiple_theta"])
def test_one_texel_changed_by_a_thousandth(luts, name):
    path = luts / f"{name}.exr"

    def change(texels):
        j, i = texels.shape[0] // 3, texels.shape[1] // 2
        texels[j, i] += 1e-3 * np.sign(texels[j, i + 1] - texels[j, i] - 2e-3)

    spoil(path, change)
    (found, *_) = problems(path)
    table, _ = exr.read(path)
    assert f"row {table.height // 3} " in found
    assert f"1 of {table.width} texels are wrong, worst in column {table.width // 2}:" in found


def test_two_rows_swapped(luts):
    path = luts / "fitted" / "direct_theta.exr"

    def change(texels):
        texels[[4, 9]] = texels[[9, 4]]

    spoil(path, change)
    found = problems(path)
    assert "contains the quantiles of row 9" in found[0]
    assert "contains the quantiles of row 4" in found[1]
    assert any("relative_variance" in problem for problem in found)


@pytest.mark.parametrize(
    "name",
    [
        "knots",
        "unit",
        "warp",
        "cell",
        "theta_r_range",
        "domain",
        "azimuth",
        "model",
        "digest",
    ],
)
def test_a_lost_attribute(luts, name):
    path = luts / "printed" / "direct_phi.exr"
    rewrite(path, lambda header: header.pop(f"hairlut.{name}"))
    assert f"hairlut.{name} is missing" in problems(path)[0]


def test_a_lost_formula(luts):
    path = luts / "printed" / "direct_phi.exr"
    rewrite(path, lambda header: header.pop("hairlut.parameters"))
    assert "attribute hairlut.parameters is '', expected" in problems(path)[0]


def test_a_lost_claim(luts):
    path = luts / "printed" / "direct_phi.exr"
    rewrite(path, lambda header: header.pop("hairlut.error.largest_weight"))
    assert "hairlut.error.largest_weight is missing" in problems(path)[0]


def test_a_claim_that_is_too_good(luts):
    path = luts / "printed" / "direct_phi.exr"
    rewrite(path, lambda header: header.update({"hairlut.error.relative_variance": "1e-9"}))
    (found,) = problems(path)
    assert found.startswith("error relative_variance is ")
    assert found.endswith(", attribute hairlut.error.relative_variance claims 1.000e-09")


def test_a_table_of_the_other_model_under_this_ones_directory(luts):
    path = luts / "printed" / "direct_theta.exr"
    shutil.copy(luts / "fitted" / "direct_theta.exr", path)
    assert "a table of another model stands under this one's name" in problems(path)[0]


def test_a_table_of_the_other_model_relabelled(luts):
    """Only the texels can tell."""
    path = luts / "printed" / "direct_theta.exr"
    shutil.copy(luts / "fitted" / "direct_theta.exr", path)
    table, _ = exr.read(LUTS / "printed" / "direct_theta.exr")
    rewrite(
        path,
        lambda header: header.update({"hairlut.model": "printed", "hairlut.parameters": table.parameters}),
    )
    found = problems(path)
    assert "texels are wrong" in found[0]
    assert any("relative_variance" in problem for problem in found)


def test_another_formula(luts):
    path = luts / "fitted" / "multiple_theta.exr"
    rewrite(
        path,
        lambda header: header.update({"hairlut.parameters": "Gaussian of theta_i; sigma = 1"}),
    )
    assert "attribute hairlut.parameters is 'Gaussian of theta_i; sigma = 1', expected" in problems(path)[0]


def test_a_missing_table(luts):
    (luts / "fitted" / "direct_phi.exr").unlink()
    (found,) = problems(luts)
    assert found.startswith("no such file: check the path, or bake it again")


def test_a_missing_mixture(luts):
    (luts / "fitted" / "mixture.exr").unlink()
    (found,) = problems(luts)
    assert "is 2, expected 1, as there is no mixture.exr beside it" in found


def test_a_table_of_another_bake(luts, tmp_path):
    """By itself it is good, but mixture.exr names another."""
    assert main(["bake", "--model", "fitted", "--size", "24x32", "--out", str(tmp_path / "other")]) == 0
    shutil.copy(tmp_path / "other" / "fitted" / "direct_phi.exr", luts / "fitted")
    (found,) = problems(luts / "fitted")
    assert "the files are of different bakes" in found


def test_one_slope_changed(luts):
    path = luts / "fitted" / "direct_phi.exr"
    table, errors = exr.read(path)
    slopes = table.slopes.copy()
    slopes[7, 11] *= 1.001
    exr.write(path, replace(table, slopes=slopes), errors)
    assert "1 slopes are wrong, worst in column 11" in problems(path)[0]


def test_a_share_changed(luts):
    path = luts / "fitted" / "mixture.exr"
    model = exr.read_model(luts / "fitted")
    mixture = replace(model.mixture, share=np.array([0.6, 0.4])[:, None, None])
    exr.write_model(luts / "fitted", replace(model, mixture=mixture))
    assert problems(path) == [
        "direct.share is 0.6, expected 0.5",
        "multiple.share is 0.4, expected 0.5",
    ]


def test_a_truncated_file(luts):
    path = luts / "fitted" / "direct_phi.exr"
    path.write_bytes(path.read_bytes()[:3000])
    assert len(problems(path)) == 1


def test_an_unknown_model(luts):
    path = luts / "fitted" / "direct_phi.exr"
    rewrite(path, lambda header: header.update({"hairlut.model": "mine"}))
    assert "name the model's file with --model" in problems(path)[0]


# ---- the command
# ----------------------------------------------------------------------------------------------


def test_command_line(luts, capsys):
    assert main(["verify", str(luts / "fitted")]) == 0
    assert capsys.readouterr().out.count("ok ") == 4
    spoil(
        luts / "fitted" / "direct_phi.exr",
        lambda texels: texels[5].__setitem__(9, texels[5, 9] + 1e-3),
    )
    assert main(["verify", str(luts), "--json"]) == 1
    reports = json.loads(capsys.readouterr().out)
    assert [report["ok"] for report in reports].count(False) == 1
    (bad,) = (report for report in reports if not report["ok"])
    assert bad["path"].endswith("direct_phi.exr")
    assert bad["problems"]


def test_command_refuses_an_empty_directory(tmp_path, capsys):
    assert main(["verify", str(tmp_path)]) == 2
    assert "no .exr file" in capsys.readouterr().err


def test_command_on_a_file_that_is_not_there(tmp_path, capsys):
    assert main(["verify", str(tmp_path / "direct_phi.exr")]) == 1
    assert "no such file" in capsys.readouterr().out


def test_tables_of_a_model_file(tmp_path, capsys):
    """They verify with the model file, and only with it."""
    model = tmp_path / "wide.py"
    model.write_text(
        "from hairlut.modelfile import gaussian\n"
        "LOBES = gaussian('direct_theta', 0.1, 0.5), gaussian('direct_phi', 3.0, 0.9), "
        "gaussian('multiple_theta', 0.0, 0.8)\n"
    )
    assert main(["bake", "--model", str(model), "--size", "16x8", "--out", str(tmp_path / "out")]) == 0
    assert main(["verify", str(tmp_path / "out"), "--model", str(model)]) == 0
    assert main(["verify", str(tmp_path / "out")]) == 1
    assert "--model" in capsys.readouterr().out
