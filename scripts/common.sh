# SPDX-License-Identifier: Apache-2.0
# Functions shared by the scripts. Sourced from the root of the source tree.

if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
  # Otherwise, nothing that uses a precompiled header is kept.
  export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}
fi
num_jobs=$(nproc)
log_dir=${log_dir:-build/logs}
mkdir -p "$log_dir"

# step NAME COMMAND...: runs the command quietly. Prints one line with the time on success, and the end of its output on
# failure.
step() {
  local name=$1 start=$SECONDS
  shift
  local log="$log_dir/${name//[^a-zA-Z0-9]/_}.log"
  if "$@" >"$log" 2>&1 </dev/null; then
    printf '%-44s ok   %4d s\n' "$name" $((SECONDS - start))
  else
    printf '%-44s FAILED after %d s; all of it in %s\n' "$name" $((SECONDS - start)) "$log"
    grep -nE 'error|FAILED|Error' "$log" | head -n 20 || true
    tail -n 40 "$log"
    return 1
  fi
}

# build_bench FOLDER TARGET...: programs, also those of bench/. Calls that share the folder wait for each other.
build_bench() {
  mkdir -p "$1"
  exec 8>"$1/lock"
  flock 8
  scripts/setup.sh --bench
  step "configure" cmake --preset release -B "$1" -DRESIGHT_BUILD_BENCH=ON -DRESIGHT_BUILD_TESTS=OFF \
    -DRESIGHT_BUILD_EXAMPLES=OFF
  step "build the programs" cmake --build "$1" -j "$num_jobs" --target "${@:2}"
  exec 8>&-
}

# keep_output FILE COMMAND...: the output of the command in FILE, which exists only if the command succeeds.
keep_output() {
  local file=$1
  shift
  "$@" >"$file.partial" && mv "$file.partial" "$file"
}
