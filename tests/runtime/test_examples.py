# SPDX-License-Identifier: BSD-3-Clause
"""The examples compile and show what they say."""

import dataclasses
import re

import pytest
from runtime.c_library import MODELS, ROOT, RUNTIME, build, run

from hairlut import exr
from runtime import strands


def test_quickstart_prints_one_direction_and_its_density():
    text = run(build() / "quickstart").stdout
    solid_angle, angle = map(float, re.findall(r"([\d.]+) per (?:sr|rad)", text))
    assert 0 < angle < solid_angle


def test_quickstart_is_ten_lines_of_main():
    body = (RUNTIME / "examples" / "quickstart.c").read_text().partition("int main")[2].splitlines()
    assert len(body) <= 10


@pytest.mark.usefixtures("loader")
def test_samples_from_files_are_the_compiled_in_ones():
    text = run(build() / "print_samples", *(ROOT / "luts" / model for model in MODELS)).stdout
    blocks = {re.split(r"[ /]", block.splitlines()[0])[-1] + block[:3]: block.splitlines()[1:]
              for block in text.split("\n\n")[1:]}  # fmt: skip
    assert len(blocks) == 4
    for model in MODELS:
        assert blocks[f"{model}com"] == [line.rstrip() for line in blocks[f"{model}fil"]]
        assert len(re.findall(r"\d\.\d+e[-+]\d\d", "\n".join(blocks[f"{model}com"]))) == 6


@pytest.mark.usefixtures("loader")
def test_a_missing_directory_is_an_error_with_its_name():
    with pytest.raises(AssertionError, match=r"no/such/mixture.exr: cannot be opened"):
        run(build() / "print_samples", "no/such")


@pytest.mark.usefixtures("loader")
def test_strand_draws_with_each_roughness(tmp_path):
    hair = dataclasses.replace(strands.baked(), name="brown")  # as its tables say
    exr.write_model(tmp_path, hair)
    lines = run(build() / "strand", tmp_path).stdout.splitlines()
    shown = [list(map(float, re.findall(r"-?\d+\.\d+", line))) for line in lines]
    (beta_m,) = (p for p in hair.parameters if p.name == "beta_m")
    steps = [beta_m.least + k / 4 * (beta_m.most - beta_m.least) for k in range(5)]
    assert [row[0] for row in shown] == pytest.approx(steps, abs=1e-3)
    assert len({row[1] for row in shown}) == 5
    for _, theta_i, pdf, light in shown:
        sampled = 1e-4 + hair.lobes[0].theta.domain[1]
        assert abs(theta_i) < sampled
        assert pdf > 0
        assert light > 0


@pytest.mark.usefixtures("loader")
def test_strand_refuses_a_missing_directory():
    with pytest.raises(AssertionError, match=r"no/such/mixture\.exr: cannot be opened"):
        run(build() / "strand", "no/such")
