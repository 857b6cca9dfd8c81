#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Recognises a sequence of any number of views, in which objects move and go again and again, and compares the memory
# and the time per view of the last tenth with the first. Twelve generated views of 96 x 72 pixels are repeated.
#   scripts/soak.sh VIEWS [PATH_OF_RESIGHT]     VIEWS: 200 or more
# Ends with 1 if memory grows by more than 25 % and 8 kB per view, if the time of the processor per view grows by more
# than 25 %, if views are not written as they are finished, or if the report is not bounded.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[[ ${1:-} =~ ^[0-9]+$ ]] && (($1 >= 200)) || { echo "soak.sh: expected VIEWS, 200 or more" >&2; exit 2; }
num_views=$1
resight=$(realpath "${2:-build/release/apps/resight/resight}")
source tests/small_scene.sh
cd "$work"

readonly num_seen=12
{
  write_scene $num_seen -110 -70 true | sed -E 's/^width = .*/width = 96/; s/^height = .*/height = 72/
    s/^f([xy]) = .*/f\1 = 78.75/; s/^cx = .*/cx = 47.5/; s/^cy = .*/cy = 35.5/'
  move_cereals 4
  remove_tea 8
} >scene.toml
run simulate scene.toml --out data --format bop --seed 1
run train data/models --out models.resight
run convert data/test/000001 seen --to tuw

# There and back, so that the camera does not jump.
mapfile -t seen < <(cd seen && ls ./*.pcd)
((${#seen[@]} == num_seen)) || { echo "soak.sh: ${#seen[@]} views were generated" >&2; exit 1; }
mkdir views
for ((v = 0; v < num_views; ++v)); do
  step=$((v % (2 * num_seen - 2)))
  ((step < num_seen)) || step=$((2 * num_seen - 2 - step))
  printf '../seen/%s\0views/cloud_%06d.pcd\0' "${seen[step]}" "$v"
done | xargs -0 -n 2 ln -s

"$resight" recognize --models models.resight --sequence views --out out --threads 1 >log 2>&1 &
pid=$!
ticks_per_s=$(getconf CLK_TCK)

# A line per sample: finished views, resident memory in kB, the processor's time in ticks.
sample() {
  local num_finished=0 memory_kb ticks
  [[ -e out/finished_views.jsonl ]] && num_finished=$(wc -l <out/finished_views.jsonl)
  memory_kb=$(awk '/^VmRSS/ { print $2 }' "/proc/$pid/status" 2>/dev/null) || return 0  # it has ended
  ticks=$(awk '{ print $14 + $15 }' "/proc/$pid/stat" 2>/dev/null) || return 0
  if [[ -n $memory_kb && -n $ticks ]]; then echo "$num_finished $memory_kb $ticks"; fi
}
while kill -0 "$pid" 2>/dev/null; do
  sample
  sleep 0.2
done >samples
wait "$pid" || { echo "recognize failed: $(tail -n 1 log)"; exit 1; }

awk -v n="$num_views" -v ticks_per_s="$ticks_per_s" '
  $2 > peak { peak = $2 }
  $1 >= n / 50 && $1 <= n / 10 { if (!first_begin) { first_begin = $1; first_ticks = $3 }
                                 first_views = $1 - first_begin; first_used = $3 - first_ticks
                                 if ($2 > first_kb) first_kb = $2 }
  $1 >= n * .9 && $1 < n       { if (!last_begin) { last_begin = $1; last_ticks = $3 }
                                 last_views = $1 - last_begin; last_used = $3 - last_ticks
                                 if ($2 > last_kb) last_kb = $2 }
  END {
    if (!first_views || !last_views) { print "views are not written as they are finished"; exit 1 }
    first_ms = 1000 * first_used / first_views / ticks_per_s
    last_ms = 1000 * last_used / last_views / ticks_per_s
    printf "%d views: memory %.0f MB in the first tenth, %.0f MB in the last (%.1f kB per view), %.0f MB at most\n",
           n, first_kb / 1000, last_kb / 1000, (last_kb - first_kb) / (.9 * n), peak / 1000
    printf "time of the processor per view: %.1f ms in the first tenth, %.1f ms in the last\n", first_ms, last_ms
    failed = 0
    if (last_kb > 1.25 * first_kb && last_kb - first_kb > 8 * .9 * n) { print "memory grows"; failed = 1 }
    if (last_ms > 1.25 * first_ms) { print "time per view grows"; failed = 1 }
    exit failed
  }' samples || fail "not flat"

tail -n 3 log
largest=$(find out -name '*.html' -printf '%s\n' | sort -n | tail -n 1)
echo "largest page of the report: $((largest / 1000)) kB of $(find out -name '*.html' | wc -l) pages; results:" \
  "$(du -sk --apparent-size out | cut -f 1) kB"
((largest < 4000000)) || fail "a page of the report is too large"
grep -q '"num_views": '"$num_views," out/summary.json || fail "not all views are in the results"
exit $((failures > 0))
