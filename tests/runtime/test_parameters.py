# SPDX-License-Identifier: BSD-3-Clause
"""Models over parameters of the hair: files through the C loader, the Python binding and exported C are one
model, which is the numpy reading's up to the rounding of floats."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

import hairlut
from hairlut import exr
from hairlut.cli import main
from hairlut.errors import HairlutError
from hairlut.model import BakedModel
from hairlut.sampler import Model, Sample
from precompute import parametric

pytest.importorskip("hairlut._core", reason="hairlut was installed without its C library")

from runtime.c_library import BUILD, ROOT, has_exr, run

from runtime import c_library

N = 5000  # more than a block of the binding
ORDER = [parameter.name for parameter in parametric.PARAMETERS]


@pytest.fixture(scope="module")
def directory(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("files") / "parametric"
    exr.write_model(path, parametric.model())
    return path


@pytest.fixture(scope="module")
def baked(directory) -> BakedModel:
    return exr.read_model(directory)


@pytest.fixture(scope="module")
def hair(directory) -> Model:
    return hairlut.load(directory)


def inputs(n: int = N) -> dict[str, np.ndarray]:
    random = np.random.default_rng(4)
    return {
        "theta_r": random.uniform(-1.6, 1.6, n).astype(np.float32),
        "phi_r": random.uniform(-3, 3, n).astype(np.float32),
        "u": random.random((n, 3), np.float32),
        "offset": random.uniform(-1, 1, n).astype(np.float32),
    }


def strands(n: int = N) -> dict[str, np.ndarray]:
    """Random parameters, some beyond their range, some on nodes."""
    given = {name: value.astype(np.float32) for name, value in parametric.values(n).items()}
    for name, nodes in parametric.NODES.items():
        given[name][: len(nodes)] = nodes
    return given


def test_draws_and_densities_are_those_of_the_numpy_reading(hair, baked):
    x, strand = inputs(), strands()
    s = hair.sample(**x, **strand)
    double = {name: value.astype(float) for name, value in strand.items()}
    theta_i, phi_i, density = baked.sample(
        x["theta_r"], x["phi_r"], x["u"].astype(float), x["offset"], double
    )
    same = abs(s.theta_i - theta_i) < 1e-3  # not those of which rounding chose the lobe
    assert same.mean() > 0.999
    np.testing.assert_allclose(s.theta_i[same], theta_i[same], atol=2e-5)
    np.testing.assert_allclose(np.cos(s.phi_i[same] - phi_i[same]), 1, atol=1e-6)
    np.testing.assert_allclose(s.pdf_angle[same], density[same], rtol=2e-3)
    random = np.random.default_rng(9)
    there = random.uniform(-1.5, 1.5, N).astype(np.float32), random.uniform(-3, 3, N).astype(np.float32)
    found = hair.pdf(x["theta_r"], x["phi_r"], *there, x["offset"], **strand)
    expected = baked.pdf(x["theta_r"], x["phi_r"], *there, x["offset"], double)
    np.testing.assert_allclose(found, expected, rtol=1e-3)


def test_parameters_matter(hair):
    """So that the comparison above can fail."""
    x, strand = inputs(), strands()
    for name in ORDER:
        moved = strand | {name: strand[name][::-1]}
        changed = hair.sample(**x, **moved).pdf_angle != hair.sample(**x, **strand).pdf_angle
        assert changed.mean() > 0.3, name


def test_parameters_broadcast_and_default_to_standard_values(hair, baked):
    x = inputs(100)
    standard = {p.name: p.standard for p in baked.parameters}
    for given in ({"tilt": -1.0}, standard):
        np.testing.assert_allclose(hair.sample(**x, **given).pdf_angle, hair.sample(**x).pdf_angle, rtol=1e-5)
        same = hair.sample(**x, **given).pdf_angle == hair.sample(**x, **standard).pdf_angle
        assert same.all()
    grid = hair.pdf(0.2, 0.1, 0.3, 1.0, beta_m=[[0.1], [0.5]], tilt=[0.0, 1.0, 2.0])
    assert grid.shape == (2, 3)
    assert grid[1, 2] == hair.pdf(0.2, 0.1, 0.3, 1.0, tilt=2.0, beta_m=0.5)
    assert len(np.unique(grid)) == 6
    shares = hair.sample(**x, shares=(0.0, 1.0, 0.0), absorption=np.linspace(0, 5, 100)).pdf_angle
    assert (shares > 0).all()


def test_parameters_are_clamped_and_no_number_has_density_0(hair):
    x = inputs(10)
    for name, (least, most, _) in hair.parameters.items():
        for beyond, end in ((least - 1, least), (-np.inf, least), (most + 1, most), (1e38, most)):
            found = hair.sample(**x, **{name: beyond}).pdf_angle
            np.testing.assert_array_equal(found, hair.sample(**x, **{name: end}).pdf_angle)
        s = hair.sample(**x, **{name: np.nan})
        assert not s.pdf_angle.any()
        assert np.isfinite([s.theta_i, s.phi_i]).all()


def test_what_a_model_says_of_its_parameters(hair):
    assert hair.parameters == {"beta_m": (0.1, 0.9, 0.3), "absorption": (0.0, 5.0, 0.5), "tilt": (-4, 4, -1)}
    with pytest.raises(HairlutError, match="parameter 'beta': model parametric has beta_m, absorption, tilt"):
        hair.pdf(0.0, 0.0, 0.0, 0.0, beta=0.3)
    for wrong in (None, "0.3", 1j):
        with pytest.raises(HairlutError, match=r"parameter 'beta_m': is .*, expected real numbers"):
            hair.pdf(0.0, 0.0, 0.0, 0.0, beta_m=wrong)
    with pytest.raises(HairlutError, match="parameter 'self'"):
        hair.sample(0.0, 0.0, (0.1, 0.2, 0.3), self=0.3)
    assert hairlut.builtin("brown").parameters == {}
    with pytest.raises(HairlutError, match="parameter 'beta_m': model brown has no parameters"):
        hairlut.builtin("brown").sample(0.0, 0.0, (0.1, 0.2, 0.3), beta_m=0.3)


@pytest.mark.skipif(not has_exr(), reason="hairlut_exr is not built")
def test_the_c_loader_reads_the_same_model(hair, directory):
    x, strand = inputs(), strands()
    loaded = c_library.load(directory)
    numbers = np.stack([strand[name] for name in ORDER], axis=-1)
    found = loaded.sample_strand(numbers, x["theta_r"], x["phi_r"], *x["u"].T, x["offset"])
    s = hair.sample(**x, **strand)
    for field in Sample._fields:
        np.testing.assert_array_equal(found[field], getattr(s, field))


PROGRAM = """
#include <stdio.h>
#include "hairlut.h"
extern const hairlut_model_desc hairlut_parametric_desc;
int main(void)
{
    char message[HAIRLUT_MESSAGE_SIZE];
    hairlut_model *made = NULL;
    if (hairlut_model_create(&hairlut_parametric_desc, NULL, &made, message) != HAIRLUT_OK)
        return puts(message), 1;
    for (int k = 0; k < 9; ++k) {
        const float strand[] = {0.1f * k, 0.6f * k, k - 4.5f};
        const float u = 0.1f + 0.1f * k;
        const float v = 1 - u, w = 0.5f * u;
        const hairlut_sample s = hairlut_sample_strand(made, strand, NULL, 0.2f, 0.3f, 0.4f, u, v, w);
        printf("%.9g\\n", s.pdf_angle);
    }
    hairlut_free(made);
    return 0;
}
"""


def test_exported_c_is_the_same_model(hair, directory, tmp_path):
    assert main(["export", str(directory), "--to", "c", "--out", str(tmp_path / "tables.c")]) == 0
    (tmp_path / "main.c").write_text(PROGRAM)
    library = BUILD / "runtime"
    flags = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-I{ROOT / 'runtime' / 'include'}")
    program = tmp_path / "program"
    run("cc", *flags, tmp_path / "main.c", tmp_path / "tables.c", "-o", program, f"-L{library}", "-lhairlut",
        f"-Wl,-rpath,{library}")  # fmt: skip
    found = [float(line) for line in subprocess.check_output([program], text=True).split()]
    k = np.arange(9, dtype=np.float32)
    u = np.float32(0.1) + np.float32(0.1) * k
    strand = {"beta_m": np.float32(0.1) * k, "absorption": np.float32(0.6) * k, "tilt": k - np.float32(4.5)}
    draws = np.stack([u, 1 - u, np.float32(0.5) * u], axis=-1)
    s = hair.sample(np.float32(0.2), np.float32(0.3), draws, np.float32(0.4), **strand)
    np.testing.assert_allclose(found, s.pdf_angle, rtol=1e-6)


def test_compiled_in_models_have_no_parameters(directory):
    c_library.build()
    c_library.cmake(ROOT / "runtime", BUILD / "runtime", "-DCMAKE_BUILD_TYPE=Release", targets=("embed",))
    done = subprocess.run(
        [BUILD / "runtime" / "embed", directory], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert not done.stdout
    assert f"embed: {directory}: depends on the parameter beta_m" in done.stderr
    assert "--at NAME=VALUE" in done.stderr
