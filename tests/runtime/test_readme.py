# SPDX-License-Identifier: BSD-3-Clause
"""The README does what it says: its C compiles, its Python runs, its figures are those of the files."""

import re

import numpy as np
import pytest
from runtime.c_library import FLAGS, ROOT, RUNTIME, build, run, tool

from hairlut import exr, mixturefile
from hairlut.fit import bsdf
from precompute import parametric

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


def compile_and_run(first: str, body: str, tmp_path):
    source = tmp_path / "readme.c"
    source.write_text(f"#include <math.h>\n{first}\n{PROGRAM.format(body=body)}")
    out = tmp_path / "readme"
    include = f"-I{RUNTIME / 'include'}"
    run(tool("cc") or tool("gcc"), *FLAGS, include, source, build() / "libhairlut.a", "-lm", "-o", out)
    run(out)


def test_c_compiles_and_runs(tmp_path):
    code, _ = fences("c")
    compile_and_run(*code.split("\n", 1), tmp_path)


def test_c_of_strands_compiles_and_runs(tmp_path):
    whole, strands = fences("c")
    first, hair = whole.split("\n", 1)
    values = "const float beta_m = 0.2f, absorption = 0.5f;\n"
    rest = "estimate += s.pdf_solid_angle;\nfloat per_steradian = hairlut_pdf_to_solid_angle(q, theta_i);\n"
    rest += "(void)bsdf;\n(void)light;\n"
    compile_and_run(first, hair.split("\n\n")[0] + "\n" + values + strands + rest, tmp_path)


def test_python_runs(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    exec(fences("python")[0], {})
    difference = float(capsys.readouterr().out.splitlines()[-1])
    assert difference < 1e-3


def test_python_of_strands_runs(monkeypatch, tmp_path):
    sample, _, _, strands = fences("python")
    names: dict = {}
    monkeypatch.chdir(ROOT)
    exec(sample, names)
    exr.write_model(tmp_path / "luts" / "my_strands", parametric.model())
    monkeypatch.chdir(tmp_path)
    exec(strands, names)
    given = names["s"].pdf_angle
    assert names["q"] == pytest.approx(given, rel=1e-3)
    others = names["hair"].pdf(0.3, 1.0, names["s"].theta_i, names["s"].phi_i)
    assert np.median(abs(others / given - 1)) > 0.01


def test_own_hair_can_be_evaluated():
    names: dict = {}
    exec(fences("python")[1], names)
    value = names["bsdf"](np.zeros((2, 1)), np.linspace(-1, 1, 5), 3.0)
    assert value.shape == (2, 5)
    assert (value > 0).all()


def test_own_strands_can_be_evaluated(tmp_path):
    path = tmp_path / "my_strands.py"
    path.write_text(fences("python")[2])
    own = bsdf.load(path)
    names = [parameter.name for parameter in own.parameters]
    assert f"const float strand[] = {{{', '.join(names)}}};" in fences("c")[1]
    value = own.density(0.3, np.linspace(-1.5, 1.5, 5), 3.0, 0.0, **dict.fromkeys(names, 0.5))
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


def test_the_model_over_parameters_is_as_good_as_the_readme_says():
    page = (ROOT / "tests" / "report" / "pages" / "parameters.md").read_text()
    (row,) = re.findall(r"^\| 0\.01 \| (\d+) \| \d+ \| (\S+) \| \S+ \| (\S+) \| (\S+) \|", page, re.MULTILINE)
    size, *samples = re.search(
        r"one model of (\d+) KB.* \| (\S+) times the samples of the authors' sampler in the median, "
        r"(\S+) at the 99th percentile, (\S+) at worst",
        README,
    ).groups()
    assert [size, *samples] == [row[0], *(f"{float(number):.3f}" for number in row[1:])]


def test_the_rendered_strands_are_as_good_as_the_readme_says():
    page = (ROOT / "tests" / "report" / "pages" / "strands.md").read_text()
    (count,) = re.findall(r"^of the (\d+) strands has", page, re.MULTILINE)
    rows = re.findall(
        r"^\| [\w ]+ \| one model (over|for)[\w ]* \| \S+ \| (\S+) \| (\S+) \|", page, re.MULTILINE
    )
    by_kind = {
        kind: [(samples, time) for which, samples, time in rows if which == kind] for kind in ("over", "for")
    }
    samples, times = zip(*by_kind["over"], strict=True)
    grouped, _ = zip(*by_kind["for"], strict=True)
    figures = re.search(
        r"whose (\d+) strands.* \| (\S+) to (\S+) times those of its authors' sampler, "
        r"each at (\S+) to (\S+) times the cost; (\S+) to (\S+) times from",
        README,
    )
    numbers = [count, *(f"{end(map(float, n)):.2f}" for n in (samples, times, grouped) for end in (min, max))]
    assert list(figures.groups()) == numbers
