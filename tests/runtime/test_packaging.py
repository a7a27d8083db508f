# SPDX-License-Identifier: BSD-3-Clause
"""The library from outside: a tiny project built in each of the three ways that users link."""

import os
import subprocess

import pytest
from runtime.c_library import BUILD, HERE, MODELS, ROOT, RUNTIME, cmake, has_exr, run, tool

CONSUMERS = HERE / "consumers"
PROJECT = """cmake_minimum_required(VERSION 3.21)
project(consumer LANGUAGES {languages})
{how}
add_executable(c99 "{consumers}/c99.c")
target_link_libraries(c99 PRIVATE hairlut::{core})
if(TARGET hairlut::exr)
    add_executable(exr "{consumers}/exr.c")
    target_link_libraries(exr PRIVATE hairlut::{exr})
endif()
"""
CXX = """add_executable(cxx17 "{consumers}/cxx17.cpp")
target_compile_features(cxx17 PRIVATE cxx_std_17)
target_link_libraries(cxx17 PRIVATE hairlut::{core})
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
    if tool("c++"):
        run(folder / "cxx17")
    if has_exr():
        for model in MODELS:
            run(folder / "exr", ROOT / "luts" / model)


def project(how: str, form: tuple[str, str] = FORMS[0]) -> str:
    """A CMakeLists.txt of the consumers; those in C++ where there is a compiler for it."""
    text, languages = (PROJECT + CXX, "C CXX") if tool("c++") else (PROJECT, "C")
    return text.format(languages=languages, how=how, consumers=CONSUMERS, core=form[0], exr=form[1])


def consume(tmp_path, how: str, form: tuple[str, str], *definitions: str) -> None:
    (tmp_path / "CMakeLists.txt").write_text(project(how, form))
    check(cmake(tmp_path, tmp_path / "build", *definitions))


def test_there_is_a_cxx_compiler_for_the_consumers():
    """Not a test of the library: fails where the others would be skipped."""
    if not tool("c++"):
        pytest.skip("consumers in C++ are not built: apt-get install g++")


def test_found_by_cmake_after_install(prefix, tmp_path):
    need = "COMPONENTS exr" if has_exr() else ""
    for form in FORMS:
        folder = tmp_path / form[0]
        folder.mkdir()
        how = f"find_package(hairlut 2.0 REQUIRED {need})"
        consume(folder, how, form, f"-DCMAKE_PREFIX_PATH={prefix}")


@pytest.mark.parametrize("version", ["1.0", "2.99", "3.0"])
def test_another_major_or_a_newer_version_is_not_found(prefix, tmp_path, version):
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.21)\nproject(consumer LANGUAGES C)\n"
        f"find_package(hairlut {version} QUIET)\nif(hairlut_FOUND)\n  message(FATAL_ERROR found)\nendif()\n"
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
        programs["exr"] = ("exr.c", "hairlut_exr")
    for program, (source, module) in programs.items():
        static = ["--static"] if linking == "static" else []
        flags = run(tool("pkg-config"), *static, "--cflags", "--libs", module, env=environment).stdout.split()
        if linking == "static":
            flags = [f"-l:lib{flag[2:]}.a" if flag.startswith("-lhairlut") else flag for flag in flags]
        run("cc", CONSUMERS / source, *flags, f"-Wl,-rpath,{libraries}", "-o", tmp_path / program)
    run(tmp_path / "c99")
    if has_exr():
        run(tmp_path / "exr", ROOT / "luts" / "fitted")


def why_not_found(prefix, tmp_path, *definitions: str, components: str = "exr") -> str:
    """What CMake says where find_package(hairlut) must fail."""
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.21)\nproject(consumer LANGUAGES C)\n"
        f"find_package(hairlut REQUIRED COMPONENTS {components})\n"
    )
    done = subprocess.run(
        [tool("cmake"), "-S", tmp_path, "-B", tmp_path / "build", "-G", "Ninja",
         f"-DCMAKE_MAKE_PROGRAM={tool('ninja')}", f"-DCMAKE_PREFIX_PATH={prefix}", *definitions],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode != 0
    return " ".join(done.stderr.split())


def test_component_exr_without_openexr_says_why(prefix, tmp_path):
    if not has_exr():
        pytest.skip("hairlut_exr was not built")
    said = why_not_found(prefix, tmp_path, "-DCMAKE_DISABLE_FIND_PACKAGE_OpenEXR=ON")
    assert "component exr needs OpenEXR >= 3.1, which was not found" in said
    assert "apt-get install libopenexr-dev" in said


def test_component_exr_of_an_installation_without_it_says_why(tmp_path):
    build = cmake(
        RUNTIME, tmp_path / "core", "-DHAIRLUT_EXR=OFF", "-DHAIRLUT_EXAMPLES=OFF",
        f"-DCMAKE_INSTALL_PREFIX={tmp_path}/p"
    )  # fmt: skip
    run(tool("cmake"), "--install", build)
    assert "was built without OpenEXR" in why_not_found(tmp_path / "p", tmp_path)


def test_an_unknown_component_is_named(prefix, tmp_path):
    assert "there is no component gpu" in why_not_found(prefix, tmp_path, components="gpu")


def test_the_installed_loader_finds_the_library_beside_it(prefix):
    if not has_exr():
        pytest.skip("hairlut_exr was not built")
    library = next(prefix.glob("lib*/libhairlut_exr.so"))
    run(
        "env", "-u", "LD_LIBRARY_PATH", tool("python3"), "-c", f"import ctypes; ctypes.CDLL({str(library)!r})"
    )


def test_tables_shaders_format_and_license_are_installed(prefix):
    data = prefix / "share" / "hairlut"
    installed = {str(file.relative_to(data)) for file in data.rglob("*") if file.is_file()}
    shipped = {str(file.relative_to(ROOT)) for file in (ROOT / "luts").rglob("*.exr")}
    shaders = {str(file.relative_to(RUNTIME)) for file in (RUNTIME / "shaders").glob("*.*")}
    assert installed == shipped | shaders | {"luts/FORMAT.md", "LICENSE"}


def test_make_install_takes_a_prefix_and_a_destination(tmp_path):
    """DESTDIR, as packagers use it."""
    environment = {**os.environ, "DESTDIR": str(tmp_path)}
    run(tool("cmake"), "--install", BUILD / "runtime", "--prefix", "/opt/hairlut", env=environment)
    assert (tmp_path / "opt" / "hairlut" / "include" / "hairlut.h").is_file()
    recipe = run("make", "-n", "install", "PREFIX=/opt/hairlut", cwd=ROOT).stdout
    assert '--install build/runtime --prefix "/opt/hairlut"' in recipe


def test_one_form_alone_can_be_installed(tmp_path):
    build = cmake(
        RUNTIME, tmp_path / "build", "-DHAIRLUT_EXR=OFF", "-DHAIRLUT_EXAMPLES=OFF", "-DBUILD_SHARED_LIBS=OFF",
        "-DHAIRLUT_INSTALL_FORMS=static"
    )  # fmt: skip
    run(tool("cmake"), "--install", build, "--prefix", tmp_path / "p")
    assert [file.name for file in (tmp_path / "p").glob("lib*/libhairlut*")] == ["libhairlut.a"]
    consumer = tmp_path / "consumer"
    consumer.mkdir()
    (consumer / "CMakeLists.txt").write_text(project("find_package(hairlut REQUIRED)"))
    run(cmake(consumer, consumer / "build", f"-DCMAKE_PREFIX_PATH={tmp_path}/p") / "c99")


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
