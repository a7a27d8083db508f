# SPDX-License-Identifier: BSD-3-Clause
"""The command: what it prints, its exit codes, and that a user's mistake is one line without a traceback."""

import json
import subprocess
import sys

import numpy as np
import pytest

from hairlut import cli, exr


def hairlut(*args, cwd=None):
    command = [sys.executable, "-m", "hairlut.cli", *map(str, args)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, check=False, timeout=120)


@pytest.fixture(scope="module")
def baked(tmp_path_factory):
    out = tmp_path_factory.mktemp("luts")
    done = hairlut("bake", "--size", "16x8", "--out", out)
    return done, out


def test_bake_writes_both_models_and_names_the_files(baked):
    done, out = baked
    assert (done.returncode, done.stderr) == (0, "")  # no progress bar where there is no terminal
    lines = done.stdout.splitlines()
    mixtures = [f"{out}/{model}/mixture.exr  direct, multiple" for model in ("printed", "fitted")]
    assert [line for line in lines if "mixture.exr" in line] == mixtures
    tables = [line for line in lines if "mixture.exr" not in line]
    assert len(tables) == 6
    for line in tables:
        path = out / line.split("  ")[0]
        table, errors = exr.read(path)
        assert (table.width, table.height) == (16, 8)
        assert f"{table.model}/{table.name}.exr" in line
        assert "relative_variance" in errors


def test_bake_is_deterministic(baked, tmp_path):
    _, out = baked
    hairlut("bake", "--size", "16x8", "--out", tmp_path, "--model", "fitted")
    files = sorted((tmp_path / "fitted").iterdir())
    assert [f.name for f in files] == [
        "direct_phi.exr",
        "direct_theta.exr",
        "mixture.exr",
        "multiple_theta.exr",
    ]
    for file in files:
        assert file.read_bytes() == (out / "fitted" / file.name).read_bytes()
    assert not (tmp_path / "printed").exists()


def test_bake_with_another_warp(tmp_path):
    done = hairlut("bake", "--size", "8x4", "--warp", "uniform", "--out", tmp_path)
    assert done.returncode == 0
    table, _ = exr.read(tmp_path / "printed" / "direct_phi.exr")
    assert str(table.warp) == "uniform"
    np.testing.assert_allclose(table.texels[0, 0], 0.0)


def test_inspect_prints_header_size_errors_and_rows(baked):
    _, out = baked
    path = out / "printed" / "direct_theta.exr"
    done = hairlut("inspect", path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "16x8 texels, 1024 bytes" in done.stdout
    assert "hairlut.domain          -1.5707963267948966 1.5707963267948966" in done.stdout
    assert "error.relative_variance" in done.stdout
    rows = done.stdout.splitlines()[-8:]
    assert rows[0].split()[:3] == ["0", "-90.0000", "1.539303e-08"]


def test_inspect_json(baked):
    _, out = baked
    path = out / "printed" / "direct_theta.exr"
    (report,) = json.loads(hairlut("inspect", path, "--json").stdout)
    table, errors = exr.read(path)
    assert (report["width"], report["height"], report["errors"]) == (16, 8, errors)
    assert report["header"]["hairlut.model"] == "printed"
    np.testing.assert_allclose([row["theta_r"] for row in report["rows"]], table.theta_r)
    np.testing.assert_allclose([row["mass"] for row in report["rows"]], np.exp(table.log_mass))
    narrowest = np.diff(table.texels.astype(float), axis=1).min(axis=1)
    np.testing.assert_array_equal([row["narrowest_cell"] for row in report["rows"]], narrowest)


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (["bake", "--model", "mine"], "'mine'"),
        (["bake", "--size", "64"], "expected WIDTHxHEIGHT"),
        (["bake", "--size", "3x9"], "size 3x9: expected a width of 4"),
        (["bake", "--size", "64x64", "--warp", "cubic"], "warp cubic"),
        (["bake", "--size", "64x64", "--cell", "cubic"], "cell cubic"),
        (["inspect", "nothing.exr"], "nothing.exr: no such file"),
        (["inspect"], "required"),
        (["export", "nowhere", "--to", "c", "--out", "a.c"], "nowhere: expected a directory"),
        (["export", "nowhere", "--to", "pdf", "--out", "a"], "pdf"),
        (["boil"], "invalid choice"),
        ([], "required"),
    ],
)
def test_wrong_use_is_one_message_and_exit_code_2(args, said, tmp_path):
    done = hairlut(*args, cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
    assert list(tmp_path.iterdir()) == []


def test_an_unwritable_place_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    done = hairlut("bake", "--size", "8x4", "--out", tmp_path / "file")
    assert done.returncode == 2
    assert "cannot be written" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("command", cli.COMMANDS)
def test_help_has_examples(command, capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main([command, "--help"])
    assert ended.value.code == 0
    text = capsys.readouterr().out
    assert "examples:" in text
    assert f"hairlut {command} " in text


def test_help_and_version(capsys):
    for argument, said in (("--help", "exit codes: 0"), ("--version", "hairlut 2.")):
        with pytest.raises(SystemExit) as ended:
            cli.main([argument])
        assert ended.value.code == 0
        assert said in capsys.readouterr().out


def test_every_command_module_is_listed():
    import pkgutil

    modules = {module.name for module in pkgutil.iter_modules(cli.__path__)} - {"__main__"}
    assert modules == set(cli.COMMANDS)
