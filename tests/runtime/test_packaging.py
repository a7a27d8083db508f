"""The library from outside: a tiny project built in each of the three ways that users link."""

import os

import pytest
from runtime.c_library import BUILD, HERE, MODELS, ROOT, RUNTIME, cmake, has_exr, run, tool

CONSUMERS = HERE / "consumers"
PROJECT = """cmake_minimum_required(VERSION 3.21)
project(consumer LANGUAGES C CXX)
{how}
add_executable(c99 "{consumers}/c99.c")
target_link_libraries(c99 PRIVATE hairlut::{core})
add_executable(cxx17 "{consumers}/cxx17.cpp")
target_compile_features(cxx17 PRIVATE cxx_std_17)
target_link_libraries(cxx17 PRIVATE hairlut::{core})
if(TARGET hairlut::exr)
    add_executable(exr "{consumers}/exr.c")
    target_link_libraries(exr PRIVATE hairlut::{exr})
endif()
"""
FORMS = [("hairlut", "exr"), ("hairlut_static", "exr_static"), ("hairlut_shared", "exr_shared")]


@pytest.fixture(scope="module", params=["ON", "OFF"], ids=["shared", "static"])
def prefix(request, tmp_path_factory):
    """An installation whose hairlut::hairlut is the shared or the static library."""
    build = cmake(
        RUNTIME, BUILD / "tests" / f"install-{request.param}", f"-DBUILD_SHARED_LIBS={request.param}",
        "-DHAIRLUT_EXAMPLES=OFF", "-DCMAKE_BUILD_TYPE=Release"
    )  # fmt: skip
    folder = tmp_path_factory.mktemp("prefix")
    run(tool("cmake"), "--install", build, "--prefix", folder)
    return folder


def check(folder) -> None:
    """Runs what the consumer project built."""
    run(folder / "c99")
    run(folder / "cxx17")
    if has_exr():
        for model in MODELS:
            run(folder / "exr", ROOT / "luts" / model)


def consume(tmp_path, how: str, form: tuple[str, str], *definitions: str) -> None:
    text = PROJECT.format(how=how, consumers=CONSUMERS, core=form[0], exr=form[1])
    (tmp_path / "CMakeLists.txt").write_text(text)
    check(cmake(tmp_path, tmp_path / "build", *definitions))


def test_found_by_cmake_after_install(prefix, tmp_path):
    need = "COMPONENTS exr" if has_exr() else ""
    for form in FORMS:
        folder = tmp_path / form[0]
        folder.mkdir()
        how = f"find_package(hairlut 1.0 REQUIRED {need})"
        consume(folder, how, form, f"-DCMAKE_PREFIX_PATH={prefix}")


def test_a_newer_major_version_is_not_found(prefix, tmp_path):
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.21)\nproject(consumer LANGUAGES C)\n"
        "find_package(hairlut 2.0 QUIET)\nif(hairlut_FOUND)\n  message(FATAL_ERROR found)\nendif()\n"
    )
    cmake(tmp_path, tmp_path / "build", f"-DCMAKE_PREFIX_PATH={prefix}")


def test_as_a_subdirectory(tmp_path):
    consume(tmp_path, f'add_subdirectory("{RUNTIME}" hairlut)', FORMS[0])


@pytest.mark.parametrize("linking", ["shared", "static"])
def test_found_by_pkg_config(prefix, tmp_path, linking):
    if not tool("pkg-config"):
        pytest.skip("pkg-config is not installed: apt-get install pkg-config")
    libraries = next(prefix.glob("lib*/pkgconfig")).parent
    environment = {**os.environ, "PKG_CONFIG_PATH": str(libraries / "pkgconfig")}
    programs = {"c99": ("c99.c", "hairlut")}
    if has_exr():
        programs["exr"] = ("exr.c", "hairlut-exr")
    for program, (source, module) in programs.items():
        static = ["--static"] if linking == "static" else []
        flags = run(tool("pkg-config"), *static, "--cflags", "--libs", module, env=environment).stdout.split()
        if linking == "static":
            flags = [f"-l:lib{flag[2:]}.a" if flag.startswith("-lhairlut") else flag for flag in flags]
        run("cc", CONSUMERS / source, *flags, f"-Wl,-rpath,{libraries}", "-o", tmp_path / program)
    run(tmp_path / "c99")
    if has_exr():
        run(tmp_path / "exr", ROOT / "luts" / "fitted")


def test_build_without_openexr_says_so_and_leaves_the_core(tmp_path):
    configured = run(
        tool("cmake"), "-S", RUNTIME, "-B", tmp_path, "-G", "Ninja", f"-DCMAKE_MAKE_PROGRAM={tool('ninja')}",
        "-DCMAKE_DISABLE_FIND_PACKAGE_OpenEXR=ON", "-DHAIRLUT_EXAMPLES=ON"
    )  # fmt: skip
    assert "OpenEXR >= 3.1 was not found" in configured.stderr
    assert "apt-get install libopenexr-dev" in configured.stderr.replace("\n ", "")
    run(tool("cmake"), "--build", tmp_path)
    assert not list(tmp_path.glob("libhairlut_exr*"))
    assert "compiled in: fitted" in run(tmp_path / "print_samples", ROOT / "luts" / "fitted").stdout
