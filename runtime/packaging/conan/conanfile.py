# SPDX-License-Identifier: BSD-3-Clause
"""Conan 2 recipe, for a checkout: conan create runtime/packaging/conan [-o "hairlut/*:exr=False"]."""

import re
from pathlib import Path

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, rmdir

REPOSITORY = Path(__file__).resolve().parents[3]


class Hairlut(ConanFile):
    name = "hairlut"
    description = "Importance sampling of a hair's scattering from lookup tables"
    license = "BSD-3-Clause"
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False], "exr": [True, False]}  # noqa: RUF012
    default_options = {"shared": False, "fPIC": True, "exr": True}  # noqa: RUF012
    implements = ["auto_shared_fpic"]  # noqa: RUF012
    languages = "C"

    def set_version(self):
        header = (REPOSITORY / "runtime" / "include" / "hairlut_version.h").read_text()
        self.version = ".".join(re.findall(r"define HAIRLUT_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", header))

    def export_sources(self):
        copy(self, "LICENSE", REPOSITORY, self.export_sources_folder)
        for folder, pattern in (("runtime", "*"), ("luts", "*.exr"), ("luts", "FORMAT.md")):
            copy(self, pattern, REPOSITORY / folder, Path(self.export_sources_folder) / folder)

    def requirements(self):
        if self.options.exr:
            self.requires("openexr/[>=3.1 <4]")

    def layout(self):
        cmake_layout(self, src_folder=".")

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["HAIRLUT_EXR"] = bool(self.options.exr)
        toolchain.cache_variables["HAIRLUT_EXAMPLES"] = False
        toolchain.cache_variables["HAIRLUT_INSTALL_FORMS"] = "shared" if self.options.shared else "static"
        toolchain.generate()
        CMakeDeps(self).generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure(build_script_folder="runtime")
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, Path(self.package_folder) / "licenses")
        for folder in ("cmake", "pkgconfig"):  # Conan writes its own
            rmdir(self, Path(self.package_folder) / "lib" / folder)

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "hairlut")
        core = self.cpp_info.components["hairlut"]
        core.set_property("cmake_target_name", "hairlut::hairlut")
        core.set_property("pkg_config_name", "hairlut")
        core.libs = ["hairlut"]
        static = not self.options.shared
        core.defines = ["HAIRLUT_STATIC"] if static else []
        core.system_libs = ["m"] if static and self.settings.os in ("Linux", "FreeBSD") else []
        if self.options.exr:
            loader = self.cpp_info.components["exr"]
            loader.set_property("cmake_target_name", "hairlut::exr")
            loader.set_property("pkg_config_name", "hairlut_exr")
            loader.libs = ["hairlut_exr"]
            loader.requires = ["hairlut", "openexr::openexr_openexrcore"]
