# SPDX-License-Identifier: BSD-3-Clause
"""The shipped shaders against the C library, on every back end that this machine has."""

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from shaders import backends
from shaders.agreement import (
    DENSITIES,
    FIRST_PARAMETER,
    NUMBERS,
    ROOT,
    SAMPLES,
    Agreement,
    Reference,
    agreement,
    hard_records,
    random_records,
    scene,
)
from shaders.backends import BACKENDS, HERE, SHADERS
from shaders.models import MODELS, OCTAVES, SheetLobe, SheetModel, near_field, strands, theta

from hairlut import exr
from hairlut.mixture import constant
from hairlut.stream import stream

RANDOM = 20_000
SHIPPED = ["printed", "fitted", "brown"]
NAMES = [*MODELS, *SHIPPED]
_known: dict[str, tuple] = {}


def known(name: str) -> tuple:
    """(model, the C library's reading of it, its scene, records)"""
    if name not in _known:
        model = MODELS[name]() if name in MODELS else exr.read_model(ROOT / "luts" / name)
        every = 1 if name in MODELS else 8
        records = [hard_records(model)[::every], random_records(RANDOM, model)]
        _known[name] = model, Reference(model), scene(model), np.concatenate(records)
    return _known[name]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("backend", BACKENDS)
def test_agrees_with_c_on_random_and_hard_inputs(backend: str, name: str):
    _, reference, where, records = known(name)
    result = agreement(reference, records, BACKENDS[backend](where, records))
    print(backend, name, result)
    assert result.holds(), result


@pytest.mark.parametrize("seed", range(3))
def test_a_model_at_fixed_parameters_is_the_blend_of_its_textures(seed: int):
    """Lobes too. The parameters are those of the model: hairlut_model_at sets the standard values."""
    model, random = strands(), np.random.default_rng(seed)
    at = {each.name: float(np.float32(random.uniform(each.least, each.most))) for each in model.parameters}
    moved = replace(model, parameters=tuple(replace(p, standard=at[p.name]) for p in model.parameters))
    records = random_records(RANDOM, moved)
    records[:, FIRST_PARAMETER:] = list(at.values())
    result = agreement(Reference(model.at(at)), records, backends.run_cxx(scene(moved), records))
    assert result.holds(), result


def test_parameters_change_what_is_drawn():
    """Else the tests above would compare nothing."""
    _, _, where, records = known("strands")
    other = records[-2000:].copy()
    other[:, FIRST_PARAMETER:] = np.roll(other[:, FIRST_PARAMETER:], 1, axis=0)
    here, there = (backends.run_cxx(where, part) for part in (records[-2000:], other))
    for column in (SAMPLES["hair"], SAMPLES["hair"] + 1, DENSITIES["hair"], DENSITIES["given"]):
        assert (np.abs(here - there)[:, column] > 1e-2).mean() > 0.3


@pytest.mark.parametrize(
    ("name", "define", "lobes"),
    [
        ("near field", "HAIRLUT_PARAMETER_LIMIT=0", 16),
        ("near field", "HAIRLUT_LOBE_LIMIT=2", 2),
        ("strands", "HAIRLUT_PARAMETER_LIMIT=2", 16),
        ("strands", "HAIRLUT_LOBE_LIMIT=3", 3),
    ],
)
def test_a_lower_limit_leaves_out_what_is_beyond_it(name: str, define: str, lobes: int):
    """Lobes beyond the limit are as if their shares were 0; parameters beyond it have standard values."""
    model = MODELS[name]()
    records = random_records(2000, model)
    usual, limited = (
        backends.run_limited(stream(model), records, lobes, *defines) for defines in ((), (define,))
    )
    assert (limited > 0).any()
    assert np.array_equal(usual, limited)


def test_without_the_code_for_parameters_a_model_that_has_them_draws_nothing():
    records = random_records(100, strands())
    assert not backends.run_limited(stream(strands()), records, 16, "HAIRLUT_PARAMETER_LIMIT=0").any()


def test_a_shader_that_knows_no_parameters_draws_nothing():
    """It takes the negative number of lobes for none."""
    assert stream(strands())[0, 0] == -len(strands().lobes)


@pytest.mark.parametrize("language", ["glsl", "hlsl", "cuh", "wgsl"])
def test_shipped_file_is_made_of_the_body(language: str):
    """Else: python3 runtime/shaders/source/assemble.py"""
    assert (SHADERS / f"hairlut.{language}").read_text() == backends.assembler().assembled(language)


# One wrong step each; the comparison must notice all of them.
MUTANTS = {
    "slopes of the cell's own": ("hairlut_blend(below.z, above.z, rows.t) / cell.w", "1.0f"),
    "density of the fraction, not of u": ("draw.pdf = cell.h / abs(cell.w)", "draw.pdf = 1.0f / abs(cell.w)"),
    "rows blended with 8 bits": (
        "rows.t = r - float(rows.row)",
        "rows.t = floor((r - float(rows.row)) * 256.0f) / 256.0f",
    ),
    "upper tail not folded": (
        "knot.m = min(u, folded)",
        "knot.m = folded > u ? u : 1.0f - min(folded + 1e-7f, 1.0f)",
    ),
    "the low half in place of the high one": ("int column = high ? half_count + i : i;", "int column = i;"),
    "one key of a node": ("branch += hairlut_blend(keys.y", "branch += 1e38f + hairlut_blend(keys.y"),
    "keys of one row": ("hairlut_blend(keys.x, keys.z, t) <= x", "keys.x <= x"),
    "difference taken for sum": ("? relative - r : relative + r", "? relative + r : relative - r"),
    "NaN not told": ("return (hairlut_bits(x) & 0x7fffffffu) > 0x7f800000u", "return hairlut_bits(x) == 0u"),
    "cosine of the float pi/2": ("z * w * series - 4.37113883e-8f", "z * w * series"),
    "places from the start of the stream": (
        "axis.first = model.first + int(shape.x)",
        "axis.first = int(shape.x)",
    ),
    "shares not divided": ("hairlut_share(mixture, k) / total", "hairlut_share(mixture, k)"),
    "a lobe of share 0 drawn": ("if (share > 0.0f && below <= wanted)", "if (below <= wanted)"),
    "shares of the lower row": ("hairlut_blend(pair.share.x, pair.share.y, row.t)", "pair.share.x"),
    "linear in the offset": ("hairlut_asin(side * h)", "1.57079637f * side * h"),
    "longer arc": (
        "turn_low + column.t * hairlut_wrap(turn_high - turn_low, -hairlut_pi)",
        "turn_low + column.t * (turn_high - turn_low)",
    ),
    "sample not mirrored": ("side * (phi.x + turn)", "phi.x + turn"),
    "turn not mirrored": ("side * (phi.x + turn)", "side * phi.x + turn"),
    "density not mirrored": (
        "side * hairlut_relative_azimuth(lobe.phi, phi_r, phi_i) - turn",
        "hairlut_relative_azimuth(lobe.phi, phi_r, phi_i) - turn",
    ),
    "density not turned": ("phi_r, phi_i) - turn, 0.0f)", "phi_r, phi_i) - 0.0f * turn, 0.0f)"),
}
STRAND_MUTANTS = {
    "weights of the opposite corner": (
        "(c & 2) != 0 ? corners.t.y : 1.0f - corners.t.y",
        "(c & 2) != 0 ? 1.0f - corners.t.y : corners.t.y",
    ),
    "steps of one axis": ("steps += (c & 2) != 0 ? corners.step.y : 0.0f;", ""),
    "one node too few": (
        "corners.first * int(axis.y) + place.gap",
        "corners.first * (int(axis.y) - 1) + place.gap",
    ),
    "parameters by the axis' number": (
        "hairlut_parameter(model, int(axis.w))",
        "hairlut_parameter(model, a)",
    ),
    "corners of the azimuth for theta_i": (
        "hairlut_axis_at(model, at, hairlut_corners_of(model, 1 + 2 * k))",
        "hairlut_axis_at(model, at, hairlut_corners_of(model, 2 + 2 * k))",
    ),
    "corners of the mixture for the azimuth": (
        "hairlut_axis_at(model, at + 3, hairlut_corners_of(model, 2 + 2 * k))",
        "hairlut_axis_at(model, at + 3, hairlut_corners_of(model, 0))",
    ),
    "keys of the lowest corner": (
        "HAIRLUT_FETCH(source, first + corner.at + node)",
        "HAIRLUT_FETCH(source, first + corners.first + node)",
    ),
    "turns along the longer arc": (
        "arc.x = hairlut_wrap(turn.x - lowest.x, -hairlut_pi)",
        "arc.x = turn.x - lowest.x",
    ),
    "standard values": ("strand.parameters = parameters;", "(void)parameters;"),
    "NaN among parameters": ("&& hairlut_parameters_known(model);", ";"),
    "not clamped": (
        "place.t = clamp((x - node.x) * node.y, 0.0f, 1.0f);",
        "place.t = (x - node.x) * node.y;",
    ),
}


def mutated(folder: Path, right: str, wrong: str) -> Path:
    shipped = (SHADERS / "hairlut.cuh").read_text()
    assert shipped.count(right) == 1
    (folder / "hairlut.cuh").write_text(shipped.replace(right, wrong))
    return folder


@pytest.mark.parametrize("mutant", MUTANTS)
def test_comparison_rejects_a_body_with_one_wrong_step(mutant: str, tmp_path: Path):
    _, reference, where, records = known("near field")
    records = records[: -RANDOM + 2000]
    got = backends.run_cxx(where, records, mutated(tmp_path, *MUTANTS[mutant]))
    try:
        result = agreement(reference, records, got)
    except AssertionError:
        return
    assert not result.holds(), result


@pytest.mark.parametrize("mutant", STRAND_MUTANTS)
def test_comparison_rejects_one_wrong_step_with_parameters(mutant: str, tmp_path: Path):
    _, reference, where, records = known("strands")
    records = records[:: len(records) // 20_000]
    got = backends.run_cxx(where, records, mutated(tmp_path, *STRAND_MUTANTS[mutant]))
    try:
        result = agreement(reference, records, got)
    except AssertionError:
        return
    assert not result.holds(), result


def test_comparison_rejects_one_wrong_density_and_one_wrong_number():
    """The tolerances themselves: C's own results, one value of one record moved."""
    model = near_field()
    reference, records = Reference(model), random_records(1000, model)
    got = reference(records)
    assert agreement(reference, records, got) == Agreement(1000, 0.0, pytest.approx(0, abs=2e-7), 0.0, 0)
    for column in (SAMPLES["lobe"] + 2, SAMPLES["hair"] + 3, DENSITIES["given"]):
        off = got.copy()
        off[7, column] *= 1 + 2e-4
        assert not agreement(reference, records, off).holds()
    off = got.copy()
    off[7, NUMBERS[0]] = 1 - off[7, NUMBERS[0]]
    assert not agreement(reference, records, off).holds()


def test_fetches_are_those_of_the_readme():
    """An axis: a column and two cells, and for a density three texels of the search up to 28 columns, four up
    to 82. The mixture of 6 theta_r and 5 offsets: two texels of a search and a node on each axis, then two
    texels a lobe."""
    column, cells, search = 1, 2, {44: 4, 33: 4, 24: 3, 28: 3}
    pdf = {width: column + cells + steps for width, steps in search.items()}
    counts = backends.count_fetches(scene(near_field()))
    assert counts["sample_lobe"] == 2 * (column + cells)
    assert counts["pdf_lobe"] == pdf[44] + pdf[33]
    assert counts["mixture"] == 2 * (2 + 1) + 2 * 3
    assert counts["sample_hair"] == 2 * (column + cells) + pdf[44] + pdf[33] + pdf[44]
    assert counts["pdf_hair"] == pdf[44] + pdf[33] + pdf[24] + pdf[28] + pdf[44]
    readme = (SHADERS / "README.md").read_text()
    models = {name: exr.read_model(ROOT / "luts" / name) for name in ("fitted", "brown")}
    for name, model in (models | {"strands": strands()}).items():
        counts = backends.count_fetches(scene(model))
        numbers = " | ".join(str(count) for count in counts.values())
        assert f"| `{name}` | {numbers} |" in readme, "change the table of runtime/shaders/README.md"


def test_example_of_the_readme_is_the_layout():
    sheet = theta(5, 3, OCTAVES)
    lobe = SheetLobe("only", sheet, None)
    texels = stream(SheetModel("example", (lobe,), constant(("only",))))
    assert len(texels) == 1024
    assert texels[0].tolist() == [1, 0, 11, 35]
    assert texels[1:3].tolist() == [[9, 1, 0, 0], [10, 1, 0, 0]]
    assert texels[3].tolist() == [13, 5, 3, 4]
    assert not texels[6:9].any()
    assert texels[11, :].tolist() == [1, 1, 1, 1]
    near, far = sheet.texels[2, [3, 2]]
    assert texels[26, :2].tolist() == [near, far - near]
    assert texels[27 + 4, [0, 2]].tolist() == sheet.texels[1:, 3].tolist()
    assert (texels[34] == np.float32(1e38)).all()
    assert not texels[35:].any()


def test_compiles_as_cuda(tmp_path: Path):
    """By nvcc, or by clang without the toolkit: to PTX for the device, and for the host. No GPU runs it
    here."""
    out = tmp_path / "kernel.ptx"
    common = ["-std=c++17", f"-I{SHADERS}", f"-I{HERE}", str(HERE / "kernel.cu")]
    if shutil.which("nvcc"):
        commands = [["nvcc", "-ptx", "-o", str(out), *common]]
    else:
        clang = [
            backends.tool("clang++", "clang"),
            "-x",
            "cuda",
            "-nocudainc",
            "-nocudalib",
            "-Wall",
            "-Wextra",
            "-Werror",
        ]
        clang += ["-include", str(HERE / "cuda_stub.h"), *common]
        device = ["--cuda-device-only", "--cuda-gpu-arch=sm_70", "-O1", "-S", "-o", str(out)]
        commands = [[*clang, *device], [*clang, "--cuda-host-only", "-fsyntax-only"]]
    for command in commands:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    assert ".entry" in out.read_text()
