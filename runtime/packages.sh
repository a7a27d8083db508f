#!/bin/sh
# Debian packages that the build (base) or the optional tests (extras) use. As root on an apt system installs what is
# missing; otherwise prints the one line to type. Never fails: what is absent is skipped, and said, later on.
set -u
case "${1:-base}" in
base) packages="gcc g++ make pkg-config libopenexr-dev" ;;
extras) packages="clang libclang-rt-14-dev valgrind lcov libbenchmark-dev libboost-dev glslang-tools libegl1
    libegl-mesa0 libgl1-mesa-dri libvulkan1 mesa-vulkan-drivers chromium chromium-driver gcc-aarch64-linux-gnu
    libc6-dev-arm64-cross qemu-user libsimde-dev" ;;
*) echo "usage: $0 [base|extras]" >&2; exit 2 ;;
esac
command -v dpkg-query >/dev/null 2>&1 || { echo "hairlut: not a Debian system; the build wants:" $packages; exit 0; }
missing=""
for package in $packages; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q "install ok installed" || missing="$missing $package"
done
[ -z "$missing" ] && exit 0
line="apt-get install -y --no-install-recommends$missing"
if [ "$(id -u)" = 0 ]; then
    echo "hairlut: $line"
    { apt-get update -qq && DEBIAN_FRONTEND=noninteractive $line; } >/dev/null ||
        echo "hairlut: could not install; type it yourself: $line"
else
    echo "hairlut: not installed:$missing. To install: sudo $line"
fi
