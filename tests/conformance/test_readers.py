# SPDX-License-Identifier: BSD-3-Clause
"""Both readers, Python's and C's, on the same files: they accept the same ones, with the same numbers, and
refuse the others for the same reason (luts/FORMAT.md)."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from conformance import cases, files
from runtime.c_library import ROOT, LoadError

from hairlut import exr
from hairlut.errors import HairlutError
from runtime import c_library

pytestmark = pytest.mark.usefixtures("loader")
PARAMETERS = 24  # names the directory of a model over parameters, beside those of formats 1 and 2
THETA_R, PHI_R = np.float32([-1.6, -0.7, 0.1, 1.2]), np.float32(0.5)
U = np.random.default_rng(3).random((200, 3)).astype(np.float32)


@pytest.fixture(scope="session")
def loader() -> None:
    """Skips where hairlut_exr was not built."""
    if not c_library.has_exr():
        pytest.skip("hairlut_exr is not built for want of OpenEXR >= 3.1: apt-get install libopenexr-dev")


@pytest.fixture(scope="module")
def good(tmp_path_factory) -> dict[int, Path]:
    """Good directories by their format."""
    folder, source = tmp_path_factory.mktemp("good"), ROOT / "luts" / "fitted"
    return {
        1: files.write_format_1(folder / "1", source),
        2: files.write_format_2(folder / "2", source),
        PARAMETERS: files.write_over_parameters(folder / "parametric"),
    }


def read_in_python(directory: Path):
    """(model, None), or (None, what was said)."""
    try:
        return exr.read_model(directory), None
    except HairlutError as error:
        return None, str(error)


def read_in_c(directory: Path):
    """(model, None), or (None, what was said)."""
    try:
        return c_library.load(directory), None
    except LoadError as error:
        return None, error.message


def agree(directory: Path, file: str, said: str | None) -> None:
    """Both accept, with the same samples; or both refuse, and name the file and the reason."""
    (ours, python), (theirs, c) = read_in_python(directory), read_in_c(directory)
    if said is None:
        assert (python, c) == (None, None)
        same_samples(ours, theirs)
        return
    for message in (python, c):
        assert message is not None, f"one reader accepts: Python says {python!r}, C says {c!r}"
        assert "\n" not in message
        assert said in message, message
        if not said.endswith(".exr"):
            assert file in message, message


def same_samples(ours, theirs) -> None:
    """Of the whole hair, up to the rounding of floats; also at random parameters."""
    theta_r = np.repeat(THETA_R, len(U) // len(THETA_R))
    offset = np.linspace(-1, 1, len(U), dtype=np.float32)
    near(
        ours.sample(theta_r, PHI_R, U.astype(float), offset),
        theirs.sample_hair(theta_r, PHI_R, *U.T, offset=offset),
    )
    if ours.parameters:
        random = np.random.default_rng(5)
        ranges = [(p.least, p.most) for p in ours.parameters]
        strands = random.uniform(*np.transpose(ranges), (len(U), len(ranges))).astype(np.float32)
        each = {p.name: strands[:, k].astype(float) for k, p in enumerate(ours.parameters)}
        near(
            ours.sample(theta_r, PHI_R, U.astype(float), offset, each),
            theirs.sample_strand(strands, theta_r, PHI_R, *U.T, offset=offset),
        )


def near(ours, other) -> None:
    theta_i, phi_i, pdf = ours
    np.testing.assert_allclose(other["theta_i"], theta_i, atol=2e-5)
    np.testing.assert_allclose(np.cos(other["phi_i"] - phi_i), 1, atol=1e-6)
    np.testing.assert_allclose(other["pdf_angle"], pdf, rtol=2e-3)


def named(of_format: int) -> list:
    given = {1: cases.of_format_1, 2: cases.of_format_2, PARAMETERS: cases.of_parameters}[of_format]()
    return [pytest.param(of_format, *case, id=f"{of_format}-{case[1]}-{case[0]}") for case in given]


@pytest.mark.parametrize(
    ("of_format", "name", "file", "edit", "said"), [*named(1), *named(2), *named(PARAMETERS)]
)
def test_both_readers_agree(good, tmp_path, of_format, name, file, edit, said):
    directory = tmp_path / "model"
    shutil.copytree(good[of_format], directory)
    edit.apply(directory / file)
    agree(directory, file, said)


@pytest.mark.parametrize("of_format", [1, 2, PARAMETERS])
def test_the_good_directories_are_accepted(good, of_format):
    agree(good[of_format], "", None)


def test_slopes_of_format_1_are_derived_alike(good):
    """Through densities at the knots' own angles, where the slope alone counts."""
    table, loaded = exr.read_model(good[1]).lobes[1].theta, c_library.load(good[1])
    rows = np.repeat(table.theta_r, table.width - 2)
    pdf = loaded.pdf("multiple", rows, 0.0, table.texels[:, 1:-1].ravel(), 0.0)
    np.testing.assert_allclose(2 * np.pi * pdf, 1 / table.slopes[:, 1:-1].ravel(), rtol=1e-3)
