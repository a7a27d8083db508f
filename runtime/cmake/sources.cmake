# SPDX-License-Identifier: BSD-3-Clause
# The list src/sources.txt, and the flags that some of its files need.

# hairlut_sources(LIBRARY VARIABLE): the library's files, each with its flags set
function(hairlut_sources library variable)
    set(list ${PROJECT_SOURCE_DIR}/src/sources.txt)
    set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${list})
    file(STRINGS ${list} lines REGEX "^${library} ")
    foreach(line IN LISTS lines)
        string(REGEX REPLACE " +" ";" words "${line}")
        list(POP_FRONT words ignored file processor)
        list(APPEND files src/${file})
        if(processor STREQUAL "x86")
            hairlut_x86_flags(${file} ${words})
        endif()
    endforeach()
    set(${variable} ${files} PARENT_SCOPE)
endfunction()

# hairlut_x86_flags(FILE FLAGS...): FLAGS are those of gcc and clang; MSVC names the whole set. Apple's compiler may be asked for
# both processors at once.
function(hairlut_x86_flags file)
    if(MSVC)
        set(flags /arch:AVX2)
        if("-mavx512f" IN_LIST ARGN)
            set(flags /arch:AVX512)
        endif()
    elseif(APPLE)
        list(TRANSFORM ARGN PREPEND "SHELL:-Xarch_x86_64 " OUTPUT_VARIABLE flags)
    else()
        set(flags ${ARGN})
    endif()
    if(APPLE OR CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64|i.86|^x86$")
        set_source_files_properties(src/${file} DIRECTORY ${PROJECT_SOURCE_DIR} PROPERTIES COMPILE_OPTIONS "${flags}")
    endif()
endfunction()
