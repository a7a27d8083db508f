# SPDX-License-Identifier: BSD-3-Clause
"""The README does what it says: its C compiles, its Python runs, its figures are those of the files."""

import re

import numpy as np
import pytest
from runtime.c_library import FLAGS, ROOT, RUNTIME, build, run, tool

from hairlut import exr, mixturefile

README = (ROOT / "README.md").read_text()
LUTS = ROOT / "luts"
PROGRAM = """
static float bsdf(float theta_i, float phi_i) {{ return 0.0f * theta_i * phi_i + 1.0f; }}
static float light(float theta_i, float phi_i) {{ return 0.0f * theta_i * phi_i + 1.0f; }}
int main(void)
{{
    const float theta_r = 0.3f, phi_r = 1.0f, offset = 0.2f, u_lobe = 0.1f, u_theta = 0.25f, u_phi = 0.75f;
    const float theta_i = -0.3f, phi_i = 2.0f;
    float estimate = 0.0f;
    {body}
    return !(estimate > 0.0f && q > 0.0f && per_steradian > q);
}}
"""


def fences(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def test_c_compiles_and_runs(tmp_path):
    (code,) = fences("c")
    first, body = code.split("\n", 1)
    source = tmp_path / "readme.c"
    source.write_text(f"#include <math.h>\n{first}\n{PROGRAM.format(body=body)}")
    out = tmp_path / "readme"
    include = f"-I{RUNTIME / 'include'}"
    run(tool("cc") or tool("gcc"), *FLAGS, include, source, build() / "libhairlut.a", "-lm", "-o", out)
    run(out)


def test_python_runs(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    sample, _ = fences("python")
    exec(sample, {})
    difference = float(capsys.readouterr().out.splitlines()[-1])
    assert difference < 1e-3


def test_own_hair_can_be_evaluated():
    _, own = fences("python")
    names: dict = {}
    exec(own, names)
    value = names["bsdf"](np.zeros((2, 1)), np.linspace(-1, 1, 5), 3.0)
    assert value.shape == (2, 5)
    assert (value > 0).all()


@pytest.mark.parametrize("model", ["printed", "fitted"])
def test_shipped_tables_are_as_good_as_the_readme_says(model):
    limit, least, most = re.search(r"V <= (\S+), (\d+) to (\d+) KB of texels", README).groups()
    for path in (LUTS / model).glob("*_*.exr"):
        table, errors = exr.read(path)
        assert errors["relative_variance"] <= float(limit)
        assert int(least) <= (table.texels.nbytes + table.slopes.nbytes) / 1000 <= int(most)


def test_brown_is_as_good_as_the_readme_says():
    figures = re.search(r"V = ([\d.]+), at most ([\d.]+) for any viewer; no weight above ([\d.]+)", README)
    names = ("relative_variance", "worst_viewer_relative_variance", "largest_weight")
    errors = mixturefile.read(LUTS / "brown" / "mixture.exr").errors
    for text, name in zip(figures.groups(), names, strict=True):
        assert f"{errors[name]:.{len(text.partition('.')[2])}f}" == text, name
