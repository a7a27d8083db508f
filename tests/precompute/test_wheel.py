# SPDX-License-Identifier: BSD-3-Clause
"""The wheel and the source distribution, used from an empty folder, without the checkout."""

import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path

import pytest

import hairlut

ROOT = Path(__file__).resolve().parents[2]
MODEL = """\
from hairlut.modelfile import gaussian
LOBES = (
    gaussian("direct_theta", mean=lambda theta_r: -theta_r, sigma=0.3),
    gaussian("direct_phi", mean=3.14159, sigma=0.8),
    gaussian("multiple_theta", mean=0, sigma=0.5),
)
"""
BSDF = """\
import numpy as np
def bsdf(theta_r, theta_i, phi):
    return np.exp(-0.5 * ((theta_i + theta_r) / 0.3) ** 2) * np.exp(2 * np.cos(phi - np.pi)) + 0 * theta_r
"""
pytestmark = pytest.mark.skipif(
    not any(shutil.which(name) for name in ("c++", "g++", "clang++")), reason="there is no C++ compiler"
)


def run(*command, cwd: Path, **environment: str) -> str:
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=600,
        stdin=subprocess.DEVNULL,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def pip(*arguments, cwd: Path, **environment: str) -> str:
    return run(sys.executable, "-m", "pip", "--disable-pip-version-check", *arguments, cwd=cwd, **environment)


@pytest.fixture(scope="module")
def sdist(tmp_path_factory) -> Path:
    """The source distribution of this checkout."""
    folder = tmp_path_factory.mktemp("sdist")
    script = (
        "import sys; sys.path.insert(0, '.'); import hairlut_build; hairlut_build.build_sdist(sys.argv[1])"
    )
    pytest.importorskip("scikit_build_core")
    run(sys.executable, "-c", script, folder, cwd=ROOT / "precompute")
    (path,) = folder.glob("*.tar.gz")
    return path


@pytest.fixture(scope="module")
def wheel(sdist, tmp_path_factory) -> Path:
    """The wheel that the source distribution makes by itself, in an empty folder."""
    folder = tmp_path_factory.mktemp("wheel")
    shutil.copy(sdist, folder)
    pip("wheel", "--quiet", "--no-deps", "--no-build-isolation", sdist.name, cwd=folder)
    (path,) = folder.glob("*.whl")
    return path


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory) -> Path:
    """A folder of packages with the wheel in it."""
    folder = tmp_path_factory.mktemp("installed")
    pip("install", "--quiet", "--no-deps", "--target", folder, wheel, cwd=folder)
    return folder


def python(installed: Path, cwd: Path, *arguments) -> str:
    """Python with that folder and what hairlut depends on, but without the editable installation: -S reads no
    .pth files."""
    path = os.pathsep.join([str(installed), sysconfig.get_path("purelib"), sysconfig.get_path("platlib")])
    return run(sys.executable, "-S", *arguments, cwd=cwd, PYTHONPATH=path)


def test_source_distribution_carries_library_and_tables(sdist) -> None:
    with tarfile.open(sdist) as archive:
        names = archive.getnames()
    for part in (
        "native/runtime/include/hairlut.h",
        "native/luts/fitted/direct_theta.exr",
        "LICENSE",
        "README.md",
    ):
        assert any(name.endswith(part) for name in names), part
    assert not any("__pycache__" in name or name.endswith(".so") for name in names)


def test_building_leaves_the_checkout_as_it_was(wheel) -> None:
    assert not (ROOT / "precompute" / "native").exists()
    assert not (ROOT / "precompute" / "LICENSE").exists()


def test_wheel_carries_everything(wheel) -> None:
    archive = zipfile.ZipFile(wheel)
    names = archive.namelist()
    sdk = "hairlut/sdk"
    for part in (
        "hairlut/py.typed",
        "hairlut/_core.pyi",
        "hairlut/viewer/page.html",
        f"{sdk}/include/hairlut.h",
        f"{sdk}/lib/cmake/hairlut/hairlut-config.cmake",
        f"{sdk}/share/hairlut/luts/fitted/direct_theta.exr",
        f"{sdk}/share/hairlut/luts/FORMAT.md",
        f"{sdk}/share/hairlut/shaders/hairlut.glsl",
    ):
        assert part in names, part
    assert any(re.fullmatch(r"hairlut/_core\..*(so|pyd)", name) for name in names)
    (metadata,) = (name for name in names if name.endswith(".dist-info/METADATA"))
    text = archive.read(metadata).decode()
    for line in (
        f"Version: {hairlut.__version__}",
        "License-Expression: BSD-3-Clause",
        "License-File: LICENSE",
    ):
        assert line in text
    assert "Classifier: Typing :: Typed" in text
    (entry,) = (name for name in names if name.endswith("entry_points.txt"))
    assert "hairlut = hairlut.cli:main" in archive.read(entry).decode()


def test_library_from_the_wheel(installed, tmp_path) -> None:
    script = (
        "import hairlut, hairlut.config as c; print(hairlut.__file__);"
        "m = hairlut.load(c.data('luts') / 'fitted'); print(m, m.sample(.3, 1, (.2, .5, .5)).pdf_angle > 0)"
    )
    out = python(installed, tmp_path, "-c", script).splitlines()
    assert out[0].startswith(str(installed))
    assert out[1] == "<hairlut.Model fitted: lobes direct, multiple> True"


def test_commands_from_the_wheel(installed, tmp_path) -> None:
    (tmp_path / "one.py").write_text(MODEL)
    (tmp_path / "my_hair.py").write_text(BSDF)
    hairlut_command = "-m", "hairlut.cli"
    python(installed, tmp_path, *hairlut_command, "bake", "--model", "one.py", "--out", "luts")
    python(installed, tmp_path, *hairlut_command, "verify", "luts/one", "--model", "one.py")
    python(installed, tmp_path, *hairlut_command, "fit", "my_hair.py", "--out", "luts")
    python(installed, tmp_path, *hairlut_command, "export", "luts/one", "--to", "c", "--out", "one.c")
    python(installed, tmp_path, *hairlut_command, "view", "luts/one", "--out", "explorer.html")
    assert "hairlut" in (tmp_path / "one.c").read_text()
    assert (tmp_path / "explorer.html").stat().st_size > 10_000
    for name in ("one", "my_hair"):
        assert (tmp_path / "luts" / name / "mixture.exr").is_file()


def test_cmake_finds_the_wheels_library(installed, tmp_path) -> None:
    (tmp_path / "main.c").write_text(
        '#include <hairlut.h>\nint main(void) { return hairlut_builtin("fitted") ? 0 : 1; }\n'
    )
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.21)\nproject(consumer C)\nfind_package(hairlut REQUIRED)\n"
        "add_executable(consumer main.c)\ntarget_link_libraries(consumer hairlut::hairlut)\n"
    )
    found = python(installed, tmp_path, "-m", "hairlut.config", "--cmake-dir").strip()
    beside = Path(sys.executable).parent
    run(
        beside / "cmake",
        "-S",
        ".",
        "-B",
        "build",
        f"-Dhairlut_DIR={found}",
        "-DCMAKE_BUILD_TYPE=Release",
        cwd=tmp_path,
    )
    run(beside / "cmake", "--build", "build", cwd=tmp_path)
    run(tmp_path / "build" / "consumer", cwd=tmp_path)


def test_without_a_compiler_python_alone_is_installed_and_says_so(sdist, tmp_path) -> None:
    """The wheel of a machine whose CXX does not exist bakes, and names what load needs."""
    shutil.copy(sdist, tmp_path)
    pip(
        "wheel",
        "--quiet",
        "--no-deps",
        "--no-build-isolation",
        sdist.name,
        cwd=tmp_path,
        CXX="no-such-compiler",
    )
    (path,) = tmp_path.glob("*.whl")
    assert not any("_core." in name and name.endswith(".so") for name in zipfile.ZipFile(path).namelist())
    packages = tmp_path / "packages"
    pip("install", "--quiet", "--no-deps", "--target", packages, path, cwd=tmp_path)
    (tmp_path / "one.py").write_text(MODEL)
    python(packages, tmp_path, "-m", "hairlut.cli", "bake", "--model", "one.py", "--out", "luts")
    script = (
        "import hairlut\n"
        "try:\n    hairlut.builtin('fitted')\n"
        "except hairlut.HairlutError as error:\n    print(error)"
    )
    assert "installed without its C library" in python(packages, tmp_path, "-c", script)
