# SPDX-License-Identifier: BSD-3-Clause
"""Build backend: scikit-build-core, fed with the C library and the tables, which lie beside this folder.

In a checkout they are at ../runtime and ../luts. A source distribution carries copies in native/, so that it
builds alone. Without a C++ compiler the wheel has Python alone: it bakes, and says what is missing.
"""

import os
import shutil
import sys
from contextlib import contextmanager
from pathlib import Path

from scikit_build_core import build as backend

HERE = Path(__file__).parent
BUNDLE = HERE / "native"
PARTS = ("runtime", "luts", "LICENSE")


def get_requires_for_build_sdist(config_settings=None):
    return backend.get_requires_for_build_sdist(config_settings)


def get_requires_for_build_wheel(config_settings=None):
    return backend.get_requires_for_build_wheel(_settings(config_settings))


def get_requires_for_build_editable(config_settings=None):
    return backend.get_requires_for_build_editable(_settings(config_settings))


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    with _license():
        return backend.build_wheel(wheel_directory, _settings(config_settings), metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    with _license():
        return backend.build_editable(wheel_directory, _settings(config_settings), metadata_directory)


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    with _license():
        return backend.prepare_metadata_for_build_wheel(metadata_directory, _settings(config_settings))


def prepare_metadata_for_build_editable(metadata_directory, config_settings=None):
    with _license():
        return backend.prepare_metadata_for_build_editable(metadata_directory, _settings(config_settings))


def build_sdist(sdist_directory, config_settings=None):
    with _license(), _bundled():
        return backend.build_sdist(sdist_directory, config_settings)


def _settings(given):
    """The caller's settings, and where the extension's CMakeLists.txt is; no extension without a compiler."""
    settings = dict(given or {})
    root = HERE.parent if (HERE.parent / "runtime" / "python").is_dir() else BUNDLE
    settings.setdefault("cmake.source-dir", os.path.relpath(root / "runtime" / "python", HERE))
    if not _compiler():
        print(
            "hairlut: no C++ compiler (c++, g++ or clang++) was found: installing Python alone. It bakes, "
            "fits and verifies; hairlut.load and hairlut.builtin need a compiler and another pip install.",
            file=sys.stderr,
        )
        settings["wheel.cmake"] = "false"
    return settings


def _compiler():
    names = [os.environ["CXX"].split()[0]] if os.environ.get("CXX") else ["c++", "g++", "clang++", "cl"]
    return any(shutil.which(name) for name in names)


@contextmanager
def _license():
    """The license beside pyproject.toml, where packages look for it, while one is made."""
    copy = HERE / "LICENSE"
    made = not copy.exists()
    if made:
        shutil.copy(HERE.parent / "LICENSE", copy)
    try:
        yield
    finally:
        if made:
            copy.unlink()


@contextmanager
def _bundled():
    """The parts of the checkout that a source distribution needs, in native/ while it is written."""
    made = not BUNDLE.exists()
    if made:
        BUNDLE.mkdir()
        for part in PARTS:
            source = HERE.parent / part
            if source.is_dir():
                shutil.copytree(source, BUNDLE / part, ignore=shutil.ignore_patterns("__pycache__", "build"))
            else:
                shutil.copy(source, BUNDLE / part)
    try:
        yield
    finally:
        if made:
            shutil.rmtree(BUNDLE)
