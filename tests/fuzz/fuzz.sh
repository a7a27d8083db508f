#!/bin/sh
# Coverage-guided fuzzing of the table loader and of tables in memory: fuzz.sh [SECONDS] (60, shared by both).
# What it finds new goes to build/fuzz/; a crash leaves its input there and fails.
set -eu
cd "$(dirname "$0")/../.."
seconds=$(( ${1:-60} / 2 ))
out=build/fuzz
command -v clang >/dev/null || { echo "hairlut: fuzzing needs clang: apt-get install clang libclang-rt-14-dev"; exit 2; }
mkdir -p "$out"
src=runtime/src
sources() { awk -v library="$1" -v folder="$src" '$1 == library && NF == 2 { print folder "/" $2 }' $src/sources.txt; }
core=$(sources hairlut | grep -v /batch)
flags="-std=c99 -g -O1 -fno-math-errno -ffp-contract=off -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all"
include="-Iruntime/include -Iruntime/src -Itests/fuzz"
clang $flags $include tests/fuzz/fuzz_memory.c $core -lm -o "$out/fuzz_memory"
targets=fuzz_memory
if pkg-config --exists OpenEXR; then
    clang $flags $include $(pkg-config --cflags OpenEXR) tests/fuzz/fuzz_loader.c $(sources hairlut_exr) $core \
        -lOpenEXRCore -lm -o "$out/fuzz_loader"
    targets="fuzz_memory fuzz_loader"
else
    echo "hairlut: OpenEXR is missing, so the loader is not fuzzed: apt-get install libopenexr-dev"
fi
for target in $targets; do
    corpus="tests/fuzz/corpus/${target#fuzz_}"
    mkdir -p "$out/$target.corpus"
    "$out/$target" -max_total_time=$seconds -rss_limit_mb=2048 -malloc_limit_mb=512 -timeout=20 -print_final_stats=1 \
        -artifact_prefix="$out/$target." "$out/$target.corpus" "$corpus" 2>"$out/$target.log" ||
        { tail -40 "$out/$target.log"; exit 1; }
    sed -n 's/^stat::\(number_of_executed_units\|new_units_added\): */'"$target"' \1 /p' "$out/$target.log"
done
