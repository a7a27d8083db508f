#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Debian packages that the build (base) or the optional tests (extras) use. As root on an apt system installs what is
# missing; otherwise prints the one line to type. Never fails: what is absent is reported later, and its tests skipped.
set -u
case "${1:-base}" in
base) packages="gcc g++ libc6-dev make pkg-config libopenexr-dev" ;;
extras) packages="clang libclang-rt-dev valgrind lcov libbenchmark-dev libboost-dev libsleef-dev glslang-tools libgl1 libegl1
    libegl-mesa0 libgl1-mesa-dri libvulkan1 mesa-vulkan-drivers chromium chromium-driver gcc-aarch64-linux-gnu
    libc6-dev-arm64-cross qemu-user wine wine64 libllvm19" ;;
*) echo "usage: $0 [base|extras]" >&2; exit 2 ;;
esac
command -v dpkg-query >/dev/null 2>&1 || { echo "hairlut: not a Debian system; the build needs:" $packages; exit 0; }
missing=""
for package in $packages; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q "install ok installed" || missing="$missing $package"
done
[ -z "$missing" ] && exit 0
install="apt-get install -y --no-install-recommends"
if [ "$(id -u)" != 0 ]; then
    echo "hairlut: not installed:$missing. To install: sudo $install$missing"
    exit 0
fi

# Releases have different packages: an unknown name must not keep the others from being installed.
apt-get update -qq >/dev/null || echo "hairlut: apt-get update failed: going on with the present lists"
known=""
for package in $missing; do
    if apt-cache show "$package" >/dev/null 2>&1; then
        known="$known $package"
    else
        echo "hairlut: this release has no package $package: left out"
    fi
done
[ -z "$known" ] && exit 0
export DEBIAN_FRONTEND=noninteractive
echo "hairlut: $install$known"
$install $known >/dev/null && exit 0
for package in $known; do # nor may one that cannot be installed
    $install "$package" >/dev/null || echo "hairlut: could not install $package; type it yourself: $install $package"
done
exit 0
