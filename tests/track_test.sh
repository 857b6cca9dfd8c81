#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `resight track` from end to end, on a small walk: the poses are right, an interrupted run ends with the same bytes, the
# cloud and the objects that stand still are written. Usage: track_test.sh PATH_OF_RESIGHT
set -uo pipefail
resight=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0
fail() {
  echo "$1"
  failures=$((failures + 1))
}

cat >scene.toml <<'SCENE'
name = "walk"
[room]
enabled = true
[camera]
width = 320
height = 240
fx = 262.5
fy = 262.5
cx = 159.5
cy = 119.5
[camera.orbit]
center_m = [0.0, 0.0, 0.80]
radius_m = 0.7
height_m = 0.35
start_deg = -120
end_deg = -60
views = 7
[[furniture]]
key = "table"
kind = "table"
size_m = [1.0, 0.7, 0.74]
[[object]]
model = "cereal_blue"
on = "table"
x_m = -0.12
y_m = 0.1
[[object]]
model = "tea_box"
on = "table"
x_m = 0.14
y_m = -0.05
SCENE
"$resight" simulate scene.toml --out walk --format bop --seed 1 >log 2>&1 || fail "simulate failed: $(tail -1 log)"
sequence=walk/test/000001
"$resight" train walk/models --out models.resight >log 2>&1 || fail "train failed: $(tail -1 log)"

"$resight" track --sequence "$sequence" --out whole.txt --fused cloud.ply >out 2>err || fail "track failed: $(tail -1 err)"
grep -q '^7 of 7 views joined' out || fail "not all views joined: $(cat out)"
awk '/ATE/ { exit !($6 < 5) }' out || fail "poses are off: $(grep ATE out)"
[ "$(grep -vc '^#' whole.txt)" = 7 ] || fail "not a line a view"
for file in cloud.ply cloud.png; do [ -s $file ] || fail "$file is not there"; done

"$resight" track --sequence "$sequence" --out parts.txt >/dev/null 2>&1 &
for _ in $(seq 400); do
  [ "$(cat parts.txt.partial 2>/dev/null | wc -l)" -ge 4 ] && break
  sleep 0.02
done
kill -9 $! 2>/dev/null
wait $! 2>/dev/null
"$resight" track --sequence "$sequence" --out parts.txt >/dev/null 2>err || fail "the second run failed: $(tail -1 err)"
grep -q 'tracked before' err || [ -e parts.txt ] || fail "nothing was taken over"
cmp -s <(grep -v '^#' whole.txt) <(grep -v '^#' parts.txt) || fail "an interrupted run ends with other poses"
[ ! -e parts.txt.partial ] || fail "parts.txt.partial is left behind"

"$resight" track --sequence "$sequence" --models models.resight --out with.txt >out 2>err || fail "with objects: $(tail -1 err)"
for object in cereal_blue tea_box; do
  grep -q "^0 $object " with_objects.txt || fail "$object is not among the objects: $(cat with_objects.txt)"
done

[ $failures = 0 ] && echo "all as it should be"
exit $failures
