# SPDX-License-Identifier: BSD-3-Clause
"""hairlut plot draws every table: baked from a formula, fitted, and over parameters of the hair."""

import numpy as np
import pytest

from hairlut import exr, figures, plot
from hairlut.cli import main
from precompute.parametric import model

STANDARD = {"beta_m": 0.3, "absorption": 0.5, "tilt": -1.0}


@pytest.fixture(scope="module")
def groom(tmp_path_factory):
    directory = tmp_path_factory.mktemp("plot") / "groom"
    exr.write_model(directory, model())
    return directory


def drawn(table, out, *at) -> bytes:
    """The picture of a table, whose bytes are the same every time."""
    given = [word for text in at for word in ("--at", text)]
    assert main(["plot", str(table), "--out", str(out), *given]) == 0
    (picture,) = out.glob("*.png")
    return picture.read_bytes()


def test_a_table_over_parameters_is_drawn_at_standard_values_or_those_of_at(groom, tmp_path):
    table = groom / "r_phi.exr"
    standard = drawn(table, tmp_path)
    assert drawn(table, tmp_path, "beta_m=0.3") == standard
    assert drawn(table, tmp_path, "beta_m=0.2") != standard


def test_parameters_on_which_a_table_does_not_depend_change_nothing(groom, tmp_path):
    assert drawn(groom / "tt_phi.exr", tmp_path, "beta_m=0.2") == drawn(groom / "tt_phi.exr", tmp_path)


def test_the_density_along_a_parameter_is_that_of_the_blended_table():
    (table,) = (table for table in model().tables if table.name == "r_phi")
    figure, panel = figures.new()
    plot.along(panel, table, table.axes[0], STANDARD)
    values = [float(line.get_label().rpartition(" ")[2]) for line in panel.lines]
    assert values == [0.1, 0.3, 0.5, 0.7, 0.9]
    for value, line in zip(values, panel.lines, strict=True):
        x, q = plot.curve(table.at({**STANDARD, "beta_m": value}), 0.0)
        np.testing.assert_allclose(line.get_ydata(), q, rtol=1e-12)
        assert np.trapezoid(q, x) == pytest.approx(1, abs=0.02)
    figures.plt.close(figure)


@pytest.mark.parametrize(
    ("table", "at", "said"),
    [
        ("r_phi.exr", "beta=1", "--at beta: the model has beta_m, absorption, tilt"),
        ("tt_phi.exr", "beta_m=0.95", "--at beta_m=0.95: expected 0.1 to 0.9"),
        ("r_phi.exr", "beta_m", "expected NAME=VALUE with a number"),
    ],
)
def test_wrong_values_are_refused(groom, tmp_path, table, at, said, capsys):
    assert main(["plot", str(groom / table), "--at", at, "--out", str(tmp_path / "out")]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_table_over_parameters_needs_its_mixture(groom, tmp_path, capsys):
    (tmp_path / "r_phi.exr").write_bytes((groom / "r_phi.exr").read_bytes())
    assert main(["plot", str(tmp_path / "r_phi.exr"), "--out", str(tmp_path / "out")]) == 2
    assert "mixture.exr: no such file" in capsys.readouterr().err
