#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `resight recognize --follow` from end to end: a folder is filled while the program runs, Ctrl-C ends it with all
# results, and they are those of the finished folder. Usage: follow_test.sh PATH_OF_RESIGHT
set -uo pipefail
resight=$(realpath "$1")
source "$(dirname "${BASH_SOURCE[0]}")/small_scene.sh"
cd "$work" || exit 1

write_changing_scene >scene.toml
run simulate scene.toml --out scene --format bop --seed 1
run train scene/models --out models.resight
source_folder=scene/test/000001
intrinsics=262.5,262.5,159.5,119.5

wait_for() { # wait_for FILE TEXT: until the file has the text; a minute is a hang
  for _ in $(seq 600); do grep -q "$2" "$1" 2>/dev/null && return; sleep 0.1; done
  fail "'$2' did not come in $1: $(tail -3 "$1")"
}

put_view() { # put_view NUMBER: as a camera writes it, the depth in two parts
  cp "$source_folder/rgb/00000$1.png" "live/color_00000$1.png"
  head -c 200 "$source_folder/depth/00000$1.png" >"live/depth_00000$1.png"
  sleep 0.2
  cp "$source_folder/depth/00000$1.png" "live/depth_00000$1.png"
}

follow=(recognize --models models.resight --intrinsics $intrinsics --depth-scale 0.0001 --stream)
"$resight" "${follow[@]}" --sequence live --poses fixed --follow --keep-late --trace --out out >lines 2>err &
program=$!
wait_for err 'waiting for views: live: no such directory'
mkdir live
for view in 0 1 2 3 4; do put_view $view; [ $view = 0 ] && wait_for lines color_000000; done
wait_for lines color_000004
kill -TERM $program  # a shell lets its jobs ignore SIGINT
wait $program
status=$?
[ $status = 0 ] || fail "Ctrl-C ends with status $status: $(tail -1 err)"
[ "$(wc -l <lines)" = 5 ] || fail "not a line a view: $(wc -l <lines)"
for file in detections.json changes.json summary.json report.html trace.jsonl; do [ -s out/$file ] || fail "$file is missing"; done
[ ! -e out/finished_views.jsonl ] || fail "finished_views.jsonl is left behind"
grep -q '"num_skipped_views": *0' out/summary.json || fail "summary.json does not count skipped views"

# The same folder as a finished one.
"$resight" "${follow[@]}" --sequence live --poses fixed --trace --out whole >whole_lines 2>err || fail "afterwards: $(tail -1 err)"
cmp -s out/detections.json whole/detections.json || fail "detections differ from those of the finished folder"
cmp -s out/trace.jsonl whole/trace.jsonl || fail "the trace differs from that of the finished folder"
cmp -s out/changes.json whole/changes.json || fail "changes differ from those of the finished folder"

# Results know how their sequence was opened. (A wrong --changes ends the viewer after that.)
"$resight" view whole --no-open --changes live 2>err
grep -q "live: holds no results of 'resight changes'" err || fail "the results do not open their sequence: $(cat err)"

# Poses that are the other way round are noticed when the camera has moved.
"$resight" recognize --models models.resight --sequence "$source_folder" --pose-convention world-to-camera --follow \
  --keep-late --idle-timeout-s 1 --out inverted >/dev/null 2>err || fail "with inverted poses: $(tail -1 err)"
grep -q 'warning: .*the poses are world to camera' err || fail "no line says that poses are inverted: $(cat err)"

# All views are there: the newest one wins, and the idle time ends the run.
"$resight" "${follow[@]}" --sequence live --poses fixed --follow --idle-timeout-s 1 --out newest >lines 2>err ||
  fail "with an idle time: $(tail -1 err)"
{ [ "$(wc -l <lines)" = 1 ] && grep -q color_000004 lines; } || fail "not the newest view only: $(cut -c1-80 lines)"
grep -q '"num_skipped_views": *4' newest/summary.json || fail "not four views are skipped"

# A number of views ends a run, too.
timeout 60 "$resight" "${follow[@]}" --sequence live --poses fixed --follow --keep-late --max-views 2 --out two >lines 2>err ||
  fail "with a number of views: $(tail -1 err)"
{ [ "$(wc -l <lines)" = 2 ] && grep -q color_000001 lines; } || fail "not the first two views: $(cut -c1-80 lines)"

# Nothing comes.
mkdir empty
"$resight" "${follow[@]}" --sequence empty --follow --idle-timeout-s 0.2 --out none >lines 2>err
[ $? = 2 ] || fail "an empty folder is no bad input: $(cat err)"
grep -q 'no view has come: empty: no sequence found' err || fail "no reason for an empty folder: $(cat err)"
[ ! -e none ] || fail "an empty run leaves results"

[ $failures = 0 ] && echo "all as it should be"
exit $failures
