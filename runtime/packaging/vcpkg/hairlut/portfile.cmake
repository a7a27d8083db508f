# SPDX-License-Identifier: BSD-3-Clause
# An overlay port, from a checkout of this repository: vcpkg install hairlut --overlay-ports=runtime/packaging/vcpkg
get_filename_component(repository "${CURRENT_PORT_DIR}/../../../.." ABSOLUTE)
vcpkg_check_features(OUT_FEATURE_OPTIONS features FEATURES exr HAIRLUT_EXR)
string(COMPARE EQUAL "${VCPKG_LIBRARY_LINKAGE}" dynamic shared)
if(shared)
    set(form shared)
else()
    set(form static)
endif()
vcpkg_cmake_configure(SOURCE_PATH "${repository}/runtime"
    OPTIONS ${features} -DHAIRLUT_EXAMPLES=OFF -DBUILD_SHARED_LIBS=${shared} -DHAIRLUT_INSTALL_FORMS=${form})
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/hairlut)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${repository}/LICENSE")
