#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fuzzes the readers of foreign bytes with libFuzzer under AddressSanitizer and UndefinedBehaviorSanitizer, one after the
# other on one core. Prints the executions of each reader, and each finding with the file that remakes it.
#   scripts/fuzz.sh MINUTES [READER...]         builds the preset `fuzz` and runs all readers (or those), MINUTES in
#                                               total. What was learnt stays in build/fuzz-corpus, findings in
#                                               build/fuzz-findings.
#   scripts/fuzz.sh --executions N [READER...]  the same until each reader has N executions in all runs together
#   scripts/fuzz.sh --short                     the run of the continuous integration: a fixed number of mutated seeds
#                                               per reader, with the program of the preset `asan-ubsan`, which must be
#                                               built
# Ends with 1 if there was a finding: a crash, a fault that a sanitizer reports, an exception, 5 s or 2 GB.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/common.sh

usage() { echo "fuzz.sh: expected MINUTES [READER...], --executions N [READER...], or --short" >&2; exit 2; }

# Readers that take a path write their input to a file, in memory if possible.
scratch=$(mktemp -d "$([[ -w /dev/shm ]] && echo /dev/shm || echo "${TMPDIR:-/tmp}")/resight_fuzz.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
findings=build/fuzz-findings
mkdir -p "$findings"
export TMPDIR=$scratch
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
# Small quarantines stay in the cache: up to 17 % more executions.
export ASAN_OPTIONS=quarantine_size_mb=2:thread_local_quarantine_size_kb=128:max_allocation_size_mb=2048
symbolizer=$(command -v llvm-symbolizer-14 || true)
[[ -n $symbolizer ]] && export ASAN_SYMBOLIZER_PATH=$symbolizer

# run_reader PROGRAM READER CORPUS LOG OPTION...: one line with the executions; fails if there was a finding.
run_reader() {
  local program=$1 reader=$2 corpus=$3 log=$4 status=0
  shift 4
  mkdir -p "$corpus"
  "$program" --reader="$reader" --seeds="$scratch/seeds-$reader"
  "$program" --reader="$reader" "$@" -timeout=5 -rss_limit_mb=2048 -print_final_stats=1 \
    -artifact_prefix="$findings/$reader-" "$corpus" "$scratch/seeds-$reader" >"$log" 2>&1 || status=$?
  awk -v reader="$reader" '/^#[0-9]+/ { runs = substr($1, 2) } /number_of_executed_units/ { runs = $2 }
       END { printf "%-22s %10d executions\n", reader, runs }' "$log"
  ((status == 0)) && return
  echo "FINDING: $program --reader=$reader $(sed -n 's/.*Test unit written to //p' "$log" | tail -n 1)"
  grep -E 'ERROR:|SUMMARY:|runtime error|what\(\)' "$log" | sort -u | head -n 5 | sed 's/^/    /'
  return 1
}

run_short() {
  local program=build/asan-ubsan/fuzz/resight_fuzz
  export program scratch findings
  export -f run_reader
  # shellcheck disable=SC2016
  "$program" --list | xargs -P "$num_jobs" -L 1 bash -c \
    'run_reader "$program" "$0" "$scratch/corpus-$0" "$scratch/$0.log" -runs="$1" -seed=1 -keep_seed=1'
}

# build_instrumented READER...: sets `program` and `readers`, all if none is named.
build_instrumented() {
  cmake --preset fuzz >"$log_dir/fuzz_configure.log"
  cmake --build build/fuzz -j "$num_jobs" --target resight_fuzz >"$log_dir/fuzz_build.log" ||
    { tail -n 40 "$log_dir/fuzz_build.log"; exit 1; }
  program=build/fuzz/fuzz/resight_fuzz readers=("$@")
  ((${#readers[@]} > 0)) || mapfile -t readers < <("$program" --list | cut -d' ' -f1)
}
# run_instrumented READER OPTION...
run_instrumented() {
  run_reader "$program" "$1" "build/fuzz-corpus/$1" "$log_dir/fuzz_$1.log" "${@:2}"
}

run_minutes() {
  local minutes=$1 reader failed=0
  build_instrumented "${@:2}"
  local seconds=$((minutes * 60 / ${#readers[@]}))
  for reader in "${readers[@]}"; do
    run_instrumented "$reader" -max_total_time=$((seconds > 0 ? seconds : 1)) || failed=1
  done
  return "$failed"
}

# The executions of a reader are counted in a file beside its corpus, in turns that are short enough to lose one.
run_executions() {
  local wanted=$1 reader count_file count failed=0
  build_instrumented "${@:2}"
  for reader in "${readers[@]}"; do
    mkdir -p build/fuzz-corpus
    count_file=build/fuzz-corpus/$reader.executions
    while count=$(cat "$count_file" 2>/dev/null || echo 0) && ((count < wanted)); do
      run_instrumented "$reader" -runs=$((wanted - count)) -max_total_time=300 >"$scratch/line" || { failed=1; break; }
      echo $((count + $(awk '{ print $2 }' "$scratch/line"))) >"$count_file"
    done
    printf '%-22s %10d executions in all runs\n' "$reader" "$count"
    if ((count < wanted)); then cat "$scratch/line"; fi
  done
  return "$failed"
}

case "${1:-}" in
  --short) (($# == 1)) || usage; run_short ;;
  --executions) [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || usage; run_executions "${@:2}" ;;
  '' | *[!0-9]*) usage ;;
  *) run_minutes "$@" ;;
esac
