#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Coverage-guided fuzzing: fuzz.sh [SECONDS of each fuzzer, 15]. The targets: files through the loader; models in memory; models
# written to files and loaded again. Prints what was run and how many branches of runtime/src each one reaches. New inputs go to
# build/fuzz/; a crash leaves its input there and fails.
set -eu
cd "$(dirname "$0")/../.."
seconds=${1:-15}
out=build/fuzz
cmake=.venv/bin/cmake
[ -x "$cmake" ] || cmake=cmake
command -v clang >/dev/null || { echo "hairlut: fuzzing needs clang: apt-get install clang libclang-rt-dev"; exit 2; }
mkdir -p "$out/folder"
export FUZZ_FOLDER="$out/folder"

targets=memory
libraries=""
flags=""
form=hairlut_static
if pkg-config --exists OpenEXR 2>/dev/null; then
    targets="memory loader round_trip"
    libraries=-lOpenEXRCore
    flags=$(pkg-config --cflags OpenEXR)
    form="hairlut_static hairlut_exr_static"
else
    echo "hairlut: OpenEXR is missing, so files are not fuzzed: apt-get install libopenexr-dev"
fi

# library FOLDER FLAGS: the static libraries, instrumented
library() {
    "$cmake" -S runtime -B "$out/$1" -G "Unix Makefiles" -DCMAKE_C_COMPILER=clang -DCMAKE_BUILD_TYPE=None -DCMAKE_C_FLAGS="$2" \
        -DHAIRLUT_EXAMPLES=OFF >"$out/$1.log" 2>&1 &&
        "$cmake" --build "$out/$1" -j 2 --target $form >>"$out/$1.log" 2>&1 || { tail -30 "$out/$1.log"; exit 1; }
}

# program TARGET FOLDER FLAGS SOURCES: a target linked with them
program() {
    target=$1 folder=$2 how=$3
    shift 3
    archives="$out/$folder/libhairlut.a"
    [ -z "$libraries" ] || archives="$out/$folder/libhairlut_exr.a $archives"
    clang -std=gnu99 $how -Iruntime/include -Iruntime/src -Itests/fuzz $flags "tests/fuzz/fuzz_$target.c" "$@" $archives $libraries -lm \
        -o "$out/$folder/fuzz_$target"
}

checks="-g -O1 -fsanitize=address,undefined -fno-sanitize-recover=all"
coverage="-g -O0 -fprofile-instr-generate -fcoverage-mapping"
library fuzzed "$checks -fsanitize=fuzzer-no-link"
library covered "$coverage"
for target in $targets; do
    corpus="tests/fuzz/corpus/$target"
    mkdir -p "$out/$target.corpus"
    program $target fuzzed "$checks -fsanitize=fuzzer"
    "$out/fuzzed/fuzz_$target" -max_total_time="$seconds" -max_len=65536 -rss_limit_mb=2048 -malloc_limit_mb=512 -timeout=20 \
        -print_final_stats=1 -artifact_prefix="$out/$target." "$out/$target.corpus" "$corpus" 2>"$out/$target.log" ||
        { tail -40 "$out/$target.log"; exit 1; }
    sed -n 's/^stat::\(number_of_executed_units\|new_units_added\): */fuzz_'"$target"' \1 /p' "$out/$target.log"
    if command -v llvm-cov >/dev/null && command -v llvm-profdata >/dev/null; then
        program $target covered "$coverage" tests/fuzz/replay.c
        find "$out/$target.corpus" "$corpus" -type f |
            LLVM_PROFILE_FILE="$out/$target.profraw" "$out/covered/fuzz_$target" - >/dev/null
        llvm-profdata merge -sparse "$out/$target.profraw" -o "$out/$target.profdata"
        llvm-cov report "$out/covered/fuzz_$target" -instr-profile="$out/$target.profdata" -show-branch-summary \
            -ignore-filename-regex='tests/|include/' >"$out/$target.coverage"
        awk -v name="fuzz_$target" '/^TOTAL/ { printf "%s branches %d of %d, %s\n", name, $(NF-2) - $(NF-1), $(NF-2), $NF }' \
            "$out/$target.coverage"
    else
        echo "hairlut: branches are not counted: apt-get install llvm"
    fi
done
