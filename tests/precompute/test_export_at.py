# SPDX-License-Identifier: BSD-3-Clause
"""Models over parameters of the hair: verified as they are, exported at fixed parameters."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest

from hairlut import exr, interpolant, verify
from hairlut.cli import main
from hairlut.export import TARGETS
from hairlut.fixed import as_floats
from hairlut.stream import stream
from precompute.parametric import model


@pytest.fixture
def directory(tmp_path):
    exr.write_model(tmp_path / "groom", replace(model(), name="parametric"))
    return tmp_path / "groom"


def export(*args) -> int:
    return main(["export", *map(str, args)])


def test_a_model_at_fixed_parameters_is_an_ordinary_model(directory, tmp_path):
    out = tmp_path / "out"
    at = ("--at", "beta_m=0.2", "--at", "absorption=1e0")
    assert export(directory, *at, "--to", "exr", "--out", out) == 0
    found, given = exr.read_model(out / "parametric"), model()
    assert found.parameters == found.mixture.axes == ()
    random = np.random.default_rng(3)
    u, theta_r, offset = random.random((50, 3)), random.uniform(-1.5, 1.5, 50), random.uniform(-1, 1, 50)
    each = {"beta_m": 0.2, "absorption": 1.0}
    for ours, theirs in zip(
        found.sample(theta_r, 0.5, u, offset), given.sample(theta_r, 0.5, u, offset, each), strict=True
    ):
        np.testing.assert_allclose(ours, theirs, rtol=1e-5, atol=1e-6)
    assert all(report.ok for report in verify.verify(out))


@pytest.mark.parametrize("target", sorted(TARGETS))
def test_every_target_takes_fixed_parameters(directory, tmp_path, target):
    assert export(directory, "--at", "tilt=2", "--to", target, "--out", tmp_path / "out" / "file") == 0


@pytest.mark.parametrize(
    ("at", "said"),
    [
        (["beta=1"], "--at beta: the model has beta_m, absorption, tilt"),
        (["beta_m=0.95"], "--at beta_m=0.95: expected 0.1 to 0.9"),
        (["beta_m=nan"], "expected NAME=VALUE with a number"),
        (["beta_m"], "expected NAME=VALUE with a number"),
        (["beta_m=0.2", "beta_m=0.2"], "--at beta_m: is given twice"),
    ],
)
def test_wrong_values_are_refused(directory, tmp_path, at, said, capsys):
    given = [word for text in at for word in ("--at", text)]
    assert export(directory, *given, "--to", "exr", "--out", tmp_path / "out") == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_raw_floats_and_npz_carry_parameters(directory, tmp_path):
    given = model()
    for target in ("raw", "npz"):
        assert export(directory, "--to", target, "--out", tmp_path) == 0
    hair = json.loads((tmp_path / "parametric" / "hair.json").read_text())
    assert hair["parameters"] == [asdict(each) for each in given.parameters]
    head, read = stream(given)[: hair["head"]], np.fromfile(tmp_path / "parametric" / "hair.f32", "<f4")
    assert np.array_equal(read[: head.size], head.ravel())
    assert head[3 + 6 * 3, :3].tolist() == np.float32([0.1, 0.9, 0.3]).tolist()
    assert head[-1, [1, 3]].tolist() == [2, 2]  # the last axis: nodes of tilt, of the last lobe's theta
    for table in given.tables:
        sidecar = json.loads((tmp_path / "parametric" / f"{table.name}.json").read_text())
        assert (sidecar["height"], sidecar["width"]) == table.texels.shape
        with np.load(tmp_path / "parametric" / f"{table.name}.npz") as file:
            assert np.array_equal(file["texels"], table.texels)
            assert all(np.array_equal(file[f"nodes_{axis.name}"], axis.nodes) for axis in table.axes)


def test_single_tables_are_not_fixed(directory, tmp_path, capsys):
    path = directory / "tt_theta.exr"
    assert export(path, "--at", "beta_m=0.2", "--to", "npz", "--out", tmp_path) == 2
    assert "expected a directory" in capsys.readouterr().err


def test_a_model_without_parameters_has_none_to_fix(luts, tmp_path, capsys):
    assert export(luts / "fitted", "--at", "beta_m=0.2", "--to", "exr", "--out", tmp_path) == 2
    assert "the model has no parameters" in capsys.readouterr().err


def test_angles_that_would_round_to_one_float_are_set_apart():
    given = model()
    table = given.tables[0].at({"tilt": 0.0})
    x = table.texels.copy()
    x[:, 3:6] = x[:, 3:4] * (1 + np.array([0, 1e-12, 2e-12]))
    x[:, -3:-1] = x[:, -1:] * (1 - np.array([2e-12, 1e-12]))
    rounded = as_floats(replace(table, texels=x)).texels
    assert (np.diff(rounded, axis=1) >= 1e-12).all()
    np.testing.assert_allclose(rounded, x, atol=1e-6)
    np.testing.assert_array_equal(rounded[:, [0, -1]], np.float32(x[:, [0, -1]]))
    np.testing.assert_array_equal(as_floats(given.tables[0]).texels, given.tables[0].texels)


def test_a_model_over_parameters_is_verified(directory, monkeypatch):
    reports = verify.verify(directory)
    assert [report.problems for report in reports] == [[]] * 6
    assert "4 tables: densities integrate to 1 at 64 random parameters" in reports[-1].note
    sizes = {report.path.stem: report.size for report in reports[:-1]}
    assert sizes == {
        "mixture": "4x3x3x4",
        "r_theta": "9x5x2",
        "r_phi": "9x5x3x2",
        "tt_theta": "9x5x4x3",
        "tt_phi": "9x5",
    }
    read = interpolant.pdf
    monkeypatch.setattr(
        interpolant, "pdf", lambda *args: read(*args) * np.where(args[0].name == "r_phi", 1.001, 1)
    )
    (problem,) = [problem for report in verify.verify(directory) for problem in report.problems]
    assert "r_phi: the density integrates to 1.001" in problem
    assert "beta_m = " in problem


def test_a_table_of_another_bake_is_found(directory):
    path = directory / "r_theta.exr"
    table, errors = exr.read(path)
    exr.write(path, replace(table, slopes=table.slopes * np.float32(1.5)), errors)
    (problem,) = [problem for report in verify.verify(directory) for problem in report.problems]
    assert "different bakes" in problem


def test_a_model_of_lobes_does_not_depend_on_parameters(directory):
    for path in directory.iterdir():
        path.unlink()
    given = model()
    renamed = [replace(table, model="fitted") for table in given.tables]
    by_name = {table.name: table for table in renamed}
    lobes = [replace(x, theta=by_name[x.theta.name], phi=x.phi and by_name[x.phi.name]) for x in given.lobes]
    exr.write_model(directory, replace(given, name="fitted", lobes=tuple(lobes)))
    problems = [problem for report in verify.verify(directory) for problem in report.problems]
    assert any("the lobes of fitted depend on no parameters" in problem for problem in problems)


def test_inspect_says_on_what_a_file_depends(directory, capsys):
    assert main(["inspect", str(directory / "mixture.exr")]) == 0
    text = capsys.readouterr().out
    assert "beta_m      from 0.1 to 0.9, standard 0.3; 3 nodes here" in text
    assert "tilt        from -4 to 4, standard -1; no axis here" in text
    assert main(["inspect", str(directory / "tt_theta.exr")]) == 0
    assert "9x5 texels for each of 4 absorption x 3 beta_m" in capsys.readouterr().out
    assert main(["inspect", "--json", str(directory / "tt_theta.exr")]) == 0
    (report,) = json.loads(capsys.readouterr().out)
    assert report["axes"] == {"absorption": [0.0, 0.7, 1.5, 5.0], "beta_m": [0.1, 0.25, 0.9]}
    assert len(report["rows"]) == 60
