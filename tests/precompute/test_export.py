# SPDX-License-Identifier: BSD-3-Clause
"""The C source of exported models: plain numbers against the public header, and the loader's model."""

import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from hairlut import export, exr
from hairlut.errors import HairlutError
from precompute.conftest import ROOT

HEADERS = ROOT / "runtime" / "include"
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Werror")
MODELS = ("printed", "fitted", "brown")
LIBRARY = ROOT / "build" / "runtime" / "libhairlut.so"

PROGRAM = """
#include <stdio.h>
#include "hairlut.h"
extern const hairlut_model_desc hairlut_brown_desc;
int main(void)
{
    char message[HAIRLUT_MESSAGE_SIZE];
    hairlut_model *made = NULL;
    if (hairlut_model_create(&hairlut_brown_desc, NULL, &made, message) != HAIRLUT_OK)
        return puts(message), 1;
    for (int k = 0; k < 7; ++k) {
        const float u = 0.1f + 0.13f * k;
        const float theta_r = 0.9f - 0.2f * k, offset = 0.31f * k - 0.9f;
        const hairlut_sample s = hairlut_sample_hair(made, NULL, theta_r, 0.3f, offset, u, 1 - u, 0.5f * u);
        printf("%.9g %.9g %.9g\\n", s.theta_i, s.phi_i, s.pdf_angle);
    }
    hairlut_free(made);
    return 0;
}
"""


@pytest.fixture(scope="module")
def source(luts, tmp_path_factory):
    out = tmp_path_factory.mktemp("c") / "new" / "tables.c"
    export.export([luts / name for name in MODELS], "c", out)
    return out


def floats(text):
    return np.array([float(word.rstrip("f")) for word in re.split(r"[,\s]+", text) if word]).astype(
        np.float32
    )


def array(text, name):
    return floats(re.search(rf"static const float {name}\[\d+\] = \{{\n(.*?)\}};", text, re.DOTALL)[1])


@pytest.mark.parametrize(
    ("compiler", "language"),
    [("gcc", "-std=c99"), ("clang", "-std=c99"), ("g++", "-xc++"), ("clang++", "-xc++")],
)
def test_it_compiles_with_the_installed_headers_alone(source, tmp_path, compiler, language):
    if not shutil.which(compiler):
        pytest.skip(f"{compiler} is not installed")
    installed = tmp_path / "include"
    installed.mkdir()
    for header in HEADERS.glob("*.h"):
        shutil.copy(header, installed)
    target = "-c", source, "-o", tmp_path / "a.o"
    command = [compiler, language, *WARNINGS, f"-I{installed}", *target]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(not LIBRARY.exists(), reason="the library is not built: make build")
@pytest.mark.skipif(not shutil.which("gcc"), reason="gcc is not installed")
def test_the_compiled_model_draws_what_the_loaded_one_does(source, luts, tmp_path):
    program = tmp_path / "main.c"
    program.write_text(PROGRAM)
    libraries = f"-L{LIBRARY.parent}", "-lhairlut", f"-Wl,-rpath,{LIBRARY.parent}", "-lm"
    command = ["gcc", "-std=c99", f"-I{HEADERS}", program, source, *libraries, "-o", tmp_path / "main"]
    subprocess.run(command, check=True)
    printed = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout
    found = np.array([[float(word) for word in line.split()] for line in printed.splitlines()])
    k = np.arange(7)
    u = 0.1 + 0.13 * k
    model = exr.read_model(luts / "brown")
    expected = model.sample(0.9 - 0.2 * k, 0.3, np.stack([u, 1 - u, 0.5 * u], axis=-1), 0.31 * k - 0.9)
    np.testing.assert_allclose(found, np.stack(expected, axis=-1), rtol=2e-4, atol=1e-5)


def test_texels_are_pairs_of_angle_and_slope(source, shipped):
    table, path, _, _ = shipped
    text = source.read_text(encoding="ascii")
    head = (
        rf"static const hairlut_table hairlut_{path.parent.name}_{table.name} = \{{sizeof\(hairlut_table\), "
    )
    rest = rf"(\w+), {table.width}, {table.height}, (.*?), HAIRLUT_WARP_OCTAVES, (.*?), 0, NULL\}};"
    name = re.search(head + rest, text)
    pairs = np.stack([table.texels, table.slopes], axis=-1)
    np.testing.assert_array_equal(array(text, name[1]), pairs.ravel())
    np.testing.assert_array_equal(floats(name[2]), np.float32([*table.theta_r_range, *table.domain]))
    assert floats(name[3]) == [np.float32(table.warp.e)]


def test_the_mixture_stands_in_it(source, luts):
    text = source.read_text(encoding="ascii")
    mixture = exr.read_model(luts / "brown").mixture
    for name in ("theta_r", "offset", "share", "turn"):
        values = getattr(mixture, name)
        np.testing.assert_array_equal(array(text, f"hairlut_brown_{name}"), np.float32(values).ravel())
    assert re.search(
        rf"hairlut_brown_mixture = \{{sizeof\(hairlut_mixture_desc\), {len(mixture.theta_r)}, "
        rf"{len(mixture.offset)}, .*, {int(mixture.mirrored)}, 0, NULL\}};",
        text,
    )


def test_texels_that_are_equal_stand_in_it_once(luts, tmp_path):
    model = exr.read_model(luts / "fitted")
    lobes = tuple(
        replace(
            lobe, theta=replace(lobe.theta, model="twin"), phi=lobe.phi and replace(lobe.phi, model="twin")
        )
        for lobe in model.lobes
    )
    twin = replace(model, name="twin", errors={}, lobes=lobes)
    exr.write_model(tmp_path / "twin", twin)
    out = export.export([luts / "fitted", tmp_path / "twin"], "c", tmp_path / "a.c")
    text = out.read_text()
    assert re.findall(r"hairlut_(\w+)_texels\[", text) == [f"fitted_{table.name}" for table in model.tables]
    assert "hairlut_twin_direct_theta = {sizeof(hairlut_table), hairlut_fitted_direct_theta_texels" in text


def test_literals_are_floats_in_c(source):
    for word in re.findall(r"[-+\w.]*\df\b", source.read_text(encoding="ascii")):
        assert re.fullmatch(r"-?\d+(\.\d+)?(e[-+]\d+)?f", word)
        assert "." in word or "e" in word


def test_deterministic(luts, tmp_path, source):
    export.export([luts / name for name in MODELS], "c", tmp_path / "again.c")
    assert (tmp_path / "again.c").read_text() == source.read_text()


def test_wrong_input_is_named(luts, tmp_path):
    with pytest.raises(HairlutError, match=r"fitted, fitted: expected a different name"):
        export.export([luts / "fitted", luts / "fitted"], "c", tmp_path / "a.c")
    with pytest.raises(HairlutError, match=r"nowhere: expected a directory with mixture\.exr"):
        export.export([tmp_path / "nowhere"], "c", tmp_path / "a.c")
    shutil.copytree(luts / "fitted", tmp_path / "mixed")
    shutil.copy(luts / "printed" / "multiple_theta.exr", tmp_path / "mixed")
    with pytest.raises(HairlutError, match=r"attribute hairlut\.model is 'printed', expected 'fitted'"):
        export.export([tmp_path / "mixed"], "c", tmp_path / "a.c")
    assert not (tmp_path / "a.c").exists()
