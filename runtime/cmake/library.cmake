# One library in its two forms, from sources compiled once.

# hairlut_library(NAME MACRO SOURCES...): NAME_shared and NAME_static, with the aliases that consumers use
function(hairlut_library name building)
    add_library(${name}_objects OBJECT ${ARGN})
    add_library(${name}_shared SHARED $<TARGET_OBJECTS:${name}_objects>)
    add_library(${name}_static STATIC $<TARGET_OBJECTS:${name}_objects>)
    target_compile_definitions(${name}_objects PRIVATE ${building})
    set_target_properties(${name}_objects PROPERTIES C_STANDARD 99 C_EXTENSIONS OFF C_VISIBILITY_PRESET hidden
        POSITION_INDEPENDENT_CODE ON)
    target_compile_options(${name}_objects PRIVATE
        $<$<C_COMPILER_ID:GNU,Clang,AppleClang>:-Wall -Wextra -Wpedantic -Wconversion -Wshadow
            -fno-math-errno -ffp-contract=off>)
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

# hairlut_instruction_set(SUFFIX PROCESSORS FLAGS...): compiles src/*_SUFFIX.c with the flags where the target has the set
function(hairlut_instruction_set suffix processors)
    file(GLOB sources CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} src/*_${suffix}.c)
    if(CMAKE_SYSTEM_PROCESSOR MATCHES "${processors}" AND CMAKE_C_COMPILER_ID MATCHES "GNU|Clang" AND sources)
        set_source_files_properties(${sources} DIRECTORY ${PROJECT_SOURCE_DIR} PROPERTIES COMPILE_OPTIONS "${ARGN}")
    endif()
endfunction()
