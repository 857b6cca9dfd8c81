#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Measures every table of README.md and docs/results.md at the checked-out commit, and writes it into the page. What is
# finished is kept in OUT and not computed again. Shards may run at the same time, also on several machines that share
# OUT; the call after the last one writes the pages.
#   scripts/results.sh [--version 2|3] [--shard I/N | --merge] [--data DIR=../shared/data] [--out DIR=out/results]
#                      [--build DIR=build/results] [--no-build] [--pages DIR=.]
# With --no-build, the programs are those in DIR, and real recordings are not measured.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
usage() {
  sed -n '6,7s/^# \{0,1\}//p' "$0" >&2
  exit 2
}
version=3 data=../shared/data out=out/results build=build/results pages=.
source scripts/shards.sh
read_options version data out build pages -- "$@"
[[ $version =~ ^[23]$ ]] || usage
[[ $pages == . ]] && require_commit --pages scripts
commit=$(git rev-parse --short=12 HEAD 2>/dev/null || echo unknown)
source scripts/common.sh
resight=$build/apps/resight/resight
if ((can_build)); then
  build_bench "$build" resight_app bench_model_objects bench_robustness bench_real_changes bench_losses
fi
parts=$out/$commit-version-$version
mkdir -p "$parts"

# The pages name each machine that computed.
name_machine() {
  local model machine
  model=$(sed -n 's/^model name[^:]*: //p;T;q' /proc/cpuinfo)
  machine="${model:-$(uname -m)}, $(nproc) cores"
  grep -qxF "$machine" "$parts/machines.txt" 2>/dev/null || echo "$machine" >>"$parts/machines.txt"
}

# part NAME COMMAND...: keeps the output of the command in NAME, unless it is there.
part() {
  local name=$1
  shift
  take_turn "$parts/$name" "$name" || return 0
  step "$name" keep_output "$parts/$name" "$@" || { missing+=("$name"); failed+=("$name"); return 0; }
  name_machine
}

# make_data_set NAME SEED: the data set, its library NAME.resight, and its name and version in NAME.txt.
make_data_set() {
  local folder=$parts/$1 preset=dynamic-tabletop
  ((version == 3)) || preset+=-$version
  [[ -e $folder.resight ]] && return
  if [[ ! -e $folder.txt ]]; then
    rm -rf "$folder"
    step "simulate $1" keep_output "$folder.txt" "$resight" simulate --preset $preset --seed "$2" --format bop \
      --out "$folder"
  fi
  grep -q "version $version," "$folder.txt" || { echo "results.sh: $preset is not version $version" >&2; exit 1; }
  local inputs=("$folder/models")
  if [[ -e $folder/library ]]; then
    local recorded=$folder/library/recorded
    if [[ ! -e $recorded ]]; then
      rm -rf "$recorded.partial"
      step "record the objects of $1" "$build/bench/bench_model_objects" --tabletop "$2" --given 3 \
        --or-one-side --out "$recorded.partial"
      mv "$recorded.partial" "$recorded"
    fi
    inputs=("$folder/library/models" "$recorded")
  fi
  step "train $1" "$resight" train "${inputs[@]}" --out "$folder.resight"
}
# One shard makes the data; the others wait.
make_data() {
  exec 9>"$parts/lock"
  flock 9
  make_data_set test 2
  make_data_set validation 1
  exec 9>&-
}

# evaluate NAME OPTION...: keeps the tables in NAME.md and NAME_times.md. All calls share their runs. They do not share
# their tables, because several shards may write these at the same time.
evaluate() {
  local name=$1 runs=$parts/results/runs options=()
  local results=$parts/results/$1-${shard_number:-all}
  shift
  [[ -e $parts/$name.md ]] && return
  if ((merge)); then options=(--merge); elif [[ -n $shard ]]; then options=(--shard "$shard"); fi
  mkdir -p "$runs" "$results"
  ln -sfn ../runs "$results/runs"
  rm -f "$results/tables.md"
  step "evaluate $name" "$resight" evaluate --models "$parts/test.resight" \
    --dataset "$parts/test" --out "$results" "$@" "${options[@]}" || ((merge)) || failed+=("$name")
  ! grep -q '^evaluate [0-9]' "$log_dir/evaluate_$name.log" || name_machine  # A view was computed.
  # A shard writes tables only if the runs of all shards are there.
  [[ -e $results/tables.md ]] || { missing+=("$name.md"); return; }
  cp "$results/times.md" "$parts/${name}_times.md"
  cp "$results/tables.md" "$parts/$name.md"
}
run_demo() {
  rm -rf "$parts/demo"
  "$resight" demo --seed 2 --out "$parts/demo"
}
measure_real() {
  ((can_build)) || return 1  # real_results.sh builds.
  scripts/real_results.sh "$data" "$parts/real" "$build" >&2 &&
    ! grep -E '^(Absent|Failed): ' "$parts/real/real.md" >&2 && cat "$parts/real/real.md"
}

source scripts/results_tables.sh
# put PAGE NAME DATA: makes the table NAME and puts it into the copy of the page.
put() {
  local table=$parts/table_$2.md
  "table_${2//-/_}" >"$table"
  [[ $(grep -c '^|' "$table") -gt 2 ]] || { echo "results.sh: the table '$2' is empty" >&2; exit 1; }
  printf '\nCommit %s; %s; %s.\n' "$commit" "$3" "$(paste -sd ';' "$parts/machines.txt" | sed 's/;/; /g')" >>"$table"
  scripts/page_tables.sh put "$new_pages/$1" "$2" "$commit" <"$table"
}
# The pages change only if all tables are there.
write_pages() {
  local test validation real="real and path-traced recordings" name
  test=$(cut -d: -f1 "$parts/test.txt")  # "dynamic-tabletop version 3, seed 2: 9 sequences, .."
  validation=$(cut -d: -f1 "$parts/validation.txt")
  new_pages=$parts/pages
  mkdir -p "$new_pages/docs"
  cp "$pages/README.md" "$new_pages/README.md"
  cp "$pages/docs/results.md" "$new_pages/docs/results.md"
  put README.md demo "demo, seed 2"
  for name in real-changes static recognition; do put docs/results.md $name "$real"; done
  for name in paper differences presets losses visibility changes scores clustering; do
    put docs/results.md $name "$test"
  done
  put docs/results.md degraded "$validation, sequence 1"
  scripts/page_tables.sh check "$new_pages/README.md" "$new_pages/docs/results.md"
  cp "$new_pages/README.md" "$pages/README.md"
  cp "$new_pages/docs/results.md" "$pages/docs/results.md"
}

((merge)) || make_data
evaluate clustering --presets mvr,mvr-chd,default -k 5 --without-clustering
evaluate default --presets default -k 0,5
evaluate paper --presets mvr,mvr-chd -k 0-7
validation=$parts/validation
part demo.txt run_demo
part degraded.md "$build/bench/bench_robustness" "$validation/test/000001" "$validation.resight" mvr,mvr-chd,default 5 \
  "$validation/test/000001.events.json"
part real.md measure_real
exit_unless_finished
write_pages
