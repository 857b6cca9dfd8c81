#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the Debian 12 packages that resight is built from. Prints one line and skips apt if all are installed.
#   scripts/setup.sh              packages of the library and the program
#   scripts/setup.sh --tests      also packages that only the tests need
#   scripts/setup.sh --bench      also packages that only the benchmarks need
#   scripts/setup.sh --baselines  also PCL (hundreds of packages, 1 to 2 GB), which only bench_baselines uses
set -euo pipefail

packages=(
  build-essential cmake ninja-build
  libeigen3-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-imgcodecs-dev libopencv-features2d-dev
  libceres-dev libtbb-dev libnanoflann-dev libembree-dev libassimp-dev
  libflatbuffers-dev flatbuffers-compiler liblzf-dev
  liblz4-dev libbz2-dev libzstd-dev libsqlite3-dev libzip-dev libopenexr-dev libpng-dev libjpeg-dev
  nlohmann-json3-dev libtomlplusplus-dev libfmt-dev libcli11-dev libboost-dev
)
for option in "$@"; do
  case "$option" in
    --tests) packages+=(libgtest-dev libgmock-dev clang-14 libclang-rt-14-dev clang-format clang-tidy graphviz
                        chromium libopenni2-dev qemu-user)
             # Node.js from elsewhere brings its own npm, which Debian's package conflicts with.
             command -v npm >/dev/null || packages+=(nodejs npm) ;;
    --bench) packages+=(libbenchmark-dev) ;;
    --baselines) packages+=(libpcl-dev libopencv-flann-dev) ;;
    *) echo "setup.sh: unknown option '$option' (expected --tests, --bench or --baselines)" >&2; exit 2 ;;
  esac
done

if ! command -v dpkg-query >/dev/null; then
  echo "setup.sh: this is not Debian; install the counterparts of: ${packages[*]}" >&2
  exit 2
fi
missing=()
for package in "${packages[@]}"; do
  state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $state == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  echo "setup: all ${#packages[@]} packages are installed"
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null || { echo "setup.sh: run as root, or install sudo; missing: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
log=$(mktemp)
trap 'rm -f "$log"' EXIT
run() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive "$@" >>"$log" 2>&1 </dev/null && return
  echo "setup.sh: failed: $*" >&2
  tail -n 20 "$log" >&2
  exit 1
}
echo "setup: installing ${#missing[@]} of ${#packages[@]} packages: ${missing[*]}"
run apt-get -q update
run apt-get -q -y install --no-install-recommends "${missing[@]}"
echo "setup: done"
