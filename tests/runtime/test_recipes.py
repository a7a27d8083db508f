# SPDX-License-Identifier: BSD-3-Clause
"""The recipes of package managers: Conan's is built and consumed, vcpkg's is held against what it builds."""

import json
import os
import re

import pytest
from runtime.c_library import BUILD, RUNTIME, core, run, tool

RECIPES = RUNTIME / "packaging"


def version() -> str:
    number = core().hairlut_version()
    return f"{number // 10000}.{number // 100 % 100}.{number % 100}"


@pytest.fixture(scope="module")
def conan():
    """A function that runs Conan with a cache of its own."""
    if not tool("conan"):
        pytest.skip("the Conan recipe is not built: .venv/bin/pip install conan")
    home = BUILD / "tests" / "conan"
    path = f"{os.path.dirname(tool('cmake'))}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "CONAN_HOME": str(home), "PATH": path}
    environment.pop("CC", None)

    def command(*words: str) -> str:
        done = run(tool("conan"), *words, env=environment)
        return done.stdout + done.stderr

    command("profile", "detect", "--force")
    return command


@pytest.mark.parametrize("shared", [True, False], ids=["shared", "static"])
def test_conan_builds_the_core_and_a_consumer_runs(conan, shared):
    """Without the loader: OpenEXR would come over the network."""
    options = ["-o", "hairlut/*:exr=False", "-o", f"hairlut/*:shared={shared}"]
    folder = BUILD / "tests" / "conan-consumer"
    for setting in (
        "tools.cmake.cmaketoolchain:generator=Ninja",
        "tools.cmake.cmaketoolchain:user_presets=",
        f"tools.cmake.cmake_layout:test_folder={folder}",
    ):
        options += ["-c", setting]
    said = conan("create", str(RECIPES / "conan"), *options)
    assert f"hairlut/{version()} (test package): Running test()" in said
    packages = list((BUILD / "tests" / "conan").rglob("p/share/hairlut/luts/fitted/mixture.exr"))
    assert packages


def test_vcpkg_port_is_of_this_version_and_names_what_there_is():
    manifest = json.loads((RECIPES / "vcpkg" / "hairlut" / "vcpkg.json").read_text())
    assert manifest["version"] == version()
    port = (RECIPES / "vcpkg" / "hairlut" / "portfile.cmake").read_text()
    build = (RUNTIME / "CMakeLists.txt").read_text()
    options = set(re.findall(r"HAIRLUT_\w+", port))
    assert {"HAIRLUT_EXR", "HAIRLUT_INSTALL_FORMS"} <= options
    for option in options:
        assert re.search(rf"(option|set)\({option} ", build), option
    assert "lib/cmake/hairlut" in port
    assert "${CMAKE_INSTALL_LIBDIR}/cmake/hairlut" in (RUNTIME / "cmake" / "install.cmake").read_text()
