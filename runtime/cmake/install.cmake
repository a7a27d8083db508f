# SPDX-License-Identifier: BSD-3-Clause
# Install: libraries, headers, a CMake package, pkg-config files, and the data: tables, shaders, the format's page, the license.
set(package_directory ${CMAKE_INSTALL_LIBDIR}/cmake/hairlut)
set(HAIRLUT_DATA_DIR ${CMAKE_INSTALL_DATADIR}/hairlut)
file(RELATIVE_PATH from_pkgconfig ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX}) # relocatable

# hairlut_install(NAME): its forms, as the CMake targets of NAME-targets.cmake and as the pkg-config module NAME
function(hairlut_install name)
    foreach(form IN LISTS HAIRLUT_INSTALL_FORMS)
        list(APPEND targets ${name}_${form})
    endforeach()
    install(TARGETS ${targets} EXPORT ${name}-targets
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(EXPORT ${name}-targets NAMESPACE hairlut:: DESTINATION ${package_directory})
    configure_file(cmake/${name}.pc.in ${name}.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

set(HAIRLUT_INSTALLED_FORM static)
if(BUILD_SHARED_LIBS)
    set(HAIRLUT_INSTALLED_FORM shared)
endif()
if(NOT HAIRLUT_INSTALLED_FORM IN_LIST HAIRLUT_INSTALL_FORMS)
    message(FATAL_ERROR "HAIRLUT_INSTALL_FORMS is '${HAIRLUT_INSTALL_FORMS}': expected it to hold '${HAIRLUT_INSTALLED_FORM}', "
        "which BUILD_SHARED_LIBS makes of hairlut::hairlut")
endif()
hairlut_install(hairlut)
if(HAIRLUT_HAS_EXR)
    hairlut_install(hairlut_exr)
endif()
install(FILES include/hairlut.h include/hairlut_export.h include/hairlut_version.h
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
configure_package_config_file(cmake/hairlut-config.cmake.in hairlut-config.cmake INSTALL_DESTINATION ${package_directory}
    PATH_VARS HAIRLUT_DATA_DIR)
write_basic_package_version_file(hairlut-config-version.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/hairlut-config.cmake ${PROJECT_BINARY_DIR}/hairlut-config-version.cmake
    DESTINATION ${package_directory})

install(DIRECTORY shaders DESTINATION ${HAIRLUT_DATA_DIR} PATTERN source EXCLUDE) # what the shaders are assembled from
if(EXISTS ${PROJECT_SOURCE_DIR}/../luts/FORMAT.md) # runtime/ may be taken alone
    install(DIRECTORY ../luts DESTINATION ${HAIRLUT_DATA_DIR} FILES_MATCHING PATTERN "*.exr" PATTERN "FORMAT.md")
    install(FILES ../LICENSE DESTINATION ${HAIRLUT_DATA_DIR})
endif()
