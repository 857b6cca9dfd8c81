#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `resight track` from end to end, on a small walk: the poses are right, an interrupted run ends with the same bytes,
# and the cloud and the static objects are written. Usage: track_test.sh PATH_OF_RESIGHT
set -uo pipefail
resight=$(realpath "$1")
source "$(dirname "${BASH_SOURCE[0]}")/small_scene.sh"
cd "$work" || exit 1

write_scene 7 -120 -60 true >scene.toml
"$resight" simulate scene.toml --out walk --format bop --seed 1 >log 2>&1 || fail "simulate failed: $(tail -1 log)"
sequence=walk/test/000001
"$resight" train walk/models --out models.resight >log 2>&1 || fail "train failed: $(tail -1 log)"

"$resight" track --sequence "$sequence" --out whole.txt --fused cloud.ply >out 2>err || fail "track failed: $(tail -1 err)"
grep -q '^7 of 7 views joined' out || fail "not all views joined: $(cat out)"
awk '/ATE/ { n++; far = !($6 + 0 < 5) } END { exit !n || far }' out || fail "poses are off: $(grep ATE out)"
[ "$(grep -vc '^#' whole.txt)" = 7 ] || fail "not a line a view"
for file in cloud.ply cloud.png; do [ -s $file ] || fail "$file is not there"; done

# A view that cannot be read interrupts a run; when it is mended, the run goes on from there.
depth=$sequence/depth/000004.png
cp "$depth" good.png
head -c 100 good.png >"$depth"
"$resight" track --sequence "$sequence" --out parts.txt >/dev/null 2>err
[ $? = 2 ] || fail "a truncated view is no bad input"
grep -v ^track err >told
{ [ "$(wc -l <told)" = 1 ] && grep -q '000004.png' told; } || fail "expected one line on the truncated view: $(cat told)"
cp parts.txt.partial sensor.txt.partial
cp good.png "$depth"
"$resight" track --sequence "$sequence" --sensor time-of-flight --out sensor.txt >/dev/null 2>err ||
  fail "with another sensor: $(tail -1 err)"
! grep -q 'tracked before' err || fail "another sensor goes on from the journal of the first"
"$resight" track --sequence "$sequence" --out parts.txt >/dev/null 2>err || fail "the second run failed: $(tail -1 err)"
[ "$(grep -c 'tracked before' err)" = 4 ] || fail "not what was tracked is taken over: $(cat err)"
cmp -s <(grep -v '^#' whole.txt) <(grep -v '^#' parts.txt) || fail "an interrupted run ends with other poses"
[ ! -e parts.txt.partial ] || fail "parts.txt.partial is left behind"

# What was tracked is kept until all results are written: a cloud that finds no space takes no tracking again.
(ulimit -f 300 && "$resight" track --sequence "$sequence" --out kept.txt --fused kept.ply >/dev/null 2>err)
[ $? = 2 ] || fail "a cloud without space is no bad output: $(tail -1 err)"
[ -s kept.txt ] || fail "the poses were not written before the cloud: $(tail -1 err)"
"$resight" track --sequence "$sequence" --out kept.txt --fused kept.ply >/dev/null 2>err || fail "again: $(tail -1 err)"
[ "$(grep -c 'tracked before' err)" = 7 ] || fail "what was tracked is lost if the cloud fails: $(cat err)"
[ ! -e kept.txt.partial ] || fail "kept.txt.partial is left behind"

# What an earlier run has left would pass for results of this one.
head -n 1 whole.txt >stale_component3.txt
echo "# static objects in another walk" >stale_objects.txt
echo "notes of the user" >mine_objects.txt
for name in stale mine; do
  "$resight" track --sequence "$sequence" --poses whole.txt --out $name.txt >/dev/null 2>err || fail "$name: $(tail -1 err)"
done
for file in stale_component3.txt stale_objects.txt; do [ ! -e $file ] || fail "$file of an earlier run stays"; done
[ -s mine_objects.txt ] || fail "a foreign file is removed"

# From a file of poses on.
"$resight" track --sequence "$sequence" --poses whole.txt --out again.txt >out 2>err || fail "from a file: $(tail -1 err)"
grep -q '^7 of 7 views joined' out || fail "not all views joined from a file: $(cat out)"
awk '/ATE/ { n++; far = !($6 + 0 < 5) } END { exit !n || far }' out || fail "poses from a file are off: $(grep ATE out)"

# Other commands take estimated poses, too.
"$resight" changes --sequence "$sequence" --poses auto --out changes >/dev/null 2>err ||
  fail "changes with estimated poses: $(tail -1 err)"
[ "$(find changes -name '*_novel.png' | wc -l)" = 7 ] || fail "not a mask a view: $(ls changes)"

"$resight" track --sequence "$sequence" --models models.resight --out with.txt >out 2>err || fail "with objects: $(tail -1 err)"
for object in cereal_blue tea_box; do
  grep -q "^0 .* $object\$" with_objects.txt || fail "$object is not among the objects: $(cat with_objects.txt)"
done

# The limit of threads does not hold for root.
as_user="" && [ "$(id -u)" != 0 ] || as_user="setpriv --reuid=12345 --clear-groups"
if $as_user "$resight" --version >/dev/null 2>err; then
  $as_user prlimit --nproc=1 "$resight" track --sequence "$sequence" --out none.txt >/dev/null 2>err
  [ $? = 1 ] || fail "without threads, the program does not end with 1"
  [ "$(cat err)" = "resight: failed: the system allows no more threads" ] || fail "without threads: $(cat err)"
fi

[ $failures = 0 ] && echo "all as it should be"
exit $failures
