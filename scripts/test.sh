#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# All checks of the continuous integration, from a clean clone: packages, format, build with warnings as errors, tests,
# the page of `resight view` (types, lint, tests, the same bundle, in a browser), clang-tidy, installation and a project
# that uses it, the program, the tests of the modules that read files of others and a short run of the fuzz targets under
# AddressSanitizer and UndefinedBehaviorSanitizer, the tests of threads under ThreadSanitizer.
#   scripts/test.sh         all of these
#   scripts/test.sh --fast  format, build and tests, for the inner loop
#   scripts/test.sh --long  before a release: all of these, every public header and source of bench/ alone, the program
#                           under ThreadSanitizer, the tests of all modules under all sanitizers, 200 faults of each
#                           command that writes, and a sequence of 2,000 views (hours)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
fast=0
long=0
packages=(--tests)
asan_modules=(core recordings io models evaluation report annotation viewer)  # They read files of others.
tsan_modules=(core)
for option in "$@"; do
  case "$option" in
    --fast) fast=1 ;;
    --long)
      long=1
      packages+=(--bench)
      mapfile -t asan_modules < <(ls src/resight/*/*_test.cpp | cut -d/ -f3 | uniq)
      tsan_modules=("${asan_modules[@]}") ;;
    *) echo "test.sh: unknown option '$option' (expected --fast or --long)" >&2; exit 2 ;;
  esac
done
scripts/setup.sh "${packages[@]}"
source scripts/common.sh

check_format() {
  find src apps examples tests bench fuzz \( -name '*.cpp' -o -name '*.hpp' \) -print0 |
    xargs -0 -P "$num_jobs" -n 50 clang-format --dry-run -Werror
}
run_tests() { ctest --test-dir build/ci -j "$num_jobs" --output-on-failure --no-tests=error; }
# "412 tests passed, 0 failed, 3 skipped": the cases of GoogleTest, and each other program as one. The log of CTest has
# "Pass Reason" and "Fail Reason" for tests with a regular expression, and calls a test without its program passed.
count_tests() {
  awk '/^\[  (PASSED |SKIPPED) \] [0-9]+ test/ { count[$2] += $4; cases = 1 }
       /^\[  FAILED  \] .* \([0-9]+ ms\)$/ { ++failed }
       /^Unable to find executable: / { ++failed }
       /^Test (Passed\.|Failed\.|Pass Reason:|Fail Reason:)$/ {
         if ($2 ~ /^Pass/ && !failed) count["PASSED"] += !cases
         else count["FAILED"] += failed ? failed : 1
         cases = failed = 0
       }
       END { printf "%d tests passed, %d failed, %d skipped\n", count["PASSED"], count["FAILED"], count["SKIPPED"] }' \
    build/ci/Testing/Temporary/LastTest.log
}

# The committed page must be the one that its sources give. Pictures of the page are in build/logs/viewer.
check_page() {
  rm -rf build/page && mkdir -p build && cp -r web/dist build/page &&
    (cd web && npm ci --no-audit --no-fund && npm run check && npm test && npm run build) || return 1
  diff -r build/page web/dist || { echo "error: web/dist was not up to date; commit the new one"; return 1; }
}
run_viewer() {
  tests/viewer_test.sh build/ci/apps/resight/resight build/logs/viewer &&
    tests/annotate_test.sh build/ci/apps/resight/resight build/logs/viewer
}

# Configures for clang-tidy, without building. All sources of a module are one translation unit, because clang-tidy
# spends its time on the headers.
configure_clang() {
  local generated=src/resight/models/generated
  cmake --preset release -B build/clang -DCMAKE_CXX_COMPILER=clang++-14 -DRESIGHT_UNITY_BATCH_SIZE=0 \
    -DRESIGHT_PRECOMPILED_HEADERS=OFF -DRESIGHT_BUILD_TESTS=OFF &&
    mkdir -p "build/clang/$generated" && cp build/ci/$generated/*.h "build/clang/$generated"
}
run_clang_tidy() {
  # The largest first, so that none runs alone at the end.
  configure_clang &&
    grep -o '"file": "[^"]*' build/clang/compile_commands.json | cut -d'"' -f4 | grep -E '/Unity/|/apps/|/examples/' |
    xargs wc -l | sort -rn | awk '$2 != "total" { print $2 }' |
    xargs -P "$num_jobs" -n 1 clang-tidy --quiet -p build/clang
}
# Compiles each public header on its own, and the sources of bench/ but for those that need PCL. Eigen, which takes most
# of the time, is precompiled.
check_headers() {
  local clang=(clang++-14 -std=c++20 -march=x86-64-v3 -isystem /usr/include/eigen3 -isystem /usr/include/opencv4)
  printf '#include <Eigen/Core>\n#include <Eigen/Geometry>\n' >build/clang/eigen.hpp
  "${clang[@]}" -x c++-header build/clang/eigen.hpp -o build/clang/eigen.pch &&
    { find src -name '*.hpp' ! -path '*/internal/*' ! -path '*/testing/*' ! -name '*test*.hpp' -print0
      find bench -name '*.cpp' ! -path 'bench/baselines/pcl/*' -print0; } |
    xargs -0 -P "$num_jobs" -I{} "${clang[@]}" -fsyntax-only -x c++ -Isrc -include-pch build/clang/eigen.pch \
      -Wno-pragma-once-outside-header {}
}
build_consumer() {
  rm -rf build/install build/consumer
  cmake --install build/ci --prefix build/install &&
    cmake -S tests/consumer -B build/consumer -G Ninja -DCMAKE_BUILD_TYPE=Release \
      -DCMAKE_PREFIX_PATH="$PWD/build/install" &&
    cmake --build build/consumer && build/consumer/consumer
}
test_targets() { printf 'resight_%s_test ' "$@"; }  # test_targets MODULE...
run_modules() {  # run_modules PRESET MODULE...
  local preset=$1
  shift
  printf "build/$preset/src/resight/%s\n" "$@" | sed 's|[^/]*$|&/resight_&_test|' |
    xargs -P "$num_jobs" -n 1 sh -c '"$0" --gtest_brief=1'
}
build_asan() {
  # shellcheck disable=SC2046
  cmake --preset asan-ubsan -DRESIGHT_BUILD_EXAMPLES=OFF &&
    cmake --build build/asan-ubsan -j "$num_jobs" --target resight_app resight_fuzz $(test_targets "${asan_modules[@]}")
}
run_asan() {
  export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
  export ASAN_OPTIONS=quarantine_size_mb=16  # Tests of memory count what was freed, too.
  run_modules asan-ubsan "${asan_modules[@]}" && tests/threads_test.sh build/asan-ubsan/apps/resight/resight
}
build_tsan() {  # build_tsan TARGET...
  cmake --preset tsan -DRESIGHT_BUILD_EXAMPLES=OFF && cmake --build build/tsan -j "$num_jobs" --target "$@"
}
tsan_options="halt_on_error=1 suppressions=$PWD/tests/tsan_suppressions.txt"
run_tsan() { TSAN_OPTIONS=$tsan_options run_modules tsan "${tsan_modules[@]}"; }
run_tsan_program() { TSAN_OPTIONS=$tsan_options tests/threads_test.sh build/tsan/apps/resight/resight; }

step "format" check_format
step "configure" cmake --preset ci
step "build, warnings are errors" cmake --build build/ci -j "$num_jobs"
step "tests" run_tests || { count_tests; exit 1; }
if ((!fast)); then
  step "page of the viewer" check_page
  step "viewer in a browser" run_viewer
  step "clang-tidy" run_clang_tidy
  step "picture of the modules" scripts/draw_modules.sh --check build/ci
  step "install, and a project that uses it" build_consumer
  step "build with ASan and UBSan" build_asan
  step "tests and program with ASan and UBSan" run_asan
  step "readers with mutated files" scripts/fuzz.sh --short
  # shellcheck disable=SC2046
  step "build with TSan" build_tsan $(test_targets "${tsan_modules[@]}")
  step "tests with TSan" run_tsan
fi
if ((long)); then
  step "each public header and source of bench/ compiles alone" check_headers
  step "build the program with TSan" build_tsan resight_app
  step "program with TSan" run_tsan_program
  step "commands that are disturbed" tests/faults_test.sh build/ci/apps/resight/resight 200
  step "memory and time of 2,000 views" scripts/soak.sh 2000 build/ci/apps/resight/resight
fi
count_tests
