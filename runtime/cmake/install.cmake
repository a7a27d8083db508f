# Install: libraries, headers, a CMake package, pkg-config files.
set(package_directory ${CMAKE_INSTALL_LIBDIR}/cmake/hairlut)
file(RELATIVE_PATH from_pkgconfig ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX}) # relocatable

# hairlut_install(NAME MODULE): both forms, as the CMake targets of NAME-targets.cmake and as the pkg-config MODULE
function(hairlut_install name module)
    install(TARGETS ${name}_shared ${name}_static EXPORT ${name}-targets
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(EXPORT ${name}-targets NAMESPACE hairlut:: DESTINATION ${package_directory})
    configure_file(cmake/${module}.pc.in ${module}.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/${module}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

hairlut_install(hairlut hairlut)
if(HAIRLUT_HAS_EXR)
    hairlut_install(hairlut_exr hairlut-exr)
endif()
install(FILES include/hairlut.h include/hairlut_export.h include/hairlut_version.h
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
set(HAIRLUT_INSTALLED_FORM static)
if(BUILD_SHARED_LIBS)
    set(HAIRLUT_INSTALLED_FORM shared)
endif()
configure_package_config_file(cmake/hairlut-config.cmake.in hairlut-config.cmake INSTALL_DESTINATION ${package_directory})
write_basic_package_version_file(hairlut-config-version.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/hairlut-config.cmake ${PROJECT_BINARY_DIR}/hairlut-config-version.cmake
    DESTINATION ${package_directory})
