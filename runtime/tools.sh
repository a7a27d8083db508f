#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Checks for the tools that setup and build need: tools.sh PYTHON [READY]. PYTHON is not checked if the file READY is newer than
# pyproject.toml: the environment exists. What is missing is named with the remedy, exit code 2, before a file is written.
set -u
cd "$(dirname "$0")/.."
python=${1:-python3}
ready=${2:-}

fail() {
    echo "hairlut: $*" >&2
    exit 2
}

# The Python that makes the environment.
check_python() {
    command -v "$python" >/dev/null 2>&1 ||
        fail "there is no program '$python': apt-get install python3 python3-venv, or name a Python of 3.11 or newer with make PYTHON=..."
    version=$("$python" -c 'import sys; print("Python %d.%d" % sys.version_info[:2])' 2>/dev/null)
    case "$version" in
    "Python 3."*) ;;
    *) fail "'$python' is no Python 3 (its version is '${version:-nothing}'): name another with make PYTHON=..." ;;
    esac
    [ "${version#Python 3.}" -ge 11 ] || fail "'$python' is $version, expected 3.11 or newer: name another with make PYTHON=..."
    "$python" -c 'import ensurepip, venv' 2>/dev/null || fail "$version lacks the venv module: apt-get install python3-venv"
}

# The compiler that CMake will choose: $CC, which may have arguments, else the first of the usual names.
find_compiler() {
    if [ -n "${CC:-}" ]; then
        command -v "${CC%% *}" >/dev/null 2>&1 || fail "CC is '$CC', and there is no such program"
        return
    fi
    for CC in cc gcc clang; do
        command -v "$CC" >/dev/null 2>&1 && return
    done
    fail "there is no C compiler (no cc, gcc or clang): apt-get install gcc libc6-dev, or name one with make CC=..."
}

check_compiler() {
    find_compiler
    folder=$(mktemp -d) || fail "no temporary folder can be made"
    trap 'rm -rf "$folder"' EXIT
    printf '#include <stdio.h>\n#include <stdlib.h>\n#include <math.h>\nint main(void) { return 0; }\n' >"$folder/empty.c"
    $CC -c "$folder/empty.c" -o "$folder/empty.o" >"$folder/log" 2>&1 ||
        fail "$CC does not compile an empty program: $(grep -m1 -i error "$folder/log" || head -n 1 "$folder/log"). Is the C library's development package there? apt-get install libc6-dev"
    $CC "$folder/empty.o" -o "$folder/empty" >"$folder/log" 2>&1 ||
        fail "$CC does not link an empty program: $(tail -n 1 "$folder/log"). apt-get install gcc libc6-dev"
}

# A build folder that was configured without a compiler, or with one that was removed, would fail every time.
forget_lost_compilers() {
    for cache in build/*/CMakeCache.txt build/*/*/CMakeCache.txt; do
        [ -f "$cache" ] || continue
        compiler=$(sed -n 's/^CMAKE_C_COMPILER:[A-Z]*=//p' "$cache")
        [ -x "$compiler" ] || rm -rf "$cache" "${cache%CMakeCache.txt}CMakeFiles"
    done
}

[ -n "$(find "$ready" -newer precompute/pyproject.toml 2>/dev/null)" ] || check_python
./runtime/packages.sh base
check_compiler
forget_lost_compilers
