# SPDX-License-Identifier: BSD-3-Clause
# One library in its two forms, from sources compiled once.

# Arithmetic as written: one rounding an operation, NaN and infinity kept, also in a project that compiles with -ffast-math,
# whose flags come before these. What compares floats for equality means it.
set(hairlut_gnu_options -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wno-float-equal
    -fno-fast-math -fno-unsafe-math-optimizations -fno-finite-math-only -fno-math-errno -ffp-contract=off)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "i.86|^x86$" OR (CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND CMAKE_SIZEOF_VOID_P EQUAL 4))
    list(APPEND hairlut_gnu_options -msse2 -mfpmath=sse)
endif()
if(NOT PROJECT_IS_TOP_LEVEL) # an including project's -Werror is for its own sources
    list(APPEND hairlut_gnu_options -Wno-error)
endif()
set(hairlut_msvc_options /W4 /fp:precise)

# hairlut_library(NAME MACRO): NAME_shared and NAME_static of the sources of the list, with the aliases that consumers use
function(hairlut_library name building)
    hairlut_sources(${name} sources)
    add_library(${name}_objects OBJECT ${sources})
    add_library(${name}_shared SHARED $<TARGET_OBJECTS:${name}_objects>)
    set(compiled ${name}_objects)
    if(WIN32) # there a source is compiled for one form: what it takes from another library is imported, or not
        add_library(${name}_static STATIC ${sources})
        list(APPEND compiled ${name}_static)
    else()
        add_library(${name}_static STATIC $<TARGET_OBJECTS:${name}_objects>)
    endif()
    target_compile_definitions(${name}_objects PRIVATE ${building})
    target_compile_definitions(${name}_static PUBLIC HAIRLUT_STATIC)
    foreach(target IN LISTS compiled)
        set_target_properties(${target} PROPERTIES C_STANDARD 99 C_EXTENSIONS OFF C_VISIBILITY_PRESET hidden
            POSITION_INDEPENDENT_CODE ON)
        target_compile_options(${target} PRIVATE "$<$<C_COMPILER_ID:GNU,Clang,AppleClang>:${hairlut_gnu_options}>"
            "$<$<C_COMPILER_ID:MSVC>:${hairlut_msvc_options}>")
    endforeach()
    target_link_options(${name}_shared PRIVATE # else gcc links what makes the whole program flush denormals
        $<$<C_COMPILER_ID:GNU>:-fno-fast-math>)
    set_target_properties(${name}_shared PROPERTIES # installed beside the library that it needs
        INSTALL_RPATH $<IF:$<PLATFORM_ID:Darwin>,@loader_path,$ORIGIN>)
    string(REPLACE "hairlut_" "" alias ${name})
    foreach(form objects shared static)
        target_include_directories(${name}_${form} PUBLIC
            $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
        if(HAIRLUT_SANITIZE)
            target_compile_options(${name}_${form} PUBLIC -fsanitize=${HAIRLUT_SANITIZE} -fno-omit-frame-pointer
                -fno-sanitize-recover=all)
            target_link_options(${name}_${form} PUBLIC -fsanitize=${HAIRLUT_SANITIZE})
        endif()
        if(HAIRLUT_COVERAGE)
            target_compile_options(${name}_${form} PRIVATE --coverage)
            target_link_options(${name}_${form} PUBLIC --coverage)
        endif()
    endforeach()
    foreach(form shared static)
        set_target_properties(${name}_${form} PROPERTIES OUTPUT_NAME ${name} EXPORT_NAME ${alias}_${form}
            VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
        add_library(hairlut::${alias}_${form} ALIAS ${name}_${form})
    endforeach()
    if(MSVC) # the import library of the shared form has the static form's name
        set_target_properties(${name}_static PROPERTIES OUTPUT_NAME ${name}_static)
    endif()
    if(BUILD_SHARED_LIBS)
        add_library(hairlut::${alias} ALIAS ${name}_shared)
    else()
        add_library(hairlut::${alias} ALIAS ${name}_static)
    endif()
endfunction()

# hairlut_link(NAME LIBRARY): a library that only the implementation uses
function(hairlut_link name library)
    target_link_libraries(${name}_objects PRIVATE ${library})
    target_link_libraries(${name}_shared PRIVATE ${library})
    target_link_libraries(${name}_static PRIVATE ${library})
endfunction()
