# SPDX-License-Identifier: BSD-3-Clause
"""precompute/README.md does what it says: its Python and its commands run, in order, in one directory.

The fits are given a looser tolerance and a smaller budget than the page's commands have, to be quick."""

import re
import shlex

import numpy as np
import pytest

from hairlut import config, exr
from hairlut.cli import main
from precompute.conftest import LUTS, ROOT

pytest.importorskip("hairlut._core", reason="the extension is not built")

README = (ROOT / "precompute" / "README.md").read_text()
QUICK = {"my_hair.py": ("--tolerance", "0.1"), "my_strands.py": ("--tolerance", "0.2", "--budget", "5")}


def python(first: str) -> str:
    """The block of Python that begins with this line."""
    (block,) = re.findall(rf"```python\n({re.escape(first)}\n.*?)```", README, re.DOTALL)
    return block


def commands(program: str) -> list[list[str]]:
    """The words that follow this program in the page's indented commands."""
    return [shlex.split(line) for line in re.findall(rf"^    {program} (.*)$", README, re.MULTILINE)]


@pytest.fixture(scope="module")
def sampled():
    """Names of the first block, run with an f whose integral is known: f cos(theta_i) is the density."""
    names: dict = {}

    def f(theta_i, phi_i):
        return names["q"] / np.cos(theta_i) ** 2

    names["f"] = f
    block = python("import numpy as np").replace("luts/brown", str(LUTS / "brown"))
    exec(block, names)
    return names


@pytest.fixture(scope="module")
def fitted(tmp_path_factory):
    """The directory in which the page's two files were fitted by its own commands."""
    folder = tmp_path_factory.mktemp("readme")
    words = commands("hairlut fit")
    assert {name for name, *_ in words} == set(QUICK)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for name, *options in words:
            (folder / name).write_text(python(f"# {name}"))
            assert main(["fit", name, *options, *QUICK[name]]) == 0
    return folder


def test_its_estimate_is_the_integral(sampled):
    assert np.allclose(sampled["q"], sampled["s"].pdf_angle, rtol=1e-3)
    assert sampled["estimate"] == pytest.approx(1, rel=1e-3)


def test_its_hair_is_fitted(fitted):
    assert exr.read_model(fitted / "luts" / "my_hair").errors["mixture"]["relative_variance"] < 0.02


def test_its_strands_are_fitted_and_sampled(fitted, sampled, monkeypatch):
    monkeypatch.chdir(fitted)
    names = dict(sampled)
    exec(python('hair = hairlut.load("luts/my_strands")'), names)
    hair, s = names["hair"], names["s"]
    assert list(hair.parameters) == ["width", "backward"]
    own = hair.pdf(0.3, 1.0, s.theta_i, s.phi_i, width=0.12, backward=0.8)
    assert np.allclose(own, s.pdf_angle, rtol=1e-3)
    assert np.median(abs(hair.pdf(0.3, 1.0, s.theta_i, s.phi_i) / own - 1)) > 0.1  # those of standard strands


def test_its_commands_are_those_of_the_program(capsys):
    table = re.findall(r"`hairlut (\w+)", README)
    assert {"fit", "bake", "verify", "inspect", "export", "view", "plot"} <= set(table)
    for name in set(table):
        with pytest.raises(SystemExit, match="0"):
            main([name, "--help"])
        options = capsys.readouterr().out
        for option in re.findall(rf"`hairlut {name} [^`]*?(--\w+)", README):
            assert option in options


def test_its_folders_exist(capsys):
    (options,) = [words for words in commands("python -m hairlut.config") if "--luts-dir" in words]
    assert config.main(options) in (0, None)
    assert len(capsys.readouterr().out.split()) == len(options)
