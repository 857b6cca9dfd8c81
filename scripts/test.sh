#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs all checks of the continuous integration from a clean clone: packages, format, build with warnings as errors,
# tests, each public header alone, a project that uses the installation, and the tests of four modules under the
# sanitizers.
#   scripts/test.sh             everything except the sanitizers
#   scripts/test.sh --sanitize  everything
#   scripts/test.sh --fast      without public headers, installation and sanitizers
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
fast=0
sanitize=0
for option in "$@"; do
  case "$option" in
    --fast) fast=1 ;;
    --sanitize) sanitize=1 ;;
    *) echo "test.sh: unknown option '$option' (expected --fast or --sanitize)" >&2; exit 2 ;;
  esac
done
scripts/setup.sh --tests
source scripts/common.sh

# Modules that read untrusted bytes or do index arithmetic. All modules would take too long under the sanitizers.
sanitized_modules=(core geometry io changes)
sanitized_targets=(resight_{core,geometry,io,changes}_test)

check_format() {
  find src apps examples tests bench \( -name '*.cpp' -o -name '*.hpp' \) -print0 | xargs -0 clang-format --dry-run -Werror
}
run_tests() { ctest --test-dir build/ci -j2 --output-on-failure --no-tests=error; }
count_tests() {  # "412 tests passed, 0 failed, 3 skipped", from the log of run_tests
  awk '/tests passed,/ { total = $NF; failed = $4 } /\*\*\*Skipped/ { ++skipped }
       END { printf "%d tests passed, %d failed, %d skipped\n", total - failed - skipped, failed, skipped }' \
    "$log_dir/tests.log"
}
build_sanitized() {
  cmake --preset asan-ubsan -DRESIGHT_BUILD_APPS=OFF -DRESIGHT_BUILD_EXAMPLES=OFF &&
    cmake --build build/asan-ubsan -j "$num_jobs" --target "${sanitized_targets[@]}"
}
run_sanitized() {
  local module
  for module in "${sanitized_modules[@]}"; do
    UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 "build/asan-ubsan/src/resight/$module/resight_${module}_test" \
      --gtest_brief=1 || return 1
  done
}
build_consumer() {
  rm -rf build/install build/consumer
  cmake --install build/ci --prefix build/install &&
    cmake -S tests/consumer -B build/consumer -G Ninja -DCMAKE_BUILD_TYPE=Release \
      -DCMAKE_PREFIX_PATH="$PWD/build/install" &&
    cmake --build build/consumer && build/consumer/consumer
}

step "format" check_format
step "configure" cmake --preset ci -DCMAKE_VERIFY_INTERFACE_HEADER_SETS=ON
step "build, warnings are errors" cmake --build build/ci -j "$num_jobs"
step "tests" run_tests || { count_tests; exit 1; }
if ((!fast)); then
  step "each public header compiles alone" cmake --build build/ci -j "$num_jobs" --target all_verify_interface_header_sets
  step "install, and a project that uses it" build_consumer
fi
if ((sanitize)); then
  step "build with ASan and UBSan" build_sanitized
  step "tests with ASan and UBSan" run_sanitized
fi
count_tests
