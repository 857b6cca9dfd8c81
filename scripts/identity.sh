#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Proves that two commits give the same results, bit for bit. Simulates a data set, trains, recognises three sequences
# with each preset, and compares the model library, detections.json and changes.json.
#   scripts/identity.sh BASE HEAD [WORK_DIR]     WORK_DIR (default: build/identity) keeps builds and results by commit
# Exit status: 0 = same bytes, or same values in the same order under other keys, or numbers within 1e-9; 1 = different;
# 2 = usage error.
# Fused multiply-add is off: with it, moving a function to another file can change the last bits. Those of pose
# uncertainties change nevertheless: the order of sums in Eigen's eigenvalue solver depends on the alignment of short
# vectors on the stack.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
(($# == 2 || $# == 3)) || { sed -n '3,10s/^# \{0,1\}//p' "$0" >&2; exit 2; }
base=$(git rev-parse --verify "$1^{commit}")
head=$(git rev-parse --verify "$2^{commit}")
work=$(realpath -m "${3:-build/identity}")
mkdir -p "$work/results"

# One source folder serves all commits, so that the second build is incremental.
build() {
  [[ -d $work/source ]] || git worktree add --quiet --detach "$work/source" "$1"
  git -C "$work/source" checkout --quiet --detach "$1"
  cmake -S "$work/source" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS=-ffp-contract=off \
    -DRESIGHT_UNITY_BUILD=ON -DRESIGHT_BUILD_TESTS=OFF >"$work/build.log" 2>&1 &&
    cmake --build "$work/build" --target resight_app >>"$work/build.log" 2>&1 ||
    { tail -n 20 "$work/build.log" >&2; exit 1; }
}

# Runs the program of a commit on the common data set into results/COMMIT. The paths are the same for all commits.
run() {
  local results=$work/results/$1 resight=$work/build/apps/resight/resight sequence preset
  [[ -e $results/done ]] && return
  echo "identity: build and run ${1:0:12}"
  build "$1"
  rm -rf "$results" && mkdir "$results" && cd "$results"
  if [[ ! -e $work/data.done ]]; then
    rm -rf "$work/data"
    "$resight" simulate --preset dynamic-tabletop-2 --seed 1 --format bop --out "$work/data" >log 2>&1
    touch "$work/data.done"
  fi
  ln -sfn "$work/data" data
  "$resight" train data/models --out models.resight >>log 2>&1
  for preset in default mvr mvr-chd; do
    for sequence in 000001 000005 000008; do
      "$resight" recognize --models models.resight --sequence "data/test/$sequence" --preset "$preset" --seed 1 \
        --out "$preset-$sequence" >>log 2>&1
    done
  done
  tail -c +41 models.resight >library.payload
  touch done
  cd - >/dev/null
}

without_keys() { sed -E 's/"[^"]*" *://g' "$1"; }

# Token by token: numbers may differ by 1e-9, relative or absolute; anything else must be the same.
same_numbers() {
  paste -d '\n' <(tokens "$1") <(tokens "$2") | awk '
    NR % 2 { a = $0; next }
    a == $0 { next }
    a !~ /^-?[0-9]/ || $0 !~ /^-?[0-9]/ { exit 1 }
    { d = a - $0; if (d < 0) d = -d; m = a < 0 ? -a : +a; if (d > 1e-9 && d > 1e-9 * m) exit 1 }'
}
tokens() { tr -s '][{},: \n' '\n' <"$1"; }

run "$base"
run "$head"
status=0
while read -r file; do
  a=$work/results/$base/$file b=$work/results/$head/$file
  if cmp -s "$a" "$b"; then
    result=identical
  elif [[ $file == *.json ]] && cmp -s <(without_keys "$a") <(without_keys "$b"); then
    result="same values, other keys"
  elif [[ $file == *.json ]] && same_numbers <(without_keys "$a") <(without_keys "$b"); then
    result="same within 1e-9"
  else
    result=DIFFERENT status=1
  fi
  printf '%-32s %s  %s\n' "$file" "$(sha256sum "$b" | cut -c1-12)" "$result"
done < <(cd "$work/results" && find "$base" "$head" \( -name detections.json -o -name changes.json -o \
  -name library.payload \) -printf '%P\n' | sort -u)
[[ -n ${result:-} ]] || { echo "identity: nothing to compare" >&2; exit 1; }
exit $status
